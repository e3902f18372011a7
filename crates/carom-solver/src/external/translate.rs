//! Rewrites a model of rows and cones as a minimisation with plain names and without a constant,
//! because all programs read that in the same way.

use std::collections::HashMap;

use crate::error::Error;
use crate::interval::Interval;
use crate::model::{
    Affine, Model, Name, Quadratic, Sense, StoredConic, Variable, mps, with_quadratic_rows,
};

/// The MPS text, and what is needed to translate the answer back.
pub(super) struct Translated {
    pub(super) text: String,
    /// Objective of the model = `sign * (objective of the file + offset)`.
    pub(super) sign: f64,
    pub(super) offset: f64,
    columns: HashMap<String, usize>,
    /// The number of columns of the model; further ones are for squares.
    count: usize,
}

/// Returns `None` if the bounds of an integer variable contain no whole number.
pub(super) fn translate(model: &Model) -> Result<Option<Translated>, Error> {
    let (count, model) = (model.variable_count(), &*with_quadratic_rows(model)?);
    let sign = model.sense().sign();
    let mut plain = Model::new("carom");
    let mut renamed: Vec<Variable> = Vec::with_capacity(model.variable_count());
    let mut columns = HashMap::with_capacity(model.variable_count());
    for (j, variable) in model.variables().enumerate() {
        let (name, mut bounds) = (format!("c{j}"), variable.bounds());
        if variable.kind().is_integral() {
            // Some programs refuse integers whose bounds are not whole.
            bounds = Interval::new(bounds.lower.ceil(), bounds.upper.floor());
            if bounds.lower > bounds.upper {
                return Ok(None);
            }
        }
        renamed.push(plain.variable(&name[..], variable.kind(), bounds.lower, bounds.upper)?);
        columns.insert(name, j);
    }
    let affine = |terms: &[(Variable, f64)], factor: f64| {
        let mut sum = Affine::zero();
        terms.iter().for_each(|&(v, a)| sum.add_term(factor * a, renamed[v.index()]));
        sum
    };
    for (i, row) in model.constraints().enumerate() {
        let limits = row.limits();
        if row.terms().is_empty() {
            // A row without variables is true or false; a fixed column makes a false one
            // infeasible.
            if !limits.contains(0.0) {
                let never = plain.continuous(format!("never{i}").as_str(), 0.0, 0.0)?;
                let row = never.within(limits.lower, limits.upper);
                plain.add(format!("r{i}").as_str(), row)?;
            }
            continue;
        }
        let row = affine(row.terms(), 1.0).within(limits.lower, limits.upper);
        plain.add(format!("r{i}").as_str(), row)?;
    }
    for (i, conic) in model.conic_constraints().enumerate() {
        let StoredConic::Quadratic { expression } = conic.conic() else { continue };
        let name = Name::from(format!("q{i}"));
        let mut row = Quadratic::from(affine(&expression.affine().terms(), 1.0));
        for (first, second, q) in expression.products() {
            row.add_product(q, renamed[first.index()], renamed[second.index()]);
        }
        plain.add(name, row.le(-expression.affine().offset()))?;
    }
    let objective = model.objective();
    let mut cost = Quadratic::from(affine(&objective.affine().terms(), sign));
    for (first, second, q) in objective.products() {
        cost.add_product(sign * q, renamed[first.index()], renamed[second.index()]);
    }
    plain.set_objective(Sense::Minimize, cost)?;
    let offset = sign * objective.affine().offset();
    Ok(Some(Translated { text: mps::write(&plain)?, sign, offset, columns, count }))
}

impl Translated {
    /// One value per column of the model, in order, or a description of what is wrong.
    pub(super) fn values(&self, found: &[(String, f64)]) -> Result<Vec<f64>, String> {
        let mut values = vec![0.0; self.columns.len()];
        for (name, value) in found {
            match self.columns.get(name) {
                Some(&j) if value.is_finite() => values[j] = *value,
                // A column that stands for a false row.
                None if name.starts_with("never") => {}
                _ => return Err(format!("it says that `{name}` is {value}")),
            }
        }
        values.truncate(self.count);
        Ok(values)
    }
}
