//! Transitions at one step, as affine functions of the state and the input at its start.

use super::affine_form::{AffineForm, combine};
use super::condition::{ConditionMaps, StepCondition};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{HybridSystem, Transition};
use crate::interval::Interval;

/// A half-space `map <= 0` among the conditions of a transition.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Guard {
    /// Its number among the [conditions](Transition::conditions) of the transition.
    pub(crate) number: usize,
    pub(crate) map: AffineForm,
    pub(crate) is_limit: bool,
}

/// The affine dynamics of a transition at one step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dynamics {
    /// The next state.
    pub(crate) next: Vec<AffineForm>,
    /// The outputs, by the choice's list of names.
    pub(crate) outputs: Vec<AffineForm>,
    /// The guards that say something at this step.
    pub(crate) guards: Vec<Guard>,
    /// The ranges of the inputs; the transition may set its own.
    pub(crate) inputs: Vec<Interval>,
}

/// The names of a choice's outputs, in the order in which its transitions name them.
pub(crate) fn output_names(transitions: &[Transition]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for output in transitions.iter().flat_map(|transition| &transition.outputs) {
        if !names.contains(&output.name.as_str()) {
            names.push(&output.name);
        }
    }
    names
}

/// The rows of a flow.
pub(crate) fn flow(system: &LinearSystem) -> Vec<AffineForm> {
    let (n, m) = (system.states(), system.inputs());
    let row = |i: usize| {
        let from_states = (0..n).map(|j| system.a()[(i, j)]);
        let factors = from_states.chain((0..m).map(|j| system.b()[(i, j)])).collect();
        AffineForm { factors, constant: system.c()[i] }
    };
    (0..n).map(row).collect()
}

/// The next state, where each of several choices adds what it changes about the common flow.
pub(crate) fn sum(common: Option<&[AffineForm]>, parts: &[&[AffineForm]]) -> Vec<AffineForm> {
    let Some((first, others)) = parts.split_first() else { return Vec::new() };
    let mut next = first.to_vec();
    for (i, next) in next.iter_mut().enumerate() {
        for part in others {
            next.add(1.0, &part[i]);
            if let Some(common) = common {
                next.add(-1.0, &common[i]);
            }
        }
    }
    next
}

/// The dynamics of a transition of a checked system at a step, with the ranges of the inputs in it.
pub(crate) fn dynamics(
    system: &HybridSystem,
    transition: &Transition,
    outputs: &[&str],
    inputs: Vec<Interval>,
    step: usize,
) -> Dynamics {
    let (n, m) = (system.states.len(), system.inputs.len());
    let width = n + m;
    let predicted = flow(&transition.flow);
    let next = match &transition.reset {
        None => predicted.clone(),
        Some(reset) => {
            let row = |i: usize| {
                let offset = reset.offset.get(step).and_then(|offset| offset.get(i));
                let factors = (0..n).map(|j| reset.matrix[(i, j)]);
                combine(factors, &predicted, width, offset.copied().unwrap_or(0.0))
            };
            (0..n).map(row).collect()
        }
    };
    let output = |name: &&str| {
        let own = transition.outputs.iter().find(|output| output.name == **name);
        own.map_or(AffineForm::constant(width, 0.0), |output| {
            let constant = output.constant.get(step).copied().unwrap_or(0.0);
            if output.is_at_start {
                let mut factors = output.factors.clone();
                factors.resize(width, 0.0);
                return AffineForm { factors, constant };
            }
            combine(output.factors.iter().copied(), &predicted, width, constant)
        })
    };
    let guard = |condition: StepCondition| match condition.maps(&predicted, width, step)? {
        ConditionMaps::HalfSpace(map) => {
            Some(Guard { number: condition.number, map, is_limit: condition.is_limit() })
        }
        ConditionMaps::Norm { .. } => None,
    };
    let guards = transition.conditions().filter_map(guard);
    Dynamics {
        next,
        outputs: outputs.iter().map(output).collect(),
        guards: guards.collect(),
        inputs,
    }
}
