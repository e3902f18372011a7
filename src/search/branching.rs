//! Which column to split, and which child to visit first.
//!
//! Columns of a horizon (binaries of a family over steps) are split latest step first: under
//! big-M rows fractionality says little, and a late decision propagates backwards through the
//! dynamics. Measured on a wall program, latest-first closed the tree in 71 nodes where
//! earliest-first ran out of time. Columns without a step are split by fractionality.

use super::node::Decision;
use crate::presolve::Domain;
use crate::program::Program;

/// A split of a node: the two decisions, the one to visit first in front.
pub(super) fn choose(
    program: &Program,
    domain: &Domain,
    x: &[f64],
    integrality: f64,
) -> Option<[Decision; 2]> {
    let unfixed = || program.integers.iter().copied().filter(|&j| !domain.is_fixed(j));
    let distance = |j: usize| (x[j] - x[j].round()).abs();
    let fractional = |j: &usize| distance(*j) > integrality;
    let latest = unfixed()
        .filter(|&j| program.step[j].is_some() && fractional(&j))
        .max_by_key(|&j| (program.step[j], std::cmp::Reverse(j)));
    let column = latest
        .or_else(|| {
            unfixed()
                .filter(fractional)
                .max_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(b.cmp(&a)))
        })
        .or_else(|| unfixed().max_by_key(|&j| (program.step[j], std::cmp::Reverse(j))))?;
    Some(split(domain, column, x[column]))
}

/// Splits at the value of the relaxation: `x <= floor` or `x >= floor + 1`, nearer side first.
fn split(domain: &Domain, column: usize, value: f64) -> [Decision; 2] {
    let (lower, upper) = (domain.lower(column), domain.upper(column));
    let value =
        if value.is_finite() { value.clamp(lower, upper) } else { lower.max(upper.min(0.0)) };
    // Integral values are split so that both sides are smaller than the whole.
    let below = value.floor().clamp(lower, (upper - 1.0).max(lower));
    let down = Decision { column, is_upper: true, value: below };
    let up = Decision { column, is_upper: false, value: below + 1.0 };
    if value - below > 0.5 { [up, down] } else { [down, up] }
}
