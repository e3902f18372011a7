//! Which speed of a hit counts as damage.

/// Which speed counts as the impact speed of a step that hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ImpactEstimate {
    /// At least the approach at both ends of the step. The impact lies between them, so this is
    /// never less than its speed. Steps without a hit stay outside all along.
    #[default]
    Sound,
    /// The approach at the end of the step, had there been no hit, as in the paper. The impact may
    /// be faster, by up to the largest acceleration times Δt, and a step without a hit may dip into
    /// a surface between its ends.
    EndOfStep,
}
