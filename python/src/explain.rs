//! Why a program has no point, in the rows, cones and columns of its arrays.

use carom::explain::{ExplainOptions, Explanation, ExplanationStatus, infeasibility};
use carom::model::{Model, Name};
use carom::solver::{Interrupt, Options};
use carom::{BranchAndBound, Error};
use pyo3::prelude::*;

use crate::build::{Layout, Part};

/// The parts of a program that contradict each other.
#[derive(Debug, Default, IntoPyObject)]
pub(crate) struct Conflict {
    status: &'static str,
    text: String,
    /// Names of statements and variables in a model from a file.
    names: Vec<String>,
    rows: Vec<usize>,
    cones: Vec<usize>,
    bounds: Vec<usize>,
}

/// Looks for the contradiction; limits end it with what is known so far.
pub(crate) fn explain(
    model: &Model,
    layout: &Layout,
    options: Options,
    interrupt: &Interrupt,
) -> Result<Conflict, Error> {
    let mut limits = ExplainOptions::default().with_interrupt(interrupt);
    limits.time_limit = options.time_limit;
    let why = infeasibility(model, &limits, &mut BranchAndBound::new(options))?;
    Ok(conflict(model, layout, &why))
}

fn conflict(model: &Model, layout: &Layout, why: &Explanation) -> Conflict {
    let status = match why.status() {
        ExplanationStatus::Feasible => "feasible",
        ExplanationStatus::Irreducible => "irreducible",
        ExplanationStatus::Reducible => "reducible",
        _ => "unknown",
    };
    let mut found = Conflict { status, text: why.to_string(), ..Conflict::default() };
    for name in why.groups().iter().flat_map(|group| group.statements()).map(Name::to_string) {
        match layout.statement(&name) {
            Some(Part::Row(row)) => found.rows.push(row),
            Some(Part::Cone(cone)) => found.cones.push(cone),
            Some(Part::Bound(column)) => found.bounds.push(column),
            None => {}
        }
        found.names.push(name);
    }
    for name in why.domains() {
        let column = model.variable_by_name(name.clone()).map(|variable| variable.index());
        found.bounds.extend(column.ok().filter(|column| *column < layout.variables.len()));
        found.names.push(name.to_string());
    }
    for parts in [&mut found.rows, &mut found.cones, &mut found.bounds] {
        parts.sort_unstable();
        parts.dedup();
    }
    found
}
