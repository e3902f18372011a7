//! The least time step for a fixed number of steps.

use std::ops::Bound::{Excluded, Unbounded};

use super::HorizonModel;
use super::Monotonicity;
use super::options::ShortestOptions;
use super::outcome::{HorizonAttempt, HorizonVerdict};
use super::run::Task;
use super::search::{build, settled};
use crate::error::Error;
use crate::hybrid::linear::check_time_step;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{HybridSystem, IntoRegion};
use crate::setters::setters;
use crate::solution::{Solution, Termination};
use crate::solver::{Solver, StopToken};

/// The time steps that [`least_time_step`] tries.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TimeStepGrid {
    /// The number of steps, the same for all.
    pub steps: usize,
    /// The lengths of a step in s, ascending.
    pub time_steps: Vec<f64>,
    /// Why every longer time step is feasible if a shorter one is. Without a reason, each shorter
    /// one is refuted separately.
    pub monotone: Option<String>,
}

impl TimeStepGrid {
    /// A grid of time steps in s, ascending, for a number of steps.
    pub fn new(steps: usize, time_steps: impl Into<Vec<f64>>) -> Self {
        TimeStepGrid { steps, time_steps: time_steps.into(), monotone: None }
    }

    setters! {
        /// Allows bisection, with the argument: why every longer time step is feasible if a
        /// shorter one is. For a vehicle that can be slowed down at will, for example, each run
        /// can be driven more slowly. This is your proof; nothing checks it.
        with_monotone(reason: impl Into<String>) => monotone = Some(reason.into());
    }

    fn check(&self) -> Result<(), Error> {
        for &time_step in &self.time_steps {
            check_time_step(time_step)?;
        }
        match self.time_steps.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => {
                let (what, range) = ("a time step of the grid", (Excluded(pair[0]), Unbounded));
                Err(Error::out_of_range_with(what, pair[1], range, ", the one before it"))
            }
            None if self.time_steps.is_empty() => {
                Err(Error::out_of_range("the number of time steps of the grid", 0.0, 1.0..))
            }
            None => Ok(()),
        }
    }
}

/// The outcome of [`least_time_step`].
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct LeastTimeStep {
    /// The least time step of the grid found feasible, in s.
    pub time_step: Option<f64>,
    /// The largest time step of the grid, in s, that is refuted together with every smaller one.
    pub refuted: Option<f64>,
    /// Whether every time step of the grid is decided: those below `time_step` are refuted, and
    /// all of them are if there is none.
    pub is_proved: bool,
    /// The run with `time_step`. It is [certified](HybridSystem::certify).
    pub run: Option<HybridRun>,
    /// Each time step tried and its verdict, in order.
    pub attempts: Vec<(f64, HorizonAttempt)>,
}

/// Finds the least time step of a grid with which a system gets from a start to a goal in a fixed
/// number of steps, and refutes all smaller ones of the grid.
///
/// ```
/// use carom::hybrid::{TimeStepGrid, least_time_step};
/// use carom::prelude::*;
///
/// let cart = |dt: f64| {
///     let mut cart = HybridSystem::new(dt);
///     let x = cart.state("x", -9.0, 9.0)?; // m
///     let v = cart.state("v", -9.0, 9.0)?; // m/s
///     let a = cart.input("a", -1.0, 1.0)?; // m/s²
///     cart.mode("roll")?.rates([x.is(v), v.is(a)])?;
///     Ok((cart, [x.equals(0.0), v.equals(0.0)], [x.equals(1.0), v.equals(0.0)]))
/// };
/// // 1 m at 1 m/s² takes 2 s: ten steps of 0.2 s.
/// let grid = TimeStepGrid::new(10, [0.1, 0.15, 0.19, 0.2, 0.25]);
/// let options = ShortestOptions::default();
/// let found = least_time_step(cart, &grid, &options, &mut BranchAndBound::default())?;
/// assert!(found.is_proved);
/// assert_eq!((found.time_step, found.refuted), (Some(0.2), Some(0.19)));
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Arguments
///
/// * `task`: the system for a time step in s, where it starts, and where it must get.
/// * `options`: `max_steps` and `coarse_guess` have no effect.
///
/// # Errors
///
/// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for an empty grid, for one that
/// is not ascending, and for a bad number of steps; errors of `task`, of a start or goal that does
/// not fit, and of the solver.
pub fn least_time_step<R: IntoRegion>(
    task: impl Fn(f64) -> Result<(HybridSystem, R, R), Error>,
    grid: &TimeStepGrid,
    options: &ShortestOptions,
    solver: &mut dyn Solver,
) -> Result<LeastTimeStep, Error> {
    least_of(grid, options, |time_step, token| {
        let (system, start, goal) = task(time_step)?;
        let (start, goal) = (&start.stated().of(&system)?, &goal.stated().of(&system)?);
        let monotonicity = Monotonicity::NotMonotone("the number of steps is fixed".into());
        let task = Task { system: &system, start, goal, monotonicity };
        let (attempt, solved) = decide(&task, grid.steps, options, token, solver)?;
        let run = match solved.filter(|_| attempt.verdict == HorizonVerdict::Feasible) {
            Some((program, solution)) => Some(program.plan(&solution)?.run),
            None => None,
        };
        Ok((attempt, run))
    })
}

