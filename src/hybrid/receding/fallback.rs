//! Inputs when there is no plan.

use super::step::MoveSource;
use crate::error::{Error, check_length};
use crate::hybrid::simulate::SimulationOptions;
use crate::hybrid::system::HybridSystem;
use crate::hybrid::terminal::TerminalSet;

/// By how much a fallback may violate a condition of the system, in its unit: as much as a plan may.
const TOLERANCE: f64 = 1e-6;

/// Where inputs come from when there is no plan.
#[derive(Default)]
pub(super) struct Fallback<'a> {
    pub(super) given: Option<Box<Given<'a>>>,
    pub(super) terminal: Option<TerminalSet>,
}

/// The user's input for a state.
pub(super) type Given<'a> = dyn FnMut(&[f64]) -> Vec<f64> + 'a;

impl Fallback<'_> {
    /// An input, where it comes from, and whether a simulation allows it. The rest of the last plan
    /// gets a step shorter.
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
    ) -> Result<(Vec<f64>, MoveSource, Option<bool>), Error> {
        let planned = if rest.is_empty() { None } else { Some(rest.clone()) };
        rest.drain(..usize::from(!rest.is_empty()));
        if let Some(inputs) = &planned
            && system.is_none_or(|system| is_allowed(system, state, inputs))
        {
            return Ok((inputs[0].clone(), MoveSource::LastPlan, system.map(|_| true)));
        }
        if let Some(set) = &self.terminal
            && set.region.contains(state, 0.0)?
        {
            return Ok((set.feedback(state)?, MoveSource::TerminalFeedback, Some(true)));
        }
        if let Some(given) = &mut self.given {
            let input = given(state);
            if let Some(system) = system {
                check_length("the input of the fallback", input.len(), system.inputs.len())?;
            }
            let allowed =
                system.map(|system| is_allowed(system, state, std::slice::from_ref(&input)));
            return Ok((input, MoveSource::Given, allowed));
        }
        let mut input = planned.and_then(|inputs| inputs.into_iter().next()).unwrap_or_default();
        if let Some(system) = system {
            input.resize(system.inputs.len(), 0.0);
            for (value, (_, range)) in input.iter_mut().zip(&system.inputs) {
                if let Some(range) = range.get(0) {
                    *value = value.max(range.lower).min(range.upper);
                }
            }
        }
        let allowed = system.map(|system| is_allowed(system, state, std::slice::from_ref(&input)));
        Ok((input, MoveSource::Emergency, allowed))
    }
}

/// Whether a simulation from a state comes to the end of some inputs.
fn is_allowed(system: &HybridSystem, state: &[f64], inputs: &[Vec<f64>]) -> bool {
    let options = SimulationOptions::default().with_tolerance(TOLERANCE);
    let run = system.simulate_with(state, inputs, &options);
    run.is_ok_and(|run| run.is_complete())
}
