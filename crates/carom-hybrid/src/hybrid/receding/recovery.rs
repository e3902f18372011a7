//! Plans from another state than the measured one, where there is none from that.

use web_time::Instant;

use super::RecedingHorizon;
use super::fallback::{TOLERANCE, judging};
use super::loop_plan::LoopPlan;
use super::planner::Planned;
use super::step::{ControlMove, MoveSource};
use crate::error::Error;
use crate::interval::Interval;
use crate::tolerance::margin_scale;

/// How often the way between a state with a plan and one without is halved.
const RECOVERY_HALVINGS: usize = 4;

/// A state whose entries lie in their ranges, if they miss them by rounding or by what a solver
/// leaves.
pub(super) fn rounded_into(state: &[f64], ranges: &[Interval]) -> Vec<f64> {
    let mut rounded = state.to_vec();
    for (value, range) in rounded.iter_mut().zip(ranges) {
        let nearest = value.clamp(range.lower, range.upper);
        if (*value - nearest).abs() <= TOLERANCE * margin_scale(value.abs(), nearest) {
            *value = nearest;
        }
    }
    rounded
}

impl RecedingHorizon<'_> {
    /// A plan from a state near the measured one: from the nearest within the domains; or else from
    /// one on the way from there to the state that the last plan foresaw, as near to the measured
    /// one as a few halvings find.
    pub(super) fn recover(
        &mut self,
        state: &[f64],
        since: Instant,
    ) -> Result<Option<ControlMove>, Error> {
        let ranges = self.planner.ranges()?;
        let clamped = |state: &[f64]| -> Vec<f64> {
            state.iter().zip(&ranges).map(|(x, range)| x.clamp(range.lower, range.upper)).collect()
        };
        if ranges.len() != state.len() {
            return Ok(None);
        }
        let nearest = clamped(state);
        let mut found = None;
        if nearest != state {
            found = self.planned_from(&nearest, since)?;
        }
        let foreseen = self.rest.states.first().filter(|own| own.len() == state.len());
        if let (None, Some(foreseen)) = (&found, foreseen) {
            let foreseen = clamped(foreseen);
            found = self.planned_from(&foreseen, since)?;
            let (mut without, mut with) = (0.0, 1.0);
            for _ in 0..RECOVERY_HALVINGS {
                if found.is_none() {
                    break;
                }
                let part = 0.5 * (without + with);
                let between = nearest.iter().zip(&foreseen).map(|(a, b)| a + part * (b - a));
                match self.planned_from(&between.collect::<Vec<_>>(), since)? {
                    Some(nearer) => (found, with) = (Some(nearer), part),
                    None => without = part,
                }
            }
        }
        let Some((mut next, plan)) = found else { return Ok(None) };
        next.source = MoveSource::Recovery;
        next.is_admissible = self.system.as_ref().map(|system| {
            let first = plan.with_first_input(&next.input);
            let options = judging(&self.memory);
            let run = system.simulate_with(state, &first, &options);
            run.is_ok_and(|run| run.is_complete())
        });
        self.rest = plan;
        Ok(Some(next))
    }

    fn planned_from(
        &mut self,
        state: &[f64],
        since: Instant,
    ) -> Result<Option<(ControlMove, LoopPlan)>, Error> {
        Ok(match self.plan(state, Some(since))? {
            Planned::Found(solution, plan, excess) => {
                Some((ControlMove::planned(&solution, plan.clone(), excess), plan))
            }
            Planned::Nothing(..) => None,
        })
    }
}
