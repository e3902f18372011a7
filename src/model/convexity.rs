//! The convexity check of quadratic objectives.

use std::collections::BTreeMap;

use faer::{Mat, Side};

use super::ids::Variable;
use crate::tolerance;

/// A direction of negative curvature, by its smallest eigenvalue and a variable with the largest
/// share in it.
pub(super) struct NegativeCurvature {
    pub(super) curvature: f64,
    pub(super) variable: Variable,
}

/// Looks for negative curvature of `sign * sum q_jk x_j x_k`.
///
/// The quadratic form splits into blocks of variables that are linked by products; each block's
/// symmetric matrix is tested by its eigenvalues.
///
/// # Complexity
///
/// Cubic in the largest block; linear for separable costs.
pub(super) fn find_negative_curvature(
    products: &[(Variable, Variable, f64)],
    sign: f64,
) -> Option<NegativeCurvature> {
    if products.iter().all(|(a, b, _)| a == b) {
        // Only squares: separable.
        let bad = products.iter().find(|(.., q)| sign * q < 0.0);
        return bad
            .map(|&(variable, _, q)| NegativeCurvature { curvature: 2.0 * sign * q, variable });
    }
    // Position of every variable that occurs, and blocks by union-find.
    let mut position = BTreeMap::new();
    for &(a, b, _) in products {
        for v in [a, b] {
            let next = position.len();
            position.entry(v).or_insert(next);
        }
    }
    let mut parent: Vec<usize> = (0..position.len()).collect();
    for (a, b, _) in products {
        let (a, b) = (root(&mut parent, position[a]), root(&mut parent, position[b]));
        parent[a.max(b)] = a.min(b);
    }
    let mut blocks: BTreeMap<usize, Vec<Variable>> = BTreeMap::new();
    for (&v, &p) in &position {
        blocks.entry(root(&mut parent, p)).or_default().push(v);
    }
    let mut entries: BTreeMap<usize, Vec<(Variable, Variable, f64)>> = BTreeMap::new();
    for &(a, b, q) in products {
        entries.entry(root(&mut parent, position[&a])).or_default().push((a, b, sign * q));
    }
    blocks.iter().find_map(|(block, members)| test_block(members, &entries[block]))
}

fn test_block(
    members: &[Variable],
    entries: &[(Variable, Variable, f64)],
) -> Option<NegativeCurvature> {
    if let [variable] = *members {
        let curvature: f64 = 2.0 * entries.iter().map(|e| e.2).sum::<f64>();
        return (curvature < 0.0).then_some(NegativeCurvature { curvature, variable });
    }
    let local: BTreeMap<Variable, usize> = members.iter().copied().zip(0..).collect();
    let mut matrix = Mat::<f64>::zeros(members.len(), members.len());
    for (a, b, q) in entries {
        let (i, j) = (local[a], local[b]);
        matrix[(i, j)] += q;
        matrix[(j, i)] += q;
    }
    let Ok(eigen) = matrix.self_adjoint_eigen(Side::Lower) else {
        // No eigenvalues, no proof of convexity.
        return Some(NegativeCurvature { curvature: f64::NAN, variable: members[0] });
    };
    let values = eigen.S().column_vector();
    let largest = (0..members.len()).map(|k| values[k].abs()).fold(0.0, f64::max);
    let smallest = (0..members.len()).min_by(|&a, &b| values[a].total_cmp(&values[b]))?;
    if values[smallest] >= -tolerance::CONVEXITY * largest {
        return None;
    }
    let direction = eigen.U().col(smallest);
    let share = |k: usize| direction[k].abs();
    let worst = (0..members.len()).max_by(|&a, &b| share(a).total_cmp(&share(b)))?;
    Some(NegativeCurvature { curvature: values[smallest], variable: members[worst] })
}

fn root(parent: &mut [usize], mut node: usize) -> usize {
    while parent[node] != node {
        parent[node] = parent[parent[node]];
        node = parent[node];
    }
    node
}
