//! Squares of binaries in a presolved objective, with the multiples that make its bound high.
//!
//! `x^2 = x` for a binary, so a multiple of `x^2 - x` may be added to a convex objective, or taken
//! from it, as long as it stays convex. The relaxation is then another one, and at integers nothing
//! has changed. [`curvature_dual`](super::curvature_dual) finds the multiples for a block of
//! binaries. Where a block has other columns, these are put at their best values first, as if they
//! had no bounds; what is left is a form over the binaries (its matrix is a Schur complement).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use faer::sparse::{SparseColMat, Triplet};

use super::curvature_dual::{BinaryBlock, BinaryRow, proved_amounts};
use crate::program::Program;
use crate::relaxation::LowerTriangle;
use crate::semidefinite::{Product, blocks};

/// Most columns of a block, and the least part of its pairs that have products.
const MOST_COLUMNS: usize = 400;
const LEAST_DENSITY: f64 = 0.1;

/// The fewest binaries of a block.
const LEAST_BLOCK: usize = 3;

/// The largest distance from 0 of a column with two values whose square changes, in its unit. The
/// change is a difference of terms that grow with the square of that, and are rounded.
const FARTHEST_BINARY: f64 = 100.0;

/// What the curvature of other columns gets so that it has an inverse, relative to its mean.
const INVERTIBLE: f64 = 1e-6;

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
    let (binaries, others): (Vec<usize>, Vec<usize>) = members.iter().partition(|j| is_binary(**j));
    let pairs = 0.5 * (members.len() * members.len()) as f64;
    if binaries.len() < LEAST_BLOCK
        || members.len() > MOST_COLUMNS
        || (products.len() as f64) < LEAST_DENSITY * pairs
    {
        return None;
    }
    let weights: BTreeMap<usize, f64> = binaries.iter().map(|&j| (j, 1.0)).collect();
    let (form, costs) = match others.is_empty() {
        true => (products.to_vec(), BTreeMap::new()),
        false => without(program, products, &binaries, &others)?,
    };
    let cost = |j: usize| costs.get(&j).copied().unwrap_or(program.linear[j]);
    let ends = |j: usize| [program.lower[j], program.upper[j]];
    let rows = rows_over(program, &binaries);
    let block = BinaryBlock { products: &form, rows: &rows, ends: &ends, cost: &cost };
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

/// The form and the linear coefficients that are left for binaries where the other columns are at
/// their best values.
fn without(
    program: &Program,
    products: &[Product],
    binaries: &[usize],
    others: &[usize],
) -> Option<(Vec<Product>, BTreeMap<usize, f64>)> {
    let place =
        |all: &[usize]| -> BTreeMap<usize, usize> { all.iter().copied().zip(0..).collect() };
    let (own, other) = (place(binaries), place(others));
    let (n, m) = (binaries.len(), others.len());
    let mut matrix = vec![0.0; m * m];
    // By binary, the products with the other columns; at the end, the costs of these.
    let mut mixed = vec![vec![0.0; m]; n + 1];
    let mut inner = vec![0.0; n * n];
    for &(a, b, q) in products {
        let q = if a == b { 2.0 * q } else { q };
        match (own.get(&a), own.get(&b), other.get(&a), other.get(&b)) {
            (Some(&i), Some(&k), ..) => (inner[i * n + k], inner[k * n + i]) = (q, q),
            (_, _, Some(&i), Some(&k)) => (matrix[i * m + k], matrix[k * m + i]) = (q, q),
            (Some(&i), _, _, Some(&k)) | (_, Some(&i), Some(&k), _) => mixed[i][k] = q,
            _ => {}
        }
    }
    let mean = (0..m).map(|k| matrix[k * m + k]).sum::<f64>() / m as f64;
    let mut factor = LowerTriangle::default();
    for (k, &j) in others.iter().enumerate() {
        mixed[n][k] = program.linear[j];
        let row = &mut matrix[k * m..=k * m + k];
        let (row, diagonal) = row.split_at_mut(k);
        factor.solve(row, 0);
        let pivot = diagonal[0] + INVERTIBLE * mean - row.iter().map(|r| r * r).sum::<f64>();
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        factor.push(row, pivot.sqrt());
    }
    mixed.iter_mut().for_each(|column| factor.solve(column, 0));
    // What is left is less by the products of the columns behind the triangle.
    let less = |i: usize, k: usize| mixed[i].iter().zip(&mixed[k]).map(|(a, b)| a * b).sum::<f64>();
    let mut form = Vec::new();
    for i in 0..n {
        for k in i..n {
            let q = inner[i * n + k] - less(i, k);
            form.push((binaries[i], binaries[k], if i == k { 0.5 * q } else { q }));
        }
    }
    let costs = binaries.iter().enumerate();
    let costs = costs.map(|(i, &j)| (j, program.linear[j] - less(i, n))).collect();
    Some((form, costs))
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
