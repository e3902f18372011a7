//! Squares of binaries in a presolved objective, with the multiples that make its bound high.
//!
//! `x^2 = x` for a binary, so a multiple of `x^2 - x` may be added to a convex objective, or taken
//! from it, as long as it stays convex. The relaxation is then another one, and at integers nothing
//! has changed. [`curvature_dual`](super::curvature_dual) finds the multiples for a block of
//! binaries. Blocks with other columns are left as they are: with these at their best values as if
//! they had no bounds, multiples can be found as well, and they may make the bound far lower.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use faer::sparse::{SparseColMat, Triplet};

use super::curvature_dual::{BinaryBlock, BinaryRow, proved_amounts};
use crate::program::Program;
use crate::semidefinite::{Product, blocks};

/// Most columns of a block, and the least part of its pairs that have products.
const MOST_COLUMNS: usize = 400;
const LEAST_DENSITY: f64 = 0.1;

/// The fewest columns of a block.
const LEAST_BLOCK: usize = 3;

/// The largest distance from 0 of a column with two values whose square changes, in its unit. The
/// change is a difference of terms that grow with the square of that, and are rounded.
const FARTHEST_BINARY: f64 = 100.0;

/// The program with other squares of binaries; `None` if none are found.
pub(super) fn with_raised_squares(program: &Program) -> Option<Program> {
    let mut products: Vec<Product> = Vec::new();
    for (i, j, p) in program.quadratic_entries().filter(|(i, j, _)| i <= j) {
        products.push((i, j, if i == j { 0.5 * p } else { p }));
    }
    let mut amounts = Vec::new();
    for (names, products) in blocks(&products) {
        let products = products.into_iter().map(|(a, b, q)| (names[a], names[b], q));
        let mut products: Vec<Product> = products.collect();
        products.sort_by_key(|&(a, b, _)| (a, b));
        amounts.extend(of_block(program, &names, &products).unwrap_or_default());
    }
    amounts.retain(|(_, amount)| *amount != 0.0);
    if amounts.is_empty() { None } else { raised(program, &amounts) }
}

/// The multiples for a block of columns.
fn of_block(
    program: &Program,
    members: &[usize],
    products: &[Product],
) -> Option<Vec<(usize, f64)>> {
    let is_binary = |j: usize| {
        let [lower, upper] = [program.lower[j], program.upper[j]];
        program.integral[j] && upper - lower == 1.0 && lower.abs() <= FARTHEST_BINARY
    };
    let pairs = 0.5 * (members.len() * members.len()) as f64;
    if members.len() < LEAST_BLOCK
        || !members.iter().all(|j| is_binary(*j))
        || members.len() > MOST_COLUMNS
        || (products.len() as f64) < LEAST_DENSITY * pairs
    {
        return None;
    }
    let cost = |j: usize| program.linear[j];
    let ends = |j: usize| [program.lower[j], program.upper[j]];
    let rows = rows_over(program, members);
    let block = BinaryBlock { products, rows: &rows, ends: &ends, cost: &cost };
    let weights: BTreeMap<usize, f64> = members.iter().map(|&j| (j, 1.0)).collect();
    proved_amounts(products, &block.multiples()?, &weights)
}

/// The rows over some columns only.
fn rows_over(program: &Program, members: &[usize]) -> Vec<BinaryRow> {
    let members: BTreeSet<usize> = members.iter().copied().collect();
    let fixed = |j: usize| (program.lower[j] == program.upper[j]).then_some(program.lower[j]);
    let rows = (0..program.row_count()).map(|row| (row, program.row_terms(row)));
    let inner = rows.filter(|(_, terms)| {
        terms.iter().all(|&(j, _)| members.contains(&j) || fixed(j).is_some())
    });
    let of = |(row, terms): (usize, Vec<(usize, f64)>)| {
        BinaryRow::of(terms.into_iter(), [program.row_lower[row], program.row_upper[row]], fixed)
    };
    inner.flat_map(of).collect()
}

/// The program with multiples of `(x - l)(x - u)` added.
fn raised(program: &Program, amounts: &[(usize, f64)]) -> Option<Program> {
    let entries = program.quadratic_entries().map(|(i, j, p)| Triplet::new(i, j, p));
    let more = amounts.iter().map(|&(j, amount)| Triplet::new(j, j, 2.0 * amount));
    let entries: Vec<Triplet<usize, usize, f64>> = entries.chain(more).collect();
    let n = program.column_count();
    let mut raised = program.clone();
    raised.quadratic = SparseColMat::try_new_from_triplets(n, n, &entries).ok()?;
    for &(j, amount) in amounts {
        let (lower, upper) = (program.lower[j], program.upper[j]);
        raised.linear[j] -= amount * (lower + upper);
        raised.offset += amount * lower * upper;
    }
    (raised.steepness, raised.squared) = (OnceLock::new(), OnceLock::new());
    Some(raised)
}
