//! The first phase: the statements of a model become rows, and the rows a program.

use std::sync::Arc;

use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::Postsolve;
use crate::presolve::{Domain, Propagator};
use crate::program::Program;
use crate::reformulate::{self, WayBack};
use crate::solver::StopToken;

/// The program of a lowered model, and the way back to the model.
#[derive(Debug)]
pub(super) struct LoweredProgram {
    pub(super) program: Program,
    way_back: Arc<WayBack>,
    /// The way back of a presolve for all values of the parameters, if there was one.
    pub(super) postsolve: Option<Postsolve>,
    /// The part of the objective that this presolve may have lost to rounding.
    pub(super) rounding: f64,
    /// The names of the columns and of the rows, if they were asked for.
    pub(super) names: Option<[Vec<String>; 2]>,
}

impl LoweredProgram {
    /// A program whose first columns are the variables of a model.
    pub(super) fn new(program: Program, way_back: Arc<WayBack>) -> Self {
        LoweredProgram { program, way_back, postsolve: None, rounding: 0.0, names: None }
    }

    /// The program that a presolve for all values of the parameters has left.
    pub(super) fn presolved(&self, program: Program, postsolve: Postsolve, rounding: f64) -> Self {
        let way_back = self.way_back.clone();
        LoweredProgram { program, way_back, postsolve: Some(postsolve), rounding, names: None }
    }

    /// From values of the program's columns to values of the model's variables.
    pub(super) fn restore(&self, x: &[f64]) -> Vec<f64> {
        match &self.postsolve {
            Some(postsolve) => self.way_back.restore(&postsolve.point(x)),
            None => self.way_back.restore(x),
        }
    }

    /// Values of the model's variables as values of the program's columns.
    pub(super) fn carry(&self, values: &[(usize, f64)]) -> Vec<(usize, f64)> {
        match &self.postsolve {
            Some(postsolve) => postsolve.carry(values),
            None => values.to_vec(),
        }
    }

    /// The place of a column among the variables of the lowered model.
    pub(super) fn column(&self, column: usize) -> Option<usize> {
        match &self.postsolve {
            Some(postsolve) => postsolve.columns().get(column).copied(),
            None => Some(column),
        }
    }
}

/// Lowers and assembles a model; `None` if a limit comes first.
///
/// # Arguments
///
/// * `names`: whether to keep the names of columns and rows.
pub(super) fn lower(
    model: &Model,
    token: &StopToken,
    names: bool,
) -> Result<Option<LoweredProgram>, Error> {
    let names_of = |model: &Model| {
        let columns = model.variables().map(|variable| variable.name().to_string());
        let rows = model.constraints().map(|row| row.name().to_string());
        names.then(|| [columns.collect(), rows.collect()])
    };
    let (mut program, way_back, names) = if model.has_only_rows() {
        (Program::assemble(model)?, WayBack::to_rows(model), names_of(model))
    } else {
        let Some(lowered) = reformulate::lower_until(model, None, token)? else {
            return Ok(None);
        };
        let names = names_of(lowered.model());
        (Program::assemble(lowered.model())?, lowered.into_way_back(), names)
    };
    check_curvature(model, &program, false)?;
    program.constant = program.sign * model.objective_constant();
    let lowered = LoweredProgram::new(program, Arc::new(way_back));
    Ok(Some(LoweredProgram { names, ..lowered }))
}

/// Refuses an objective whose distance from a convex one is seen within the bounds of the program of a
/// model, and within those that its rows imply.
///
/// # Arguments
///
/// * `for_all_parameters`: whether parameters may take any value of their ranges.
///
/// # Errors
///
/// [`ErrorKind::NotConvex`](crate::ErrorKind::NotConvex).
pub(super) fn check_curvature(
    model: &Model,
    program: &Program,
    for_all_parameters: bool,
) -> Result<(), Error> {
    if !model.is_convex_within_bounds() {
        return Ok(());
    }
    let mut domain = Domain::new(program);
    for parameter in model.parameters().filter(|_| for_all_parameters) {
        if let Some(range) = model.variable_ref(parameter)?.parameter_range() {
            domain.set_lower(parameter.index(), range.lower);
            domain.set_upper(parameter.index(), range.upper);
        }
    }
    // Without a point there is nothing to be seen.
    if Propagator::new(program).propagate_all(program, &mut domain).is_err() {
        return Ok(());
    }
    model.check_convexity(|j| domain.upper(j) - domain.lower(j))
}
