//! The run to which inputs and transitions lead from a start, in as many digits as it needs, and by how much
//! a plan's samples differ from it.
//!
//! A sample of a plan may miss the next state by a tolerance. The flow of an unstable system multiplies that
//! miss at every further step, so it can carry a plan to where no input leads. This is seen only from the
//! start.

use super::digits::Digits;
use super::error::RunError;
use super::plan::PlannedRun;
use crate::hybrid::affine::{self, Map};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{HybridSystem, Transition};
use crate::tolerance::allowed_drift;

/// Floats of a number at first; they suffice unless the system is very unstable.
const FEW: usize = 2;

/// Floats of a number if a few do not suffice: some 1000 bits.
const MANY: usize = 20;

/// The share of what is allowed that digits may lose (no unit).
const LOST: f64 = 1e-3;

/// A run from a start, by sample and state.
pub(super) struct OpenRun {
    pub(super) samples: Vec<Vec<Digits>>,
}

/// `A x + B u + c`.
fn fly(flow: &LinearSystem, state: &[Digits], input: &[f64], most: usize) -> Vec<Digits> {
    let row = |i: usize| {
        let mut sum = Digits::new(flow.c()[i]);
        for (j, x) in state.iter().enumerate() {
            if flow.a()[(i, j)] != 0.0 {
                sum.add_multiple(flow.a()[(i, j)], x);
            }
        }
        for (j, &u) in input.iter().enumerate() {
            if flow.b()[(i, j)] != 0.0 {
                sum.add_product(flow.b()[(i, j)], u);
            }
        }
        sum.keep(most);
        sum
    };
    (0..state.len()).map(row).collect()
}

/// Where a transition leads if no other choice changes anything.
fn follow(
    transition: &Transition,
    step: usize,
    state: &[Digits],
    input: &[f64],
    most: usize,
) -> Vec<Digits> {
    let prediction = fly(&transition.flow, state, input, most);
    let Some(reset) = &transition.reset else { return prediction };
    let offset = reset.offset.get(step);
    let row = |i: usize| {
        let offset = offset.and_then(|offset| offset.get(i)).copied();
        let mut sum = Digits::new(offset.unwrap_or(0.0));
        for (j, y) in prediction.iter().enumerate() {
            if reset.matrix[(i, j)] != 0.0 {
                sum.add_multiple(reset.matrix[(i, j)], y);
            }
        }
        sum.keep(most);
        sum
    };
    (0..state.len()).map(row).collect()
}

/// The next state under one transition per choice: each adds what it changes about the common flow.
pub(super) fn lead(
    system: &HybridSystem,
    taken: &[&Transition],
    step: usize,
    state: &[Digits],
    input: &[f64],
    most: usize,
) -> Vec<Digits> {
    let common = match (&system.flow, taken) {
        (_, [only]) => return follow(only, step, state, input, most),
        (Some(flow), _) => flow,
        // Refused by the system's check.
        (None, _) => return state.to_vec(),
    };
    let flown = fly(common, state, input, most);
    let mut next = flown.clone();
    for own in taken.iter().filter(|own| own.reset.is_some() || own.flow != *common) {
        let changed = follow(own, step, state, input, most);
        for ((next, changed), flown) in next.iter_mut().zip(&changed).zip(&flown) {
            next.add_multiple(1.0, changed);
            next.add_multiple(-1.0, flown);
        }
    }
    next.iter_mut().for_each(|value| value.keep(most));
    next
}

/// A number of a sample as it is.
pub(super) fn exact(state: &[f64]) -> Vec<Digits> {
    state.iter().map(|&value| Digits::new(value)).collect()
}

/// By how much numbers differ from a plan's, at most; NaN if that has no float.
pub(super) fn differences(state: &[Digits], plan: &[f64]) -> Vec<f64> {
    let of = |(value, &plan): (&Digits, &f64)| {
        let mut difference = value.clone();
        difference.add(-plan);
        difference.value()
    };
    state.iter().zip(plan).map(of).collect()
}

impl OpenRun {
    /// The run of a plan's transitions from a start with some inputs, in so many digits that what is lost is
    /// small beside the drift that is allowed.
    pub(super) fn of(plan: &PlannedRun<'_>, start: &[f64], inputs: &[Vec<f64>]) -> Self {
        let run = OpenRun::with_parts(plan, start, inputs, FEW);
        let suffices = |(sample, numbers): (usize, &Vec<Digits>)| {
            let allowed = plan.allowed_drifts(sample);
            numbers.iter().zip(allowed).all(|(number, allowed)| number.lost() <= LOST * allowed)
        };
        match run.samples.iter().enumerate().all(suffices) {
            true => run,
            false => OpenRun::with_parts(plan, start, inputs, MANY),
        }
    }

    fn with_parts(
        plan: &PlannedRun<'_>,
        start: &[f64],
        inputs: &[Vec<f64>],
        most: usize,
    ) -> Self {
        let mut samples = vec![exact(start)];
        for (step, input) in inputs.iter().enumerate() {
            let taken = plan.transitions(step);
            let next = lead(plan.system, &taken, step, &samples[step], input, most);
            samples.push(next);
        }
        OpenRun { samples }
    }

