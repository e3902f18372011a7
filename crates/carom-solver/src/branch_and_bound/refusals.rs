//! The points that the check of the model has refused, for searches that stall.

use std::sync::{Mutex, PoisonError};

use crate::solution::Verification;

/// The check of the refused point that violates the model least.
#[derive(Debug, Default)]
pub(super) struct Refusals(Mutex<Option<Verification>>);

impl Refusals {
    /// Takes note of a refused point.
    pub(super) fn note(&self, check: Verification) {
        let mut nearest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_nearer = |old: &Verification| worst(&check) < worst(old);
        if nearest.as_ref().is_none_or(is_nearer) {
            *nearest = Some(check);
        }
    }

    pub(super) fn take(&self) -> Option<Verification> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The largest violation, in the unit of its statement.
fn worst(check: &Verification) -> f64 {
    let amounts = check.violations().iter().map(|violation| violation.amount);
    amounts.fold(0.0, |most, amount| if amount.is_nan() { f64::INFINITY } else { most.max(amount) })
}
