//! The run to which inputs and transitions lead from a start, in as many digits as it needs, and by
//! how much a plan's samples differ from it.
//!
//! A sample of a plan may miss the next state by a tolerance. The flow of an unstable system
//! multiplies that miss at every further step, so it can carry a plan to where no input leads. This
//! is seen only from the start.

use super::digits::{Digits, RoundedFloat, RunNumber};
use super::plan::PlannedRun;
use super::step::{Flown, StepStart};
use crate::error::{Error, RunError};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::step::{self, AffineForm};
use crate::hybrid::system::{Coordinates, HybridSystem, Measure, Transition};
use crate::interval::Interval;
use crate::tolerance::allowed_drift;

/// Floats of a number where rounding is too much; they suffice unless the system is very unstable.
const FEW_PARTS: usize = 2;

/// Floats of a number if a few do not suffice: some 1000 bits.
pub(super) const MANY_PARTS: usize = 20;

/// The relative step of a difference quotient (no unit).
const MAP_DIFFERENCE: f64 = 1e-6;

/// The share of what is allowed that digits may lose (no unit).
const LOST: f64 = 1e-3;

/// A run from a start beside a plan.
pub(super) struct OpenRun {
    /// By how much the run differs from the plan, by sample and state; NaN if that has no float.
    differences: Vec<Vec<f64>>,
    /// The most that the digits have lost.
    lost: Vec<Vec<f64>>,
}

