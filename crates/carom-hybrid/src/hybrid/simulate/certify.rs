//! The certificate of a run: every step, from the run's own samples, satisfies what is stated, and
//! the samples are where the inputs lead from the first one.

use super::condition::{Slack, tightest};
use super::memory;
use super::open_run::OpenRun;
use super::plan::PlannedRun;
use super::step::{Flown, StepStart, sample_conditions};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, RunError};
use crate::hybrid::memory::Memory;
use crate::hybrid::rows::{HybridRun, SystemVariables};
use crate::hybrid::system::{Coordinates, Discretization, HybridSystem, Measure, Transition};
use crate::solution::Solution;
use crate::tolerance::{FEASIBILITY, REPLAY, margin_scale};

/// By how much a run may miss a limit or a guard: its rows hold to `FEASIBILITY`, and its samples
/// agree to `REPLAY`.
pub(super) const MISS: f64 = FEASIBILITY + REPLAY;

/// The result of replaying a run, if the run is what the system states.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RunCertificate {
    /// Δt of the time-stepped law that the run follows, in s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub time_step: f64,
    /// The method that makes steps of nonlinear rates; `None` without such rates.
    #[cfg_attr(feature = "serde", serde(default))]
    pub discretization: Option<Discretization>,
    /// Largest difference between a sample and where the step before leads, in the states' units.
    pub largest_residual: f64,
    /// Largest violation of a condition, in its unit; 0 if none is violated.
    pub largest_violation: f64,
    /// Largest difference between a sample and the state to which the transitions and inputs lead
    /// from the first sample alone, in the states' units. It is computed in as many digits as that
    /// needs; unstable flows amplify small residuals.
    pub drift: f64,
    /// The number of events.
    pub events: usize,
    /// The steps in which a transition that was not taken satisfies its guards too.
    pub ties: Vec<usize>,
}

impl HybridSystem {
    /// Checks a run against the system as it is stated: replays each step from the run's own
    /// samples and compares domains, limits, guards, ranges, modes, dwell times, events, next
    /// states and outputs. This shares no code with the rows of programs.
    ///
    /// At a tie, a run may take any of the possible transitions.
    ///
    /// A run is one from its start: the samples must also be near those to which its transitions
    /// and inputs lead from the first sample, computed in many digits.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Run`] if the run is not what the system states: next states and outputs differ
    /// by more than [`tolerance::REPLAY`], or a condition is violated by more than that and
    /// [`tolerance::FEASIBILITY`] together; beyond a magnitude of 1000 both grow in proportion, and
    /// for domains that are not of an ordinary size (some 0.02 to 2e6) they are relative to the
    /// domain. [`RunError::Drift`] if a sample is farther from the
    /// run of the inputs than [`tolerance::REPLAY`] a step and [`tolerance::DRIFT`] of the state's
    /// domain. [`ErrorKind::UnknownName`] and [`ErrorKind::Length`] for a run of another system.
    /// The errors of [`HybridSystem::check`].
    ///
    /// [`tolerance::DRIFT`]: crate::tolerance::DRIFT
    /// [`tolerance::REPLAY`]: crate::tolerance::REPLAY
    /// [`tolerance::FEASIBILITY`]: crate::tolerance::FEASIBILITY
    pub fn certify(&self, run: &HybridRun) -> Result<RunCertificate, Error> {
        self.check()?;
        self.certify_in(&Coordinates::of(self), run)
    }

    /// The same of a checked system, with tolerances in the units of these coordinates.
    pub(crate) fn certify_in(
        &self,
        coordinates: &Coordinates,
        run: &HybridRun,
    ) -> Result<RunCertificate, Error> {
        let plan = PlannedRun::new(self, run)?;
        let mut certificate = RunCertificate {
            time_step: self.time_step,
            discretization: self.discretized_by(),
            largest_residual: 0.0,
            largest_violation: 0.0,
            drift: 0.0,
            events: 0,
            ties: Vec::new(),
        };
        let mut memory = plan.first_memory()?;
        for step in 0..plan.inputs.len() {
            let start = plan.start(coordinates, step);
            let conditions = sample_conditions(self, coordinates, step, &plan.states[step]);
            certificate.sample(step, conditions)?;
            certificate.sample(step, start.joint_limits())?;
            let taken = certificate.step(&plan, &start, &memory)?;
            for (choice, (transition, _)) in self.choices.iter().zip(&taken) {
                memory.advance(&choice.name, transition);
            }
            plan.check_modes(&memory, step + 1)?;
        }
        let last = plan.inputs.len();
        let conditions = sample_conditions(self, coordinates, last, &plan.states[last]);
        certificate.sample(last, conditions)?;
        certificate.events = memory.events;
        let open = OpenRun::of(&plan, &plan.states[0], &plan.inputs);
        certificate.drift = open.largest_drift();
        match open.worst(&plan) {
            Some(departure) => Err(plan.drifts(&plan.states[0], &plan.inputs, &departure).into()),
            None => Ok(certificate),
        }
    }
}

/// The roundings of a value and of what leads to it, as a multiple of the distance of floats.
const ROUNDINGS: f64 = 8.0;

/// The difference of two values of a state that is allowed, in the state's unit: the tolerance in
/// the unit of its domain, more for large numbers, and what the digits of the user's numbers round.
fn allowed_difference(measure: Measure, first: f64, second: f64) -> f64 {
    let scale = measure.scale * margin_scale(measure.inward(first).abs(), measure.inward(second));
    REPLAY * scale + ROUNDINGS * f64::EPSILON * first.abs().max(second.abs())
}

