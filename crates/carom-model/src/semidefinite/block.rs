//! One block of a quadratic form: scaling, cheap tests, and the verdict of a factor.

use super::direction::Direction;
use super::scaled::{Factored, Scaled, exponent, times_power};
use super::{Product, dense, sparse};

/// How many units in the last place of its coefficient each square may lack, for each entry of the
/// longest row: the rounding of the products and sums that the coefficients come from.
const UNITS: f64 = 8.0;

/// The same where neither a proof nor a direction is found otherwise, as a multiple of [`UNITS`].
const MORE: f64 = 16.0;

/// Entries beyond this in a matrix whose diagonal is within `1..4` leave a negative minor.
const BEYOND: f64 = 8.0;

/// The part of what is allowed that is left for what a factor misses (no unit).
const FOR_FACTOR: f64 = 1.0 / 64.0;

/// The most that is added to a diagonal entry: fixed variables may lack anything.
const MOST_ADDED: f64 = 1e300;

/// The symmetric matrix of a block; variables are numbered within it.
pub(super) struct MatrixBlock {
    /// By variable: its number in the whole form.
    pub(super) names: Vec<usize>,
    pub(super) diagonal: Vec<f64>,
    /// Twice the entries above the diagonal, as the form has them.
    pub(super) pairs: Vec<Product>,
    allowed: Vec<f64>,
    /// The entries of the longest row.
    longest: usize,
}

/// The verdict on a block.
enum Curvature {
    Proved,
    Negative(Direction),
    /// Neither, with the most promising direction.
    Open(Direction),
}

impl MatrixBlock {
    /// From products of places among the names.
    pub(super) fn new(names: Vec<usize>, products: &[Product], allowed: Vec<f64>) -> Self {
        let mut diagonal = vec![0.0; names.len()];
        let mut pairs = Vec::with_capacity(products.len());
        let mut count = vec![1; names.len()];
        for &(i, j, q) in products {
            if i == j {
                diagonal[i] += q;
            } else {
                pairs.push((i, j, q));
                (count[i], count[j]) = (count[i] + 1, count[j] + 1);
            }
        }
        let longest = count.into_iter().max().unwrap_or(0);
        MatrixBlock { names, diagonal, pairs, allowed, longest }
    }

    /// A direction of negative curvature; `None` if there is none but for what is allowed.
    pub(super) fn refute(&self) -> Option<Direction> {
        let mut open = None;
        for part in [UNITS, UNITS * MORE] {
            match self.verdict(part * f64::EPSILON * (self.longest + 2) as f64) {
                Curvature::Proved => return None,
                Curvature::Negative(direction) => return Some(direction),
                Curvature::Open(direction) => open = Some(direction),
            }
        }
        open
    }

    fn verdict(&self, rounding: f64) -> Curvature {
        let n = self.names.len();
        // Half of the rounding, and some of what is allowed, is for what the factor misses.
        let shares = |of_rounding: f64, of_allowed: f64| -> Vec<f64> {
            let share = |j: usize| {
                let rounding = of_rounding * rounding * self.diagonal[j].abs();
                (rounding + of_allowed * self.allowed[j]).min(MOST_ADDED)
            };
            (0..n).map(share).collect()
        };
        let (added, room) = (shares(0.5, 1.0 - FOR_FACTOR), shares(0.5, FOR_FACTOR));
        let raised: Vec<f64> = (0..n).map(|j| self.diagonal[j] + added[j]).collect();
        if self.pairs.is_empty() {
            let negative = |j: &usize| raised[*j] + room[*j] < 0.0;
            return match (0..n).find(negative) {
                Some(j) => Curvature::Negative(Direction::axis(self, j)),
                None => Curvature::Proved,
            };
        }
        if let Some(j) = (0..n).find(|&j| raised[j].is_nan() || raised[j] <= 0.0) {
            return self.judge(Direction::at_flat(self, j));
        }
        if self.is_dominant(&raised) {
            return Curvature::Proved;
        }
        let powers: Vec<i32> = raised.iter().map(|&entry| -exponent(entry).div_euclid(2)).collect();
        let mut pairs = Vec::with_capacity(self.pairs.len());
        for &(i, j, q) in &self.pairs {
            let entry = times_power(q, powers[i] + powers[j] - 1);
            if entry.abs() >= BEYOND {
                return self.judge(Direction::of_pair(self, i, j, q));
            }
            pairs.push((i, j, entry));
        }
        let scaled = |entries: &[f64]| -> Vec<f64> {
            let entries = entries.iter().zip(&powers);
            entries.map(|(&entry, &power)| times_power(entry, 2 * power)).collect()
        };
        let (matrix, room) = (Scaled { diagonal: scaled(&raised), pairs }, scaled(&room));
        let weak = match factor(&matrix, &room) {
            Factored::Covered => return Curvature::Proved,
            Factored::Weak(vector) => vector,
        };
        self.judge(Direction::from_scaled(self, weak.into_iter().zip(powers).collect()))
    }

    fn judge(&self, (direction, is_proved): (Direction, bool)) -> Curvature {
        if is_proved { Curvature::Negative(direction) } else { Curvature::Open(direction) }
    }

    /// Whether each diagonal entry is at least the sum of the other ones of its row.
    fn is_dominant(&self, diagonal: &[f64]) -> bool {
        let mut sums = vec![0.0_f64; diagonal.len()];
        for &(i, j, q) in &self.pairs {
            sums[i] += q.abs();
            sums[j] += q.abs();
        }
        // The entries are half as large. Sums are rounded.
        let part = 0.5 * (1.0 + f64::EPSILON * (self.longest + 2) as f64);
        diagonal.iter().zip(&sums).all(|(entry, sum)| *entry >= sum * part)
    }
}

/// Fewest products summed up in a factor that is computed as a dense one.
const DENSE_PRODUCTS: f64 = 2e7;

/// Most rows of a matrix whose factor is computed as a dense one.
const DENSE_ROWS: usize = 8192;

/// Factorises a matrix.
///
/// # Arguments
///
/// * `room`: by row, what the magnitudes that the factor misses may sum up to.
fn factor(matrix: &Scaled, room: &[f64]) -> Factored {
    let n = matrix.diagonal.len();
    let natural = || (0..n).collect::<Vec<usize>>();
    // Where most entries are there, no order leaves fewer.
    if 4 * matrix.pairs.len() > n * n {
        let is_small = (n as f64).powi(3) / 6.0 < DENSE_PRODUCTS || n > DENSE_ROWS;
        return if is_small {
            sparse::factor(matrix, &natural(), room)
        } else {
            dense::factor(matrix, room)
        };
    }
    match sparse::order(matrix) {
        Some((order, work)) if work < DENSE_PRODUCTS || n > DENSE_ROWS => {
            sparse::factor(matrix, &order, room)
        }
        None if n > DENSE_ROWS => sparse::factor(matrix, &natural(), room),
        _ => dense::factor(matrix, room),
    }
}
