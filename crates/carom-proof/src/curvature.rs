//! The rule for bounds that follow from the curvature of the objective.
//!
//! With `P + diag(d)` positive semidefinite, at every point
//! `objective(x) >= objective(p) + sum_j term_j(x_j)`,
//! `term_j(x_j) = g_j (x_j - p_j) - d_j / 2 (x_j - p_j)^2`, `g` the gradient at `p`. Where
//! `d_j < 0`, a term is at least `-g_j^2 / (-2 d_j)`; else it is bounded by the bounds of its
//! column. A column for which one term alone exceeds what the others leave is out of reach.

use crate::bounds::{Bounds, Side};
use crate::exact::{Dyadic, Number};
use crate::linear_rules::Sums;
use crate::quadratic_rules::{Entries, Quadratic, farthest_square, value_at};
use crate::rows::Row;
use crate::text::{Refusal, rejected};
use std::cmp::Ordering;

/// A lower bound of the objective around a point.
#[derive(Debug)]
pub(crate) struct Around {
    point: Entries,
    gradient: Row,
    /// By how much the terms of steep columns can fall.
    falls: Entries,
    least: Dyadic,
}

impl Quadratic {
    /// The least of the objective around a point, by the falls that the terms of steep columns
    /// have.
    pub(crate) fn around(
        &self,
        point: Entries,
        falls: Entries,
        bounds: &Bounds,
        sums: &mut Sums,
    ) -> Result<Around, Refusal> {
        let Some(deficits) = self.deficits() else {
            return rejected("`w` needs `p` before it");
        };
        let gradient = self.gradient(&point, sums)?;
        let mut columns: Vec<u32> = gradient.entries().map(|(column, _)| column).collect();
        columns.extend(deficits.iter().map(|entry| entry.0));
        columns.sort_unstable();
        columns.dedup();
        self.add_value(&gradient, &point, sums)?;
        for column in columns {
            let deficit = value_at(deficits, column);
            let slope = gradient.coefficient(column as usize);
            if deficit < 0.0 {
                let fall = value_at(&falls, column);
                if let Some(slope) = slope {
                    sums.column.add(slope, slope);
                }
                let square = sums.column.take()?;
                sums.column.subtract(fall, -2.0 * deficit);
                sums.column.add(&square, 1.0);
                if fall < 0.0 || sums.column.take_sign()? == Ordering::Greater {
                    return rejected(format!("column {column} may lower the objective by more"));
                }
                sums.total.subtract(fall, 1.0);
                continue;
            }
            let (lower, upper) = bounds.of(column as usize);
            let at = value_at(&point, column);
            if let Some(slope) = slope {
                let worst = bounds.smallest(column, slope);
                if !worst.is_finite() {
                    return rejected(format!("column {column} has no curvature and no bound"));
                }
                sums.total.add(slope, worst);
                sums.total.subtract(slope, at);
            }
            if deficit > 0.0 {
                if !lower.is_finite() || !upper.is_finite() {
                    return rejected(format!("column {column} has a deficit and is not bounded"));
                }
                let square = farthest_square(lower, upper, at, &mut sums.column)?.half();
                sums.total.subtract(&square, deficit);
            }
        }
        let least = sums.total.take()?;
        Ok(Around { point, gradient, falls, least })
    }

    /// Whether every point with a column beyond a value is worse than a limit.
    pub(crate) fn is_beyond(
        &self,
        around: &Around,
        column: usize,
        side: Side,
        value: f64,
        (limit, bounds): (f64, &Bounds),
        sums: &mut Sums,
    ) -> Result<bool, Refusal> {
        let deficit = self.deficits().map_or(0.0, |deficits| value_at(deficits, column as u32));
        let at = value_at(&around.point, column as u32);
        let is_outside = if side == Side::Upper { value >= at } else { value <= at };
        let zero = Number::Float(0.0);
        let slope = around.gradient.coefficient(column).unwrap_or(zero);
        let worst = bounds.smallest(column as u32, slope);
        if deficit > 0.0 || (deficit < 0.0 && !is_outside) {
            return Ok(false);
        }
        sums.column.add(value, 1.0);
        sums.column.subtract(at, 1.0);
        let step = sums.column.take()?;
        // The term grows beyond the value.
        sums.column.add(slope, 1.0);
        sums.column.subtract(&step, deficit);
        let growth = sums.column.take_sign()?;
        let shrinks = if side == Side::Upper { Ordering::Less } else { Ordering::Greater };
        if growth == shrinks {
            return Ok(false);
        }
        sums.column.add(&step, &step);
        let square = sums.column.take()?.half();
        // The least of the others, and the term at the value.
        sums.total.add(&around.least, 1.0);
        if deficit < 0.0 {
            sums.total.add(value_at(&around.falls, column as u32), 1.0);
        } else {
            sums.total.subtract(slope, worst);
            sums.total.add(slope, at);
        }
        sums.total.add(slope, &step);
        sums.total.subtract(&square, deficit);
        sums.total.subtract(limit, 1.0);
        Ok(sums.total.take_sign()? != Ordering::Less)
    }
}
