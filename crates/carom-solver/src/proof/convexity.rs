//! The proof that an objective is convex: a factor `L` and what the diagonal lacks, `d`, such that
//! `P + diag(d) - L L'` is diagonally dominant.
//!
//! `semidefinite` first adds to the diagonal what rounding may have taken from it, and ends at a
//! pivot that is not positive. What it adds would be a deficit here, which no column without a
//! bound can have. So the matrix stays as it is, and such pivots are passed over.

use std::collections::BTreeMap;

use crate::program::Program;
use crate::semidefinite::blocks;
use crate::sum::Sum;

/// The part of each diagonal entry that the factor leaves, for rounding (no unit).
const LEFT_FOR_ROUNDING: f64 = 1e-12;

/// The part of a diagonal entry below which a pivot may be rounding (no unit).
const SLIGHT_PIVOT: f64 = 1e-11;

/// The part of what is known of the steepness that is proved, so that rounding has room (no unit).
const OF_STEEPNESS: f64 = 0.99;

/// A factor by columns, and the deficits by column of the program.
#[derive(Debug, Default)]
pub(super) struct ConvexityProof {
    pub(super) factor: Vec<Vec<(usize, f64)>>,
    pub(super) deficits: Vec<f64>,
}

/// A symmetric matrix by columns of its lower triangle.
type Lower = Vec<BTreeMap<usize, f64>>;

/// The tries of a steepness, each half of the one before, and the largest as a part of the least
/// diagonal entry.
const STEEPNESS_TRIES: i32 = 30;
const LARGEST_STEEPNESS: f64 = 0.25;

/// How much larger than necessary the deficits of columns are that make others steep, for rounding
/// (no unit).
const PAID_FOR_STEEPNESS: f64 = 1.0 + 1e-9;

impl ConvexityProof {
    /// Of the objective of a program.
    ///
    /// Where a column with curvature lacks a bound, the deficits of its block are negative if they
    /// can be: the objective is steep there.
    ///
    /// # Arguments
    ///
    /// * `is_open`: whether a column lacks a bound.
    pub(super) fn of(program: &Program, is_open: &dyn Fn(usize) -> bool) -> Self {
        let mut convexity = ConvexityProof::nothing(program);
        for (names, matrix) in matrices(program) {
            let spare: Vec<f64> = match names.iter().any(|&j| is_open(j)) {
                true => names.iter().map(|&j| OF_STEEPNESS * program.steepness()[j]).collect(),
                false => vec![0.0; names.len()],
            };
            convexity.add(&names, matrix, &spare);
        }
        convexity
    }

    /// A proof in which all columns with curvature that lack a bound are steep, at the cost of the
    /// others; `None` if there are none, or if they cannot be.
    ///
    /// If `P` is positive semidefinite with the parts `A`, `B`, `C` (the columns without bounds,
    /// the products with others, and these), it stays so with `A / 2` and `2 C` instead, as with
    /// all rows and columns of the one times the root of 1/2 and of the other times the root of 2.
    /// So `C` has deficits that are at least as large as it, and `A` has as much to spare as half
    /// of it.
    pub(super) fn steep(program: &Program, is_open: &dyn Fn(usize) -> bool) -> Option<Self> {
        let mut convexity = ConvexityProof::nothing(program);
        let mut is_any = false;
        for (names, matrix) in matrices(program) {
            let is_open: Vec<bool> = names.iter().map(|&j| is_open(j)).collect();
            if !is_open.contains(&true) {
                convexity.add(&names, matrix, &vec![0.0; names.len()]);
                continue;
            }
            is_any = true;
            let diagonal = |k: usize| matrix[k].get(&k).copied().unwrap_or(0.0);
            let open = (0..names.len()).filter(|&k| is_open[k]);
            let least = open.map(diagonal).fold(f64::INFINITY, f64::min);
            let mut paid = vec![0.0; names.len()];
            for (k, column) in matrix.iter().enumerate() {
                for (&i, value) in column.iter().filter(|(i, _)| !is_open[k] && !is_open[**i]) {
                    paid[k] += PAID_FOR_STEEPNESS * value.abs();
                    paid[i] += if i == k { 0.0 } else { PAID_FOR_STEEPNESS * value.abs() };
                }
            }
            let begun = convexity.factor.len();
            let is_steep = (0..STEEPNESS_TRIES).any(|k| {
                let steepness = LARGEST_STEEPNESS * least * 0.5_f64.powi(k);
                let taken = (0..names.len()).map(|k| if is_open[k] { steepness } else { -paid[k] });
                convexity.factor.truncate(begun);
                convexity.add(&names, matrix.clone(), &taken.collect::<Vec<f64>>());
                (0..names.len()).all(|k| !is_open[k] || convexity.deficits[names[k]] < 0.0)
            });
            if !is_steep {
                return None;
            }
        }
        is_any.then_some(convexity)
    }

    fn nothing(program: &Program) -> Self {
        ConvexityProof { factor: Vec::new(), deficits: vec![0.0; program.column_count()] }
    }

