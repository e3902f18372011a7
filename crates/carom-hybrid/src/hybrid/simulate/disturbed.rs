//! Runs of a plan in a disturbed world, with a feedback that corrects its inputs.

use super::certify::MISS;
use super::condition::{Slack, tightest};
use super::memory;
use super::options::SimulationOptions;
use super::plan::PlannedRun;
use super::step::{Flown, StepStart, sample_conditions};
use super::stepper::Stepper;
use crate::error::{Error, ErrorKind};
use crate::hybrid::matrix::Matrix;
use crate::hybrid::memory::Memory;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{Coordinates, HybridSystem, Reset, Transition};
use crate::interval::Interval;

/// A run of a plan in a disturbed world.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DisturbedRun {
    /// States, inputs and transitions of the run, up to where it ends: a run that no transition
    /// continues has fewer samples than the plan.
    pub run: HybridRun,
    /// Whether it took the transitions of the plan in every step, to the tolerances of
    /// certificates.
    pub kept: bool,
    /// The first step in which it took another transition or ended.
    pub deviation: Option<usize>,
    /// The largest violation of a condition of the steps that were kept, in its unit.
    pub largest_violation: f64,
}

impl HybridSystem {
    /// The system with a value for every uncertain parameter.
    fn drawn(&self, draw: &mut dyn FnMut(Interval) -> f64) -> HybridSystem {
        let mut drawn = self.clone();
        let n = self.states.len();
        let choices = drawn.choices.iter_mut();
        for own in choices.flat_map(|choice| &mut choice.transitions) {
            for parameter in std::mem::take(&mut own.uncertain) {
                let value = draw(parameter.range);
                let identity =
                    || Reset { matrix: faer::Mat::identity(n, n), offset: vec![0.0; n].into() };
                let reset = own.reset.get_or_insert_with(identity);
                let Reset { matrix, offset } = &parameter.effect;
                reset.matrix = &reset.matrix + matrix * faer::Scale(value);
                let last = reset.offset.settles().max(offset.settles());
                let at = |step: usize| -> Vec<f64> {
                    let both = reset.offset.get(step).into_iter().flatten();
                    let both = both.zip(offset.get(step).into_iter().flatten());
                    both.map(|(own, by)| own + value * by).collect()
                };
                reset.offset = (0..=last).map(at).collect::<Vec<_>>().into();
            }
        }
        drawn
    }

    /// Flies a planned run in a disturbed world: the inputs are those of the plan, corrected by the
    /// feedback with a gain, and `draw` says what happens within each range, in every step for each
    /// uncertain parameter and each disturbance of the system.
    ///
    /// A plan of a [robust program](crate::hybrid::HybridProgram::robust) keeps its transitions and
    /// conditions under every draw; another one may not. Where the planned transition is not
    /// possible, the run takes one that is.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", 0.0, 9.0)?; // m
    /// let u = cart.input("u", -1.0, 1.0)?; // m
    /// cart.disturbance(x, -0.1, 0.1)?;
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// let mut program = cart.program(4)?;
    /// program.start([x.equals(0.0)])?;
    /// program.goal([x.equals(3.0)])?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!(plan.to_string().starts_with("# nominal"));
    /// // Pushed by 0.1 m in each step, without and with a feedback.
    /// let open = cart.fly(&plan.run, [[0.0]], &mut |range| range.upper)?;
    /// let closed = cart.fly(&plan.run, [[-1.0]], &mut |range| range.upper)?;
    /// assert!((open.run.state("x")?[4] - 3.4).abs() < 1e-6);
    /// assert!((closed.run.state("x")?[4] - 3.1).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `gain`: K of the feedback `u = v + K (x - z)`, a row for each input and a column for each
    ///   state.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] for a gain of another size; [`ErrorKind::UnknownName`] and
    /// [`ErrorKind::Length`] for a run of another system.
    pub fn fly(
        &self,
        plan: &HybridRun,
        gain: impl Into<Matrix>,
        draw: &mut dyn FnMut(Interval) -> f64,
    ) -> Result<DisturbedRun, Error> {
        self.fly_from(&[], plan, &gain.into(), draw)
    }

