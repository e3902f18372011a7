//! A program with fixed integers, over as few columns as its equations leave.
//!
//! States are shares of the sides of the box, as on a device: an affine function of them is a
//! constant and a factor for each axis.

use crate::arrays::LawOutput;
use crate::form::ParametricForm;

/// A coefficient below this one, beside a largest one of 1, is a rounding.
const NO_COEFFICIENT: f64 = 1e-11;

/// How close the limits of an equation are.
const EQUATION: f64 = 1e-10;

/// The least pivot of a Hessian, relative, that is strictly convex enough for a device.
const LEAST_CURVATURE: f64 = 1e-7;

/// A function of columns and states: factors of columns; a constant, and factors of states.
#[derive(Debug, Clone)]
pub(crate) struct StateAffine {
    pub(crate) columns: Vec<f64>,
    pub(crate) states: Vec<f64>,
}

impl StateAffine {
    fn zero(columns: usize, states: usize) -> Self {
        StateAffine { columns: vec![0.0; columns], states: vec![0.0; states] }
    }

    /// Adds a multiple.
    fn add(&mut self, factor: f64, other: &StateAffine) {
        let add = |(own, other): (&mut f64, &f64)| *own += factor * other;
        self.columns.iter_mut().zip(&other.columns).for_each(add);
        self.states.iter_mut().zip(&other.states).for_each(add);
    }

    /// Puts an expression in the place of a column.
    fn replace(&mut self, column: usize, expression: &StateAffine) {
        let factor = std::mem::take(&mut self.columns[column]);
        if factor != 0.0 {
            self.add(factor, expression);
        }
    }

    /// The column with the largest factor; `None` without columns.
    fn largest(&self) -> Option<usize> {
        let largest = (0..self.columns.len())
            .max_by(|&i, &j| self.columns[i].abs().total_cmp(&self.columns[j].abs()))?;
        (self.columns[largest] != 0.0).then_some(largest)
    }
}

/// A function between limits.
#[derive(Debug, Clone)]
struct LimitedRow {
    of: StateAffine,
    lower: f64,
    upper: f64,
    /// The size of 1 of it in the unit of the row of the form.
    unit: f64,
}

impl LimitedRow {
    /// The same with a largest factor of 1, and a constant 0; `None` without columns, or if all of
    /// their factors are less than this.
    fn normalized(mut self, least: f64) -> Option<Self> {
        let factor = self.of.columns[self.of.largest()?];
        if factor.abs() < least {
            return None;
        }
        let constant = std::mem::take(&mut self.of.states[0]);
        self.unit *= factor.abs();
        let limits = [(self.lower - constant) / factor, (self.upper - constant) / factor];
        (self.lower, self.upper) =
            if factor > 0.0 { (limits[0], limits[1]) } else { (limits[1], limits[0]) };
        let scale = |value: &mut f64| {
            *value /= factor;
            if value.abs() < NO_COEFFICIENT {
                *value = 0.0;
            }
        };
        self.of.columns.iter_mut().for_each(scale);
        self.of.states.iter_mut().for_each(scale);
        Some(self)
    }

    fn is_like(&self, other: &LimitedRow) -> bool {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= NO_COEFFICIENT * (1.0 + a.abs());
        self.of.columns.iter().zip(&other.of.columns).all(near)
            && self.of.states.iter().zip(&other.of.states).all(near)
    }

    fn is_equation(&self) -> bool {
        let room = EQUATION * (1.0 + self.lower.abs());
        self.lower.is_finite() && self.upper - self.lower <= room
    }
}