    /// The largest difference between a sample of the plan and the run, in the states' units. Infinite if it
    /// has left the range of floats.
    pub(super) fn largest_drift(&self, plan: &PlannedRun<'_>) -> f64 {
        let of = |(numbers, states): (&Vec<Digits>, &Vec<f64>)| self::drifts(numbers, states);
        self.samples.iter().zip(&plan.states).flat_map(of).fold(0.0, f64::max)
    }

    /// Where the plan differs from the run by more than is allowed: the sample and the state at which it does
    /// so the most beside what is allowed there, the difference, and what is allowed.
    pub(super) fn worst(&self, plan: &PlannedRun<'_>) -> Option<Departure> {
        let mut worst: Option<(f64, Departure)> = None;
        for (sample, (numbers, states)) in self.samples.iter().zip(&plan.states).enumerate() {
            let allowed = plan.allowed_drifts(sample);
            for (state, (drift, allowed)) in
                drifts(numbers, states).into_iter().zip(allowed).enumerate()
            {
                let share = drift / allowed;
                if share > 1.0 && worst.as_ref().is_none_or(|(most, _)| share > *most) {
                    worst = Some((share, Departure { sample, state, drift, allowed }));
                }
            }
        }
        worst.map(|(_, departure)| departure)
    }
}

/// The magnitudes of the differences, with what digits have lost.
fn drifts(numbers: &[Digits], states: &[f64]) -> Vec<f64> {
    let of = |(difference, number): (f64, &Digits)| {
        let drift = difference.abs() + number.lost();
        if drift.is_nan() { f64::INFINITY } else { drift }
    };
    differences(numbers, states).into_iter().zip(numbers).map(of).collect()
}

/// Where a plan leaves the run of its inputs.
pub(super) struct Departure {
    sample: usize,
    state: usize,
    drift: f64,
    allowed: f64,
}

impl PlannedRun<'_> {
    /// The transitions of a step, one per choice.
    pub(super) fn transitions(&self, step: usize) -> Vec<&Transition> {
        let choices = self.system.choices.iter().zip(&self.taken);
        choices.map(|(choice, taken)| &choice.transitions[taken[step]]).collect()
    }

    /// How much each state of a sample may differ from the run.
    pub(super) fn allowed_drifts(&self, sample: usize) -> Vec<f64> {
        let states = self.system.states.iter().zip(&self.states[sample]);
        let steps = self.inputs.len();
        states.map(|((_, domain), &x)| allowed_drift(domain.upper - domain.lower, x, steps)).collect()
    }

    /// The next state as functions of the state and the input at a step.
    pub(super) fn maps(&self, step: usize) -> Vec<Map> {
        let of = |own: &&Transition| {
            affine::behaviour(self.system, own, &[], Vec::new(), step).next
        };
        let parts: Vec<Vec<Map>> = self.transitions(step).iter().map(of).collect();
        let parts: Vec<&[Map]> = parts.iter().map(Vec::as_slice).collect();
        let common = self.system.flow.as_ref().map(affine::flow);
        affine::sum(common.as_deref(), &parts)
    }

    /// By how much each sample misses where the one before leads with an input, by step and state.
    pub(super) fn residuals(&self, inputs: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let of = |(step, input): (usize, &Vec<f64>)| {
            let state = exact(&self.states[step]);
            let next = lead(self.system, &self.transitions(step), step, &state, input, FEW);
            differences(&next, &self.states[step + 1])
        };
        inputs.iter().enumerate().map(of).collect()
    }

    /// The error that says of which miss a departure is made: the one that has grown the most.
    pub(super) fn drifts(
        &self,
        start: &[f64],
        inputs: &[Vec<f64>],
        departure: &Departure,
    ) -> RunError {
        let &Departure { sample, state, drift, allowed } = departure;
        let n = self.system.states.len();
        let residuals = self.residuals(inputs);
        let mut weights: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == state))).collect();
        let (mut step, mut violation, mut most) = (sample.saturating_sub(1), 0.0_f64, 0.0_f64);
        let mut take = |at: usize, misses: &[f64], weights: &[f64]| {
            for (miss, weight) in misses.iter().zip(weights) {
                if (miss * weight).abs() > most {
                    (step, violation, most) = (at, miss.abs(), (miss * weight).abs());
                }
            }
        };
        for t in (0..sample).rev() {
            take(t, &residuals[t], &weights);
            let maps = self.maps(t);
            let back = |j: usize| maps.iter().zip(&weights).map(|(m, w)| m.factors[j] * w).sum();
            weights = (0..n).map(back).collect();
        }
        let off: Vec<f64> = start.iter().zip(&self.states[0]).map(|(a, b)| a - b).collect();
        take(0, &off, &weights);
        let state = self.system.states[state].0.clone();
        RunError::Drift { step, violation, sample, state, drift, allowed }
    }
}
