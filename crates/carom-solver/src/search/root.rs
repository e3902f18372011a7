//! The root, propagated and probed once, for all workers and for all that strengthens the program.

use super::indifferent_binaries::{BinaryGroup, groups, ungrouped_binaries};
use super::root_point::RootPoint;
use super::task::SolveTask;
use crate::presolve::{
    Conflict, Domain, ProbingRecord, Propagator, Trials, covering_rows, probe, probe_again,
    probe_implications,
};
use crate::program::Program;
use crate::solver::StopToken;

/// Trials of probing at the root. Each costs a propagation of the rows it reaches, a small part of
/// a relaxation.
const ROOT_TRIALS: usize = 4000;

/// Trials in a row that may find nothing where a wider root has been probed before.
const ROOT_FAILED_TRIALS: usize = 12;

/// Numbers of sides of the disjunctions that are split at once.
const DISJUNCTION_SIDES: std::ops::RangeInclusive<usize> = 3..=64;

/// The root after propagation and probing; every worker starts from it.
#[derive(Debug, Clone)]
pub struct Root {
    /// The covering rows that can be split.
    pub(super) covers: Vec<usize>,
    pub(super) groups: Vec<BinaryGroup>,
    /// Binaries without a cost that are in no group.
    pub(super) ungrouped: Vec<usize>,
    /// The integers in the order of probing, the last one first.
    pub(super) late_first: Vec<usize>,
    pub(super) domain: Domain,
    /// The propagator, with the implications that probing has found.
    pub(super) propagator: Propagator,
    pub(super) conflict: Option<Conflict>,
    /// The relaxed point, where it is known.
    pub(super) point: Option<RootPoint>,
}

impl Root {
    /// Propagates, and probes if `probing`, until the token is over. Propagation keeps the token.
    pub(crate) fn new(program: &Program, token: &StopToken, probing: bool) -> Self {
        let mut domain = Domain::new(program);
        let mut propagator = Propagator::new(program);
        propagator.set_stop_token(token);
        let late_first: Vec<usize> = program.integers.iter().rev().copied().collect();
        let trials = if probing { ROOT_TRIALS } else { 0 };
        let conflict = propagator
            .propagate_all(program, &mut domain)
            .and_then(|()| probe(program, &mut domain, &mut propagator, &late_first, trials, token))
            .and_then(|()| {
                probe_implications(
                    program,
                    &mut domain,
                    &mut propagator,
                    &late_first,
                    trials,
                    token,
                )
            })
            .map(|implications| propagator.set_implications(implications))
            .err();
        let (covers, groups) = (covering_rows(program, &DISJUNCTION_SIDES), groups(program));
        let ungrouped = ungrouped_binaries(program, &groups);
        Root { covers, groups, ungrouped, late_first, domain, propagator, conflict, point: None }
    }

    /// The proved bound of the relaxed root, where it is known.
    pub(crate) fn relaxed_bound(&self) -> Option<f64> {
        self.point.as_ref().map(|point| point.bound)
    }

    /// Iterations of the relaxation of the root, where it is known.
    pub(crate) fn relaxed_iterations(&self) -> u64 {
        self.point.as_ref().map_or(0, |point| point.iterations)
    }

    /// The root with the bound that the bounds of its columns prove.
    pub(super) fn bounded(&self, task: &SolveTask<'_>) -> Self {
        let mut cascade = task.cascades.take();
        let point = RootPoint::of_bounds(task.program, &self.domain, &mut cascade);
        task.cascades.give_back(cascade);
        Root { point, ..self.clone() }
    }

    /// The root of the same program with tighter bounds: what is known of it still holds.
    pub(crate) fn within(&self, program: &Program, token: &StopToken, probing: bool) -> Self {
        let mut root = self.clone();
        root.propagator.set_stop_token(token);
        let (domain, propagator) = (&mut root.domain, &mut root.propagator);
        let mark = domain.mark();
        for j in 0..program.column_count() {
            let [lower, upper] = domain.bounds(j);
            if program.lower[j] > lower {
                domain.apply(j, false, program.lower[j]);
            }
            if program.upper[j] < upper {
                domain.apply(j, true, program.upper[j]);
            }
        }
        if root.conflict.is_none() {
            let most = if probing { ROOT_TRIALS } else { 0 };
            let trials = Trials { most, patience: ROOT_FAILED_TRIALS };
            let mut record = ProbingRecord::new(program.column_count());
            root.conflict = propagator
                .propagate_since(program, domain, mark)
                .and_then(|()| {
                    let order = (&root.late_first[..], trials);
                    probe_again(program, domain, propagator, order, &mut record, token)
                })
                .err();
        }
        root
    }

    /// The bounds of a column; `None` if there is no point.
    pub(crate) fn bounds(&self, column: usize) -> Option<[f64; 2]> {
        self.conflict.is_none().then(|| self.domain.bounds(column))
    }

    /// Carries the root over to a program over the same columns with another objective or further
    /// rows.
    pub(crate) fn carry_over(&mut self, program: &Program, token: &StopToken) {
        if self.conflict.is_some() {
            return;
        }
        (self.covers, self.groups) = (covering_rows(program, &DISJUNCTION_SIDES), groups(program));
        self.ungrouped = ungrouped_binaries(program, &self.groups);
        self.renew(program, token);
    }

    /// Propagates the domain through another program.
    fn renew(&mut self, program: &Program, token: &StopToken) {
        let mut propagator = Propagator::new(program);
        propagator.set_stop_token(token);
        propagator.set_implications(self.propagator.implications().clone());
        self.conflict = propagator.propagate_all(program, &mut self.domain).err();
        self.propagator = propagator;
    }
}