/// `min 1/2 z'Hz + (tilt)'z` over rows that are at least 0.
#[derive(Debug)]
pub(crate) struct CondensedProgram {
    /// `H`, by row.
    pub(crate) hessian: Vec<Vec<f64>>,
    /// By column of z: a constant, and factors of states.
    pub(crate) tilt: Vec<Vec<f64>>,
    pub(crate) rows: Vec<StateAffine>,
    /// The most that a row can be, by the bounds of z, over the box.
    pub(crate) most: Vec<f64>,
    /// The size of 1 of a row in the unit of the row of the form.
    pub(crate) units: Vec<f64>,
    pub(crate) outputs: Vec<StateAffine>,
    /// All columns of the form.
    pub(crate) columns: Vec<StateAffine>,
}

/// The rows of a form with fixed integers, and the bounds of its columns. Also a function for each
/// column: itself, or its fixed value.
fn fixed_rows(form: &ParametricForm, integers: &[f64]) -> (Vec<LimitedRow>, Vec<StateAffine>) {
    let (n, states) = (form.columns(), form.axes.len() + 1);
    let mut values = vec![StateAffine::zero(n, states); n];
    for (j, value) in values.iter_mut().enumerate() {
        match form.integral[j] {
            true => value.states[0] = integers[j],
            false => value.columns[j] = 1.0,
        }
    }
    for (a, &j) in form.axes.iter().enumerate() {
        values[j] = StateAffine::zero(n, states);
        values[j].states[0] = form.lower[j];
        values[j].states[a + 1] = form.upper[j] - form.lower[j];
    }
    let mut rows = Vec::new();
    for row in &form.rows {
        let mut of = StateAffine::zero(n, states);
        row.terms.iter().for_each(|&(j, a)| of.add(a, &values[j]));
        rows.push(LimitedRow { of, lower: row.lower, upper: row.upper, unit: 1.0 });
    }
    for j in (0..n).filter(|&j| !form.integral[j] && !form.is_axis[j]) {
        let (of, lower, upper) = (values[j].clone(), form.lower[j], form.upper[j]);
        rows.push(LimitedRow { of, lower, upper, unit: 1.0 });
    }
    (rows, values)
}

/// Rows of which those with the same function are one. Rows of states alone are left out, because
/// they hold where the cell has plans.
fn joined(rows: Vec<LimitedRow>, least: f64) -> Vec<LimitedRow> {
    let mut all: Vec<LimitedRow> = Vec::with_capacity(rows.len());
    for row in rows.into_iter().filter_map(|row| row.normalized(least)) {
        match all.iter_mut().find(|other| other.is_like(&row)) {
            Some(other) => {
                other.lower = other.lower.max(row.lower);
                other.upper = other.upper.min(row.upper);
                other.unit = other.unit.max(row.unit);
            }
            None => all.push(row),
        }
    }
    all
}

impl CondensedProgram {
    /// The program of these integers, an entry a column; `None` if it is not strictly convex.
    pub(crate) fn new(
        form: &ParametricForm,
        outputs: &[LawOutput],
        integers: &[f64],
    ) -> Option<Self> {
        let (rows, mut values) = fixed_rows(form, integers);
        let mut rows = joined(rows, 0.0);
        while let Some(at) = rows.iter().position(LimitedRow::is_equation) {
            let LimitedRow { of: mut expression, lower, upper, .. } = rows.swap_remove(at);
            // Its largest factor is 1.
            let column = expression.largest()?;
            expression.columns[column] = 0.0;
            expression.columns.iter_mut().for_each(|factor| *factor = -*factor);
            expression.states.iter_mut().for_each(|factor| *factor = -*factor);
            expression.states[0] += 0.5 * (lower + upper);
            rows.iter_mut().for_each(|row| row.of.replace(column, &expression));
            values.iter_mut().for_each(|value| value.replace(column, &expression));
            // Rows had a largest factor of 1, so that less than this is what cancelled.
            rows = joined(rows, NO_COEFFICIENT);
        }
        let is_free = |j: &usize| values.iter().any(|value| value.columns[*j] != 0.0);
        let free: Vec<usize> = (0..form.columns()).filter(is_free).collect();
        let over_free = |of: &StateAffine| StateAffine {
            columns: free.iter().map(|&j| of.columns[j]).collect(),
            states: of.states.clone(),
        };
        let values: Vec<StateAffine> = values.iter().map(over_free).collect();
        let bounds: Vec<[f64; 2]> = free.iter().map(|&j| [form.lower[j], form.upper[j]]).collect();
        let mut own = CondensedProgram::with_cost(form, &values, free.len());
        for output in outputs {
            let mut of = StateAffine::zero(free.len(), form.axes.len() + 1);
            of.states[0] = output.offset;
            output.terms.iter().for_each(|&(j, a)| of.add(a, &values[j]));
            own.outputs.push(of);
        }
        for row in &rows {
            for (limit, sign) in [(row.lower, 1.0), (row.upper, -1.0)] {
                if limit.is_infinite() {
                    continue;
                }
                let mut of = StateAffine::zero(free.len(), form.axes.len() + 1);
                of.add(sign, &over_free(&row.of));
                of.states[0] -= sign * limit;
                let ends = of.columns.iter().zip(&bounds);
                let most: f64 = ends.map(|(a, [l, u])| (a * l).max(a * u)).sum();
                let states: f64 = of.states[1..].iter().map(|a| a.max(0.0)).sum();
                own.most.push((most + states + of.states[0]).max(0.0));
                own.units.push(row.unit);
                own.rows.push(of);
            }
        }
        own.columns = values;
        own.is_strictly_convex().then_some(own)
    }

