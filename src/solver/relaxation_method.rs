//! Which method solves the continuous relaxations.

use std::fmt;

/// Which method solves the continuous relaxations of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RelaxationMethod {
    /// Methods that start from what the parent's relaxation left: dual simplex for linear
    /// relaxations, dual active set for small dense ones that are strictly convex. For the others, and
    /// for those that these give up on, as [`InteriorPoint`](Self::InteriorPoint).
    #[default]
    ActiveSet,
    /// The crate's own interior-point method, and Clarabel for the relaxations that it gives up on.
    InteriorPoint,
    /// Clarabel alone.
    Clarabel,
}

impl RelaxationMethod {
    /// All methods.
    pub const ALL: [RelaxationMethod; 3] =
        [RelaxationMethod::ActiveSet, RelaxationMethod::InteriorPoint, RelaxationMethod::Clarabel];
}

impl fmt::Display for RelaxationMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RelaxationMethod::ActiveSet => "active-set",
            RelaxationMethod::InteriorPoint => "interior-point",
            RelaxationMethod::Clarabel => "clarabel",
        })
    }
}
