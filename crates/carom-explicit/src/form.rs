//! The matrix form over variables and parameters, `min 1/2 x'Px + q'x + c` over rows and a box.

use carom_model::internals::semidefinite::negative_direction;
use carom_model::model::{Model, Variable};
use carom_model::{Error, ErrorKind};

use crate::simplex_cell::BOX_UNITS;

/// The most parameters of a set: the cells of a box are n! simplices to begin with.
const MOST_AXES: usize = 6;

/// The rounding of entries of `P`, relative to the sum of their column.
const ENTRY_ROUNDING: f64 = 4e-15;

/// A row `lower <= terms <= upper`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FormRow {
    pub(crate) terms: Vec<(usize, f64)>,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

/// A lowered model as matrices, always a minimisation. Its columns are the variables of the lowered
/// model, and some of them are the axes of the set.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ParametricForm {
    pub(crate) names: Vec<String>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) integral: Vec<bool>,
    /// The columns of the axes, and whether a column is one.
    pub(crate) axes: Vec<usize>,
    pub(crate) is_axis: Vec<bool>,
    pub(crate) rows: Vec<FormRow>,
    /// `P`, symmetric, by column: rows and values.
    pub(crate) quadratic: Vec<Vec<(usize, f64)>>,
    pub(crate) linear: Vec<f64>,
    pub(crate) offset: f64,
    /// By how much the diagonal of `P` may be too small to be semidefinite, because of rounding,
    /// and what that adds to the cost over the bounds of the columns.
    pub(crate) lack: Vec<f64>,
    pub(crate) lacked: f64,
    /// 1 if the model minimises, -1 if it maximises.
    pub(crate) sign: f64,
}

pub(crate) fn refused(what: String, help: &str) -> Error {
    let solver = "a table of laws".to_owned();
    ErrorKind::Unsupported { solver, what, help: help.into() }.into()
}

impl ParametricForm {
    /// The form of a lowered model in which the `axes` range over their declared ranges. Other
    /// parameters have the values that they have.
    pub(crate) fn of(model: &Model, axes: &[Variable]) -> Result<Self, Error> {
        if !model.has_only_rows() || model.conic_constraints().next().is_some() {
            let what = "cones".to_owned();
            return Err(refused(what, "state norms as rows, such as the sides of a polygon"));
        }
        if axes.is_empty() || axes.len() > MOST_AXES {
            let (what, value) = ("the number of axes of a table", axes.len() as f64);
            return Err(Error::out_of_range(what, value, 1.0..=MOST_AXES as f64));
        }
        let n = model.variable_count();
        let sign = model.sense().sign();
        let mut form = ParametricForm {
            names: Vec::with_capacity(n),
            lower: Vec::with_capacity(n),
            upper: Vec::with_capacity(n),
            integral: Vec::with_capacity(n),
            axes: axes.iter().map(|axis| axis.index()).collect(),
            is_axis: vec![false; n],
            rows: Vec::new(),
            quadratic: vec![Vec::new(); n],
            linear: vec![0.0; n],
            offset: sign * model.objective().affine().offset(),
            lack: vec![0.0; n],
            lacked: 0.0,
            sign,
        };
        for variable in model.variables() {
            let bounds = variable.bounds();
            let whole = variable.kind().is_integral();
            form.names.push(variable.name().to_string());
            form.lower.push(if whole { bounds.lower.ceil() } else { bounds.lower });
            form.upper.push(if whole { bounds.upper.floor() } else { bounds.upper });
            form.integral.push(whole);
        }
        for &axis in axes {
            let variable = model.variable_ref(axis)?;
            let name = variable.name().to_string();
            let Some(range) = variable.parameter_range() else {
                return Err(ErrorKind::NotParameter { name }.into());
            };
            if range.upper <= range.lower {
                let what = format!("the axis `{name}`, whose range is one value");
                return Err(refused(what, "leave it out of the axes"));
            }
            let j = axis.index();
            if form.is_axis[j] {
                let what = format!("the axis `{name}` twice");
                return Err(refused(what, "name each parameter once"));
            }
            (form.lower[j], form.upper[j], form.is_axis[j]) = (range.lower, range.upper, true);
        }
        for row in model.constraints() {
            let terms = row.terms().iter().map(|&(v, a)| (v.index(), a)).collect();
            let limits = row.limits();
            form.rows.push(FormRow { terms, lower: limits.lower, upper: limits.upper });
        }
        form.bound_columns();
        let open = |j: &usize| !form.lower[*j].is_finite() || !form.upper[*j].is_finite();
        if let Some(j) = (0..n).find(open) {
            let what = format!("`{}`, which has no bound on a side", form.names[j]);
            return Err(refused(what, "give it two finite bounds"));
        }
        for (v, a) in model.objective().affine().terms() {
            form.linear[v.index()] = sign * a;
        }
        form.add_products(&model.minimized_products())?;
        Ok(form)
    }

