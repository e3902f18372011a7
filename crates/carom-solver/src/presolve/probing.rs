//! Probing: try both values of a binary, and keep what propagation proves.
//!
//! Takes integral columns with two values left; leaves one value where propagation refutes the
//! other (Savelsbergh, Preprocessing and probing techniques for mixed integer programming problems,
//! ORSA Journal on Computing 6, 1994).
//!
//! A binary whose value 1 contradicts the domain is fixed to 0, and the other way round. A trial
//! costs one propagation, a small fraction of a relaxation. It often excludes most impacts and
//! refutes many horizons without a relaxation.
//!
//! An exclusion at one step often lets the next step be excluded, forwards or backwards in
//! time, so rounds alternate in direction, and a whole chain is excluded in one round instead of
//! one link per round.
//!
//! A trial that found nothing is not repeated while the rows that it visited are unchanged, within
//! a node or from node to node.

use super::change_log::RowBlockSet;
use super::domain::Domain;
use super::propagation::{Conflict, Propagator};
use crate::program::Program;
use crate::solver::StopToken;
use crate::tolerance;

/// The number of trials of a side (the upper or the lower values) after which its success rate
/// counts.
const MIN_SIDE_TRIALS: u32 = 100;

/// The trials per success that are accepted of a side. With 100, `wall_fuel_60` spends twice the
/// time on trials, and other programs the same.
const TRIALS_PER_SUCCESS: u32 = 30;

/// The number of visits after which a side with too few successes is tried again.
const RETRIAL_INTERVAL: u32 = 8;

/// The rows that earlier trials visited, and the results of these trials.
#[derive(Debug, Clone)]
pub(crate) struct ProbingRecord {
    /// By column, the last one of its upper value and of its lower one.
    trials: Vec<[SideTrial; 2]>,
    /// The same for all columns together: trials, and those that found something.
    counts: [(u32, u32); 2],
    visits: u32,
    /// The bounds found last: column, whether it is the upper one, value.
    found: Vec<(usize, bool, f64)>,
    /// Trials of the last visit.
    tried: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct SideTrial {
    /// 0 where there was none.
    time: u32,
    visited: RowBlockSet,
}

impl ProbingRecord {
    /// A record without trials; `columns` is the number of columns of the program.
    pub(crate) fn new(columns: usize) -> Self {
        ProbingRecord {
            trials: vec![[SideTrial::default(); 2]; columns],
            counts: [(0, 0); 2],
            visits: 0,
            found: Vec::new(),
            tried: 0,
        }
    }

    /// The bounds that the last visit found by its trials, in their order: the column, whether it
    /// is the upper bound, and its value. Propagation finds the rest again.
    pub(crate) fn found(&self) -> &[(usize, bool, f64)] {
        &self.found
    }

    /// Trials of the last visit.
    pub(crate) fn tried(&self) -> usize {
        self.tried
    }

    /// Whether the success rate of a side is high enough, or its retrial is due.
    fn is_worth(&self, is_upper: bool) -> bool {
        let (trials, found) = self.counts[usize::from(is_upper)];
        trials < MIN_SIDE_TRIALS
            || u64::from(found) * u64::from(TRIALS_PER_SUCCESS) >= u64::from(trials)
            || self.visits.is_multiple_of(RETRIAL_INTERVAL)
    }

    fn note(&mut self, column: usize, is_upper: bool, trial: SideTrial, found: bool) {
        let side = usize::from(is_upper);
        self.trials[column][side] = trial;
        self.counts[side].0 += 1;
        self.counts[side].1 += u32::from(found);
    }
}

/// Limits on the number of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trials {
    /// The most trials.
    pub most: usize,
    /// The most of them in a row that find nothing.
    pub patience: usize,
}

/// Probes columns in the given order and back until a full round changes nothing, or the trials run
/// out.
///
/// Only columns with two whole values left are probed; others are passed over. `token` is asked
/// before every trial; what is proved until it is over is kept.
///
/// # Errors
///
/// The `Conflict` that proves the domain empty.
pub fn probe(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    columns: &[usize],
    trials: usize,
    token: &StopToken,
) -> Result<(), Conflict> {
    let mut record = ProbingRecord::new(program.column_count());
    let trials = Trials { most: trials, patience: usize::MAX };
    probe_again(program, domain, propagator, (columns, trials), &mut record, token)
}

/// Like [`probe`] with so many trials of these columns, at one of many nodes that share a
/// propagator: it passes over what the record says has been tried on the same bounds, and tries the
/// sides that hardly ever find anything now and then only.
///
/// # Errors
///
/// The `Conflict` that proves the domain empty.
pub(crate) fn probe_again(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    (columns, trials): (&[usize], Trials),
    record: &mut ProbingRecord,
    token: &StopToken,
) -> Result<(), Conflict> {
    let open =
        |domain: &Domain, j: usize| program.integral[j] && domain.upper(j) - domain.lower(j) == 1.0;
    record.visits = record.visits.wrapping_add(1);
    record.found.clear();
    record.tried = 0;
    let (mut left, mut idle) = (trials.most, 0);
    let mut backwards = false;
    loop {
        let before = domain.mark();
        for k in 0..columns.len() {
            let j = columns[if backwards { columns.len() - 1 - k } else { k }];
            for is_upper in [false, true] {
                if !open(domain, j) {
                    break;
                }
                let last = record.trials[j][usize::from(is_upper)];
                let known =
                    last.time > 0 && !propagator.change_log.has_changed(last.visited, last.time);
                if known || !record.is_worth(is_upper) {
                    continue;
                }
                if left == 0 || idle == trials.patience || token.is_over() {
                    return Ok(());
                }
                left -= 1;
                record.tried += 1;
                idle += 1;
                let [lower, upper] = domain.bounds(j);
                let mark = domain.mark();
                // First the upper value, then the lower one.
                let value = if is_upper { lower } else { upper };
                let (trial, visited, time) =
                    propagator.try_bound(program, domain, j, is_upper, value);
                record.note(j, is_upper, SideTrial { time, visited }, trial.is_err());
                if trial.is_err() {
                    idle = 0;
                    let value = if is_upper { upper } else { lower };
                    domain.apply(j, !is_upper, value);
                    record.found.push((j, !is_upper, value));
                    propagator.propagate_since(program, domain, mark)?;
                }
            }
        }
        if domain.mark() == before {
            return Ok(());
        }
        backwards = !backwards;
    }
}

impl Propagator {
    /// Propagates a bound on trial and undoes it. Returns the outcome, the visited blocks and the
    /// time.
    fn try_bound(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        column: usize,
        is_upper: bool,
        value: f64,
    ) -> (Result<(), Conflict>, RowBlockSet, u32) {
        let mark = domain.mark();
        self.change_log.set_on_trial(true);
        self.change_log.start();
        self.least_gain = tolerance::PROBING_GAIN;
        domain.apply(column, is_upper, value);
        let trial = self.propagate_since(program, domain, mark);
        domain.undo_to(mark);
        self.least_gain = tolerance::PROPAGATION_GAIN;
        self.change_log.set_on_trial(false);
        let (visited, time) = self.change_log.finish();
        (trial, visited, time)
    }
}
