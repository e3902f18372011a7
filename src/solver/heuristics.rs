//! Which heuristics a search may use.

/// Which heuristics a search may use: ways to look for points beside the nodes themselves.
///
/// Leaves of the tree and relaxed points whose integers are whole are no heuristics and always
/// taken. Points that the caller proposes (a guess of a [`TreeSeed`](super::TreeSeed), a
/// [`Proposal`](super::Proposal)) are tried wherever they are given. Heuristics never change the
/// answer, only how soon it is found: every point is verified, and bounds come from the tree alone.
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Heuristics {
    /// Round and propagate: integers are fixed one after the other near their relaxed values, and
    /// propagation fixes others on the way. At the root and now and then below it; default on.
    pub rounding: bool,
    /// Rolling out: the inputs of a relaxed point are fixed one after the other, and states and modes
    /// follow by propagation. At the root and now and then below it, where there is an objective;
    /// default on.
    pub roll_out: bool,
    /// Diving: some integers are fixed, the relaxation is solved again, and so on down to a point.
    /// A budget of iterations grows with its success; default on.
    pub diving: bool,
    /// Relaxation-induced neighbourhood search: integers on which the best point and a relaxed
    /// point agree are fixed, and what is left is searched for a better point, with few nodes;
    /// default on.
    pub neighbourhood: bool,
    /// Local branching: a small search among the points that differ from the best one in few
    /// binaries; default off.
    pub local_branching: bool,
    /// The feasibility pump: rounding and projection in turn, where the root of a program with an
    /// objective has led to no point; default on.
    pub pump: bool,
}

impl Default for Heuristics {
    fn default() -> Self {
        Heuristics {
            rounding: true,
            roll_out: true,
            diving: true,
            neighbourhood: true,
            local_branching: false,
            pump: true,
        }
    }
}

impl Heuristics {
    /// No heuristic.
    pub const fn none() -> Self {
        Heuristics {
            rounding: false,
            roll_out: false,
            diving: false,
            neighbourhood: false,
            local_branching: false,
            pump: false,
        }
    }

    /// Every heuristic.
    pub const fn all() -> Self {
        Heuristics {
            rounding: true,
            roll_out: true,
            diving: true,
            neighbourhood: true,
            local_branching: true,
            pump: true,
        }
    }

    /// Those that a search inside a search may use.
    pub(crate) const fn nested(self) -> Self {
        let Heuristics { rounding, roll_out, diving, .. } = self;
        Heuristics { rounding, roll_out, diving, ..Heuristics::none() }
    }
}