    /// Bounds of columns that have none, from rows in which all others have some.
    fn bound_columns(&mut self) {
        let is_open = |lower: f64, upper: f64| !lower.is_finite() || !upper.is_finite();
        for _ in 0..self.lower.len() {
            let mut changed = false;
            for row in &self.rows {
                for &(j, a) in row.terms.iter().filter(|(_, a)| *a != 0.0) {
                    if !is_open(self.lower[j], self.upper[j]) {
                        continue;
                    }
                    let (mut least, mut most) = (0.0, 0.0);
                    for &(k, b) in row.terms.iter().filter(|(k, _)| *k != j) {
                        let ends = [b * self.lower[k], b * self.upper[k]];
                        least += ends[0].min(ends[1]);
                        most += ends[0].max(ends[1]);
                    }
                    let ends = [(row.lower - most) / a, (row.upper - least) / a];
                    let (lower, upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                    // Somewhat wider, for roundings.
                    let room = 1e-9 * (1.0 + lower.abs().min(upper.abs()));
                    if lower.is_finite() && !self.lower[j].is_finite() {
                        (self.lower[j], changed) = (lower - room, true);
                    }
                    if upper.is_finite() && !self.upper[j].is_finite() {
                        (self.upper[j], changed) = (upper + room, true);
                    }
                }
            }
            if !changed {
                break;
            }
        }
    }

    fn add_products(&mut self, products: &[(usize, usize, f64)]) -> Result<(), Error> {
        let own = products.iter().copied().filter(|p| !self.is_axis[p.0] && !self.is_axis[p.1]);
        if let Some(direction) = negative_direction(&own.collect::<Vec<_>>(), &|_| 0.0) {
            let largest = direction.steps.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let name = largest.map_or("", |step| &self.names[step.0]);
            let what = format!("a cost that is not convex in `{name}`");
            return Err(refused(what, "write squares"));
        }
        for &(a, b, q) in products {
            // x'Px / 2 holds q x_a^2 as P_aa = 2 q, and q x_a x_b as P_ab = P_ba = q.
            if a == b {
                self.quadratic[a].push((a, 2.0 * q));
            } else {
                self.quadratic[a].push((b, q));
                self.quadratic[b].push((a, q));
            }
        }
        self.quadratic.iter_mut().for_each(|column| column.sort_by_key(|entry| entry.0));
        for j in (0..self.columns()).filter(|j| !self.is_axis[*j]) {
            let own = self.quadratic[j].iter().filter(|entry| !self.is_axis[entry.0]);
            if own.clone().any(|entry| entry.0 != j) {
                let sum: f64 = own.map(|entry| entry.1.abs()).sum();
                self.lack[j] = ENTRY_ROUNDING * sum;
                self.lacked += 0.5 * self.lack[j] * (self.upper[j] - self.lower[j]).powi(2);
            }
        }
        Ok(())
    }

    /// Number of columns.
    pub(crate) fn columns(&self) -> usize {
        self.lower.len()
    }

    /// The state at a corner.
    pub(crate) fn state(&self, units: &[i64]) -> Vec<f64> {
        let own = |(&j, &units): (&usize, &i64)| {
            let share = units as f64 / BOX_UNITS as f64;
            self.lower[j] + (self.upper[j] - self.lower[j]) * share
        };
        self.axes.iter().zip(units).map(own).collect()
    }

    /// `P x`.
    pub(crate) fn times_quadratic(&self, x: &[f64]) -> Vec<f64> {
        let product = |column: &Vec<(usize, f64)>| column.iter().map(|&(i, p)| p * x[i]).sum();
        self.quadratic.iter().map(product).collect()
    }

    /// `q'x`.
    pub(crate) fn linear_cost(&self, x: &[f64]) -> f64 {
        self.linear.iter().zip(x).map(|(q, x)| q * x).sum()
    }

    /// `A'y`, added.
    pub(crate) fn add_transposed(&self, y: &[f64], sum: &mut [f64]) {
        for (row, &y) in self.rows.iter().zip(y).filter(|(_, y)| **y != 0.0) {
            row.terms.iter().for_each(|&(j, a)| sum[j] += a * y);
        }
    }

    /// The largest violation of a row at a point.
    pub(crate) fn violation(&self, x: &[f64]) -> f64 {
        let of = |row: &FormRow| {
            let sum: f64 = row.terms.iter().map(|&(j, a)| a * x[j]).sum();
            (row.lower - sum).max(sum - row.upper)
        };
        self.rows.iter().map(of).fold(0.0, f64::max)
    }
}
