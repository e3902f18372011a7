//! Planning again and again: a receding or shrinking horizon, and closed loops.
//!
//! | part | file |
//! | --- | --- |
//! | a controller: plan, move, fall back | `receding/mod.rs` |
//! | a move and where it comes from | `receding/step.rs` |
//! | inputs when there is no plan | `receding/fallback.rs` |
//! | closed loops with a plant, and their records | `receding/closed_loop.rs` |
//! | disturbances from a seed | `receding/disturbance.rs` |

mod closed_loop;
mod disturbance;
mod fallback;
mod step;

pub use closed_loop::ClosedLoop;
pub use disturbance::Disturbance;
pub use step::{Move, MoveSource};

use web_time::{Duration, Instant};

use super::rows::HybridProgram;
use super::system::HybridSystem;
use super::terminal::TerminalSet;
use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::model::{Affine, Family, Model, Variable};
use crate::solution::{Point, Solution};
use crate::solver::{Control, Prepared, Solver};
use fallback::Fallback;

/// A controller that plans anew from every measured state and hands out the first input of the plan.
///
/// The program is prepared once. Each [`step`](Self::step) gives the parameters of the measured
/// state their values, and begins with the last plan, moved one step ahead. A step always has an input: see [`MoveSource`] for what comes instead of a plan.
///
/// # Recursive feasibility
///
/// Suppose that a plan ends in a [`TerminalSet`] of its system; that the next measured state is the
/// one that the plan predicts; that nothing in the program depends on the step; and that the program
/// has no limit beyond those of the system. Then the rest of the plan with one step of the set's
/// feedback is again a point of the program, so it has one at every later step. If its terminal cost
/// is the regulator's, the optimal costs do not rise. A disturbance breaks the second assumption:
/// then limits that are [softened](HybridProgram::soften) keep the program feasible, and a
/// [fallback](Self::with_fallback) the loop.
///
/// ```
/// use carom::hybrid::{
///     Cost, Horizon, HybridSystem, LinearSystem, MoveSource, RecedingHorizon, Transition,
/// };
/// use carom::interval::Interval;
/// use carom::prelude::*;
///
/// let line = LinearSystem::double_integrator(0.5)?;
/// let system = HybridSystem::new()
///     .with_state("x", Interval::new(-5.0, 5.0))
///     .with_state("v", Interval::new(-2.0, 2.0))
///     .with_input("a", Interval::new(-1.0, 1.0))
///     .with_transition(Transition::new("drive", line));
/// let mut model = Model::new("drive");
/// let program = system.write(&mut model, "", &Horizon::new(8, 0.5)?)?;
/// let cost = Cost::quadratic([[1.0, 0.0], [0.0, 1.0]], [[0.1]]);
/// let cost = program.add_cost(&mut model, "cost", &cost)?;
/// model.minimize(cost)?;
///
/// let mut solver = BranchAndBound::default();
/// let mut controller = RecedingHorizon::new(&program, model, &mut solver)?;
/// let plant = |state: &[f64], next: &carom::hybrid::Move| {
///     Ok(system.simulate(state, &[&next.input])?.last().to_vec())
/// };
/// let run = controller.run(&[4.0, 0.0], 20, plant)?;
/// assert!(run.states[20].iter().all(|x| x.abs() < 0.1));
/// assert!(run.moves.iter().all(|next| next.source == MoveSource::Optimal));
/// # Ok::<(), carom::Error>(())
/// ```
pub struct RecedingHorizon<'a> {
    planner: Planner<'a>,
    system: Option<HybridSystem>,
    fallback: Fallback<'a>,
    excess: Option<Affine>,
    budget: Option<Duration>,
    steps: usize,
    /// The rest of the last plan: an input a step.
    rest: Vec<Vec<f64>>,
}

/// Where plans come from.
enum Planner<'a> {
    /// One program for all steps.
    Receding(Box<dyn Prepared + 'a>, Handles),
    /// A program for each number of steps that are left.
    Shrinking { solver: &'a mut dyn Solver, build: Box<Build<'a>>, left: usize },
}

type Build<'a> = dyn FnMut(usize) -> Result<(HybridProgram, Model), Error> + 'a;

/// The variables of a program that a controller reads and writes.
struct Handles {
    measured: Vec<Variable>,
    states: Vec<Family>,
    inputs: Vec<Family>,
}

impl Handles {
    /// Adds parameters for the state at the first sample of a program.
    fn measure(program: &HybridProgram, model: &mut Model) -> Result<Self, Error> {
        let mut measured = Vec::new();
        for (k, (name, domain)) in program.system().states.iter().enumerate() {
            let Some(first) = program.states().get(k).and_then(|family| family.get(0)) else {
                continue;
            };
            let middle = 0.0_f64.clamp(domain.lower, domain.upper);
            let name = format!("measured_{}", name.replace(char::is_whitespace, "_"));
            let parameter = model.parameter(name.as_str(), middle, domain.lower, domain.upper)?;
            model.add(format!("{name}_row").as_str(), (first - parameter).equals(0.0))?;
            measured.push(parameter);
        }
        let (states, inputs) = (program.states().to_vec(), program.inputs().to_vec());
        Ok(Handles { measured, states, inputs })
    }

