//! Whether a start is in the goal already.

use crate::error::Error;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{HybridSystem, Region};
use crate::interval::Interval;
use crate::tolerance::FEASIBILITY;

impl HybridSystem {
    /// A run without steps whose only sample is in two regions, if the middle of what their ranges
    /// share is one.
    pub(super) fn common_sample(
        &self,
        first: &Region,
        second: &Region,
    ) -> Result<Option<HybridRun>, Error> {
        let mut state = Vec::with_capacity(self.states.len());
        let ranges = first.ranges.iter().zip(&second.ranges);
        for ((_, domain), (first, second)) in self.states.iter().zip(ranges) {
            let Interval { lower, upper } = domain.intersection(*first).intersection(*second);
            if lower > upper + FEASIBILITY {
                return Ok(None);
            }
            state.push(0.5 * (lower + upper));
        }
        let is_in = |region: &Region| region.contains(&state, FEASIBILITY);
        if !is_in(first)? || !is_in(second)? {
            return Ok(None);
        }
        let inputs: [[f64; 0]; 0] = [];
        let simulation = self.simulate(&state, &inputs)?;
        let mut run = simulation.to_run();
        run.modes.clear();
        for choice in &self.choices {
            let modes = choice.modes();
            let both =
                |mode: &&str| [first, second].iter().all(|own| own.allows(&choice.name, mode));
            match modes.iter().copied().find(both) {
                Some(mode) => run.modes.push((choice.name.clone(), vec![mode.to_owned()])),
                None if modes.is_empty() => {}
                None => return Ok(None),
            }
        }
        // A sample that breaks a limit is none.
        Ok(simulation.is_complete().then_some(run))
    }
}
