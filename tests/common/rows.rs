//! Whether a point satisfies the rows of a lowered model, for some values of its auxiliary
//! integers: by trying them all. Data are small whole numbers and halves, so sums are exact.

use carom::prelude::*;

/// Whether all rows hold, without any tolerance.
pub(crate) fn rows_hold(model: &Model, values: &[f64]) -> bool {
    model.constraints().all(|row| {
        let sum: f64 = row.terms().iter().map(|&(v, a)| a * values[v.index()]).sum();
        row.limits().contains(sum)
    })
}

/// Whether the rows hold at `values`, the first columns of the model, for some whole values of
/// the columns after them.
pub(crate) fn extends(model: &Model, values: &[f64]) -> bool {
    let bounds: Vec<(f64, f64)> = model
        .variables()
        .skip(values.len())
        .map(|v| {
            assert!(v.kind().is_integral(), "only integers are enumerated: {}", v.name());
            (v.bounds().lower, v.bounds().upper)
        })
        .collect();
    let mut point = values.to_vec();
    point.extend(bounds.iter().map(|(lower, _)| lower));
    loop {
        if rows_hold(model, &point) {
            return true;
        }
        // The next assignment, like a counter.
        let mut digit = 0;
        loop {
            let Some(&(lower, upper)) = bounds.get(digit) else { return false };
            let value = &mut point[values.len() + digit];
            if *value < upper {
                *value += 1.0;
                break;
            }
            *value = lower;
            digit += 1;
        }
    }
}
