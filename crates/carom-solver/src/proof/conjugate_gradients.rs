//! Linear equations that need no more than a few digits, by conjugate gradients.

use crate::program::Program;

/// The part of the first residual's square that ends the method (no unit).
const CONVERGED_SHARE: f64 = 1e-30;

/// About the solution of `A x = right` with a positive semidefinite A: the best of the steps.
///
/// # Arguments
///
/// * `product`: gives A times a vector.
/// * `diagonal`: about the diagonal of A, by which residuals are divided.
pub(super) fn conjugate_gradients(
    product: impl Fn(&[f64]) -> Vec<f64>,
    diagonal: &[f64],
    right: &[f64],
    steps: usize,
) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let scaled =
        |rest: &[f64]| -> Vec<f64> { rest.iter().zip(diagonal).map(|(r, d)| r / d).collect() };
    let (mut x, mut rest) = (vec![0.0; right.len()], right.to_vec());
    let mut direction = scaled(&rest);
    let mut square = dot(&rest, &direction);
    let enough = CONVERGED_SHARE * square;
    let mut best = (dot(&rest, &rest), x.clone());
    for _ in 0..steps {
        if square.is_nan() || square <= enough {
            break;
        }
        let product = product(&direction);
        let along = dot(&direction, &product);
        if along.is_nan() || along <= 0.0 {
            break;
        }
        let step = square / along;
        for k in 0..x.len() {
            x[k] += step * direction[k];
            rest[k] -= step * product[k];
        }
        let length = dot(&rest, &rest);
        if length < best.0 {
            best = (length, x.clone());
        }
        let next_scaled = scaled(&rest);
        let next = dot(&rest, &next_scaled);
        for k in 0..x.len() {
            direction[k] = next_scaled[k] + next / square * direction[k];
        }
        square = next;
    }
    best.1
}

/// About the solution of `P x = right` over some columns of a quadratic objective.
pub(super) fn curved_solution(
    program: &Program,
    columns: &[usize],
    right: &[f64],
    steps: usize,
) -> Vec<f64> {
    let mut place = vec![usize::MAX; program.column_count()];
    columns.iter().enumerate().for_each(|(k, &j)| place[j] = k);
    let diagonal = |j: &usize| {
        let (rows, values) = program.quadratic_column(*j);
        let own = rows.iter().zip(values).find(|(i, _)| *i == j);
        own.map_or(1.0, |(_, a)| *a).max(f64::MIN_POSITIVE)
    };
    let diagonal: Vec<f64> = columns.iter().map(diagonal).collect();
    let product = |direction: &[f64]| {
        let mut product = vec![0.0; columns.len()];
        for (&j, x) in columns.iter().zip(direction) {
            let (rows, values) = program.quadratic_column(j);
            for (&i, a) in rows.iter().zip(values) {
                if let Some(entry) = product.get_mut(place[i]) {
                    *entry += a * x;
                }
            }
        }
        product
    };
    conjugate_gradients(product, &diagonal, right, steps)
}
