//! Tubes around plans for the differential equations: every disturbed motion under a feedback stays
//! in them.

use super::condition::{guard_condition, limit_condition};
use super::plan::PlannedRun;
use super::track::{Freedom, StepFeedback};
use super::zonotope::Zonotope;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Condition, Error, check_length};
use crate::hybrid::rows::HybridRun;
use crate::hybrid::step::{ConditionSet, Moment, StepCondition};
use crate::hybrid::system::{HybridSystem, Transition};
use crate::interval::Interval;

/// The difference from the plan that costs as much as an input's whole range, relative to the width
/// of a state's domain (no unit).
const TUBE_CLOSENESS: f64 = 0.1;

/// A tube around a plan, for the motion by the differential equations under a feedback.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MotionTube {
    /// By sample and state, in the states' units, in the system's order: every disturbed motion
    /// differs from the plan's sample by at most this.
    pub radii: Vec<Vec<f64>>,
    /// The sample or step at which a condition of the system has the least room in the tube, with
    /// that room in the condition's unit. Below 0, some motion might break it, and the tube proves
    /// nothing from there on.
    pub tightest: Option<(usize, Condition, f64)>,
    /// By step, then by input, the factors of the states' differences from the plan.
    gains: Vec<Vec<Vec<f64>>>,
    states: Vec<Vec<f64>>,
    inputs: Vec<Vec<f64>>,
}

impl MotionTube {
    /// Whether every disturbed motion keeps all conditions of the system at its samples and steps,
    /// with the plan's transitions.
    pub fn holds(&self) -> bool {
        self.tightest.as_ref().is_none_or(|(_, _, room)| *room >= 0.0)
    }

    /// The input of a step, held over it: that of the plan, corrected by the state that is measured
    /// at its beginning. In the system's order; inputs that are values of functions are left as
    /// planned.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a step beyond the plan, [`ErrorKind::Length`] for a state of
    /// another system.
    pub fn input(&self, step: usize, state: &[f64]) -> Result<Vec<f64>, Error> {
        let (Some(gains), Some(planned)) = (self.gains.get(step), self.inputs.get(step)) else {
            let what = "the step of a tube";
            return Err(Error::out_of_range(what, step as f64, ..self.gains.len() as f64));
        };
        check_length("the state", state.len(), self.states[step].len())?;
        let corrected = planned.iter().zip(gains).map(|(u, gains)| {
            let off = state.iter().zip(&self.states[step]).map(|(x, plan)| x - plan);
            u + gains.iter().zip(off).map(|(gain, off)| gain * off).sum::<f64>()
        });
        Ok(corrected.collect())
    }
}

