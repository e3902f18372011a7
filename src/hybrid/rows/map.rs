//! Transitions as affine functions of the state and the input at the start of a step.

use std::ops::Range;

use faer::Mat;

use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, HybridSystem, Transition};
use crate::interval::Interval;

/// An affine function of `z = (state, input)`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map {
    pub(super) factors: Vec<f64>,
    pub(super) constant: f64,
}

impl Map {
    pub(super) fn constant(width: usize, constant: f64) -> Self {
        Map { factors: vec![0.0; width], constant }
    }

    pub(super) fn is_constant(&self) -> bool {
        self.factors.iter().all(|&factor| factor == 0.0)
    }

    pub(super) fn is_zero(&self) -> bool {
        self.constant == 0.0 && self.is_constant()
    }

    /// Adds a multiple of another map.
    pub(super) fn add(&mut self, factor: f64, other: &Map) {
        self.constant += factor * other.constant;
        self.factors.iter_mut().zip(&other.factors).for_each(|(own, its)| *own += factor * its);
    }

    pub(super) fn minus(&self, other: &Map) -> Map {
        let mut difference = self.clone();
        difference.add(-1.0, other);
        difference
    }

    pub(super) fn scaled(&self, factor: f64) -> Map {
        let factors = self.factors.iter().map(|a| factor * a).collect();
        Map { factors, constant: factor * self.constant }
    }

    /// All its numbers: the factors, then the constant.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.factors.iter().copied().chain([self.constant])
    }

    /// Its value in numbers.
    pub(super) fn at(&self, z: &[f64]) -> f64 {
        self.factors.iter().zip(z).map(|(a, z)| a * z).sum::<f64>() + self.constant
    }
}

/// A guard `map <= 0` of a transition.
#[derive(Debug, Clone)]
pub(super) struct Guard {
    /// Its position: the guards at the start, then those on the prediction.
    pub(super) number: usize,
    pub(super) map: Map,
    pub(super) is_limit: bool,
}

/// A transition at one step.
#[derive(Debug, Clone)]
pub(super) struct Behaviour {
    /// The next state.
    pub(super) next: Vec<Map>,
    /// The outputs, by the choice's list of names.
    pub(super) outputs: Vec<Map>,
    /// The guards that say something at this step.
    pub(super) guards: Vec<Guard>,
    /// The ranges of the inputs; the transition may set its own.
    pub(super) inputs: Vec<Interval>,
}

/// The names of a choice's outputs, in the order in which its transitions name them.
pub(super) fn output_names(transitions: &[Transition]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for output in transitions.iter().flat_map(|transition| &transition.outputs) {
        if !names.contains(&output.name.as_str()) {
            names.push(&output.name);
        }
    }
    names
}

/// The rows of a flow.
pub(super) fn flow(system: &LinearSystem) -> Vec<Map> {
    let (n, m) = (system.states(), system.inputs());
    let entry = |matrix: &Mat<f64>, i: usize, range: Range<usize>| -> Vec<f64> {
        range.map(|j| matrix[(i, j)]).collect()
    };
    let row = |i: usize| Map {
        factors: [entry(system.a().faer(), i, 0..n), entry(system.b().faer(), i, 0..m)].concat(),
        constant: system.c()[i],
    };
    (0..n).map(row).collect()
}

/// `factors . maps + constant`.
pub(super) fn combine<'a>(
    factors: impl IntoIterator<Item = f64>,
    maps: impl IntoIterator<Item = &'a Map>,
    width: usize,
    constant: f64,
) -> Map {
    let mut sum = Map::constant(width, constant);
    let terms = factors.into_iter().zip(maps).filter(|(factor, _)| *factor != 0.0);
    terms.for_each(|(factor, map)| sum.add(factor, map));
    sum
}

/// `normal . z - limit`, of a half-space at a step; `None` if it limits nothing there.
pub(super) fn excess(halfspace: &Halfspace, width: usize, step: usize) -> Option<Map> {
    let limit = halfspace.limit_at(step);
    let mut factors = halfspace.normal.clone();
    factors.resize(width, 0.0);
    limit.is_finite().then_some(Map { factors, constant: -limit })
}

/// A transition of a checked system at a step, with the ranges of the inputs in it.
pub(super) fn behaviour(
    system: &HybridSystem,
    transition: &Transition,
    outputs: &[&str],
    inputs: Vec<Interval>,
    step: usize,
) -> Behaviour {
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
        own.map_or(Map::constant(width, 0.0), |output| {
            let constant = output.constant.get(step).copied().unwrap_or(0.0);
            if output.is_at_start {
                let mut factors = output.factors.clone();
                factors.resize(width, 0.0);
                return Map { factors, constant };
            }
            combine(output.factors.iter().copied(), &predicted, width, constant)
        })
    };
    let at_start = transition.guards.iter().map(|guard| (guard, excess(guard, width, step)));
    let at_end = transition.prediction_guards.iter().map(|guard| {
        let limit = guard.limit_at(step);
        let map = || combine(guard.normal.iter().copied(), &predicted, width, -limit);
        (guard, limit.is_finite().then(map))
    });
    let guards = at_start.chain(at_end).enumerate().filter_map(|(number, (guard, map))| {
        Some(Guard { number, map: map?, is_limit: guard.is_limit })
    });
    Behaviour {
        next,
        outputs: outputs.iter().map(output).collect(),
        guards: guards.collect(),
        inputs,
    }
}
