//! Inputs when there is no plan.

use super::step::MoveSource;
use crate::error::{Error, check_finite, check_length};
use crate::hybrid::simulate::SimulationOptions;
use crate::hybrid::system::HybridSystem;
use crate::hybrid::terminal::TerminalSet;

/// By how much a fallback may violate a condition of the system, in its unit: as much as a plan may.
pub(super) const TOLERANCE: f64 = 1e-6;

/// Where inputs come from when there is no plan.
#[derive(Default)]
pub(super) struct Fallback<'a> {
    pub(super) given: Option<Box<Given<'a>>>,
    pub(super) terminal: Option<TerminalSet>,
    /// A simulation of the user's, where there is no system.
    pub(super) check: Option<Box<Check<'a>>>,
}

/// The user's input for a state.
pub(super) type Given<'a> = dyn FnMut(&[f64]) -> Vec<f64> + 'a;

/// Whether inputs, an entry per step, are admissible from a state on.
pub(super) type Check<'a> = dyn FnMut(&[f64], &[Vec<f64>]) -> bool + 'a;

/// An input, where it comes from, and whether a simulation allows it.
pub(super) type Answer = (Vec<f64>, MoveSource, Option<bool>);

impl Fallback<'_> {
    /// The first input that a simulation allows: of the rest of the last plan, the terminal feedback, the
    /// given input, and the next input of the last plan alone. If it allows none, the given input, or
    /// the last. The rest of the last plan gets a step shorter.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::ErrorKind::Length) and
    /// [`ErrorKind::NotFinite`](crate::ErrorKind::NotFinite) for the input that the user gives.
    pub(super) fn input(
        &mut self,
        system: Option<&HybridSystem>,
        state: &[f64],
        rest: &mut Vec<Vec<f64>>,
    ) -> Result<Answer, Error> {
        let planned = rest.clone();
        rest.drain(..usize::from(!rest.is_empty()));
        if let Some(first) = planned.first() {
            let allowed = self.allows(system, state, &planned);
            if allowed != Some(false) {
                return Ok((first.clone(), MoveSource::LastPlan, allowed));
            }
        }
        if let Some(set) = &self.terminal
            && set.region.contains(state, 0.0)?
        {
            return Ok((set.feedback(state)?, MoveSource::TerminalFeedback, Some(true)));
        }
        let given = match self.given(system, state)? {
            Some(given) if given.2 != Some(false) => return Ok(given),
            given => given,
        };
        let mut input = planned.into_iter().next().unwrap_or_default();
        if let Some(system) = system {
            input.resize(system.inputs.len(), 0.0);
            for (value, (_, range)) in input.iter_mut().zip(&system.inputs) {
                if let Some(range) = range.get(0) {
                    *value = value.max(range.lower).min(range.upper);
                }
            }
        }
        // Without a system, nobody knows how many inputs there are.
        let allowed = match system {
            None if input.is_empty() => None,
            _ => self.allows(system, state, std::slice::from_ref(&input)),
        };
        Ok(match given {
            Some(given) if allowed != Some(true) => given,
            _ => (input, MoveSource::Emergency, allowed),
        })
    }

    /// The user's input, if there is one.
    fn given(
        &mut self,
        system: Option<&HybridSystem>,
        state: &[f64],
    ) -> Result<Option<Answer>, Error> {
        let Some(given) = &mut self.given else { return Ok(None) };
        let input = given(state);
        if let Some(system) = system {
            check_length("the input of the fallback", input.len(), system.inputs.len())?;
        }
        check_finite("the input of the fallback", "an entry", input.iter().copied())?;
        let allowed = self.allows(system, state, std::slice::from_ref(&input));
        Ok(Some((input, MoveSource::Given, allowed)))
    }

    /// Whether a simulation from a state comes to the end of some inputs; `None` without one.
    fn allows(
        &mut self,
        system: Option<&HybridSystem>,
        state: &[f64],
        inputs: &[Vec<f64>],
    ) -> Option<bool> {
        if let Some(check) = &mut self.check {
            return Some(check(state, inputs));
        }
        let options = SimulationOptions::default().with_tolerance(TOLERANCE);
        let run = system?.simulate_with(state, inputs, &options);
        Some(run.is_ok_and(|run| run.is_complete()))
    }
}
