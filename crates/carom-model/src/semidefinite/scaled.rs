//! A block in units of its own, scaled by powers of two, and what a factorisation finds of it.

/// Steps of inverse iteration.
pub(super) const INVERSE_ITERATIONS: usize = 3;

/// A matrix in units in which its diagonal is within `1..4`.
pub(super) struct Scaled {
    pub(super) diagonal: Vec<f64>,
    /// The entries off the diagonal, the smaller position first.
    pub(super) pairs: Vec<(usize, usize, f64)>,
}

/// The result of a factorisation.
pub(super) enum Factored {
    /// The factor misses no more of the matrix than there is room for.
    Covered,
    /// A vector that the matrix makes short, or turns back.
    Weak(Vec<f64>),
}

/// Whether what a factor misses is within the room that there is, row by row.
///
/// # Arguments
///
/// * `missed`: the sum of the magnitudes in each row of the residual.
pub(super) fn is_covered(matrix: &Scaled, missed: &[f64], room: &[f64]) -> bool {
    // The sum on the diagonal was rounded as well.
    let is_covered = |j: usize| {
        missed[j].is_finite() && missed[j] + f64::EPSILON * matrix.diagonal[j] <= room[j]
    };
    (0..missed.len()).all(is_covered)
}

/// The largest `k` with `2^k <= value`, of a positive value.
pub(super) fn exponent(value: f64) -> i32 {
    let field = |value: f64| (value.to_bits() >> 52 & 0x7ff) as i32;
    match field(value) {
        0 => field(value * 2.0_f64.powi(100)) - 1123,
        field => field - 1023,
    }
}

/// `value * 2^power`, rounded only if it leaves the range of floats.
pub(super) fn times_power(value: f64, power: i32) -> f64 {
    let mut value = value;
    let mut left = power;
    while left != 0 {
        let step = left.clamp(-1000, 1000);
        value *= 2.0_f64.powi(step);
        left -= step;
    }
    value
}
