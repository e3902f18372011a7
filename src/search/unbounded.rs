//! Recession directions: proof that a program has no finite optimum.

use crate::presolve::Reduced;

/// Whether `ray` is a direction along which the reduced program stays feasible and its objective
/// falls without limit.
pub(super) fn is_descent_ray(program: &Reduced, ray: &[f64]) -> bool {
    const MARGIN: f64 = 1e-7;
    let size = ray.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if !(size > 0.0 && size.is_finite()) {
        return false;
    }
    let d: Vec<f64> = ray.iter().map(|v| v / size).collect();
    let cost: f64 = program.linear.iter().zip(&d).map(|(q, d)| q * d).sum();
    let cost_scale = program.linear.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    if cost.is_nan() || cost >= -1e-6 * cost_scale {
        return false;
    }
    let mut curved = vec![0.0; d.len()];
    for j in 0..d.len() {
        let (rows, entries) = program.quadratic.vector(j);
        for (&i, &p) in rows.iter().zip(entries) {
            curved[i] += p * d[j];
            if i != j {
                curved[j] += p * d[i];
            }
        }
    }
    let flat = curved.iter().all(|c| c.abs() <= MARGIN * cost_scale.max(1.0));
    let bounds = d.iter().enumerate().all(|(j, &d)| {
        (d <= MARGIN || program.upper[j].is_infinite())
            && (d >= -MARGIN || program.lower[j].is_infinite())
    });
    let rows = (0..program.rows.len()).all(|i| {
        let (columns, values) = program.rows.vector(i);
        let change: f64 = columns.iter().zip(values).map(|(&j, &a)| a * d[j]).sum();
        let scale = values.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
        (change <= MARGIN * scale || program.row_upper[i].is_infinite())
            && (change >= -MARGIN * scale || program.row_lower[i].is_infinite())
    });
    flat && bounds && rows
}
