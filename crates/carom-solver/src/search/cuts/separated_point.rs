//! The point to cut off, with the data that every aggregate needs.

use super::cut::reach;
use crate::presolve::Domain;
use crate::program::Program;

/// A column measured from a bound: `t = sign * (x - constant - slope * x_binary)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct From {
    pub(super) sign: f64,
    pub(super) constant: f64,
    pub(super) slope: f64,
    pub(super) binary: usize,
    /// The row of a variable bound.
    pub(super) row: usize,
    /// `t` at the point.
    pub(super) value: f64,
}

impl From {
    /// A bound that no binary changes.
    fn simple(sign: f64, constant: f64, value: f64) -> Self {
        From { sign, constant, slope: 0.0, binary: 0, row: usize::MAX, value }
    }
}

/// A point of a program, the activities of its rows, and where its continuous columns can be
/// measured from.
pub(super) struct SeparatedPoint<'a> {
    pub(super) program: &'a Program,
    pub(super) domain: &'a Domain,
    pub(super) x: &'a [f64],
    activities: Vec<f64>,
    /// By row, whether it can be aggregated with others.
    fit: Vec<bool>,
    /// By column, the nearest simple bound, the nearest variable one, and the nearer of the two.
    simple: Vec<Option<From>>,
    variable: Vec<Option<From>>,
    nearest: Vec<Option<From>>,
    /// By column, the nearest variable bound from below and from above.
    sides: Vec<[Option<From>; 2]>,
}

impl<'a> SeparatedPoint<'a> {
    pub(super) fn new(program: &'a Program, domain: &'a Domain, x: &'a [f64]) -> Self {
        let n = program.column_count();
        let activities = (0..program.row_count()).map(|row| program.activity(row, x)).collect();
        let mut point = SeparatedPoint {
            program,
            domain,
            x,
            activities,
            fit: (0..program.row_count()).map(|row| is_fit(program, row)).collect(),
            simple: vec![None; n],
            variable: vec![None; n],
            nearest: Vec::new(),
            sides: vec![[None; 2]; n],
        };
        point.find_variable_bounds();
        point.find_simple_bounds();
        point.nearest = point.simple.iter().zip(&point.variable).map(nearer).collect();
        point
    }

    fn find_variable_bounds(&mut self) {
        let SeparatedPoint { program, domain, x, .. } = *self;
        for row in 0..program.row_count() {
            let (&[p, q], &[a, b]) = program.row(row) else { continue };
            for (j, a, z, b) in [(p, a, q, b), (q, b, p, a)] {
                if program.integral[j] || !program.integral[z] || domain.is_fixed(z) {
                    continue;
                }
                // a x + b z within limits: x = limit / a - (b / a) z is a bound.
                let limits = [program.row_lower[row], program.row_upper[row]];
                for (limit, upper) in [(limits[0], a < 0.0), (limits[1], a > 0.0)] {
                    let sign = if upper { -1.0 } else { 1.0 };
                    let (constant, slope) = (limit / a, -b / a);
                    let value = (sign * (x[j] - constant - slope * x[z])).max(0.0);
                    let from = From { sign, constant, slope, binary: z, row, value };
                    offer(&mut self.variable[j], from);
                    offer(&mut self.sides[j][usize::from(upper)], from);
                }
            }
        }
    }

    fn find_simple_bounds(&mut self) {
        let SeparatedPoint { program, domain, x, .. } = *self;
        for j in (0..program.column_count()).filter(|&j| !program.integral[j]) {
            for (constant, sign) in [(domain.lower(j), 1.0), (domain.upper(j), -1.0)] {
                let value = (sign * (x[j] - constant)).max(0.0);
                offer(&mut self.simple[j], From::simple(sign, constant, value));
            }
        }
    }

    /// The nearest simple bound of a continuous column.
    pub(super) fn simple(&self, column: usize) -> Option<From> {
        self.simple[column]
    }

    /// The nearest variable bound of a continuous column.
    pub(super) fn variable(&self, column: usize) -> Option<From> {
        self.variable[column]
    }

