//! A mode that is kept for ever: its affine map, and what must hold at every step.

use faer::Mat;

use super::error::TerminalError;
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Choice, Halfspace, HybridSystem, Transition};
use crate::interval::Interval;

/// A row `state . x + input . u <= limit`.
#[derive(Debug, Clone)]
pub(crate) struct Limit {
    pub(crate) name: String,
    pub(crate) state: Vec<f64>,
    pub(crate) input: Vec<f64>,
    pub(crate) limit: f64,
}

/// One transition per choice, repeated for ever from the step at which nothing depends on the step
/// any more.
#[derive(Debug, Clone)]
pub(crate) struct Stay {
    /// The map from a state and an input to the next state.
    pub(crate) map: LinearSystem,
    /// Limits and guards; neither the domains nor the ranges.
    pub(crate) limits: Vec<Limit>,
    /// Ranges of the inputs.
    pub(crate) ranges: Vec<Interval>,
    /// The modes in which the choices stay.
    pub(crate) modes: Vec<(String, String)>,
}

impl Stay {
    /// The map and the limits of the named transitions, one per choice in their order.
    pub(crate) fn new(system: &HybridSystem, transitions: &[&str]) -> Result<Self, Error> {
        system.check()?;
        check_length("the list of transitions", transitions.len(), system.choices.len())?;
        let (n, m) = (system.states.len(), system.inputs.len());
        let step = system.settles();
        let taken = system.choices.iter().zip(transitions).map(|(choice, name)| find(choice, name));
        let taken: Vec<&Transition> = taken.collect::<Result<_, _>>()?;
        for (choice, transition) in system.choices.iter().zip(&taken) {
            check_lasts(system, choice, transition)?;
        }
        let mut limits: Vec<Limit> = system
            .limits
            .iter()
            .chain(taken.iter().flat_map(|transition| &transition.guards))
            .filter_map(|h| of_halfspace(h, n, m, step))
            .collect();
        for transition in &taken {
            let flow = &transition.flow;
            let guards = transition.prediction_guards.iter();
            limits.extend(guards.filter_map(|h| of_prediction(h, flow, step)));
        }
        let ranges = (0..m).map(|input| system.input_range_of(&taken, input, step));
        let modes = system.choices.iter().zip(&taken).filter_map(|(choice, transition)| {
            let (mode, _) = transition.modes.as_ref()?;
            Some((choice.name.clone(), mode.clone()))
        });
        Ok(Stay {
            map: map(system.flow.as_ref(), &taken, step)?,
            limits,
            ranges: ranges.collect(),
            modes: modes.collect(),
        })
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
    let unknown =
        || ErrorKind::UnknownName { name: name.to_owned(), kind: "transition of the choice" };
    let found = choice.transitions.iter().find(|transition| transition.name == name);
    found.ok_or_else(|| unknown().into())
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

fn of_halfspace(halfspace: &Halfspace, n: usize, m: usize, step: usize) -> Option<Limit> {
    let limit = halfspace.limit_at(step);
    let (state, input) = halfspace.parts(n);
    let mut input = input.to_vec();
    input.resize(m, 0.0);
    limit.is_finite().then(|| Limit {
        name: halfspace.name.clone(),
        state: state.to_vec(),
        input,
        limit,
    })
}

/// A guard on the flow's result as a limit on the state and the input before the step.
fn of_prediction(halfspace: &Halfspace, flow: &LinearSystem, step: usize) -> Option<Limit> {
    let limit = halfspace.limit_at(step);
    let along = |entry: &dyn Fn(usize) -> f64| -> f64 {
        halfspace.normal.iter().enumerate().map(|(i, normal)| normal * entry(i)).sum()
    };
    let (a, b, c) = (flow.a(), flow.b(), flow.c());
    limit.is_finite().then(|| Limit {
        name: halfspace.name.clone(),
        state: (0..flow.states()).map(|j| along(&|i| a[(i, j)])).collect(),
        input: (0..flow.inputs()).map(|j| along(&|i| b[(i, j)])).collect(),
        limit: limit - along(&|i| c[i]),
    })
}

/// The next state of a step that takes these transitions.
fn map(
    flow: Option<&LinearSystem>,
    taken: &[&Transition],
    step: usize,
) -> Result<LinearSystem, Error> {
    let maps = taken.iter().map(|transition| after_reset(transition, step));
    let mut maps = maps.collect::<Result<Vec<_>, _>>()?;
    let (Some(flow), true) = (flow, maps.len() > 1) else {
        // One choice: its transition decides alone.
        return maps.pop().ok_or_else(|| Error::out_of_range("the number of choices", 0.0, "1"));
    };
    // Each choice adds what it changes about the common flow.
    let extra = maps.len() as f64 - 1.0;
    let (n, m) = (flow.states(), flow.inputs());
    let sum = |entry: &dyn Fn(&LinearSystem) -> f64| {
        maps.iter().map(entry).sum::<f64>() - extra * entry(flow)
    };
    LinearSystem::new(
        Mat::from_fn(n, n, |i, j| sum(&|s| s.a()[(i, j)])),
        Mat::from_fn(n, m, |i, j| sum(&|s| s.b()[(i, j)])),
        (0..n).map(|i| sum(&|s| s.c()[i])).collect::<Vec<f64>>(),
    )
}

fn after_reset(transition: &Transition, step: usize) -> Result<LinearSystem, Error> {
    let (flow, Some(reset)) = (&transition.flow, &transition.reset) else {
        return Ok(transition.flow.clone());
    };
    let (r, offset) = (&reset.matrix, reset.offset.get(step));
    let at = |i: usize| offset.and_then(|offset| offset.get(i)).copied().unwrap_or(0.0);
    let constant = |i: usize| (0..flow.states()).map(|k| r[(i, k)] * flow.c()[k]).sum::<f64>();
    let constant: Vec<f64> = (0..flow.states()).map(|i| constant(i) + at(i)).collect();
    LinearSystem::new(r * flow.a().faer(), r * flow.b().faer(), constant)
}
