//! The motion between samples: the differential equations themselves, integrated with steps whose
//! error is estimated.

use super::plan::PlannedRun;
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{HybridSystem, Transition};

/// The error that a step of the integration may have, relative to values of at least 1 (no unit).
const STEP_ERROR: f64 = 1e-11;

/// The most steps of the integration within a step of the system.
const MOST_INTEGRATION_STEPS: usize = 20_000;

/// The motion of a run's inputs and transitions by the differential equations of its system, beside
/// the run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ContinuousMotion {
    /// The states at the samples, by sample and state, in their units; in the system's order.
    pub samples: Vec<Vec<f64>>,
    /// By sample and state: the motion is proved to differ from the sample by at most this. Empty
    /// if the motion is simulated only.
    pub radii: Vec<Vec<f64>>,
    /// The motion at the instants of the integration, or at the samples of an enclosure: s since
    /// the start, and the states. A reset has two entries of one time.
    pub path: Vec<(f64, Vec<f64>)>,
    /// For each state, the largest difference between a sample of the run and the motion, in its
    /// unit; proved if there are radii.
    pub errors: Vec<f64>,
}

impl HybridSystem {
    /// Integrates the differential equations under a run's inputs and transitions, from the run's
    /// first sample: the motion that a robot makes if its model is right. The run itself is one of
    /// steps, by the [discretization](HybridSystem::discretization) where rates are nonlinear.
    ///
    /// Linear flows are exact, and a flow by [next values](HybridSystem::next) has no motion but
    /// its map. Others are integrated by the pair of formulas of J. R. Dormand and P. J. Prince ("A
    /// family of embedded Runge-Kutta formulae", Journal of Computational and Applied Mathematics
    /// 6(1), 1980), whose steps have an estimated error of 1e-11.
    ///
    /// ```
    /// use carom::hybrid::Discretization;
    /// use carom::prelude::*;
    ///
    /// let mut pendulum = HybridSystem::new(0.1); // s
    /// let angle = pendulum.state("angle", -4.0, 4.0)?; // rad
    /// let rate = pendulum.state("rate", -9.0, 9.0)?; // rad/s
    /// let torque = pendulum.input("torque", -5.0, 5.0)?; // 1/s²
    /// pendulum.discretization(Discretization::RungeKutta4)?;
    /// pendulum.mode("swing")?.rates([angle.is(rate), rate.is(torque - 9.81 * angle.sin())])?;
    /// let mut program = pendulum.program(5)?;
    /// program.start([angle.equals(0.0), rate.equals(0.0)])?;
    /// program.maximize(program.end(angle)?)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// let motion = pendulum.motion(&plan.run)?;
    /// assert!(motion.errors[0] < 1e-4); // rad
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`] and [`ErrorKind::Length`] for a run of another system;
    /// [`ErrorKind::Misplaced`] for a system with functions of which a transition beside others
    /// changes the flow; [`ErrorKind::NotFinite`] if the motion leaves the range of floats, or has
    /// no value; those of [`HybridSystem::check`].
    pub fn motion(&self, run: &HybridRun) -> Result<ContinuousMotion, Error> {
        self.check()?;
        let plan = PlannedRun::new(self, run)?;
        let first = plan.states[0].clone();
        let mut motion = ContinuousMotion {
            samples: vec![first.clone()],
            radii: Vec::new(),
            path: vec![(0.0, first.clone())],
            errors: vec![0.0; first.len()],
        };
        let mut state = first;
        for (step, input) in plan.inputs.iter().enumerate() {
            let began = step as f64 * self.time_step;
            let taken = plan.transitions(step);
            state = self.moved(&taken, step, began, state, input, &mut motion.path)?;
            for (error, (own, planned)) in
                motion.errors.iter_mut().zip(state.iter().zip(&plan.states[step + 1]))
            {
                *error = error.max((own - planned).abs());
            }
            motion.samples.push(state.clone());
        }
        Ok(motion)
    }

    /// The state after a step of the motion.
    fn moved(
        &self,
        taken: &[&Transition],
        step: usize,
        began: f64,
        state: Vec<f64>,
        input: &[f64],
        path: &mut Vec<(f64, Vec<f64>)>,
    ) -> Result<Vec<f64>, Error> {
        let flow = self.flow_together(taken)?;
        let input = self.with_function_values(&state, &state, input);
        let ended = match self.functions.rates(flow, &state, &input) {
            None => flow.step(&state, &input)?,
            Some(_) => {
                let rates =
                    |state: &[f64]| self.functions.rates(flow, state, &input).unwrap_or_default();
                let integrator = Integrator { rates: &rates, duration: self.time_step };
                integrator
                    .integrate(state, |time, state| path.push((began + time, state.to_vec())))?
            }
        };
        let end = began + self.time_step;
        path.push((end, ended.clone()));
        let resets = taken.iter().filter_map(|own| own.reset.as_ref());
        let mut next = ended.clone();
        for reset in resets {
            let offset = reset.offset.get(step);
            for (i, next) in next.iter_mut().enumerate() {
                let offset = offset.and_then(|own| own.get(i)).copied().unwrap_or(0.0);
                let sum: f64 = (0..ended.len()).map(|j| reset.matrix[(i, j)] * ended[j]).sum();
                // Each choice adds what it changes.
                *next += sum + offset - ended[i];
            }
        }
        if next != ended {
            path.push((end, next.clone()));
        }
        Ok(next)
    }

    /// The one flow of the transitions of a step.
    pub(super) fn flow_together<'a>(
        &'a self,
        taken: &[&'a Transition],
    ) -> Result<&'a LinearSystem, Error> {
        let changes = |own: &&&Transition| self.flow.as_ref() != Some(&own.flow);
        let mut changed = taken.iter().filter(changes);
        match (changed.next(), changed.next(), &self.flow) {
            (Some(own), None, _) => Ok(&own.flow),
            (None, _, Some(flow)) => Ok(flow),
            (Some(own), Some(_), _) => {
                let name = format!("`{}`", own.name);
                let place = "the motion of a step in which two choices change the flow".to_owned();
                let help = "state both choices as one";
                Err(ErrorKind::Misplaced { name, place, help }.into())
            }
            // Refused by the check of the system.
            (None, _, None) => Err(Error::unknown_name("flow", "part of the system")),
        }
    }
}

/// The integration of one step.
struct Integrator<'a> {
    /// The derivatives at a state.
    rates: &'a dyn Fn(&[f64]) -> Vec<f64>,
    /// In s.
    duration: f64,
}

/// The coefficients of the stages, each a row, and after them of the fifth-order formula.
const STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The difference of the two formulas.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

impl Integrator<'_> {
    /// The state at the end; tells of each state before it.
    fn integrate(
        &self,
        mut state: Vec<f64>,
        mut tell: impl FnMut(f64, &[f64]),
    ) -> Result<Vec<f64>, Error> {
        let (mut time, mut by) = (0.0, 0.1 * self.duration);
        for _ in 0..MOST_INTEGRATION_STEPS {
            by = f64::min(by, self.duration - time);
            let (next, error) = self.step(&state, by);
            if error <= 1.0 {
                time += by;
                state = next;
                if time >= self.duration * (1.0 - f64::EPSILON) {
                    return Ok(state);
                }
                tell(time, &state);
            }
            let factor = if error > 0.0 { 0.9 * error.powf(-0.2) } else { 5.0 };
            // NaN makes the step smaller.
            by *= if factor.is_nan() { 0.2 } else { factor.clamp(0.2, 5.0) };
        }
        let (name, what) = ("the motion".to_owned(), "a state");
        Err(ErrorKind::NotFinite { name, what, value: f64::NAN }.into())
    }

    /// A step, and its error in units of what is allowed.
    fn step(&self, state: &[f64], by: f64) -> (Vec<f64>, f64) {
        let mut slopes = vec![(self.rates)(state)];
        let moved = |weights: &[f64], slopes: &[Vec<f64>]| -> Vec<f64> {
            let at = |(i, x): (usize, &f64)| {
                let sum: f64 = weights.iter().zip(slopes).map(|(w, own)| w * own[i]).sum();
                x + by * sum
            };
            state.iter().enumerate().map(at).collect()
        };
        let mut next = Vec::new();
        for weights in STAGES {
            next = moved(weights, &slopes);
            slopes.push((self.rates)(&next));
        }
        let error = |(i, x): (usize, &f64)| {
            let sum: f64 = ERROR.iter().zip(&slopes).map(|(w, own)| w * own[i]).sum();
            (by * sum / (STEP_ERROR * x.abs().max(1.0))).abs()
        };
        let errors = next.iter().enumerate().map(error);
        let worst = errors.fold(0.0_f64, |most, own| match most.is_nan() || own.is_nan() {
            true => f64::NAN,
            false => most.max(own),
        });
        (next, worst)
    }
}
