//! Why there is no terminal cost or no terminal set.

use thiserror::Error;

/// Why a system has no terminal cost or no terminal set.
///
/// It is an [`ErrorKind::Terminal`](super::ErrorKind::Terminal).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TerminalError {
    /// A weight is not symmetric.
    #[error("the weight {weight} is not symmetric; give its symmetric part (W + W')/2")]
    NotSymmetric {
        /// `Q` or `R`.
        weight: &'static str,
    },
    /// A weight has an eigenvalue that is too small.
    #[error(
        "the weight {weight} has the eigenvalue {eigenvalue:.3e}; Q must be positive semidefinite \
         and R positive definite"
    )]
    Indefinite {
        /// `Q` or `R`.
        weight: &'static str,
        /// Its smallest eigenvalue.
        eigenvalue: f64,
    },
    /// No feedback stabilises the system.
    #[error(
        "the system is not stabilisable: no input moves its mode with |eigenvalue| = \
         {magnitude:.6}; leave that state out, or add an input that acts on it"
    )]
    NotStabilisable {
        /// The magnitude of the eigenvalue of A.
        magnitude: f64,
    },
    /// The cost does not see a mode that does not decay by itself.
    #[error(
        "the cost does not see the system's mode with |eigenvalue| = {magnitude:.6}, so the least \
         cost does not stabilise it; give Q a weight on it"
    )]
    NotDetectable {
        /// The magnitude of the eigenvalue of A.
        magnitude: f64,
    },
    /// The Riccati equation was not solved to a small residual.
    #[error(
        "the Riccati equation is solved only to a relative residual of {residual:.3e}; scale the \
         states and the inputs so that entries of Q and R are of similar size"
    )]
    NotSolved {
        /// The residual relative to the cost matrix.
        residual: f64,
    },
    /// No input holds the system at the target.
    #[error(
        "no input holds the system at the target: the best one moves `{state}` by {drift:.3e} a \
         step; choose a target that is an equilibrium"
    )]
    NoEquilibrium {
        /// The state that moves most.
        state: String,
        /// How far it moves, in the state's unit.
        drift: f64,
    },
    /// The target violates a limit, or lies on it, so no set around it satisfies the limit.
    #[error(
        "the target leaves `{limit}` a slack of {slack:.3e}, so no set around it satisfies that \
         limit; choose a target inside all limits, ranges and guards of its mode"
    )]
    AtLimit {
        /// The domain, range, limit or guard.
        limit: String,
        /// How far the target is inside, in the limit's unit; 0 or less.
        slack: f64,
    },
    /// A transition that cannot be repeated for ever.
    #[error("`{transition}` cannot be repeated for ever: {reason}; choose another transition")]
    CannotStay {
        /// The transition.
        transition: String,
        /// The reason why it cannot be repeated, in words.
        reason: String,
    },
    /// The feedback does not stabilise the mode.
    #[error(
        "the feedback does not stabilise the mode: the spectral radius of A + B K is \
         {spectral_radius:.6}; use the regulator of the mode's own flow"
    )]
    NotStabilising {
        /// The largest magnitude of an eigenvalue of A + B K, 1 or more.
        spectral_radius: f64,
    },
    /// The limits over more and more steps go on to cut the set.
    #[error(
        "the terminal set is not determined after {iterations} steps; raise `most_iterations`, or \
         use a feedback that converges faster"
    )]
    NotDetermined {
        /// How many steps were tried.
        iterations: usize,
    },
    /// The check of the finished set failed, or the solver gave no proof.
    #[error(
        "the terminal set is not verified: a state in it may get to {reached:.9} of `{limit}` \
         where at most {allowed:.9} is allowed; lower `contraction`"
    )]
    NotVerified {
        /// The facet.
        limit: String,
        /// The proved bound on what a step can reach, as a fraction of the facet's distance.
        reached: f64,
        /// The largest allowed value, as a fraction of the facet's distance.
        allowed: f64,
    },
}