    /// The cost, and no rows.
    fn with_cost(form: &ParametricForm, values: &[StateAffine], free: usize) -> Self {
        let states = form.axes.len() + 1;
        let mut hessian = vec![vec![0.0; free]; free];
        let mut tilt = vec![vec![0.0; states]; free];
        for (j, column) in form.quadratic.iter().enumerate() {
            for &(i, p) in column {
                for (f, (hessian, tilt)) in hessian.iter_mut().zip(&mut tilt).enumerate() {
                    let factor = p * values[i].columns[f];
                    hessian.iter_mut().zip(&values[j].columns).for_each(|(h, x)| *h += factor * x);
                    tilt.iter_mut().zip(&values[j].states).for_each(|(g, x)| *g += factor * x);
                }
            }
        }
        for (value, q) in values.iter().zip(&form.linear) {
            for (tilt, x) in tilt.iter_mut().zip(&value.columns) {
                tilt[0] += q * x;
            }
        }
        let (rows, most, units) = (Vec::new(), Vec::new(), Vec::new());
        let (outputs, columns) = (Vec::new(), Vec::new());
        CondensedProgram { hessian, tilt, rows, most, units, outputs, columns }
    }

    fn is_strictly_convex(&self) -> bool {
        self.factor().is_some()
    }

    /// The Cholesky factor of the Hessian.
    fn factor(&self) -> Option<Vec<Vec<f64>>> {
        let n = self.hessian.len();
        let largest = (0..n).map(|k| self.hessian[k][k]).fold(0.0, f64::max);
        let mut factor = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in 0..=i {
                let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let rest = self.hessian[i][j] - sum;
                if i == j {
                    if rest.is_nan() || rest <= LEAST_CURVATURE * largest {
                        return None;
                    }
                    factor[i][i] = rest.sqrt();
                } else {
                    factor[i][j] = rest / factor[j][j];
                }
            }
        }
        Some(factor)
    }

    /// The inverse of the Hessian times vectors.
    pub(crate) fn solved(&self, vectors: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
        let factor = self.factor()?;
        let n = factor.len();
        let solve = |vector: &Vec<f64>| {
            let mut x = vector.clone();
            for i in 0..n {
                let sum: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
                x[i] = (x[i] - sum) / factor[i][i];
            }
            for i in (0..n).rev() {
                let sum: f64 = (i + 1..n).map(|k| factor[k][i] * x[k]).sum();
                x[i] = (x[i] - sum) / factor[i][i];
            }
            x
        };
        Some(vectors.iter().map(solve).collect())
    }
}