/// The share of the difference that is allowed between a sample and where the step before leads
/// from which on a plan is corrected (no unit): the misses of several functions add up.
const CORRECTED: f64 = 0.9;

impl PlannedRun<'_> {
    /// Whether a sample is nearly as far from where the step before leads as is allowed.
    pub(super) fn misses(&self, inputs: &[Vec<f64>]) -> bool {
        let coordinates = Coordinates::of(self.system);
        self.residuals(inputs).iter().zip(&self.states[1..]).any(|(residuals, sample)| {
            let each = residuals.iter().zip(sample).enumerate();
            each.into_iter().any(|(i, (residual, x))| {
                residual.abs() > CORRECTED * allowed_difference(coordinates.state(i), *x, *x)
            })
        })
    }
}

impl SystemVariables {
    /// Reads a solution and [certifies](HybridSystem::certify) its run: a solution whose run is not
    /// what the system states is an error.
    pub fn certified(&self, solution: &Solution) -> Result<(HybridRun, RunCertificate), Error> {
        let run = self.read(solution)?;
        let certificate = match self.coordinates().is_plain() {
            true => self.system().certify(&run)?,
            false => self.system().certify_in(self.coordinates(), &run)?,
        };
        Ok((run, certificate))
    }
}

impl RunCertificate {
    /// Notes the conditions of a sample and refuses violated ones.
    fn sample(&mut self, sample: usize, slacks: Vec<Slack>) -> Result<(), Error> {
        match self.violated(slacks) {
            Some(Slack { condition, slack, .. }) => {
                Err(RunError::Sample { sample, condition, violation: -slack }.into())
            }
            None => Ok(()),
        }
    }

    /// The most violated condition, if it is violated by more than is allowed.
    fn violated(&mut self, slacks: Vec<Slack>) -> Option<Slack> {
        let tightest = tightest(slacks)?;
        if !tightest.holds(MISS) {
            return Some(tightest);
        }
        self.largest_violation = self.largest_violation.max(-tightest.slack);
        None
    }

    /// Checks the transitions of one step and the sample to which they lead.
    fn step<'a>(
        &mut self,
        plan: &PlannedRun<'a>,
        start: &StepStart<'_>,
        memory: &Memory,
    ) -> Result<Vec<(&'a Transition, Flown)>, Error> {
        let (system, step) = (plan.system, start.step);
        let (mut taken, mut is_tie) = (Vec::new(), false);
        for (c, choice) in system.choices.iter().enumerate() {
            for (k, transition) in choice.transitions.iter().enumerate() {
                let (flown, mut slacks) = start.fly(choice, transition)?;
                slacks.extend(memory::conditions(memory, system, choice, transition));
                if k != plan.taken[c][step] {
                    is_tie |= slacks.iter().all(|slack| slack.holds(MISS));
                    continue;
                }
                if let Some(Slack { condition, slack, .. }) = self.violated(slacks) {
                    let (choice, transition) = (choice.name.clone(), transition.name.clone());
                    let violation = -slack;
                    let error =
                        RunError::Transition { step, choice, transition, condition, violation };
                    return Err(error.into());
                }
                taken.push((transition, flown));
            }
        }
        if is_tie {
            self.ties.push(step);
        }
        let flown: Vec<&Flown> = taken.iter().map(|(_, flown)| flown).collect();
        let transitions: Vec<&Transition> =
            taken.iter().map(|&(transition, _)| transition).collect();
        let next = start.next_state(&flown)?;
        self.compare(plan, start.coordinates, step + 1, &next)?;
        let events = start.together(&transitions, &plan.states[step + 1], memory.events);
        self.sample(step + 1, events)?;
        self.outputs(plan, start.coordinates, step, &taken)?;
        Ok(taken)
    }

    /// Compares a sample with the state to which the step leads.
    fn compare(
        &mut self,
        plan: &PlannedRun<'_>,
        coordinates: &Coordinates,
        sample: usize,
        next: &[f64],
    ) -> Result<(), Error> {
        let names = plan.system.states.iter().map(|(name, _)| name).enumerate();
        for ((i, name), (&own, &replayed)) in names.zip(plan.states[sample].iter().zip(next)) {
            let allowed = allowed_difference(coordinates.state(i), replayed, own);
            let residual = (own - replayed).abs();
            // NaN fails as well.
            if residual.is_nan() || residual > allowed {
                let state = name.clone();
                return Err(RunError::State { sample, state, residual, allowed }.into());
            }
            self.largest_residual = self.largest_residual.max(residual);
        }
        Ok(())
    }

    /// Compares the outputs of a step with what its transitions give.
    fn outputs(
        &mut self,
        plan: &PlannedRun<'_>,
        coordinates: &Coordinates,
        step: usize,
        taken: &[(&Transition, Flown)],
    ) -> Result<(), Error> {
        for (name, values) in plan.outputs {
            let Some(&value) = values.get(step) else { continue };
            let parts = taken.iter().flat_map(|(transition, flown)| {
                let own = transition.outputs.iter().zip(&flown.outputs);
                own.filter(|(output, _)| output.name == *name).map(|(_, value)| value)
            });
            let expected: f64 = parts.sum();
            let unit = coordinates.output(name);
            let scale = unit * margin_scale((value / unit).abs(), expected / unit);
            let (residual, allowed) = ((value - expected).abs(), MISS * scale);
            if residual.is_nan() || residual > allowed {
                let output = name.clone();
                return Err(RunError::Output { step, output, residual, allowed }.into());
            }
        }
        Ok(())
    }
}
