//! A small program as plain numbers.

use carom::prelude::*;

use super::quadratic_program::dot;

/// A variable.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column {
    pub(crate) kind: VariableKind,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

/// `lower <= a'x <= upper`, with one coefficient a column. The model gets it multiplied by
/// `scale`, which is a power of two, so that nothing is rounded.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) scale: f64,
}

/// "Binary on (or off) implies a row".
#[derive(Debug, Clone)]
pub(crate) struct Switch {
    pub(crate) binary: usize,
    pub(crate) on: bool,
    pub(crate) line: Line,
}

/// `weight * (a'x + constant)^2`; the weight is positive, but over columns with two values.
#[derive(Debug, Clone)]
pub(crate) struct Square {
    pub(crate) weight: f64,
    pub(crate) coefficients: Vec<f64>,
    pub(crate) constant: f64,
}

/// A mixed-integer program. It minimises the cost `squares + linear'x + constant`, or maximises
/// its negative.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) columns: Vec<Column>,
    pub(crate) lines: Vec<Line>,
    pub(crate) switches: Vec<Switch>,
    pub(crate) squares: Vec<Square>,
    pub(crate) linear: Vec<f64>,
    pub(crate) constant: f64,
    pub(crate) maximize: bool,
}

impl Line {
    pub(crate) fn row(&self, variables: &[Variable]) -> Row {
        let row = affine(&self.coefficients, variables) * self.scale;
        row.within(self.lower * self.scale, self.upper * self.scale)
    }

    /// By how much the row is missed at a point, in the model's (scaled) unit, beyond what it may
    /// be.
    pub(crate) fn excess(&self, x: &[f64], tolerance: f64) -> f64 {
        let activity = self.scale * dot(&self.coefficients, x);
        let terms = self.coefficients.iter().zip(x).map(|(a, x)| (self.scale * a * x).abs());
        let (below, above) =
            (self.lower * self.scale - activity, activity - self.upper * self.scale);
        let limit = self.scale * if below > above { self.lower } else { self.upper };
        let size = terms.sum::<f64>() + if limit.is_finite() { limit.abs() } else { 0.0 };
        below.max(above) - allowed(tolerance, size)
    }
}

/// What a statement may be missed by: the tolerance, and the rounding of the point and of plain
/// sums.
fn allowed(tolerance: f64, size: f64) -> f64 {
    tolerance + 8.0 * f64::EPSILON * size
}

impl Case {
    /// The model, and its variables in the order of the columns.
    pub(crate) fn build(&self) -> (Model, Vec<Variable>) {
        let mut model = Model::new("case");
        let mut variables = Vec::new();
        for (j, column) in self.columns.iter().enumerate() {
            let Column { kind, lower, upper } = *column;
            let variable = model.variable(format!("v{j}"), kind, lower, upper);
            variables.push(variable.expect("a variable"));
        }
        for (i, line) in self.lines.iter().enumerate() {
            model.add(format!("r{i}"), line.row(&variables)).expect("a row");
        }
        for (i, switch) in self.switches.iter().enumerate() {
            let binary = variables[switch.binary];
            let condition = if switch.on { binary.on() } else { binary.off() };
            let implication = condition.implies(switch.line.row(&variables));
            model.add(format!("i{i}"), implication).expect("an indicator");
        }
        let mut cost = Quadratic::from(affine(&self.linear, &variables) + self.constant);
        for square in &self.squares {
            let inner = affine(&square.coefficients, &variables) + square.constant;
            cost += square.weight * inner.square();
        }
        if self.maximize {
            model.maximize(-cost).expect("a concave objective");
        } else {
            model.minimize(cost).expect("a convex objective");
        }
        (model, variables)
    }

    /// `+1` when minimising, `-1` when maximising: objective = sign * cost.
    pub(crate) fn sign(&self) -> f64 {
        if self.maximize { -1.0 } else { 1.0 }
    }

    /// The cost that is minimised.
    pub(crate) fn cost(&self, x: &[f64]) -> f64 {
        let square = |s: &Square| s.weight * (dot(&s.coefficients, x) + s.constant).powi(2);
        self.squares.iter().map(square).sum::<f64>() + dot(&self.linear, x) + self.constant
    }

    /// What a point violates beyond the tolerance, in words.
    pub(crate) fn violation(&self, x: &[f64], tolerance: f64) -> Option<String> {
        assert_eq!(x.len(), self.columns.len());
        for (j, (column, &x)) in self.columns.iter().zip(x).enumerate() {
            let allowed = allowed(tolerance, x.abs());
            if !(x >= column.lower - allowed && x <= column.upper + allowed) {
                return Some(format!("v{j} = {x} is outside its bounds"));
            }
            if column.kind != VariableKind::Continuous && (x - x.round()).abs() > 1e-9 {
                return Some(format!("v{j} = {x} is not whole"));
            }
        }
        for (i, line) in self.lines.iter().enumerate() {
            let excess = line.excess(x, tolerance);
            if excess.is_nan() || excess > 0.0 {
                return Some(format!("row r{i} is missed by {excess} beyond the tolerance"));
            }
        }
        for (i, switch) in self.switches.iter().enumerate() {
            let excess = switch.line.excess(x, tolerance);
            if (x[switch.binary] > 0.5) == switch.on && (excess.is_nan() || excess > 0.0) {
                return Some(format!("i{i} is missed by {excess} beyond the tolerance"));
            }
        }
        None
    }
}

fn affine(coefficients: &[f64], variables: &[Variable]) -> Affine {
    coefficients.iter().zip(variables).map(|(&a, &v)| a * v).sum()
}
