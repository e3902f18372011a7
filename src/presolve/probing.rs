//! Probing: try both values of a binary, keep what propagation proves.
//!
//! A binary whose value 1 contradicts the domain is fixed to 0, and the other way round. A trial
//! costs one propagation, a small fraction of a relaxation; on wall programs most impacts that
//! cannot happen are excluded this way, and many horizons are refuted without any relaxation.
//!
//! What is excluded at one step often lets the next step be excluded, forwards or backwards in time,
//! so rounds change direction: a chain falls in one round instead of one link a round.

use super::analysis::Cut;
use super::domain::Domain;
use super::propagation::{Conflict, Propagator};
use crate::program::Program;

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
    mut trials: usize,
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
                if trials == 0 || !go_on() {
                    return Ok(());
                }
                trials -= 1;
                let (lower, upper) = (domain.lower(j), domain.upper(j));
                let mark = domain.mark();
                // First the upper value, then the lower one.
                domain.apply(j, is_upper, if is_upper { lower } else { upper });
                let trial = propagator.propagate_until(program, domain, mark, Cut::Decision);
                domain.undo_to(mark);
                if trial.is_err() {
                    let reason = propagator.reason_against(j, is_upper);
                    let value = if is_upper { upper } else { lower };
                    domain.apply_because(j, !is_upper, value, reason);
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