/// `A x + B u + c`.
fn fly<N: RunNumber>(flow: &LinearSystem, state: &[N], input: &[f64], most: usize) -> Vec<N> {
    let row = |i: usize| {
        let mut sum = N::new(flow.c()[i]);
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
fn follow<N: RunNumber>(
    transition: &Transition,
    step: usize,
    state: &[N],
    input: &[f64],
    most: usize,
) -> Vec<N> {
    let prediction = fly(&transition.flow, state, input, most);
    let Some(reset) = &transition.reset else { return prediction };
    let offset = reset.offset.get(step);
    let row = |i: usize| {
        let offset = offset.and_then(|offset| offset.get(i)).copied();
        let mut sum = N::new(offset.unwrap_or(0.0));
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
pub(super) fn lead<N: RunNumber>(
    system: &HybridSystem,
    taken: &[&Transition],
    step: usize,
    state: &[N],
    input: &[f64],
    most: usize,
) -> Vec<N> {
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

/// The numbers of a sample as they are.
pub(super) fn exact<N: RunNumber>(state: &[f64]) -> Vec<N> {
    state.iter().map(|&value| N::new(value)).collect()
}

/// By how much numbers differ from a plan's; NaN if that has no float.
pub(super) fn differences<N: RunNumber>(state: &[N], plan: &[f64]) -> Vec<f64> {
    state.iter().zip(plan).map(|(number, &plan)| number.minus(plan)).collect()
}

impl OpenRun {
    /// The run of a plan's transitions from a start with some inputs, in so many digits that what
    /// is lost is small beside the drift that is allowed.
    pub(super) fn of(plan: &PlannedRun<'_>, start: &[f64], inputs: &[Vec<f64>]) -> Self {
        if plan.system.is_nonlinear() {
            let states = plan.flown(start, inputs);
            let difference = |(own, planned): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                own.iter().zip(planned).map(|(own, planned)| own - planned).collect()
            };
            let differences = states.iter().zip(&plan.states).map(difference).collect();
            let lost = plan.states.iter().map(|sample| vec![0.0; sample.len()]).collect();
            return OpenRun { differences, lost };
        }
        let suffices = |run: &OpenRun| {
            run.lost.iter().enumerate().all(|(sample, lost)| {
                let allowed = plan.allowed_drifts(sample);
                lost.iter().zip(allowed).all(|(lost, allowed)| *lost <= LOST * allowed)
            })
        };
        let rough = OpenRun::with_parts::<RoundedFloat>(plan, start, inputs, 1);
        if suffices(&rough) {
            return rough;
        }
        let few = OpenRun::with_parts::<Digits>(plan, start, inputs, FEW_PARTS);
        match suffices(&few) {
            true => few,
            false => OpenRun::with_parts::<Digits>(plan, start, inputs, MANY_PARTS),
        }
    }

    fn with_parts<N: RunNumber>(
        plan: &PlannedRun<'_>,
        start: &[f64],
        inputs: &[Vec<f64>],
        most: usize,
    ) -> Self {
        let mut run = OpenRun { differences: Vec::new(), lost: Vec::new() };
        let mut state: Vec<N> = exact(start);
        for (step, planned) in plan.states.iter().enumerate() {
            run.differences.push(differences(&state, planned));
            run.lost.push(state.iter().map(N::lost).collect());
            if let Some(input) = inputs.get(step) {
                state = lead(plan.system, &plan.transitions(step), step, &state, input, most);
            }
        }
        run
    }

    /// The largest difference between a sample of the plan and the run, in the states' units.
    /// Infinite if it has left the range of floats.
    pub(super) fn largest_drift(&self) -> f64 {
        self.differences
            .iter()
            .flatten()
            .map(|difference| magnitude(*difference))
            .fold(0.0, f64::max)
    }

    /// Where the plan differs from the run by more than is allowed: the sample and the state at
    /// which it does so the most beside what is allowed there, the difference, and what is allowed.
    pub(super) fn worst(&self, plan: &PlannedRun<'_>) -> Option<Departure> {
        let mut worst: Option<(f64, Departure)> = None;
        for (sample, (differences, lost)) in self.differences.iter().zip(&self.lost).enumerate() {
            let allowed = plan.allowed_drifts(sample);
            let each = differences.iter().zip(lost).zip(allowed).enumerate();
            for (state, ((difference, lost), allowed)) in each {
                let drift = magnitude(*difference + lost.copysign(*difference));
                let share = drift / allowed;
                if share > 1.0 && worst.as_ref().is_none_or(|(most, _)| share > *most) {
                    worst = Some((share, Departure { sample, state, drift, allowed }));
                }
            }
        }
        worst.map(|(_, departure)| departure)
    }
}

/// The magnitude of a difference; infinite if it has no float.
fn magnitude(difference: f64) -> f64 {
    if difference.is_nan() { f64::INFINITY } else { difference.abs() }
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
        let allowed = |((_, domain), &x): (&(String, Interval), &f64)| {
            let measure = Measure::of(*domain);
            let width = (domain.upper - domain.lower) / measure.scale;
            measure.scale * allowed_drift(width, measure.inward(x), steps)
        };
        states.map(allowed).collect()
    }

    /// The states to which transitions and inputs lead from a start, in floats, for a system with
    /// functions, which have a value in floats only; NaN from where it has none.
    pub(super) fn flown(&self, start: &[f64], inputs: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut states = vec![start.to_vec()];
        for (step, input) in inputs.iter().enumerate() {
            states.push(self.led(step, &states[step], input));
        }
        states
    }

    /// The state to which a step leads from a state with an input, in floats.
    pub(super) fn led(&self, step: usize, state: &[f64], input: &[f64]) -> Vec<f64> {
        let input = &self.system.with_function_values(state, state, input);
        let (system, guess) = (self.system, &self.states[step + 1]);
        let coordinates = &Coordinates::default();
        let start = StepStart { system, coordinates, step, state, input, guess };
        let taken = self.system.choices.iter().zip(self.transitions(step));
        let flown = taken.map(|(choice, own)| start.fly(choice, own).map(|(flown, _)| flown));
        let next = flown
            .collect::<Result<Vec<Flown>, Error>>()
            .and_then(|flown| start.next_state(&flown.iter().collect::<Vec<&Flown>>()));
        // Lengths that do not fit were refused.
        next.unwrap_or_else(|_| vec![f64::NAN; state.len()])
    }

    /// The next state near a step of the plan as affine functions of the state and the input, by
    /// differences.
    fn maps_near(&self, step: usize) -> Vec<AffineForm> {
        let (state, input) = (&self.states[step], &self.inputs[step]);
        let (n, m) = (state.len(), input.len());
        let mut point = [&state[..], input].concat();
        let middle = self.led(step, state, input);
        let mut maps = vec![AffineForm::constant(n + m, 0.0); n];
        for k in 0..n + m {
            let (own, by) = (point[k], MAP_DIFFERENCE * point[k].abs().max(1.0));
            point[k] = own + by;
            let moved = self.led(step, &point[..n], &point[n..]);
            point[k] = own;
            for (map, (to, from)) in maps.iter_mut().zip(moved.iter().zip(&middle)) {
                map.factors[k] = (to - from) / by;
            }
        }
        for (map, to) in maps.iter_mut().zip(&middle) {
            map.constant = to - map.at(&point);
        }
        maps
    }

    /// The next state as functions of the state and the input at a step.
    pub(super) fn maps(&self, step: usize) -> Vec<AffineForm> {
        if self.system.is_nonlinear() {
            return self.maps_near(step);
        }
        let of = |own: &&Transition| step::dynamics(self.system, own, &[], Vec::new(), step).next;
        let parts: Vec<Vec<AffineForm>> = self.transitions(step).iter().map(of).collect();
        let parts: Vec<&[AffineForm]> = parts.iter().map(Vec::as_slice).collect();
        let common = self.system.flow.as_ref().map(step::flow);
        step::sum(common.as_deref(), &parts)
    }

    /// By how much each sample misses where the one before leads with an input, by step and state.
    pub(super) fn residuals(&self, inputs: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let of = |(step, input): (usize, &Vec<f64>)| {
            let state: Vec<Digits> = exact(&self.states[step]);
            let next = lead(self.system, &self.transitions(step), step, &state, input, FEW_PARTS);
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
