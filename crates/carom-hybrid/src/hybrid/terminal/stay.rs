//! A mode that is kept for ever: its affine map, and what must hold at every step.

use faer::Mat;

use crate::error::{Error, TerminalError, check_length};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::step::{self, AffineForm, ConditionMaps, Dynamics, StepCondition};
use crate::hybrid::system::{Approximation, Choice, HybridSystem, Transition};
use crate::interval::Interval;

/// One transition per choice, repeated for ever from the step at which nothing depends on the step
/// any more.
#[derive(Debug, Clone)]
pub(crate) struct Stay {
    /// The map from a state and an input to the next state.
    pub(crate) map: LinearSystem,
    /// Limits and guards, by their names: forms that are at most 0. Neither the domains nor the
    /// ranges.
    pub(crate) limits: Vec<(String, AffineForm)>,
    /// Ranges of the inputs.
    pub(crate) ranges: Vec<Interval>,
    /// The modes in which the choices stay.
    pub(crate) modes: Vec<(String, String)>,
}

impl Stay {
    /// The map and the limits of the named transitions, one per choice in their order.
    pub(crate) fn new(system: &HybridSystem, transitions: &[&str]) -> Result<Self, Error> {
        system.check()?;
        system.check_is_linear("a terminal set")?;
        // Polygons within norms, so that what keeps the former keeps the latter.
        let system = &system.polyhedral(Approximation::Inner);
        check_length("the list of transitions", transitions.len(), system.choices.len())?;
        let (n, m) = (system.states.len(), system.inputs.len());
        let step = system.settles();
        let taken = system.choices.iter().zip(transitions).map(|(choice, name)| find(choice, name));
        let taken: Vec<&Transition> = taken.collect::<Result<_, _>>()?;
        for (choice, transition) in system.choices.iter().zip(&taken) {
            check_lasts(system, choice, transition)?;
        }
        let form = |own: StepCondition<'_>, predicted: &[AffineForm]| {
            let ConditionMaps::HalfSpace(map) = own.maps(predicted, n + m, step)? else {
                return None;
            };
            Some((own.name().to_owned(), map))
        };
        let mut limits: Vec<(String, AffineForm)> = Vec::new();
        limits.extend(system.conditions().filter_map(|own| form(own, &[])));
        let dynamics = |t: &&Transition| step::dynamics(system, t, &[], Vec::new(), step);
        let dynamics: Vec<Dynamics> = taken.iter().map(dynamics).collect();
        for transition in &taken {
            let (flow, own) = (step::flow(&transition.flow), transition.conditions());
            limits.extend(own.filter_map(|own| form(own, &flow)));
        }
        let common = system.flow.as_ref().map(step::flow);
        let parts: Vec<&[AffineForm]> = dynamics.iter().map(|own| &own.next[..]).collect();
        let next = step::sum(common.as_deref(), &parts);
        let map = LinearSystem::new(
            Mat::from_fn(n, n, |i, j| next[i].factors[j]),
            Mat::from_fn(n, m, |i, j| next[i].factors[n + j]),
            next.iter().map(|next| next.constant).collect::<Vec<f64>>(),
        )?;
        let ranges = (0..m).map(|input| system.input_range_of(&taken, input, step));
        let modes = system.choices.iter().zip(&taken).filter_map(|(choice, transition)| {
            let (mode, _) = transition.modes.as_ref()?;
            Some((choice.name.clone(), mode.clone()))
        });
        Ok(Stay { map, limits, ranges: ranges.collect(), modes: modes.collect() })
    }

    /// The input nearest to `from` that holds a state as well as an input can.
    pub(crate) fn holding_input(&self, state: &[f64], from: &[f64]) -> Result<Vec<f64>, Error> {
        let moved = self.map.step(state, from)?;
        let missing = Mat::from_fn(state.len(), 1, |i, _| state[i] - moved[i]);
        let change = match self.map.b().faer().thin_svd() {
            Ok(svd) if !from.is_empty() => svd.pseudoinverse() * missing,
            _ => Mat::zeros(from.len(), 1),
        };
        Ok(from.iter().enumerate().map(|(k, u)| u + change[(k, 0)]).collect())
    }

    /// The state that moves most in a step, relative to its domain: its position, how far it moves
    /// in its unit, and relative to the domain.
    pub(crate) fn drift(
        &self,
        system: &HybridSystem,
        state: &[f64],
        input: &[f64],
    ) -> Result<(usize, f64, f64), Error> {
        let next = self.map.step(state, input)?;
        let mut worst = (0, 0.0, 0.0);
        for (i, (_, domain)) in system.states.iter().enumerate() {
            let drift = next[i] - state[i];
            let relative = drift.abs() / unit(domain);
            if relative > worst.2 || relative.is_nan() {
                worst = (i, drift, relative);
            }
        }
        Ok(worst)
    }
}

/// Half a domain's width, or 1 for a point.
pub(crate) fn unit(domain: &Interval) -> f64 {
    let half = 0.5 * domain.width();
    if half > 0.0 { half } else { 1.0 }
}

fn find<'a>(choice: &'a Choice, name: &str) -> Result<&'a Transition, Error> {
    let found = choice.transitions.iter().find(|transition| transition.name == name);
    found.ok_or_else(|| Error::unknown_name(name, "transition of the choice"))
}

/// Refuses transitions that something ends after a while.
fn check_lasts(
    system: &HybridSystem,
    choice: &Choice,
    transition: &Transition,
) -> Result<(), Error> {
    let refused = |reason: String| {
        Err(TerminalError::CannotStay { transition: transition.name.clone(), reason }.into())
    };
    if let Some((from, to)) = &transition.modes {
        if from != to {
            return refused(format!("it leads from mode `{from}` to mode `{to}`"));
        }
        if choice.dwells.iter().any(|dwell| dwell.mode == *from && dwell.most.is_some()) {
            return refused(format!("the dwell time of mode `{from}` is limited"));
        }
    }
    if transition.is_event && system.most_events.is_some() {
        return refused("it is an event, and the number of events is limited".into());
    }
    Ok(())
}