    /// Adds a block, from whose diagonal something is taken.
    fn add(&mut self, names: &[usize], mut matrix: Lower, taken: &[f64]) {
        matrix.iter_mut().enumerate().for_each(|(k, column)| {
            if taken[k] != 0.0 {
                *column.entry(k).or_default() -= taken[k];
            }
        });
        let matrix = &matrix;
        let mut lack = lacking(matrix, &[]);
        let mut factor = Vec::new();
        if lack.iter().any(|&lack| lack > 0.0) {
            // A matrix that is not singular has no deficits if a little is left of it for rounding;
            // of a singular one, nothing can be left.
            let tried = [LEFT_FOR_ROUNDING, 0.0].map(|left| {
                let factor = factorise(matrix, left);
                let lack = lacking(matrix, &factor);
                (lack.iter().sum::<f64>(), factor, lack)
            });
            let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
            (_, factor, lack) = best.unwrap_or_default();
        }
        for (k, lack) in lack.into_iter().enumerate() {
            // The matrix without what was taken was rounded.
            let rounding = if taken[k] != 0.0 {
                4.0 * f64::EPSILON * matrix_size(matrix, k, taken[k])
            } else {
                0.0
            };
            self.deficits[names[k]] = lack - taken[k] + rounding;
        }
        let name = |column: Vec<(usize, f64)>| -> Vec<(usize, f64)> {
            column.into_iter().map(|(i, value)| (names[i], value)).collect()
        };
        self.factor.extend(factor.into_iter().map(name));
    }
}

/// The blocks of the curvature of a program: their columns, and their entries.
fn matrices(program: &Program) -> impl Iterator<Item = (Vec<usize>, Lower)> {
    let upper = program.quadratic_entries().filter(|(i, j, _)| i <= j);
    let products: Vec<_> = upper.collect();
    blocks(&products).into_iter().map(|(names, entries)| {
        let mut matrix: Lower = vec![BTreeMap::new(); names.len()];
        for (i, j, p) in entries {
            *matrix[i.min(j)].entry(i.max(j)).or_default() += p;
        }
        (names, matrix)
    })
}

/// By row, what the diagonal of `A - L L'` lacks of the sum of the other magnitudes.
fn lacking(matrix: &Lower, factor: &[Vec<(usize, f64)>]) -> Vec<f64> {
    let n = matrix.len();
    // By entry: the sum, and the magnitudes of its terms.
    let mut rest: Vec<BTreeMap<usize, (Sum, f64)>> = vec![BTreeMap::new(); n];
    for (j, column) in matrix.iter().enumerate() {
        for (&i, &a) in column {
            rest[j].insert(i, (Sum::new(a), 0.0));
        }
    }
    for column in factor {
        for (k, &(j, b)) in column.iter().enumerate() {
            for &(i, a) in &column[k..] {
                let (sum, size) = rest[j].entry(i).or_default();
                sum.add_product(-a, b);
                *size += (a * b).abs();
            }
        }
    }
    let mut lack = vec![Sum::default(); n];
    for (j, column) in rest.into_iter().enumerate() {
        for (i, (sum, size)) in column {
            let value = sum.value();
            let error = if size > 0.0 { 1e-25 * size + f64::EPSILON * value.abs() } else { 0.0 };
            if i == j {
                lack[j].add(error - value);
            } else {
                lack[i].add(value.abs() + error);
                lack[j].add(value.abs() + error);
            }
        }
    }
    let most = |sum: Sum| match sum.value() {
        lack if lack > 0.0 => lack * (1.0 + 8.0 * f64::EPSILON),
        _ => 0.0,
    };
    lack.into_iter().map(most).collect()
}

/// The root of the pivot of a column; `None` if it is rounding. Then the column of the factor is 0,
/// and what is left of the matrix counts as lacking.
///
/// # Arguments
///
/// * `entry`: the entry of the matrix; `below`: what is left of the column, with the diagonal of
///   each row.
fn pivot(value: f64, entry: f64, mut below: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    if value.is_nan() || value < f64::MIN_POSITIVE {
        return None;
    }
    let is_slight = value < SLIGHT_PIVOT * entry.abs();
    // No entry of a semidefinite matrix is larger.
    let is_rounding = is_slight && below.any(|(a, diagonal)| a * a > value * diagonal.max(0.0));
    (!is_rounding).then(|| value.sqrt())
}

fn matrix_size(matrix: &Lower, k: usize, taken: f64) -> f64 {
    matrix[k].get(&k).map_or(0.0, |entry| entry.abs()) + taken
}

/// `L` with `L L' = A` but for rounding, for pivots that are not positive, and for the part of the
/// diagonal that is left.
fn factorise(matrix: &Lower, left: f64) -> Vec<Vec<(usize, f64)>> {
    let mut work = matrix.clone();
    for (k, column) in work.iter_mut().enumerate() {
        column.entry(k).and_modify(|entry| *entry *= 1.0 - left);
    }
    let mut columns = Vec::with_capacity(matrix.len());
    for k in 0..matrix.len() {
        let entry = matrix[k].get(&k).copied().unwrap_or(0.0);
        let value = work[k].remove(&k).unwrap_or(0.0);
        let below = std::mem::take(&mut work[k]);
        let diagonal = |i: &usize| work[*i].get(i).copied().unwrap_or(0.0);
        let rows = below.iter().map(|(i, a)| (*a, diagonal(i)));
        let Some(root) = pivot(value, entry, rows) else {
            columns.push(Vec::new());
            continue;
        };
        let below = below.into_iter().map(|(i, a)| (i, a / root)).filter(|(_, a)| *a != 0.0);
        let below: Vec<(usize, f64)> = below.collect();
        for (p, &(j, b)) in below.iter().enumerate() {
            for &(i, a) in &below[p..] {
                *work[j].entry(i).or_default() -= a * b;
            }
        }
        columns.push(std::iter::once((k, root)).chain(below).collect());
    }
    columns
}
