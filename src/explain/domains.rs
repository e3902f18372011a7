//! Which domains a contradiction uses, if propagation can tell.

use std::collections::BTreeMap;

use super::oracle::Oracle;
use crate::error::Error;
use crate::model::{Model, Name, VariableKind, subset};
use crate::presolve::{Domain, Propagator};
use crate::program::Program;
use crate::reformulate;

/// Limit on propagations; variables that are not reached count as used.
const TRIALS: usize = 500;

/// A part of a model that propagation refutes, while bounds are removed.
struct Search<'a> {
    program: &'a Program,
    propagator: Propagator,
    /// For each variable of the model, whether its bounds stay.
    used: Vec<bool>,
    trials: usize,
}

/// The variables whose bounds are needed for propagation to refute the statements that are kept;
/// empty if it does not refute them.
///
/// The big-Ms are not recomputed.
pub(super) fn used_domains(
    model: &Model,
    keep: &[bool],
    oracle: &Oracle<'_>,
) -> Result<Vec<Name>, Error> {
    let part = subset(model, |position| keep[position]);
    let lowered = match reformulate::lower(&part) {
        Err(error) if reformulate::is_missing_bound(&error) => return Ok(Vec::new()),
        other => other?,
    };
    let program = Program::assemble(lowered.model())?;
    let bounded = model.variables().map(|v| {
        let whole = v.kind() == VariableKind::Binary;
        !(whole && v.bounds().lower == 0.0 && v.bounds().upper == 1.0)
    });
    let mut search = Search {
        program: &program,
        propagator: Propagator::new(&program),
        used: bounded.collect(),
        trials: TRIALS,
    };
    if !search.refutes(oracle, model) {
        return Ok(Vec::new());
    }
    search.open((0, model.variable_count()), oracle, model);
    let used = model.variables().filter(|v| search.used[v.id().index()]);
    let mut names: Vec<Name> = used.map(|v| v.name().clone()).collect();
    // Families together, in the order of their first members.
    let mut first = BTreeMap::new();
    for (place, name) in names.iter().enumerate() {
        first.entry(name.family().to_owned()).or_insert(place);
    }
    names.sort_by_key(|name| (first.get(name.family()).copied(), name.step()));
    Ok(names)
}

impl Search<'_> {
    /// Removes the bounds of as many variables in a range as possible, by bisection.
    fn open(&mut self, (first, end): (usize, usize), oracle: &Oracle<'_>, model: &Model) {
        let before = self.used[first..end].to_vec();
        if !before.contains(&true) {
            return;
        }
        self.used[first..end].fill(false);
        if self.refutes(oracle, model) {
            return;
        }
        self.used[first..end].copy_from_slice(&before);
        if end - first > 1 {
            let middle = first + (end - first) / 2;
            self.open((first, middle), oracle, model);
            self.open((middle, end), oracle, model);
        }
    }

    fn refutes(&mut self, oracle: &Oracle<'_>, model: &Model) -> bool {
        if self.trials == 0 || oracle.is_stopped() {
            return false;
        }
        self.trials -= 1;
        let mut domain = Domain::new(self.program);
        for variable in model.variables().filter(|v| !self.used[v.id().index()]) {
            let (low, high) = match variable.kind() {
                VariableKind::Binary => (0.0, 1.0),
                _ => (f64::NEG_INFINITY, f64::INFINITY),
            };
            domain.set_lower(variable.id().index(), low);
            domain.set_upper(variable.id().index(), high);
        }
        self.propagator.propagate_all(self.program, &mut domain).is_err()
    }
}
