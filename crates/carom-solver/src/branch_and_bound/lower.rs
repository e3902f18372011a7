//! The first phase: the statements of a model become rows, and the rows a program.

use std::sync::Arc;

use super::convex_objective::convex_form;
use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::Postsolve;
use crate::presolve::{Domain, LeafColumns, Propagator};
use crate::program::Program;
use crate::reformulate::{self, Lowered, WayBack};
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
    /// The columns that its equations determine in leaves.
    pub(super) leaf_columns: LeafColumns,
    /// The names of the columns and of the rows, if they were asked for.
    pub(super) names: Option<[Vec<String>; 2]>,
    /// By how much the program's objective may be below that of the model at a point, in its unit.
    pub(super) loss: f64,
    /// The program that the model states, if its objective is not convex.
    stated: Option<Box<StatedProgram>>,
}

/// A program whose objective is not convex.
#[derive(Debug)]
struct StatedProgram {
    program: Program,
    /// Multiples of `z^2 - z` of columns between 0 and 1 that make the objective as it was convex.
    squares: Option<Vec<(usize, f64)>>,
}

impl LoweredProgram {
    /// A program whose first columns are the variables of a model.
    pub(super) fn new(program: Program, way_back: Arc<WayBack>) -> Self {
        LoweredProgram {
            program,
            way_back,
            postsolve: None,
            rounding: 0.0,
            leaf_columns: LeafColumns::default(),
            names: None,
            loss: 0.0,
            stated: None,
        }
    }

    /// The same, with what its objective has to do with that of the model.
    pub(super) fn in_form(self, form: AssembledForm) -> Self {
        let AssembledForm { loss, stated } = form;
        LoweredProgram { loss, stated, ..self }
    }

    /// The program that the model states, and multiples of `z^2 - z` that make its objective
    /// convex, if there are any.
    pub(super) fn stated(&self) -> (&Program, Option<&[(usize, f64)]>) {
        match &self.stated {
            Some(stated) => (&stated.program, stated.squares.as_deref()),
            None => (&self.program, Some(&[])),
        }
    }

    /// The program that a presolve for all values of the parameters has left.
    pub(super) fn presolved(&self, program: Program, postsolve: Postsolve, rounding: f64) -> Self {
        LoweredProgram {
            postsolve: Some(postsolve),
            rounding,
            loss: self.loss,
            ..LoweredProgram::new(program, self.way_back.clone())
        }
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

/// How a convex objective differs from that of the model.
#[derive(Debug, Default)]
pub(super) struct AssembledForm {
    loss: f64,
    stated: Option<Box<StatedProgram>>,
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
    let lowered = if model.has_only_rows() {
        None
    } else {
        let Some(lowered) = reformulate::lower_until(model, None, token)? else {
            return Ok(None);
        };
        Some(lowered)
    };
    let rows = lowered.as_ref().map_or(model, Lowered::model);
    let names = names_of(rows);
    // A proof knows no squares of equations and no towers.
    let (program, form) = assemble(rows, false, names.is_none())?;
    let way_back = lowered.map_or_else(|| WayBack::to_rows(model), Lowered::into_way_back);
    let mut lowered = LoweredProgram::new(program, Arc::new(way_back)).in_form(form);
    lowered.program.constant = lowered.program.sign * model.objective_constant();
    lowered.names = names;
    Ok(Some(lowered))
}

/// Assembles a model that has only rows. An objective that is not seen to be convex within the
/// bounds of the program, and within those that its rows imply, becomes one that is.
///
/// # Arguments
///
/// * `for_all_parameters`: whether parameters may take any value of their ranges.
/// * `may_restate`: whether squares of equations may be added to such an objective, and long norms
///   may become towers. Proofs know neither.
///
/// # Errors
///
/// [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex); those of [`Program::assemble`].
pub(super) fn assemble(
    rows: &Model,
    for_all_parameters: bool,
    may_restate: bool,
) -> Result<(Program, AssembledForm), Error> {
    let assembled = |model: &Model| match may_restate {
        true => Program::assemble_with_towers(model),
        false => Program::assemble(model),
    };
    let mut program = assembled(rows)?;
    if !rows.is_convex_within_bounds() {
        return Ok((program, AssembledForm::default()));
    }
    let mut domain = Domain::new(&program);
    for parameter in rows.parameters().filter(|_| for_all_parameters) {
        if let Some(range) = rows.variable_ref(parameter)?.parameter_range() {
            domain.set_lower(parameter.index(), range.lower);
            domain.set_upper(parameter.index(), range.upper);
        }
    }
    if Propagator::new(&program).propagate_all(&program, &mut domain).is_err() {
        // Without a point there is nothing to be seen.
        program.make_feasibility_problem();
        return Ok((program, AssembledForm::default()));
    }
    if rows.concave_direction(|j| domain.upper(j) - domain.lower(j)).is_none() {
        return Ok((program, AssembledForm::default()));
    }
    let form = convex_form(rows, &domain, may_restate)?;
    let convex = assembled(&form.model)?;
    let stated = Box::new(StatedProgram { program, squares: form.squares });
    Ok((convex, AssembledForm { loss: form.loss, stated: Some(stated) }))
}
