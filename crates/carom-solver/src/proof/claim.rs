//! The claim of a proof.

/// A statement to be proved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Claim {
    /// The (minimised) objective of every point is at least this.
    Bound(f64),
    /// There is no point.
    Infeasible,
}
