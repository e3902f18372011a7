//! Whether a plan is the run of its inputs, and inputs with which it is.

use super::open_run::OpenRun;
use super::plan::PlannedRun;
use super::track::{Freedom, TrackedRun};
use crate::error::{Error, RunError};
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::HybridSystem;

/// A plan beside the run from its start.
pub(crate) enum Followed {
    /// It is the run of its inputs, up to what is allowed.
    AsPlanned,
    /// It leaves that run. These runs have the same transitions and other inputs, and need not keep
    /// what is stated. Without an error, the run may be kept as it is.
    Leaves(Vec<HybridRun>, Option<RunError>),
}

impl HybridSystem {
    /// Follows the inputs and transitions of a run from a start, each input within its range.
    ///
    /// # Arguments
    ///
    /// * `start`: the first sample as it is stated, of which that of the run may be off by a
    ///   tolerance.
    pub(crate) fn follow(&self, run: &HybridRun, start: &[f64]) -> Result<Followed, Error> {
        let plan = PlannedRun::new(self, run)?;
        let inputs = plan.inputs_within();
        let error = match OpenRun::of(&plan, start, &inputs).worst(&plan) {
            Some(departure) => Some(plan.drifts(start, &inputs, &departure)),
            None if self.is_nonlinear() && plan.misses(&inputs) => None,
            None => return Ok(Followed::AsPlanned),
        };
        // Without inputs, there is one run.
        let freedoms = match self.inputs.is_empty() {
            true => &[Freedom::WholeRange][..],
            false => &[Freedom::ToNearerEnd, Freedom::WholeRange],
        };
        let tracked = freedoms.iter().filter_map(|freedom| plan.tracked(start, *freedom));
        let runs = tracked.map(|TrackedRun { mut inputs, states }| {
            let ends = states.iter().zip(states.iter().skip(1));
            for (input, (state, next)) in inputs.iter_mut().zip(ends) {
                *input = self.with_function_values(state, next, input);
            }
            let mut run = run.clone();
            put(&mut run.states, &states);
            put(&mut run.inputs, &inputs);
            run.outputs.clear();
            run
        });
        Ok(Followed::Leaves(runs.collect(), error))
    }
}

/// Puts values by sample in the place of those of named series, in their order.
fn put(series: &mut [(String, Vec<f64>)], values: &[Vec<f64>]) {
    for (k, (_, own)) in series.iter_mut().enumerate() {
        *own = values.iter().map(|sample| sample[k]).collect();
    }
}
