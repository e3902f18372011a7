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
}

impl LoweredProgram {
    /// A program whose first columns are the variables of a model.
    pub(super) fn new(program: Program, way_back: Arc<WayBack>) -> Self {
        LoweredProgram { program, way_back, postsolve: None, rounding: 0.0 }
    }

    /// The program that a presolve for all values of the parameters has left.
    pub(super) fn presolved(&self, program: Program, postsolve: Postsolve, rounding: f64) -> Self {
        let way_back = self.way_back.clone();
        LoweredProgram { program, way_back, postsolve: Some(postsolve), rounding }
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
pub(super) fn lower(model: &Model, token: &StopToken) -> Result<Option<LoweredProgram>, Error> {
    let (mut program, way_back) = if model.has_only_rows() {
        (Program::assemble(model)?, WayBack::to_rows(model))
    } else {
        let Some(lowered) = reformulate::lower_until(model, None, token)? else {
            return Ok(None);
        };
        (Program::assemble(lowered.model())?, lowered.into_way_back())
    };
    check_curvature(model, &program, false)?;
    program.constant = program.sign * model.objective_constant();
    Ok(Some(LoweredProgram::new(program, Arc::new(way_back))))
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
