//! The solution of a small square system in balls.

use super::ball::Ball;
use super::equations::Equations;
use crate::tolerance::largest_magnitude;

/// The values of some columns that as many equations determine; unknown where these are dependent.
///
/// # Arguments
///
/// * `known`: the values of all other columns of the equations.
pub(super) fn solve(
    equations: &Equations,
    which: &[usize],
    columns: &[usize],
    known: impl Fn(usize) -> Ball,
) -> Vec<Ball> {
    let n = columns.len();
    let zero = Ball::from(0.0);
    let mut matrix = vec![vec![zero; n]; n];
    let mut right = vec![zero; n];
    for (k, &equation) in which.iter().enumerate() {
        right[k] = Ball::from(equations.right(equation));
        for &(j, a) in equations.terms(equation) {
            match columns.iter().position(|&column| column == j) {
                Some(place) => matrix[k][place] = Ball::from(a),
                None => right[k] = right[k].plus_product(-a, known(j)),
            }
        }
    }
    let scale: Vec<f64> =
        matrix.iter().map(|row| largest_magnitude(row.iter().map(|entry| entry.value()))).collect();
    let mut order: Vec<usize> = (0..n).collect();
    for k in 0..n {
        let size = |row: usize| matrix[row][k].pivot_size() / scale[row];
        let best = (k..n).max_by(|&a, &b| size(order[a]).total_cmp(&size(order[b])));
        let Some(best) = best.filter(|&best| size(order[best]) > 0.0) else {
            return vec![Ball::UNKNOWN; n];
        };
        order.swap(k, best);
        let pivot = matrix[order[k]].clone();
        for &row in &order[k + 1..] {
            if matrix[row][k] == zero {
                continue;
            }
            let factor = matrix[row][k].over(pivot[k]);
            for j in k + 1..n {
                matrix[row][j] = matrix[row][j].minus_product(factor, pivot[j]);
            }
            right[row] = right[row].minus_product(factor, right[order[k]]);
        }
    }
    let mut values = vec![zero; n];
    for k in (0..n).rev() {
        let row = order[k];
        let mut sum = right[row];
        for j in k + 1..n {
            sum = sum.minus_product(matrix[row][j], values[j]);
        }
        values[k] = sum.over(matrix[row][k]);
    }
    values
}