impl HybridSystem {
    /// A tube around a plan for the motion by the differential equations, under a feedback that
    /// corrects each input by the state at the beginning of its step: a linear-quadratic regulator
    /// along the plan, which weighs states and inputs by the widths of their ranges.
    ///
    /// # What holds
    ///
    /// If the tube [holds](MotionTube::holds), then every motion by the differential equations as
    /// they are stated, which begins within `start` of the plan, takes the plan's transitions at
    /// the samples with the inputs of [`MotionTube::input`], and is pushed at each sample by
    /// anything within the system's [disturbance](HybridSystem::disturbance) and the [uncertain
    /// parts](crate::hybrid::TransitionMut::uncertain) of its transitions, is within the radii
    /// at every sample, and keeps domains, limits, guards and ranges there. Between samples
    /// nothing is said of conditions. The error of the discretization is part of the tube. The
    /// proof is by interval arithmetic, and assumes that functions of the standard library err by
    /// less than four units in the last place.
    ///
    /// The goal of the plan is not known here: compare the last radii with it.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut car = HybridSystem::new(0.2); // s
    /// let y = car.state("y", -2.0, 2.0)?; // m
    /// let heading = car.state("heading", -1.0, 1.0)?; // rad
    /// let turn = car.input("turn", -1.0, 1.0)?; // rad/s
    /// car.mode("drive")?.rates([y.is(heading.sin()), heading.is(turn)])?;
    /// car.disturbance(y, -0.01, 0.01)?; // m
    /// let run = car.simulate(&[1.0, 0.0], &[[-0.6], [-0.6], [0.0], [0.0], [0.5], [0.5]])?;
    /// let tube = car.motion_tube(&run.to_run(), &[0.02, 0.02])?;
    /// assert!(tube.holds());
    /// assert!(tube.radii[6][0] < 0.1); // m
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `start`: by state, by how much the first state may differ from the plan's, in its unit.
    ///
    /// # Errors
    ///
    /// Those of [`enclose_motion`](HybridSystem::enclose_motion); [`ErrorKind::Length`] and
    /// [`ErrorKind::OutOfRange`] for `start`.
    pub fn motion_tube(&self, run: &HybridRun, start: &[f64]) -> Result<MotionTube, Error> {
        self.check()?;
        let plan = PlannedRun::new(self, run)?;
        let n = self.states.len();
        check_length("the ranges of the start", start.len(), n)?;
        if let Some(bad) = start.iter().find(|own| !(own.is_finite() && **own >= 0.0)) {
            return Err(Error::out_of_range("a range of the start", *bad, 0.0..f64::INFINITY));
        }
        let ranges: Vec<Vec<Interval>> =
            (0..plan.inputs.len()).map(|step| plan.input_ranges(step)).collect();
        let widths = self.states.iter().map(|(_, domain)| TUBE_CLOSENESS * domain.width());
        let widths: Vec<f64> = widths.map(|own| own.max(f64::EPSILON)).collect();
        let feedbacks =
            plan.feedbacks(&plan.inputs, &ranges, Freedom::WholeRange, &|_| widths.clone());
        let gains = feedbacks.ok_or_else(super::zonotope::lost)?;
        // Functions and inputs with one or some values are as planned.
        let is_free = |u: usize, step: usize| {
            !self.functions.is_function(u)
                && self.values_of_input(u).is_none()
                && ranges[step][u].width() > 0.0
        };
        let gain = |u: usize, step: usize, own: &StepFeedback| -> Vec<f64> {
            (0..n).map(|i| if is_free(u, step) { own.gain[(u, i)] } else { 0.0 }).collect()
        };
        let of_step = |(step, own): (usize, &StepFeedback)| {
            (0..self.inputs.len()).map(|u| gain(u, step, own)).collect()
        };
        let gains: Vec<Vec<Vec<f64>>> = gains.iter().enumerate().map(of_step).collect();
        let mut tube = MotionTube {
            radii: Vec::new(),
            tightest: None,
            gains,
            states: plan.states.clone(),
            inputs: plan.inputs.clone(),
        };
        let mut own = Zonotope::point(&plan.states[0]);
        own.spread(&start.iter().map(|r| Interval::new(-r, *r)).collect::<Vec<_>>());
        for step in 0..plan.inputs.len() {
            tube.radii.push(own.distance_from(&plan.states[step]));
            tube.note_sample(self, step, &own);
            let taken = plan.transitions(step);
            let steered = own.steered(&tube.gains[step], &plan.states[step], &plan.inputs[step]);
            tube.note_step(self, &plan, step, &steered);
            let mut moved = steered.clone();
            moved.follow(self.flow_together(&taken)?, self, &plan.inputs[step])?;
            moved.keep(n);
            tube.note_guards(self, &taken, step, &moved, Moment::Prediction);
            let unknown = unknown(&taken, step, &moved.around());
            moved.reset(&taken, step);
            moved.spread(&unknown);
            if !self.disturbance.is_empty() {
                moved.spread(&self.disturbance);
            }
            own = moved;
        }
        let last = plan.inputs.len();
        tube.radii.push(own.distance_from(&plan.states[last]));
        tube.note_sample(self, last, &own);
        Ok(tube)
    }
}

impl MotionTube {
    fn note(&mut self, at: usize, condition: Condition, room: f64) {
        let room = if room.is_nan() { f64::NEG_INFINITY } else { room };
        if self.tightest.as_ref().is_none_or(|(_, _, least)| room < *least) {
            self.tightest = Some((at, condition, room));
        }
    }

    /// Domains, limits of states, and nonlinear limits.
    fn note_sample(&mut self, system: &HybridSystem, sample: usize, own: &Zonotope) {
        let around = own.around();
        for ((name, domain), range) in system.states.iter().zip(&around) {
            let room = (range.lower - domain.lower).min(domain.upper - range.upper);
            self.note(sample, Condition::Domain { state: name.clone() }, room);
        }
        for row in &system.state_rows {
            let condition = Condition::Limit { name: row.name.clone() };
            self.note(sample, condition, row.least_slack(&around));
        }
        for limit in system.limits_of(false) {
            if let Some(room) = room(system, limit.set, own, sample) {
                self.note(sample, limit_condition(limit), room);
            }
        }
    }

    /// Ranges of inputs, limits of states and inputs, and guards of the start of a step.
    fn note_step(
        &mut self,
        system: &HybridSystem,
        plan: &PlannedRun<'_>,
        step: usize,
        own: &Zonotope,
    ) {
        let n = system.states.len();
        let around = own.around();
        for (u, range) in plan.input_ranges(step).into_iter().enumerate() {
            if system.functions.is_function(u) {
                continue;
            }
            let input = around[n + u];
            let room = (input.lower - range.lower).min(range.upper - input.upper);
            self.note(step, Condition::InputRange { input: system.inputs[u].0.clone() }, room);
        }
        for limit in system.limits_of(true) {
            if let Some(room) = room(system, limit.set, own, step) {
                self.note(step, limit_condition(limit), room);
            }
        }
        self.note_guards(system, &plan.transitions(step), step, own, Moment::Start);
    }

    fn note_guards(
        &mut self,
        system: &HybridSystem,
        taken: &[&Transition],
        step: usize,
        own: &Zonotope,
        moment: Moment,
    ) {
        let guards = taken.iter().flat_map(|own| own.conditions());
        let guards: Vec<StepCondition<'_>> = guards.filter(|own| own.moment == moment).collect();
        for guard in guards {
            if let Some(room) = room(system, guard.set, own, step) {
                self.note(step, guard_condition(guard), room);
            }
        }
    }
}