    /// Flies a run as [`fly`](HybridSystem::fly), from a start that is off by some numbers.
    pub(crate) fn fly_from(
        &self,
        off: &[f64],
        plan: &HybridRun,
        gain: &Matrix,
        draw: &mut dyn FnMut(Interval) -> f64,
    ) -> Result<DisturbedRun, Error> {
        let (n, m) = (self.states.len(), self.inputs.len());
        if (gain.nrows(), gain.ncols()) != (m, n) {
            return Err(ErrorKind::Shape {
                what: "the gain of a feedback",
                rows: gain.nrows(),
                columns: gain.ncols(),
                expected: format!("{m}x{n}"),
            }
            .into());
        }
        let planned = PlannedRun::new(self, plan)?;
        let mut memory = planned.first_memory()?;
        let mut disturbed = DisturbedRun {
            run: HybridRun {
                time_step: self.time_step,
                states: self.states.iter().map(|(name, _)| (name.clone(), vec![])).collect(),
                inputs: self.inputs.iter().map(|(name, _)| (name.clone(), vec![])).collect(),
                transitions: self.choices.iter().map(|own| (own.name.clone(), vec![])).collect(),
                ..HybridRun::default()
            },
            kept: true,
            deviation: None,
            largest_violation: 0.0,
        };
        let coordinates = &Coordinates::of(self);
        let options = SimulationOptions::default().with_tolerance(MISS).with_first_possible(true);
        let mut state = planned.states[0].clone();
        state.iter_mut().zip(off).for_each(|(x, by)| *x += by);
        let is_uncertain = self.transitions().any(|own| !own.uncertain.is_empty());
        disturbed.note(&state);
        for step in 0..planned.inputs.len() {
            let off: Vec<f64> =
                state.iter().zip(&planned.states[step]).map(|(x, z)| x - z).collect();
            let fed = |u: usize| -> f64 { (0..n).map(|i| gain[(u, i)] * off[i]).sum() };
            let input: Vec<f64> =
                planned.inputs[step].iter().enumerate().map(|(u, v)| v + fed(u)).collect();
            let input = self.with_function_values(&state, &state, &input);
            let drawn = is_uncertain.then(|| self.drawn(draw));
            let by: Vec<f64> = self.disturbance.iter().map(|range| draw(*range)).collect();
            let system = drawn.as_ref().unwrap_or(self);
            let (own, guess) = (&state[..], &state[..]);
            let start = StepStart { system, coordinates, step, state: own, input: &input, guess };
            let transition = |c: usize, k: usize| system.choices[c].transitions.get(k);
            let of_plan = planned.taken.iter().map(|own| own[step]).collect::<Vec<usize>>();
            let (next, slacks) = disturbed.planned(&start, &of_plan, &by, &memory)?;
            let tight = tightest(slacks);
            let mut picked = of_plan;
            let next = match tight.filter(|slack| !slack.holds(MISS)) {
                None => next,
                Some(_) => {
                    disturbed.kept = false;
                    disturbed.deviation.get_or_insert(step);
                    let stepper =
                        Stepper { start, memory: &memory, options: &options, disturbance: &by };
                    let Ok(taken) = stepper.take(&[])? else { return Ok(disturbed) };
                    picked = taken.picked;
                    taken.next
                }
            };
            for (c, k) in picked.iter().enumerate() {
                let Some(own) = transition(c, *k) else { continue };
                memory.advance(&self.choices[c].name, own);
                disturbed.run.transitions[c].1.push(own.name.clone());
            }
            let inputs = disturbed.run.inputs.iter_mut().zip(&input);
            inputs.for_each(|((_, values), value)| values.push(*value));
            state = next;
            disturbed.note(&state);
        }
        Ok(disturbed)
    }
}

impl DisturbedRun {
    fn note(&mut self, state: &[f64]) {
        let states = self.run.states.iter_mut().zip(state);
        states.for_each(|((_, values), value)| values.push(*value));
    }

    /// Where the planned transitions lead, and all their conditions.
    fn planned(
        &mut self,
        start: &StepStart<'_>,
        taken: &[usize],
        by: &[f64],
        memory: &Memory,
    ) -> Result<(Vec<f64>, Vec<Slack>), Error> {
        let system = start.system;
        let mut slacks = start.joint_limits();
        let (mut members, mut flown): (Vec<&Transition>, Vec<Flown>) = (Vec::new(), Vec::new());
        for (choice, k) in system.choices.iter().zip(taken) {
            let own = &choice.transitions[*k];
            let (to, conditions) = start.fly(choice, own)?;
            slacks.extend(conditions);
            slacks.extend(memory::conditions(memory, system, choice, own));
            members.push(own);
            flown.push(to);
        }
        let mut next = start.next_state(&flown.iter().collect::<Vec<_>>())?;
        next.iter_mut().zip(by).for_each(|(x, w)| *x += w);
        slacks.extend(start.together(&members, &next, memory.events));
        if start.step == 0 {
            slacks.extend(sample_conditions(system, start.coordinates, 0, start.state));
        }
        let violations = slacks.iter().map(|slack| -slack.slack);
        let most = violations.fold(0.0_f64, f64::max);
        if slacks.iter().all(|slack| slack.holds(MISS)) {
            self.largest_violation = self.largest_violation.max(most);
        }
        Ok((next, slacks))
    }
}
