//! One step of a hybrid system in numbers: flows, guards and resets, evaluated as they are stated.

use super::condition::{Slack, guard_condition, limit_condition};
use super::memory::events;
use crate::error::{Condition, Error};
use crate::hybrid::step::{Moment, StepCondition};
use crate::hybrid::system::{Choice, Coordinates, HybridSystem, Transition};
use crate::sum::Sum;

/// A sample of a run and the input of the step that begins there.
#[derive(Debug, Clone)]
pub(super) struct StepStart<'a> {
    pub(super) system: &'a HybridSystem,
    /// Of the system's domains, for tolerances.
    pub(super) coordinates: &'a Coordinates,
    pub(super) step: usize,
    pub(super) state: &'a [f64],
    /// With the values of the functions that do not depend on the next state.
    pub(super) input: &'a [f64],
    /// A state near the next one, where functions depend on it.
    pub(super) guess: &'a [f64],
}

/// Where a transition leads if no other choice changes anything.
#[derive(Debug, Clone)]
pub(super) struct Flown {
    /// After the reset.
    pub(super) next: Vec<f64>,
    /// The outputs, in the order of the transition.
    pub(super) outputs: Vec<f64>,
}

/// The conditions of a sample: domains, and limits on states alone.
pub(super) fn sample_conditions(
    system: &HybridSystem,
    coordinates: &Coordinates,
    step: usize,
    state: &[f64],
) -> Vec<Slack> {
    let named = system.states.iter().zip(state).enumerate();
    let domains = named.map(|(i, ((name, domain), &value))| {
        let condition = Condition::Domain { state: name.clone() };
        Slack::of_range(condition, *domain, value, coordinates.state(i))
    });
    let limits = system
        .limits_of(false)
        .filter_map(|own| Slack::of_set(limit_condition(own), own.set, coordinates, state, step));
    let nonlinear = system.state_rows.iter().map(|row| {
        let condition = Condition::Limit { name: row.name.clone() };
        Slack::counted(condition, row.slack(state))
    });
    domains.chain(limits).chain(nonlinear).collect()
}

impl StepStart<'_> {
    /// The state, then the input.
    fn joint(&self) -> Vec<f64> {
        [self.state, self.input].concat()
    }

    /// The limits on states and inputs together.
    pub(super) fn joint_limits(&self) -> Vec<Slack> {
        let point = self.joint();
        let limits = self.system.limits_of(true);
        let slack = |own: StepCondition<'_>| {
            Slack::of_set(limit_condition(own), own.set, self.coordinates, &point, self.step)
        };
        limits.filter_map(slack).collect()
    }

    /// Where a transition leads, and the conditions of its own: guards and input ranges.
    pub(super) fn fly(
        &self,
        choice: &Choice,
        transition: &Transition,
    ) -> Result<(Flown, Vec<Slack>), Error> {
        let input = self.input_under(&transition.flow)?;
        let prediction = transition.flow.step(self.state, &input)?;
        let joint = self.joint();
        let guards = transition.conditions().filter_map(|own| {
            let point = if own.moment == Moment::Start { &joint } else { &prediction };
            Slack::of_set(guard_condition(own), own.set, self.coordinates, point, self.step)
        });
        let own = self.system.inputs.iter().zip(self.input).enumerate();
        let own = own.filter(|(k, _)| !self.system.functions.is_function(*k));
        let ranges = own.filter_map(|(k, ((name, _), &value))| {
            let range = self.system.input_range(choice, transition, k, self.step)?;
            let condition = Condition::InputRange { input: name.clone() };
            let mut slack = Slack::of_range(condition, range, value, self.coordinates.input(k));
            if let Some(values) = self.system.values_of_input(k) {
                // Between two values an input is off by the distance to the nearer one.
                let off = (value - values.nearest(value)).abs();
                slack.slack = if off > 0.0 { slack.slack.min(-off) } else { slack.slack };
            }
            Some(slack)
        });
        let slacks = guards.chain(ranges).collect();
        let outputs = transition.outputs.iter().map(|output| {
            let from = if output.is_at_start { &joint } else { &prediction };
            let mut sum = Sum::new(output.constant.get(self.step).copied().unwrap_or(0.0));
            output.factors.iter().zip(from).for_each(|(&factor, &x)| sum.add_product(factor, x));
            sum.value()
        });
        let outputs = outputs.collect();
        let next = match &transition.reset {
            None => prediction,
            Some(reset) => {
                let offset = reset.offset.get(self.step).into_iter().flatten();
                let row = |(i, &offset): (usize, &f64)| {
                    let mut sum = Sum::new(offset);
                    for (j, &value) in prediction.iter().enumerate() {
                        sum.add_product(reset.matrix[(i, j)], value);
                    }
                    sum.value()
                };
                offset.enumerate().map(row).collect()
            }
        };
        Ok((Flown { next, outputs }, slacks))
    }
}

impl StepStart<'_> {
    /// The next state under one transition per choice, before any disturbance.
    pub(super) fn next_state(&self, flown: &[&Flown]) -> Result<Vec<f64>, Error> {
        let common = match (&self.system.flow, flown) {
            (_, [only]) => return Ok(only.next.clone()),
            (Some(flow), _) => flow.step(self.state, &self.input_under(flow)?)?,
            // Refused by the system's check.
            (None, _) => vec![0.0; self.state.len()],
        };
        let next = common.iter().enumerate().map(|(i, &y)| {
            let changes = flown.iter().filter_map(|flown| flown.next.get(i)).map(|x| x - y);
            y + changes.sum::<f64>()
        });
        Ok(next.collect())
    }

    /// The conditions on the transitions of a step together: the limit on events and the conditions
    /// of the next sample.
    pub(super) fn together(
        &self,
        transitions: &[&Transition],
        next: &[f64],
        events_before: usize,
    ) -> Vec<Slack> {
        let mut slacks = sample_conditions(self.system, self.coordinates, self.step + 1, next);
        let count = transitions.iter().filter(|transition| transition.is_event).count();
        if let (Some(most), true) = (self.system.most_events, count > 0) {
            slacks.push(events(most, events_before + count));
        }
        slacks
    }
}