/// The parts of the next state that transitions do not know, over a box of predictions.
fn unknown(taken: &[&Transition], step: usize, predicted: &[Interval]) -> Vec<Interval> {
    let mut parts = vec![Interval::point(0.0); predicted.len()];
    for own in taken.iter().flat_map(|own| &own.uncertain) {
        let offset = own.effect.offset.get(step);
        for (i, part) in parts.iter_mut().enumerate() {
            let offset = offset.and_then(|own| own.get(i)).copied().unwrap_or(0.0);
            let terms = predicted.iter().enumerate().map(|(j, y)| *y * own.effect.matrix[(i, j)]);
            let effect = terms.fold(Interval::point(offset), |sum, own| sum + own);
            *part = *part + own.range * effect;
        }
    }
    parts
}

/// The least room that a condition has over a set; `None` if nothing is limited at the step.
fn room(system: &HybridSystem, set: ConditionSet<'_>, own: &Zonotope, step: usize) -> Option<f64> {
    let n = system.states.len();
    let around = own.around();
    match set {
        ConditionSet::HalfSpace(half) => {
            let limit = half.limit_at(step);
            if limit == f64::INFINITY {
                return None;
            }
            // Functions have the range that they have over the box.
            let mut factors = half.normal.clone();
            let mut rest = Interval::point(0.0);
            if factors.len() > n && system.is_nonlinear() {
                let ranges = system.functions.ranges(&around[..n], &around[n..]);
                for (u, range) in ranges.iter().enumerate() {
                    if system.functions.is_function(u) && factors[n + u] != 0.0 {
                        rest = rest + *range * factors[n + u];
                        factors[n + u] = 0.0;
                    }
                }
            }
            let most = Interval::point(own.largest(&factors)) + rest;
            Some((Interval::point(limit) + -most).lower)
        }
        ConditionSet::Norm(norm) => {
            let value = |part: &crate::hybrid::system::NormEntry| {
                let terms = part.factors.iter().zip(&around).filter(|(a, _)| **a != 0.0);
                let start = Interval::point(part.constant_at(step));
                terms.fold(start, |sum, (a, range)| sum + *range * *a)
            };
            let squares = norm.entries.iter().map(|part| {
                let most = Interval::point(value(part).magnitude());
                most * most
            });
            let sum = squares.fold(Interval::point(0.0), |sum, own| sum + own);
            Some((value(&norm.bound) + Interval::point(-sum.upper.sqrt().next_up())).lower)
        }
    }
}

impl Zonotope {
    /// The set with inputs behind the states: those of the plan, corrected by the states.
    fn steered(&self, gains: &[Vec<f64>], states: &[f64], inputs: &[f64]) -> Zonotope {
        let mut own = self.clone();
        let mut rounding = vec![Interval::point(0.0); states.len()];
        for (gain, u) in gains.iter().zip(inputs) {
            let off = self
                .centre
                .iter()
                .zip(states)
                .map(|(x, plan)| Interval::point(*x) + Interval::point(-plan));
            let terms = gain.iter().zip(off).map(|(gain, off)| off * *gain);
            let exact = terms.fold(Interval::point(*u), |sum, own| sum + own);
            let centre = 0.5 * exact.lower + 0.5 * exact.upper;
            let mut rest = Interval::point((exact + Interval::point(-centre)).magnitude());
            own.centre.push(centre);
            for (generator, from) in own.generators.iter_mut().zip(&self.generators) {
                let terms = gain.iter().zip(from).map(|(gain, x)| Interval::point(*gain) * *x);
                let exact = terms.fold(Interval::point(0.0), |sum, own| sum + own);
                let entry = 0.5 * exact.lower + 0.5 * exact.upper;
                rest = rest + Interval::point((exact + Interval::point(-entry)).magnitude());
                generator.push(entry);
            }
            rounding.push(rest);
        }
        own.spread(&rounding.iter().map(|r| Interval::new(-r.upper, r.upper)).collect::<Vec<_>>());
        own
    }

    /// Leaves out entries beyond the first ones.
    fn keep(&mut self, count: usize) {
        self.centre.truncate(count);
        self.generators.iter_mut().for_each(|own| own.truncate(count));
    }

    /// Adds a box.
    fn spread(&mut self, by: &[Interval]) {
        for (i, range) in by.iter().enumerate() {
            let middle = 0.5 * range.lower + 0.5 * range.upper;
            let centre = self.centre[i] + middle;
            let missed =
                (Interval::point(self.centre[i]) + *range + Interval::point(-centre)).magnitude();
            self.centre[i] = centre;
            if missed > 0.0 {
                let mut own = vec![0.0; self.centre.len()];
                own[i] = missed;
                self.generators.push(own);
            }
        }
    }

    /// By how much each entry may differ from a state.
    fn distance_from(&self, state: &[f64]) -> Vec<f64> {
        let off = self.around();
        off.iter().zip(state).map(|(own, x)| (*own + Interval::point(-x)).magnitude()).collect()
    }
}
