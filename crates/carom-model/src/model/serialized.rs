//! Models from and to `serde`: a model that is read is checked like one that is written by hand.

use super::affine::merge;
use super::checks::{finite, limits};
use super::disjunction::{MAX_NESTING, check_selector};
use super::name::Name;
use super::store::{
    ConicData, ConstraintData, DisjunctionData, FunctionData, IndicatorData, LogicalData, Model,
    SosData, StoredModel, VariableData,
};
use super::stored::{StoredRow, StoredTerm};
use crate::error::Error;

impl TryFrom<StoredModel> for Model {
    type Error = Error;

    fn try_from(stored: StoredModel) -> Result<Self, Error> {
        let mut model = Model::empty(stored.name, stored.tag);
        let mut all_relaxed = Vec::new();
        for data in stored.variables {
            let VariableData { name, kind, lower, upper, range, semicontinuous, relaxed } = data;
            let variable = match range {
                Some(range) => model.push_stored_parameter(name, kind, (lower, upper), range)?,
                None => model.variable(name, kind, lower, upper)?,
            };
            if let Some(values) = semicontinuous {
                model.make_semicontinuous(variable, values.lower, values.upper)?;
            }
            all_relaxed.extend(relaxed.then_some(variable));
        }
        for ConstraintData { name, row } in stored.constraints {
            let row = row.checked(&model, &name)?;
            model.push_constraint(name, row)?;
        }
        for IndicatorData { name, condition, row, big_m } in stored.indicators {
            let row = row.checked(&model, &name)?;
            model.push_indicator(name, condition, row, big_m)?;
        }
        for ConicData { name, condition, conic, big_m } in stored.conic {
            name.check()?;
            let conic = model.checked_conic(conic, &name)?;
            model.push_conic(name, condition, conic, big_m)?;
        }
        for LogicalData { name, logic } in stored.logic {
            model.add(name, logic)?;
        }
        for DisjunctionData { name, method, terms } in stored.disjunctions {
            let terms = checked(terms, &model, &name, 1)?;
            model.push_disjunction(name, method, terms)?;
        }
        for SosData { name, most, members } in stored.sets {
            model.add_set(name, most, members)?;
        }
        model.set_reformulation(stored.reformulation);
        for FunctionData { result, function } in stored.functions {
            model.push_stored_function(result, function)?;
        }
        model.set_objective(stored.sense, stored.objective)?;
        // An objective may have been set before that is convex at whole values only.
        for variable in all_relaxed {
            model.relax_integer(variable)?;
        }
        for family in stored.background {
            model.set_background(&family)?;
        }
        (model.stored.words, model.stored.by_step) = (stored.words, stored.by_step);
        Ok(model)
    }
}

impl From<Model> for StoredModel {
    fn from(model: Model) -> Self {
        model.stored
    }
}

impl StoredRow {
    /// Checks a row from a file; unlike a new one it may be empty.
    fn checked(mut self, model: &Model, name: &Name) -> Result<Self, Error> {
        name.check()?;
        for &(variable, _) in &self.terms {
            model.check_variable(variable, name)?;
        }
        merge(&mut self.terms);
        for &(_, coefficient) in &self.terms {
            finite(coefficient, "a coefficient", name)?;
        }
        (self.lower, self.upper) = limits(self.lower, self.upper, name)?;
        Ok(self)
    }
}

/// Checks the terms of a disjunction from a file, at a level from 1 on.
fn checked(
    terms: Vec<StoredTerm>,
    model: &Model,
    name: &Name,
    level: u32,
) -> Result<Vec<StoredTerm>, Error> {
    name.check()?;
    if terms.is_empty() {
        return Err(Error::out_of_range(format!("the number of terms of `{name}`"), 0.0, 1.0..));
    }
    if level > MAX_NESTING {
        let (what, most) = (format!("the number of levels of `{name}`"), f64::from(MAX_NESTING));
        return Err(Error::out_of_range(what, f64::from(level), ..=most));
    }
    let term = |StoredTerm { selector, rows, conic, nested }| {
        check_selector(selector, model, name)?;
        let rows = rows.into_iter().map(|row: StoredRow| row.checked(model, name));
        let nested = nested.into_iter().map(|inner| checked(inner, model, name, level + 1));
        let (rows, nested) = (rows.collect::<Result<_, _>>()?, nested.collect::<Result<_, _>>()?);
        let conic = conic.into_iter().map(|conic| model.checked_conic(conic, name));
        Ok(StoredTerm { selector, rows, conic: conic.collect::<Result<_, _>>()?, nested })
    };
    terms.into_iter().map(term).collect()
}
