//! The capabilities that a backend may lack.

use std::fmt;

/// A capability that a backend may lack. Every backend must have all that is not listed here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Capability {
    /// Continuous variables.
    Continuous,
    /// Integer variables beyond binaries.
    Integers,
    /// Convex quadratic objectives over continuous variables.
    Quadratic,
    /// Convex quadratic objectives with integers or binaries.
    MixedIntegerQuadratic,
    /// Norms and convex quadratic rows: second-order cones, with and without integers.
    Cones,
    /// Indicators.
    Indicators,
    /// Logic over binaries.
    Logic,
    /// Disjunctions.
    Disjunctions,
    /// Special ordered sets.
    OrderedSets,
    /// Semi-continuous and semi-integer variables.
    SemiContinuous,
    /// Functions: products, absolute values, extrema.
    Functions,
    /// Detecting that a program is unbounded.
    Unbounded,
    /// Limits on nodes.
    NodeLimit,
    /// Limits on time.
    TimeLimit,
    /// Reacting to an interrupt while the search runs, not only before.
    InterruptWhileRunning,
    /// Progress events: the root, and every incumbent that is returned.
    Events,
}

impl fmt::Display for Capability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Capability::Continuous => "continuous variables",
            Capability::Integers => "integers beyond binaries",
            Capability::Quadratic => "quadratic objectives",
            Capability::MixedIntegerQuadratic => "quadratic objectives with integers",
            Capability::Cones => "norms and quadratic rows",
            Capability::Indicators => "indicators",
            Capability::Logic => "logic",
            Capability::Disjunctions => "disjunctions",
            Capability::OrderedSets => "special ordered sets",
            Capability::SemiContinuous => "semi-continuous variables",
            Capability::Functions => "functions",
            Capability::Unbounded => "detecting that a program is unbounded",
            Capability::NodeLimit => "node limits",
            Capability::TimeLimit => "time limits",
            Capability::InterruptWhileRunning => "interrupts while running",
            Capability::Events => "progress events",
        })
    }
}
