//! Points of a log: their objectives, and how far they violate the program.

use crate::exact::{Dyadic, Number, OutOfRange, Plain, Sum};
use crate::program::Program;
use crate::rows::Row;
use std::cmp::Ordering;
use std::fmt;

/// A point, judged by the program of the log.
#[derive(Debug, Clone)]
pub struct Point {
    /// In the sense of the model.
    pub objective: Dyadic,
    /// The largest violation of bounds, rows, cones and integrality, of cones up to rounding.
    pub violation: f64,
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let violation = Plain(self.violation);
        write!(f, "point: objective {}, largest violation {violation}", self.objective)
    }
}

impl Point {
    /// `entries` are sorted by column; `rows` are those of the program.
    pub(crate) fn judge(
        entries: &[(u32, f64)],
        program: &Program,
        rows: &[Row],
        sum: &mut Sum,
    ) -> Result<Self, OutOfRange> {
        let mut x = vec![0.0; program.columns.len()];
        for &(column, value) in entries {
            if let Some(own) = x.get_mut(column as usize) {
                *own = value;
            }
        }
        let at = |column: u32| x.get(column as usize).copied().unwrap_or(0.0);
        let mut violation = 0.0_f64;
        for (column, &value) in program.columns.iter().zip(&x) {
            let below = column.lower - value;
            let above = value - column.upper;
            violation = violation.max(below).max(above);
            if column.is_integral {
                violation = violation.max((value - value.round()).abs());
            }
        }
        for row in rows {
            let sides = [(&row.lower, false), (&row.upper, true)];
            for (side, is_upper) in sides {
                let Some(side) = side else { continue };
                for (column, value) in row.entries() {
                    sum.add(value, at(column));
                }
                sum.subtract(side, 1.0);
                let beyond = sum.take()?;
                let beyond = if is_upper { beyond } else { beyond.negated() };
                violation = violation.max(beyond.nearest());
            }
        }
        for cone in &program.cones {
            let (first, second) = (at(cone.head), at(cone.second.unwrap_or(cone.head)));
            for &column in &cone.tail {
                sum.add(at(column), at(column));
            }
            let square = sum.take()?;
            sum.add(&square, 1.0);
            sum.subtract(first, second);
            if sum.take_sign()? == Ordering::Greater || first < 0.0 || second < 0.0 {
                // How much both heads would have to grow, up to rounding.
                let distance = (first - second).hypot(2.0 * square.nearest().sqrt());
                let missing = 0.5 * (distance - first - second);
                violation = violation.max(if missing.is_nan() { f64::INFINITY } else { missing });
            }
        }
        let objective = objective(&at, program, sum)?;
        Ok(Point { objective, violation })
    }
}

fn objective(
    at: &impl Fn(u32) -> f64,
    program: &Program,
    sum: &mut Sum,
) -> Result<Dyadic, OutOfRange> {
    let mut total = Sum::default();
    let objective = &program.objective;
    for &(row, column, value) in &objective.triangle {
        sum.add(value, at(row));
        let product = sum.take()?;
        total.add(&product, at(column));
        if row != column {
            total.add(&product, at(column));
        }
    }
    let half = total.take()?.half();
    total.add(&half, 1.0);
    for &(column, value) in &objective.linear {
        total.add(value, at(column));
    }
    total.add(objective.constant, Number::Float(1.0));
    let value = total.take()?;
    Ok(if program.is_maximisation { value.negated() } else { value })
}
