//! Transitions as affine functions of the state and the input at the start of a step.

use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, HybridSystem, Transition};
use crate::interval::Interval;

/// An affine form `factors . z + constant` of `z = (state, input)`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AffineForm {
    pub(crate) factors: Vec<f64>,
    pub(crate) constant: f64,
}

impl AffineForm {
    pub(crate) fn constant(width: usize, constant: f64) -> Self {
        AffineForm { factors: vec![0.0; width], constant }
    }

    pub(crate) fn is_constant(&self) -> bool {
        self.factors.iter().all(|&factor| factor == 0.0)
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.constant == 0.0 && self.is_constant()
    }

    /// Adds a multiple of another map.
    pub(crate) fn add(&mut self, factor: f64, other: &AffineForm) {
        self.constant += factor * other.constant;
        self.factors.iter_mut().zip(&other.factors).for_each(|(own, its)| *own += factor * its);
    }

    pub(crate) fn minus(&self, other: &AffineForm) -> AffineForm {
        let mut difference = self.clone();
        difference.add(-1.0, other);
        difference
    }

    pub(crate) fn scaled(&self, factor: f64) -> AffineForm {
        let factors = self.factors.iter().map(|a| factor * a).collect();
        AffineForm { factors, constant: factor * self.constant }
    }

    /// All its numbers: the factors, then the constant.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.factors.iter().copied().chain([self.constant])
    }

    /// The magnitudes of all its numbers.
    pub(crate) fn magnitudes(&self) -> AffineForm {
        let factors = self.factors.iter().map(|a| a.abs()).collect();
        AffineForm { factors, constant: self.constant.abs() }
    }

    /// Its range over a box.
    pub(crate) fn over(&self, ranges: &[Interval]) -> Interval {
        let terms = self.factors.iter().zip(ranges).map(|(a, range)| *range * *a);
        terms.fold(Interval::point(self.constant), |sum, term| sum + term)
    }

    /// Its value in numbers.
    pub(crate) fn at(&self, z: &[f64]) -> f64 {
        self.factors.iter().zip(z).map(|(a, z)| a * z).sum::<f64>() + self.constant
    }
}

/// A guard `map <= 0` of a transition.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Guard {
    /// Its position: the guards at the start, then those on the prediction.
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

/// `factors . maps + constant`.
pub(crate) fn combine<'a>(
    factors: impl IntoIterator<Item = f64>,
    maps: impl IntoIterator<Item = &'a AffineForm>,
    width: usize,
    constant: f64,
) -> AffineForm {
    let mut sum = AffineForm::constant(width, constant);
    let terms = factors.into_iter().zip(maps).filter(|(factor, _)| *factor != 0.0);
    terms.for_each(|(factor, map)| sum.add(factor, map));
    sum
}

/// `normal . z - limit`, of a half-space at a step; `None` if it limits nothing there.
pub(crate) fn excess(halfspace: &Halfspace, width: usize, step: usize) -> Option<AffineForm> {
    let limit = halfspace.limit_at(step);
    let mut factors = halfspace.normal.clone();
    factors.resize(width, 0.0);
    limit.is_finite().then_some(AffineForm { factors, constant: -limit })
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
    let at_start = transition.guards.iter().map(|guard| (guard, excess(guard, width, step)));
    let at_end = transition.prediction_guards.iter().map(|guard| {
        let limit = guard.limit_at(step);
        let map = || combine(guard.normal.iter().copied(), &predicted, width, -limit);
        (guard, limit.is_finite().then(map))
    });
    let guards = at_start.chain(at_end).enumerate().filter_map(|(number, (guard, map))| {
        Some(Guard { number, map: map?, is_limit: guard.is_limit })
    });
    Dynamics {
        next,
        outputs: outputs.iter().map(output).collect(),
        guards: guards.collect(),
        inputs,
    }
}
