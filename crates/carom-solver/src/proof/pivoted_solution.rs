//! Small dense linear equations, by elimination with the largest pivots.

use crate::tolerance::largest_magnitude;

/// The part of the first pivot below which the others are rounding (no unit).
const PIVOT_SHARE: f64 = 1e-14;

/// A solution of `sum z_k vectors[k] = right`: few numbers that are not 0, and those where vectors
/// are large. What no solution reaches is left.
pub(super) fn pivoted_solution(vectors: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let (many, count) = (vectors.len(), right.len());
    // By equation: the coefficients, scaled by the largest, and the right side.
    let equation = |i: usize| {
        let mut own: Vec<f64> = vectors.iter().map(|vector| vector[i]).collect();
        let most = largest_magnitude(&own);
        own.push(right[i]);
        if most > 0.0 {
            own.iter_mut().for_each(|a| *a /= most);
        }
        own
    };
    let mut equations: Vec<Vec<f64>> = (0..count).map(equation).collect();
    let mut pivots = Vec::new();
    let mut least = f64::MIN_POSITIVE;
    for done in 0..count.min(many) {
        let mut best = (0.0, done, 0);
        for (i, equation) in equations.iter().enumerate().skip(done) {
            for (k, a) in equation[..many].iter().enumerate() {
                if a.abs() > best.0 {
                    best = (a.abs(), i, k);
                }
            }
        }
        let (size, row, k) = best;
        if size <= least || !size.is_finite() {
            break;
        }
        least = least.max(PIVOT_SHARE * size);
        equations.swap(done, row);
        pivots.push(k);
        let (above, below) = equations.split_at_mut(done + 1);
        let pivot = &above[done];
        for equation in below {
            let factor = equation[k] / pivot[k];
            if factor != 0.0 {
                equation.iter_mut().zip(pivot).for_each(|(a, b)| *a -= factor * b);
                equation[k] = 0.0;
            }
        }
    }
    let mut solution = vec![0.0; many];
    for (equation, &k) in equations.iter().zip(&pivots).rev() {
        // The pivots of earlier equations are 0 here.
        let known: f64 = equation[..many].iter().zip(&solution).map(|(a, z)| a * z).sum();
        solution[k] = (equation[many] - known) / equation[k];
    }
    solution
}
