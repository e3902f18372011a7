//! Directions of negative curvature: rounded to few digits, and checked with twice the digits.

use super::block::MatrixBlock;
use super::scaled::{exponent, times_power};
use crate::sum::Sum;
use crate::tolerance::largest_magnitude;

/// Digits that the entries of a direction are rounded to, the fewest with which the curvature is
/// proved to be negative.
const ENTRY_DIGITS: [usize; 4] = [3, 6, 10, 17];

/// The rounding of a compensated sum, relative to the sum of its terms' magnitudes and for the
/// square of their number.
const SUM_ROUNDING: f64 = 4.0 * f64::EPSILON * f64::EPSILON;

/// Sums of smaller terms may underflow.
const LEAST: f64 = 1e-200;

/// Entries below this part of the largest one, in the unit of the matrix, are left out; so products
/// of two of them do not underflow.
const TINY: f64 = 1e-60;

/// A direction along which a form is concave.
#[derive(Debug, Clone, Default)]
pub struct Direction {
    /// Variables and their steps, the largest of which is 1, in the order of the variables.
    pub steps: Vec<(usize, f64)>,
    /// `2 d'Md / d'd`: the second derivative along the direction, per unit of length squared.
    pub curvature: f64,
}

impl Direction {
    /// Along one variable.
    pub(super) fn axis(block: &MatrixBlock, j: usize) -> Self {
        Direction { steps: vec![(block.names[j], 1.0)], curvature: 2.0 * block.diagonal[j] }
    }

    /// From a variable whose square has no positive coefficient; and whether it is proved.
    pub(super) fn at_flat(block: &MatrixBlock, j: usize) -> (Self, bool) {
        if block.diagonal[j] < 0.0 {
            return (Direction::axis(block, j), true);
        }
        let of_it = block.pairs.iter().filter(|(a, b, q)| (*a == j || *b == j) && *q != 0.0);
        let largest = of_it.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
        match largest {
            Some(&(a, b, q)) => Direction::of_pair(block, a, b, q),
            None => (Direction::axis(block, j), false),
        }
    }

    /// Along two variables whose product outweighs their squares.
    pub(super) fn of_pair(block: &MatrixBlock, i: usize, j: usize, q: f64) -> (Self, bool) {
        // Steps with which both squares weigh about the same; one flat one goes as far as the
        // product needs to win.
        let flat = |k: usize| block.diagonal[k] <= 0.0;
        let even = |k: usize| if flat(k) { 0 } else { -exponent(block.diagonal[k]).div_euclid(2) };
        let mut powers = [even(i), even(j)];
        if flat(i) != flat(j) {
            let k = usize::from(flat(j));
            powers[k] = 3 - exponent(q.abs()) - powers[1 - k];
        }
        let mut vector = vec![(0.0, 0); block.names.len()];
        vector[i] = (1.0, powers[0]);
        vector[j] = (-1.0_f64.copysign(q), powers[1]);
        Direction::from_scaled(block, vector)
    }

    /// From entries times powers of two; and whether it is proved that the curvature is negative.
    pub(super) fn from_scaled(block: &MatrixBlock, vector: Vec<(f64, i32)>) -> (Self, bool) {
        // Units in which the entries of the direction are comparable: those of the matrix.
        let used = vector.iter().filter(|(z, _)| *z != 0.0 && z.is_finite());
        let largest = largest_magnitude(used.clone().map(|(z, _)| z));
        let top = used.map(|&(z, power)| exponent(z.abs()) + power).max().unwrap_or(0);
        let mut last = Direction { steps: Vec::new(), curvature: f64::NAN };
        for digits in ENTRY_DIGITS {
            let least = TINY.max(if digits == 17 { 0.0 } else { 0.1_f64.powi(digits as i32) });
            let mut steps: Vec<(usize, f64)> = Vec::new();
            for (k, &(z, power)) in vector.iter().enumerate() {
                let step = rounded(times_power(z, power - top), digits);
                if z.is_finite() && z.abs() >= least * largest && step.is_normal() {
                    steps.push((k, step));
                }
            }
            let size = |step: &f64| step.abs();
            let largest = steps.iter().rev().map(|(_, step)| *step);
            let largest = largest.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(1.0);
            steps.iter_mut().for_each(|(_, step)| *step = rounded(*step / largest, digits));
            let powers: Vec<i32> = vector.iter().map(|(_, power)| *power).collect();
            let (curvature, is_proved) = curvature(block, &steps, &powers);
            let named = steps.into_iter().map(|(k, step)| (block.names[k], step));
            last = Direction { steps: named.collect(), curvature };
            if is_proved {
                return (last, true);
            }
        }
        (last, false)
    }
}

fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// `2 d'Md / d'd`, and whether it is proved to be negative.
fn curvature(block: &MatrixBlock, steps: &[(usize, f64)], powers: &[i32]) -> (f64, bool) {
    // In units in which the direction is comparable, so that nothing underflows that matters.
    let mut scaled = vec![0.0; powers.len()];
    let mut squares = 0.0;
    for &(k, step) in steps {
        scaled[k] = times_power(step, -powers[k]);
        squares += step * step;
    }
    let top = scaled.iter().filter(|z| **z != 0.0).map(|z| exponent(z.abs())).max().unwrap_or(0);
    scaled.iter_mut().for_each(|z| *z = times_power(*z, -top));
    let (mut sum, mut size, mut count) = (Sum::default(), 0.0, 0.0);
    let diagonal = block.diagonal.iter().enumerate().map(|(k, &q)| (k, k, q));
    for (i, j, q) in diagonal.chain(block.pairs.iter().copied()) {
        if scaled[i] != 0.0 && scaled[j] != 0.0 {
            let entry = times_power(q, powers[i] + powers[j]);
            sum.add_product_of_three(scaled[i], scaled[j], entry);
            size += (scaled[i] * scaled[j] * entry).abs();
            count += 1.0;
        }
    }
    let value = sum.value();
    let rounding = SUM_ROUNDING * (count + 4.0) * (count + 4.0) * size;
    let is_proved = value < -rounding && size.is_finite() && size > LEAST;
    (2.0 * times_power(value, 2 * top) / squares, is_proved)
}
