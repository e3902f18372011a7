//! Which heuristics a search may use.

/// The primal heuristics that a search may use.
///
/// Leaves of the tree and integral relaxed points are always used. So are points from the caller (a
/// [`MipStart`](super::MipStart)). Heuristics never change the answer, only how soon it is found:
/// every point is verified, and bounds come only from the tree.
///
/// ```
/// use carom::prelude::*;
/// use carom::solver::Heuristics;
///
/// let mut heuristics = Heuristics::none();
/// heuristics.diving = true;
/// let options = Options::default().with_heuristics(heuristics);
/// assert!(options.heuristics.diving && !options.heuristics.rounding);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Heuristics {
    /// Round and propagate: fixes integers one after the other near their relaxed values, with
    /// propagation in between. At the root and occasionally below it; default on.
    pub rounding: bool,
    /// Roll-out: fixes the inputs of a relaxed point one after the other; states and modes follow
    /// by propagation. At the root and occasionally below it, if there is an objective; default on.
    pub roll_out: bool,
    /// Diving: fixes some integers, solves the relaxation again, and repeats until there is a
    /// point. Its budget of iterations grows with its success; default on.
    pub diving: bool,
    /// Relaxation-induced neighbourhood search: fixes integers on which the best point and a
    /// relaxed point agree, and searches the rest for a better point with few nodes; default on.
    pub neighbourhood: bool,
}

impl Default for Heuristics {
    fn default() -> Self {
        Heuristics { rounding: true, roll_out: true, diving: true, neighbourhood: true }
    }
}

impl Heuristics {
    /// No heuristic.
    pub const fn none() -> Self {
        Heuristics { rounding: false, roll_out: false, diving: false, neighbourhood: false }
    }

    /// The heuristics of a nested search.
    pub(crate) const fn nested(self) -> Self {
        let Heuristics { rounding, roll_out, diving, .. } = self;
        Heuristics { rounding, roll_out, diving, ..Heuristics::none() }
    }
}