    fn values(&self, state: &[f64]) -> Vec<(Variable, f64)> {
        self.measured.iter().copied().zip(state.iter().copied()).collect()
    }

    /// The values of families, by step.
    fn read(families: &[Family], point: &Point) -> Result<Vec<Vec<f64>>, Error> {
        let steps = families.iter().map(Family::len).min().unwrap_or(0);
        let at = |t: usize| families.iter().map(|family| point.value(family[t])).collect();
        (0..steps).map(at).collect()
    }
}

impl<'a> RecedingHorizon<'a> {
    /// A controller with the horizon of a program, which moves along with it.
    ///
    /// The state at the first sample becomes a parameter within the domains of the states. Nothing
    /// else in the model may fix it.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::prepare`]; [`ErrorKind::DuplicateName`] if the model has a variable
    /// `measured_x` for a state `x`.
    pub fn new(
        program: &HybridProgram,
        mut model: Model,
        solver: &'a mut dyn Solver,
    ) -> Result<Self, Error> {
        let handles = Handles::measure(program, &mut model)?;
        let planner = Planner::Receding(solver.prepare(&model)?, handles);
        Ok(RecedingHorizon::of(planner, Some(program.system().clone())))
    }

    /// A controller for any model in which parameters are the measured state. Without a system
    /// or a [check](Self::with_check) nothing is simulated, and the rest of an old plan is trusted while
    /// there is no new one.
    ///
    /// # Arguments
    ///
    /// * `measured`: a parameter for each entry of the state.
    /// * `states`: for each of them, its values at the samples 0, 1, ...
    /// * `inputs`: for each input, its values in the steps 0, 1, ...
    ///
    /// # Errors
    ///
    /// Those of [`Solver::prepare`]; [`ErrorKind::ForeignHandle`] and [`ErrorKind::NotParameter`];
    /// [`ErrorKind::Length`] if there are not as many states as parameters.
    pub fn of_model(
        model: &Model,
        measured: &[Variable],
        states: &[Family],
        inputs: &[Family],
        solver: &'a mut dyn Solver,
    ) -> Result<Self, Error> {
        check_length("the states", states.len(), measured.len())?;
        for &parameter in measured {
            let variable = model.variable_ref(parameter)?;
            if variable.parameter_range().is_none() {
                let name = variable.name().to_string();
                return Err(ErrorKind::NotParameter { name }.into());
            }
        }
        let handles = Handles {
            measured: measured.to_vec(),
            states: states.to_vec(),
            inputs: inputs.to_vec(),
        };
        Ok(RecedingHorizon::of(Planner::Receding(solver.prepare(model)?, handles), None))
    }

    /// A controller that plans towards a fixed time: the horizon is a step shorter after every move.
    /// Each program is solved from nothing.
    ///
    /// # Arguments
    ///
    /// * `steps`: those of the first program.
    /// * `build`: the program of so many steps, and the model that holds it.
    pub fn shrinking(
        steps: usize,
        build: impl FnMut(usize) -> Result<(HybridProgram, Model), Error> + 'a,
        solver: &'a mut dyn Solver,
    ) -> Self {
        let planner = Planner::Shrinking { solver, build: Box::new(build), left: steps };
        RecedingHorizon::of(planner, None)
    }

    fn of(planner: Planner<'a>, system: Option<HybridSystem>) -> Self {
        RecedingHorizon {
            planner,
            system,
            fallback: Fallback::default(),
            excess: None,
            budget: None,
            steps: 0,
            rest: Vec::new(),
        }
    }

    /// Stops each search after this time. A step takes a little longer, because a point is polished
    /// and verified before it counts. Each search first completes the last plan, moved one step ahead,
    /// so a plan is at hand early.
    #[must_use]
    pub fn with_budget(mut self, budget: Duration) -> Self {
        self.budget = Some(budget);
        self
    }

    /// Sets the input when there is no plan, as a function of the state.
    #[must_use]
    pub fn with_fallback(mut self, input: impl FnMut(&[f64]) -> Vec<f64> + 'a) -> Self {
        self.fallback.given = Some(Box::new(input));
        self
    }

    /// Judges inputs without a plan by a simulation of one's own instead of the system's: whether from a
    /// state on the inputs of some steps, an entry per input, are admissible.
    #[must_use]
    pub fn with_check(mut self, check: impl FnMut(&[f64], &[Vec<f64>]) -> bool + 'a) -> Self {
        self.fallback.check = Some(Box::new(check));
        self
    }