    /// The nearest bound of a continuous column; a variable one wins a tie.
    pub(super) fn nearest(&self, column: usize) -> Option<From> {
        self.nearest[column]
    }

    /// The bound of a continuous column from which a term `a x` is measured as a nonnegative one:
    /// the nearest variable bound of that side, or else its simple bound.
    pub(super) fn vanishing(&self, column: usize, a: f64) -> From {
        let upper = a < 0.0;
        self.sides[column][usize::from(upper)].unwrap_or_else(|| {
            let constant = self.domain.bounds(column)[usize::from(upper)];
            let sign = if upper { -1.0 } else { 1.0 };
            let value = (sign * (self.x[column] - constant)).max(0.0);
            From::simple(sign, constant, value)
        })
    }

    /// The nearest variable bound of a continuous column from above, or else from below.
    pub(super) fn opening(&self, column: usize) -> Option<From> {
        let [lower, upper] = self.sides[column];
        upper.or(lower)
    }

    /// Whether the nearest variable bound of a continuous column is farther than the simple one.
    pub(super) fn hides_variable_bound(&self, column: usize) -> bool {
        let [nearest, variable] = [self.nearest[column], self.variable[column]];
        variable.zip(nearest).is_some_and(|(variable, nearest)| nearest.value < variable.value)
    }

    /// Whether a row can be aggregated with others: it has a limit, and is no variable bound, which
    /// is put in anyway.
    pub(super) fn is_fit(&self, row: usize) -> bool {
        self.fit[row]
    }

    /// The distance of a continuous column from the bound that it is measured from; infinite for a
    /// free one.
    pub(super) fn distance(&self, column: usize) -> f64 {
        self.nearest(column).map_or(f64::INFINITY, |from| from.value)
    }

    /// Which side of a row its slack is measured from: `1` for the upper one.
    pub(super) fn slack_sign(&self, row: usize) -> f64 {
        let [below, above] = self.rooms(row);
        if above <= below { 1.0 } else { -1.0 }
    }

    /// The distance of a row to the nearer of its limits, negative if it is violated.
    pub(super) fn slack(&self, row: usize) -> f64 {
        let [below, above] = self.rooms(row);
        above.min(below)
    }

    /// The coefficient of a column in the row of its variable bound.
    pub(super) fn coefficient(&self, row: usize, column: usize) -> f64 {
        let (columns, values) = self.program.row(row);
        columns.iter().zip(values).find(|(j, _)| **j == column).map_or(1.0, |(_, a)| *a)
    }

    /// The slack of a row as a column: it is measured from 0.
    pub(super) fn slack_from(&self, row: usize) -> From {
        let value = self.slack(row).max(0.0);
        From::simple(1.0, 0.0, value)
    }

    /// The largest magnitude of a column within its bounds and at the point.
    pub(super) fn reach(&self, column: usize) -> f64 {
        reach(self.domain, column).max(self.x[column].abs())
    }

    fn rooms(&self, row: usize) -> [f64; 2] {
        let activity = self.activities[row];
        [activity - self.program.row_lower[row], self.program.row_upper[row] - activity]
    }
}

fn is_fit(program: &Program, row: usize) -> bool {
    let whole = |&j: &usize| program.integral[j];
    let columns = program.row(row).0;
    let variable_bound = columns.len() == 2 && columns.iter().any(whole);
    let limited = program.row_lower[row].is_finite() || program.row_upper[row].is_finite();
    limited && !variable_bound
}

fn nearer((simple, variable): (&Option<From>, &Option<From>)) -> Option<From> {
    match (*simple, *variable) {
        (Some(simple), Some(variable)) if simple.value < variable.value => Some(simple),
        (simple, variable) => variable.or(simple),
    }
}

/// Takes a bound if it is nearer than the one before.
fn offer(from: &mut Option<From>, new: From) {
    let known = new.constant.is_finite() && new.slope.is_finite();
    if known && from.is_none_or(|old| new.value < old.value) {
        *from = Some(new);
    }
}
