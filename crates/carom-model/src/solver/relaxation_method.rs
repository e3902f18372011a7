//! Which method solves the continuous relaxations.

use std::fmt;

/// Which method solves the continuous relaxations of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RelaxationMethod {
    /// The method that suits a relaxation: the dual simplex method for linear ones and the dual
    /// active-set method for small dense ones that are strictly convex, both started from the
    /// parent's relaxation. For the others, and where these two give up, as
    /// [`InteriorPoint`](Self::InteriorPoint).
    #[default]
    Automatic,
    /// The crate's own interior-point method, and Clarabel for the relaxations that it gives up on.
    InteriorPoint,
    /// Clarabel alone.
    Clarabel,
}

impl RelaxationMethod {
    /// All methods.
    pub const ALL: [RelaxationMethod; 3] =
        [RelaxationMethod::Automatic, RelaxationMethod::InteriorPoint, RelaxationMethod::Clarabel];
}

impl fmt::Display for RelaxationMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RelaxationMethod::Automatic => "automatic",
            RelaxationMethod::InteriorPoint => "interior-point",
            RelaxationMethod::Clarabel => "clarabel",
        })
    }
}