    /// Takes the feedback of a terminal set when there is no plan and the state is in the set.
    #[must_use]
    pub fn with_terminal_set(mut self, set: TerminalSet) -> Self {
        self.fallback.terminal = Some(set);
        self
    }

    /// Reports the value of an expression with every plan, such as the sum of the excesses of
    /// softened limits. A plan in which it is above 1e-6 is called [`MoveSource::Softened`].
    #[must_use]
    pub fn with_excess(mut self, excess: impl Into<Affine>) -> Self {
        self.excess = Some(excess.into());
        self
    }

    /// The next move from a measured state.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`] and [`ErrorKind::NotFinite`] for the state; errors of the solver; for a
    /// shrinking horizon those of building the program, and [`ErrorKind::OutOfRange`] after its
    /// last step. A state outside the declared ranges, an infeasible program and a limit without a
    /// point are no errors: the move then comes from a fallback.
    pub fn step(&mut self, state: &[f64]) -> Result<Move, Error> {
        let began = Instant::now();
        check_finite("the measured state", "an entry", state.iter().copied())?;
        let planned = self.plan(state)?;
        let mut next = match planned {
            Planned::Found(solution, states, inputs, excess) => {
                self.rest = inputs.get(1..).unwrap_or_default().to_vec();
                Move::planned(&solution, states, inputs, excess)
            }
            Planned::Nothing(solution, why) => {
                let system = self.system.as_ref();
                let input = self.fallback.input(system, state, &mut self.rest)?;
                let mut next = Move::without_plan(input);
                next.reason = Some(why);
                if let Some(solution) = solution {
                    next.count(&solution);
                }
                next
            }
        };
        next.step = self.steps;
        next.state = state.to_vec();
        self.steps += 1;
        match &mut self.planner {
            Planner::Receding(prepared, _) => prepared.shift(),
            Planner::Shrinking { left, .. } => *left -= 1,
        }
        next.time = began.elapsed();
        Ok(next)
    }

    /// Plans from a state.
    fn plan(&mut self, state: &[f64]) -> Result<Planned, Error> {
        let budget = self.budget;
        let (result, handles) = match &mut self.planner {
            Planner::Receding(prepared, handles) => {
                check_length("the measured state", state.len(), handles.measured.len())?;
                if budget.is_some() {
                    prepared.options_mut().time_limit = budget;
                }
                let values = handles.values(state);
                (prepared.solve(&values, &mut Control::default()), &*handles)
            }
            Planner::Shrinking { solver, build, left } => {
                if *left == 0 {
                    let what = "the step of a shrinking horizon";
                    let steps = self.steps as f64;
                    return Err(Error::out_of_range(what, steps, "before its end"));
                }
                let (program, mut model) = build(*left)?;
                check_length("the measured state", state.len(), program.states().len())?;
                let handles = Handles::measure(&program, &mut model)?;
                self.system = Some(program.system().clone());
                if budget.is_some() {
                    solver.options_mut().time_limit = budget;
                }
                let values = handles.values(state);
                let result = model.set_parameters(&values).and_then(|()| solver.solve(&model));
                return Planned::of(result, &handles, self.excess.as_ref());
            }
        };
        Planned::of(result, handles, self.excess.as_ref())
    }
}

/// The result of planning.
enum Planned {
    /// A solution with its states, inputs and excess.
    Found(Box<Solution>, Vec<Vec<f64>>, Vec<Vec<f64>>, Option<f64>),
    /// No point, and why.
    Nothing(Option<Box<Solution>>, String),
}

impl Planned {
    fn of(
        result: Result<Solution, Error>,
        handles: &Handles,
        excess: Option<&Affine>,
    ) -> Result<Self, Error> {
        let solution = match result {
            Ok(solution) => Box::new(solution),
            // Values were checked to be finite: one is outside its range.
            Err(error) if matches!(error.kind(), ErrorKind::OutOfRange { .. }) => {
                return Ok(Planned::Nothing(None, error.to_string()));
            }
            Err(other) => return Err(other),
        };
        let Some(point) = solution.point() else {
            let why = solution.termination().to_string();
            return Ok(Planned::Nothing(Some(solution), why));
        };
        let states = Handles::read(&handles.states, point)?;
        let inputs = Handles::read(&handles.inputs, point)?;
        let excess = excess.map(|excess| point.value(excess)).transpose()?;
        Ok(Planned::Found(solution, states, inputs, excess))
    }
}

impl std::fmt::Debug for RecedingHorizon<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RecedingHorizon")
            .field("budget", &self.budget)
            .field("steps", &self.steps)
            .field("rest", &self.rest)
            .finish_non_exhaustive()
    }
}