/// The least time step of a grid, by decisions on one of them each, with the run if there is one.
pub(crate) fn least_of(
    grid: &TimeStepGrid,
    options: &ShortestOptions,
    mut decide: impl FnMut(f64, &StopToken) -> Result<(HorizonAttempt, Option<HybridRun>), Error>,
) -> Result<LeastTimeStep, Error> {
    grid.check()?;
    let token = StopToken::new(options.time_limit, &options.interrupt);
    let mut found = LeastTimeStep {
        time_step: None,
        refuted: None,
        is_proved: false,
        run: None,
        attempts: Vec::new(),
    };
    // Below `low` all are refuted; at `high` one is feasible, or the grid ends.
    let (mut low, mut high) = (0, grid.time_steps.len());
    while low < high && !token.is_over() {
        let middle = if grid.monotone.is_some() { low + (high - low) / 2 } else { low };
        let time_step = grid.time_steps[middle];
        let (attempt, run) = decide(time_step, &token)?;
        found.attempts.push((time_step, attempt));
        match (attempt.verdict, run) {
            (HorizonVerdict::Feasible, Some(run)) => {
                found.run = Some(run);
                found.time_step = Some(time_step);
                high = middle;
            }
            (HorizonVerdict::Refuted(_), _) => {
                found.refuted = Some(time_step);
                low = middle + 1;
            }
            _ => return Ok(found),
        }
        if grid.monotone.is_none() && found.time_step.is_some() {
            break;
        }
    }
    found.is_proved = low == high;
    Ok(found)
}

/// The program of a horizon and its solution, if it was solved.
type TriedHorizon<M> = Option<(<M as HorizonModel>::Program, Solution)>;

/// Decides one horizon, by sets or by a solve.
pub(crate) fn decide<M: HorizonModel>(
    task: &M,
    steps: usize,
    options: &ShortestOptions,
    token: &StopToken,
    solver: &mut dyn Solver,
) -> Result<(HorizonAttempt, TriedHorizon<M>), Error> {
    let mut program = build(task, steps, options)?;
    // A log takes nothing from sets as given.
    let uses_sets = options.reach_sets && solver.options().proof.is_none();
    if let Some(mut sets) = if uses_sets { task.reach_sets()? } else { None }
        && let Some(tube) = sets.tube_until(steps, token)?
    {
        let variables = task.variables(&mut program);
        if tube.is_empty() || tube.tighten(program.as_mut(), &variables)?.infeasible {
            return Ok((HorizonAttempt::by_sets(steps), None));
        }
    }
    let solution = token.solve(solver, program.as_ref(), &mut |_| {})?;
    let attempt = HorizonAttempt::of(steps, &solution);
    Ok(match settled(task, &mut program, solution, solver, token)? {
        Ok(solution) => (attempt, Some((program, solution))),
        Err(_) => (
            HorizonAttempt { verdict: HorizonVerdict::Undecided(Termination::Stalled), ..attempt },
            None,
        ),
    })
}
