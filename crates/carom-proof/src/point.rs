//! Points of a log: their objectives, and how far they violate the program.

use crate::checker::Checker;
use crate::exact::{Dyadic, Number, Plain};
use crate::quadratic_rules::{Quadratic, value_at};
use crate::text::{Refusal, rejected};
use std::cmp::Ordering;
use std::fmt;

/// The largest violation of a bound, a row or integrality with which a point is one of the program:
/// the largest tolerance that a search can be asked for, and the rounding of its terms.
const TOLERANCE: f64 = 1e-3;
const ROUNDING: f64 = 1e-12;

/// A point, judged by the program of the log.
#[derive(Debug, Clone)]
pub struct Point {
    /// In the sense of the model.
    pub objective: Dyadic,
    /// The largest violation of bounds, rows, cones, functions and integrality, of cones and functions
    /// up to rounding.
    pub violation: f64,
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let violation = Plain(self.violation);
        write!(f, "point: objective {}, largest violation {violation}", self.objective)
    }
}

impl Point {
    /// Judges a point, whose entries are sorted by column. `rows` is how many facts are rows of the
    /// program.
    pub(crate) fn judge(
        entries: &[(u32, f64)],
        rows: usize,
        checker: &mut Checker,
    ) -> Result<Self, Refusal> {
        let Checker { program, facts, sums, .. } = checker;
        // As the header states it: what is added to it is 0 only where integral columns are whole.
        let stated = Quadratic::new(&program.objective, program.columns.len());
        let objective = stated.value(entries, sums)?;
        let sum = &mut sums.column;
        let at = |column: u32| value_at(entries, column);
        let (mut violation, has_cones) = (0.0_f64, !program.cones.is_empty());
        let mut judged = |miss: f64, size: f64, what: &dyn Fn() -> String| {
            violation = violation.max(miss);
            if !has_cones && miss > TOLERANCE + ROUNDING * size.min(f64::MAX) {
                return rejected(format!("the point misses {} by {}", what(), Plain(miss)));
            }
            Ok(())
        };
        for (column, own) in program.columns.iter().zip(0..) {
            let value = at(own);
            let miss = (column.lower - value).max(value - column.upper);
            judged(miss, value.abs(), &|| format!("a bound of column {own} ({})", column.name))?;
            if column.is_integral {
                let miss = (value - value.round()).abs();
                judged(miss, 0.0, &|| format!("a whole number of column {own} ({})", column.name))?;
            }
        }
        for (index, row) in facts.iter().take(rows).enumerate() {
            let name = program.row_names.get(index).map_or("", String::as_str);
            let what = || format!("row {index} ({name})");
            let sides = [(&row.lower, false), (&row.upper, true)];
            for (side, is_upper) in sides {
                let Some(side) = side else { continue };
                let mut size = side.nearest().abs();
                for (column, value) in row.entries() {
                    sum.add(value, at(column));
                    if let Number::Float(value) = value {
                        size += (value * at(column)).abs();
                    }
                }
                sum.subtract(side, 1.0);
                let beyond = sum.take()?;
                let beyond = if is_upper { beyond } else { beyond.negated() };
                judged(beyond.nearest(), size, &what)?;
            }
        }
        for (index, term) in program.terms.iter().enumerate() {
            let (own, Some(value)) = (at(term.result), term.value_near(at)) else { continue };
            let miss = if value.is_nan() { f64::INFINITY } else { (own - value).abs() };
            judged(miss, own.abs(), &|| format!("the function of term {index}"))?;
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
        let objective = if program.is_maximisation { objective.negated() } else { objective };
        Ok(Point { objective, violation })
    }
}
