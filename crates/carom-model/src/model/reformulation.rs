//! How a model prefers to be lowered to rows. Preferences never change which points are feasible.

/// How a disjunction becomes rows. All methods have the same solutions. They differ in size and in
/// the tightness of the relaxation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Method {
    /// If a term is not selected, its rows are relaxed by one M each. Fewest rows and columns,
    /// weakest relaxation.
    #[default]
    #[doc(alias = "big-M")]
    BigM,
    /// Each row of a term is relaxed by a separate M for each of the *other* terms, from a linear
    /// program over that term. As many rows as big-M, and never weaker.
    MultiM,
    /// The convex hull of the terms: a copy of the variables for each term. The tightest
    /// relaxation of a single disjunction, at the price of many columns.
    Hull,
}

impl Method {
    /// All methods, from the smallest to the tightest.
    pub const ALL: [Method; 3] = [Method::BigM, Method::MultiM, Method::Hull];

    /// The usual name of the method.
    pub fn word(self) -> &'static str {
        match self {
            Method::BigM => "big-M",
            Method::MultiM => "multi-M",
            Method::Hull => "hull",
        }
    }
}

/// How a model is to be lowered to rows. This changes sizes, bounds and solution times, but not the
/// set of solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[must_use = "a reformulation does nothing until it is given to `Model::set_reformulation`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reformulation {
    method: Method,
    linear_programs: bool,
}

impl Reformulation {
    /// Sets the method for disjunctions without one of their own; [`Method::BigM`] by default.
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Chooses whether every big-M is tightened by a linear program over the whole relaxation. Off
    /// by default, because each lowering then solves a linear program per M. It pays if the search
    /// is long.
    pub fn with_linear_programs(mut self, on: bool) -> Self {
        self.linear_programs = on;
        self
    }

    /// The method for disjunctions without one of their own.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Whether big-Ms are tightened by linear programs.
    pub fn linear_programs(&self) -> bool {
        self.linear_programs
    }
}

/// Where the big-M of an indicator comes from. Values are in the unit of the indicator's row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BigM {
    /// Derived per side from the current bounds of the row's variables.
    #[default]
    Automatic,
    /// The user's value, refused unless the current bounds prove it.
    Given(f64),
    /// The user's value, used without proof; the report lists it.
    Assumed(f64),
}
