//! The memory of results that are no longer needed, for new ones.

use super::parameters::MAX_KEPT_RESULTS;
use super::warm_start::ParentIterate;
use crate::relaxation::{RelaxationResult, WarmState};

#[derive(Default)]
pub(super) struct ResultMemory {
    vectors: Vec<Vec<f64>>,
    /// The multipliers of cones that belong to the last result.
    pub(super) cone_dual: Vec<f64>,
    /// States of iterates that are not shared.
    states: Vec<WarmState>,
}

impl ResultMemory {
    /// A vector of some values.
    pub(super) fn vector(&mut self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut vector = self.vectors.pop().unwrap_or_default();
        vector.clear();
        vector.extend(values);
        vector
    }

    /// A state that `write` makes.
    pub(super) fn state(&mut self, write: impl FnOnce(&mut ParentIterate)) -> WarmState {
        let mut state =
            self.states.pop().unwrap_or_else(|| WarmState::new(ParentIterate::default()));
        if let Some(parent) = state.get_mut() {
            write(parent);
        }
        state
    }

    /// Takes a result back.
    pub(super) fn take_back(&mut self, result: RelaxationResult) {
        let RelaxationResult { x, y, warm, .. } = result;
        // The point is the first to be written again.
        for vector in [y, x] {
            if vector.capacity() > 0 && self.vectors.len() < MAX_KEPT_RESULTS {
                self.vectors.push(vector);
            }
        }
        let own =
            warm.and_then(|mut state| state.get_mut::<ParentIterate>().is_some().then_some(state));
        self.states.extend(own.filter(|_| self.states.len() < MAX_KEPT_RESULTS));
    }
}
