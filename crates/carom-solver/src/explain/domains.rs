//! Which domains a contradiction uses, if propagation can tell.
//!
//! Propagation sees a row at a time, so it may need bounds where rows alone contradict each other
//! (`x + y <= 1`, `x + y >= 2`). A relaxation sees all rows together, so it is asked too before a
//! domain is named.

use std::collections::{BTreeMap, BTreeSet};

use super::oracle::Oracle;
use crate::error::Error;
use crate::model::{AnyStatement, Model, Name, VariableKind, VariableRef, statements, subset};
use crate::presolve::{Domain, Propagator};
use crate::program::Program;
use crate::reformulate;
use crate::relaxation::{MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict};
use crate::solver::{Options, StopToken};

/// Limit on propagations; variables that are not reached count as used.
const MAX_PROPAGATIONS: usize = 500;

/// Limit on relaxations, each of which costs as much as many propagations.
const MAX_RELAXATIONS: usize = 60;

/// The most binaries of the statements that are blamed of which it is asked whether they have to be
/// binary.
const MAX_BINARIES: usize = 100;

/// A part of a model that propagation refutes, while bounds are removed.
struct DomainReduction<'a> {
    program: &'a Program,
    propagator: Propagator,
    /// For each variable of the model, whether its bounds stay; binaries without theirs are still 0
    /// or 1.
    used: Vec<bool>,
    /// For each variable of the model, whether it may have any value.
    free: Vec<bool>,
    trials: usize,
    cascade: MethodCascade,
    options: Options,
    relaxations: usize,
}

/// The variables whose bounds are needed for propagation or a relaxation to refute the statements
/// that are kept; empty if propagation does not refute them with all bounds.
///
/// The bounds of the variables in the statements that are blamed come first: where they suffice,
/// others are not named. The big-Ms are not recomputed.
pub(super) fn used_domains(
    model: &Model,
    keep: &[bool],
    blamed: &[usize],
    oracle: &Oracle<'_>,
) -> Result<Vec<Name>, Error> {
    let part = subset(model, |position| keep[position]);
    let lowered = match reformulate::lower_around_functions(&part, &StopToken::default()) {
        Err(error) if reformulate::is_missing_bound(&error) => return Ok(Vec::new()),
        other => other?,
    };
    let Some(lowered) = lowered else { return Ok(Vec::new()) };
    let mut program = Program::assemble(lowered.model())?;
    program.make_feasibility_problem();
    let bounded = model.variables().map(|v| {
        let whole = v.kind() == VariableKind::Binary;
        !(whole && v.bounds().lower == 0.0 && v.bounds().upper == 1.0)
    });
    let mut search = DomainReduction {
        program: &program,
        propagator: Propagator::new(&program),
        used: bounded.collect(),
        free: vec![false; model.variable_count()],
        trials: MAX_PROPAGATIONS,
        cascade: MethodCascade::new(Options::default().relaxation),
        options: Options::default(),
        relaxations: 0,
    };
    if !search.refutes(oracle, model) {
        return Ok(Vec::new());
    }
    let all = search.used.clone();
    let near = variables_of(model, blamed);
    search.used.iter_mut().enumerate().for_each(|(k, used)| *used &= near.contains(&k));
    if !search.refutes(oracle, model) {
        search.used = all;
    }
    search.relaxations = MAX_RELAXATIONS;
    search.open((0, model.variable_count()), oracle, model);
    let binaries = search.needed_binaries(&near, oracle, model);
    let used = model.variables().filter(|v| {
        let index = v.id().index();
        search.used[index] || binaries.contains(&index)
    });
    let mut names: Vec<Name> = used.map(|v| v.name().clone()).collect();
    // Families together, in the order of their first members.
    let mut first = BTreeMap::new();
    for (place, name) in names.iter().enumerate() {
        first.entry(name.family().to_owned()).or_insert(place);
    }
    names.sort_by_key(|name| (first.get(name.family()).copied(), name.step()));
    Ok(names)
}

/// The positions of the variables in rows and indicators with some positions among the
/// [`statements`].
fn variables_of(model: &Model, positions: &[usize]) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    for (position, statement) in statements(model).enumerate() {
        let terms = match statement {
            _ if !positions.contains(&position) => continue,
            AnyStatement::Row(row) => row.terms(),
            AnyStatement::Indicator(row) => row.terms(),
            _ => continue,
        };
        found.extend(terms.iter().map(|(variable, _)| variable.index()));
    }
    found
}

impl DomainReduction<'_> {
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

    /// The binaries among some variables that have to be 0 or 1, not just whole; none if a limit
    /// comes first.
    fn needed_binaries(
        &mut self,
        near: &BTreeSet<usize>,
        oracle: &Oracle<'_>,
        model: &Model,
    ) -> BTreeSet<usize> {
        let is_open = |v: &VariableRef<'_>| {
            let index = v.id().index();
            v.kind() == VariableKind::Binary && !self.used[index] && near.contains(&index)
        };
        let open = model.variables().filter(is_open).map(|v| v.id().index());
        let open: Vec<usize> = open.take(MAX_BINARIES + 1).collect();
        if open.len() > MAX_BINARIES {
            return BTreeSet::new();
        }
        open.iter().for_each(|&index| self.free[index] = true);
        if !self.refutes(oracle, model) {
            open.iter().for_each(|&index| self.free[index] = false);
            for &index in &open {
                self.free[index] = true;
                self.free[index] = self.refutes(oracle, model);
            }
        }
        let is_complete = self.trials > 0 && !oracle.is_stopped();
        open.into_iter().filter(|&index| is_complete && !self.free[index]).collect()
    }

    fn refutes(&mut self, oracle: &Oracle<'_>, model: &Model) -> bool {
        if self.trials == 0 || oracle.is_stopped() {
            return false;
        }
        self.trials -= 1;
        let mut domain = Domain::new(self.program);
        for variable in model.variables().filter(|v| !self.used[v.id().index()]) {
            let (low, high) = match variable.kind() {
                VariableKind::Binary if !self.free[variable.id().index()] => (0.0, 1.0),
                _ => (f64::NEG_INFINITY, f64::INFINITY),
            };
            domain.set_lower(variable.id().index(), low);
            domain.set_upper(variable.id().index(), high);
        }
        let refuted = self.propagator.propagate_all(self.program, &mut domain).is_err();
        refuted || self.relaxation_refutes(&domain, oracle)
    }

    fn relaxation_refutes(&mut self, domain: &Domain, oracle: &Oracle<'_>) -> bool {
        if self.relaxations == 0 {
            return false;
        }
        self.relaxations -= 1;
        let Some(mut reduced) = self.cascade.reducer().reduce(self.program, domain) else {
            return true;
        };
        let question = RelaxationQuestion {
            purpose: Purpose::Node,
            cutoff: f64::INFINITY,
            options: &self.options,
            constant: 0.0,
            look_for_descent: false,
            token: oracle.token(),
            warm: None,
        };
        matches!(self.cascade.solve(&mut reduced, &question), RelaxationVerdict::Refuted(_))
    }
}
