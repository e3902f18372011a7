//! The value of a column at which the rows are violated least.

use crate::program::Program;

/// Where the weighted violation of rows has its kinks along a column, and how much steeper it gets
/// there.
#[derive(Debug, Default)]
pub struct Kinks(Vec<(f64, f64)>);

impl Kinks {
    /// The value within bounds at which the weighted violation of the rows of a column is least, or
    /// the present one if none is better than others. An integer may be between two whole values.
    ///
    /// # Arguments
    ///
    /// * `x`: the present value.
    /// * `row`: weight and activity of a row.
    pub fn least(
        &mut self,
        program: &Program,
        column: usize,
        x: f64,
        [lower, upper]: [f64; 2],
        row: impl Fn(usize) -> (f64, f64),
    ) -> f64 {
        let Kinks(kinks) = self;
        kinks.clear();
        let mut slope = 0.0;
        let (rows, values) = program.column(column);
        for (&i, &a) in rows.iter().zip(values) {
            let (weight, activity) = row(i);
            let rest = activity - a * x;
            let limits = [program.row_lower[i], program.row_upper[i]];
            let [left, right] = if a > 0.0 { limits } else { [limits[1], limits[0]] };
            // Below `left / a` the row is violated, and above `right / a`.
            if left.is_finite() {
                slope -= weight * a.abs();
            }
            for limit in [left, right].into_iter().filter(|limit| limit.is_finite()) {
                kinks.push(((limit - rest) / a, weight * a.abs()));
            }
        }
        if slope == 0.0 {
            return x.min(kinks.iter().map(|kink| kink.0).fold(upper, f64::min)).max(lower);
        }
        kinks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = x;
        for &(place, steeper) in &*kinks {
            best = place;
            slope += steeper;
            if slope >= 0.0 {
                break;
            }
        }
        best.clamp(lower, upper)
    }
}
