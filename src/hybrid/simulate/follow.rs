//! Whether a plan is the run of its inputs, and inputs with which it is.

use super::error::RunError;
use super::open_run::OpenRun;
use super::plan::PlannedRun;
use super::track::{Freedom, TrackedRun};
use crate::error::Error;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::HybridSystem;

/// A plan beside the run from its start.
pub(in crate::hybrid) enum Followed {
    /// It is the run of its inputs, up to what is allowed.
    AsPlanned,
    /// It leaves that run, and this run has the same transitions and other inputs.
    Corrected(Box<HybridRun>, RunError),
    /// It leaves that run, and there are no such inputs.
    Drifts(RunError),
}

impl HybridSystem {
    /// Follows the inputs and transitions of a run from a start, each input within its range.
    ///
    /// # Arguments
    ///
    /// * `start`: the first sample as it is stated, of which that of the run may be off by a tolerance.
    pub(in crate::hybrid) fn follow(
        &self,
        run: &HybridRun,
        start: &[f64],
    ) -> Result<Followed, Error> {
        let plan = PlannedRun::new(self, run)?;
        let inputs = plan.inputs_within();
        let Some(departure) = OpenRun::of(&plan, start, &inputs).worst(&plan) else {
            return Ok(Followed::AsPlanned);
        };
        let error = plan.drifts(start, &inputs, &departure);
        let kept = [Freedom::ToNearerEnd, Freedom::WholeRange].into_iter().find_map(|freedom| {
            let tracked = plan.tracked(start, freedom)?;
            plan.is_near(&tracked.states).then_some(tracked)
        });
        Ok(match kept {
            None => Followed::Drifts(error),
            Some(TrackedRun { inputs, states }) => {
                let mut run = run.clone();
                put(&mut run.states, &states);
                put(&mut run.inputs, &inputs);
                Followed::Corrected(Box::new(run), error)
            }
        })
    }
}

impl PlannedRun<'_> {
    /// Whether states are as near to the plan's as drifts may be.
    fn is_near(&self, states: &[Vec<f64>]) -> bool {
        states.iter().zip(&self.states).enumerate().all(|(sample, (states, planned))| {
            let apart = states.iter().zip(planned).map(|(a, b)| (a - b).abs());
            apart.zip(self.allowed_drifts(sample)).all(|(apart, allowed)| apart <= allowed)
        })
    }
}

/// Puts values by sample in the place of those of named series, in their order.
fn put(series: &mut [(String, Vec<f64>)], values: &[Vec<f64>]) {
    for (k, (_, own)) in series.iter_mut().enumerate() {
        *own = values.iter().map(|sample| sample[k]).collect();
    }
}
