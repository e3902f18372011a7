//! Polymatroid cuts of norms of binaries.
//!
//! Takes a relaxed point and second-order cones with constants and multiples of binaries in the
//! tail; leaves at most one cut for each cone (Atamtürk and Narayanan, Polymatroids and mean-risk
//! minimization in discrete optimization, Operations Research Letters 36, 2008).
//!
//! Where every entry of a tail is a number times a binary, the length of the tail is a function of
//! the set of binaries at 1: `f(S) = sqrt(c + sum of w_i over S)`, which is submodular. So for any
//! order of the binaries, `f(0) + sum p_i b_i <= f(S)` with `p_i = f(S_i) - f(S_{i-1})`, where
//! `S_i` are the first `i` of them. The order of the relaxed values gives the deepest of these
//! cuts, which together with bounds are the convex hull; the cone itself says less unless all
//! values are alike.

use std::collections::BTreeMap;

use super::cut::Cut;
use crate::presolve::Domain;
use crate::program::{Cone, ConeRole, ConeShape, Program};
use crate::solver::StopToken;

/// Fewest binaries of a tail: for one, the cone says the same.
const FEWEST: usize = 2;

/// The polymatroid cuts that a point violates, one a cone at most.
pub fn polymatroid_cuts(
    program: &Program,
    domain: &Domain,
    x: &[f64],
    token: &StopToken,
) -> Vec<Cut> {
    let whole = program.cones.iter().filter(|cone| cone.role != ConeRole::Part);
    let mut cuts = Vec::new();
    for cone in whole {
        if token.spend(10 * cone.columns.len()) {
            break;
        }
        cuts.extend(cut_of(program, domain, x, cone));
    }
    cuts
}

fn cut_of(program: &Program, domain: &Domain, x: &[f64], cone: &Cone) -> Option<Cut> {
    let (constant, weights) = squares(program, cone)?;
    if weights.len() < FEWEST {
        return None;
    }
    let mut order: Vec<(usize, f64)> = weights.into_iter().collect();
    order.sort_by(|a, b| x[b.0].total_cmp(&x[a.0]).then(a.0.cmp(&b.0)));
    // `sum p b - head <= -f(0)`.
    let mut terms = heads(cone, x)?;
    let (mut sum, mut length) = (constant, constant.sqrt());
    for (binary, weight) in order {
        sum += weight;
        *terms.entry(binary).or_default() += sum.sqrt() - length;
        length = sum.sqrt();
    }
    Cut::new(terms, -constant.sqrt(), length, domain, x)
}

/// The length of a tail, squared, as a constant and a weight for each binary that is at 1; `None`
/// if it is no such sum.
fn squares(program: &Program, cone: &Cone) -> Option<(f64, BTreeMap<usize, f64>)> {
    let mut constant = 0.0;
    let mut weights: BTreeMap<usize, f64> = BTreeMap::new();
    for &j in cone.tail() {
        let [lower, upper] = [program.lower[j], program.upper[j]];
        if lower == upper {
            constant += lower * lower;
            continue;
        }
        let (binary, factor) = multiple(program, j)?;
        *weights.entry(binary).or_default() += factor * factor;
    }
    Some((constant, weights))
}

/// The binary of which a column is a multiple by an equality, and the factor.
fn multiple(program: &Program, column: usize) -> Option<(usize, f64)> {
    let is_binary =
        |j: usize| program.integral[j] && program.lower[j] >= 0.0 && program.upper[j] <= 1.0;
    if is_binary(column) {
        return Some((column, 1.0));
    }
    program.column(column).0.iter().find_map(|&row| {
        let is_multiple = program.row_lower[row] == 0.0 && program.row_upper[row] == 0.0;
        let (&[p, q], &[a, b]) = program.row(row) else { return None };
        let (other, factor) = if p == column { (q, -b / a) } else { (p, -a / b) };
        (is_multiple && is_binary(other)).then_some((other, factor))
    })
}

/// An upper bound of the length of the tail that is linear in the head, with its sign changed;
/// close at a point.
fn heads(cone: &Cone, x: &[f64]) -> Option<BTreeMap<usize, f64>> {
    match (cone.shape, cone.head()) {
        (ConeShape::Norm, &[head]) => Some(BTreeMap::from([(head, -1.0)])),
        (ConeShape::Rotated, &[first, second]) => {
            // `2 sqrt(p q) <= k p + q / k`
            let factor = (x[second] / x[first]).sqrt();
            let usable = factor.is_finite() && factor > 0.0;
            usable.then(|| BTreeMap::from([(first, -0.5 * factor), (second, -0.5 / factor)]))
        }
        _ => None,
    }
}
