//! Probing: try both values of a binary, keep what propagation proves.
//!
//! A binary whose value 1 contradicts the domain is fixed to 0, and the other way round. A trial
//! costs one propagation, a small fraction of a relaxation; on wall programs most impacts that
//! cannot happen are excluded this way, and many horizons are refuted without any relaxation.
//!
//! What is excluded at one step often lets the next step be excluded, forwards or backwards in time,
//! so rounds change direction: a chain falls in one round instead of one link a round.
//!
//! A trial that found nothing is not repeated while nothing has changed that it looked at, at one
//! node or from node to node.

use super::domain::Domain;
use super::footprint::Blocks;
use super::propagation::{Conflict, Propagator};
use crate::program::Program;
use crate::tolerance;

/// What the last trial of each literal looked at.
#[derive(Debug, Clone)]
pub struct ProbingRecord {
    /// By column, for its upper value and its lower one.
    trials: Vec<[Trial; 2]>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Trial {
    /// 0 where there was none.
    time: u32,
    visited: Blocks,
}

impl ProbingRecord {
    /// Nothing was tried yet; `columns` is the number of columns of the program.
    pub fn new(columns: usize) -> Self {
        ProbingRecord { trials: vec![[Trial::default(); 2]; columns] }
    }
}

/// Probes columns in the given order and back until a full round changes nothing, or the trials run out.
///
/// Only columns with two whole values left are probed; others are passed over. `go_on` is asked
/// before every trial; what is proved until it says no is kept.
///
/// # Errors
///
/// The [`Conflict`] that proves the domain empty.
pub fn probe(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    columns: &[usize],
    trials: usize,
    go_on: &dyn Fn() -> bool,
) -> Result<(), Conflict> {
    let mut record = ProbingRecord::new(program.column_count());
    probe_again(program, domain, propagator, (columns, trials), &mut record, go_on)
}

/// Like [`probe`] with so many trials of these columns, at one of many nodes that share a propagator:
/// it passes over what the record says has been tried on the same bounds.
///
/// # Errors
///
/// The [`Conflict`] that proves the domain empty.
pub fn probe_again(
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    (columns, mut trials): (&[usize], usize),
    record: &mut ProbingRecord,
    go_on: &dyn Fn() -> bool,
) -> Result<(), Conflict> {
    let open =
        |domain: &Domain, j: usize| program.integral[j] && domain.upper(j) - domain.lower(j) == 1.0;
    let mut backwards = false;
    loop {
        let before = domain.mark();
        for k in 0..columns.len() {
            let j = columns[if backwards { columns.len() - 1 - k } else { k }];
            for is_upper in [false, true] {
                if !open(domain, j) {
                    break;
                }
                let last = &mut record.trials[j][usize::from(is_upper)];
                let changed = propagator.footprint.changed_after(last.time);
                if last.time > 0 && changed & last.visited == 0 {
                    continue;
                }
                if trials == 0 || !go_on() {
                    return Ok(());
                }
                trials -= 1;
                let [lower, upper] = domain.bounds(j);
                let mark = domain.mark();
                // First the upper value, then the lower one.
                let value = if is_upper { lower } else { upper };
                let (trial, visited, time) =
                    propagator.try_bound(program, domain, j, is_upper, value);
                *last = Trial { time, visited };
                if trial.is_err() {
                    domain.apply(j, !is_upper, if is_upper { upper } else { lower });
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
    /// Propagates a bound on trial and takes everything back: the outcome, what it looked at, and when.
    fn try_bound(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        column: usize,
        is_upper: bool,
        value: f64,
    ) -> (Result<(), Conflict>, Blocks, u32) {
        let mark = domain.mark();
        self.footprint.set_on_trial(true);
        self.footprint.start();
        self.least_gain = tolerance::PROBING_GAIN;
        domain.apply(column, is_upper, value);
        let trial = self.propagate_since(program, domain, mark);
        domain.undo_to(mark);
        self.least_gain = tolerance::PROPAGATION_GAIN;
        self.footprint.set_on_trial(false);
        let (visited, time) = self.footprint.finish();
        (trial, visited, time)
    }
}
