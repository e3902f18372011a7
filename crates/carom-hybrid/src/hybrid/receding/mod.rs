//! Planning again and again: a receding or shrinking horizon, and closed loops.
//!
//! | part | file |
//! | --- | --- |
//! | a controller and its settings; a step: plan, move, fall back | `receding/mod.rs`; `receding/next_move.rs` |
//! | where plans come from | `receding/planner.rs` |
//! | what a step proposes to the next one | `receding/guess.rs` |
//! | values of parameters by step of the loop | `receding/forecast.rs` |
//! | a plan, whole; a move and where it comes from | `receding/loop_plan.rs`; `receding/step.rs` |
//! | moves when there is no plan; plans from another state | `receding/fallback.rs`; `receding/recovery.rs` |
//! | closed loops with a plant, and their records | `receding/closed_loop.rs` |
//! | disturbances from a seed | `receding/disturbance.rs` |

mod closed_loop;
mod disturbance;
mod fallback;
mod forecast;
mod guess;
mod loop_plan;
mod next_move;
mod planner;
mod recovery;
mod step;

pub use closed_loop::{BrokenLoop, ClosedLoop};
pub use disturbance::Disturbance;
pub use step::{ControlMove, MoveSource};

use web_time::Duration;

use super::memory::Memory;
use super::program::HybridProgram;
use super::system::HybridSystem;
use super::terminal::TerminalSet;
use crate::error::{Error, ErrorKind, check_length};
use crate::model::{Affine, Family, Model, Variable};
use crate::solver::Solver;
use fallback::Fallback;
use forecast::Forecasts;
use guess::LastIntegers;
use loop_plan::LoopPlan;
use planner::{Clock, Handles, Planner};

/// A controller that plans anew from every measured state and hands out the first step of the plan.
///
/// The program is prepared once. Each [`step`](Self::step) gives the parameters of the measured
/// state their values, and begins with the last plan, moved one step ahead. A step always has an
/// input: see [`MoveSource`] for what comes instead of a plan.
///
/// # Recursive feasibility
///
/// Suppose that a plan ends in a [`TerminalSet`] of its system; that the next measured state is the
/// one that the plan predicts; that nothing in the program depends on the step; and that the
/// program has no limit beyond those of the system. Then the rest of the plan with one step of the
/// set's feedback is again a point of the program, so it has one at every later step. If its
/// terminal cost is the regulator's, the optimal costs do not rise. A disturbance breaks the second
/// assumption: then limits that are [softened](HybridProgram::soften) keep the program feasible,
/// and a [fallback](Self::with_fallback) the loop.
///
/// ```
/// use carom::hybrid::MoveSource;
/// use carom::prelude::*;
///
/// let mut cart = HybridSystem::new(0.5); // s
/// let x = cart.state("x", -5.0, 5.0)?; // m
/// let v = cart.state("v", -2.0, 2.0)?; // m/s
/// let a = cart.input("a", -1.0, 1.0)?; // m/s²
/// cart.mode("drive")?.rates([x.is(v), v.is(a)])?;
/// let mut program = cart.program(8)?;
/// let cost = program.sum(x.square() + v.square() + 0.1 * a.square())?;
/// program.minimize(cost)?;
///
/// let mut solver = BranchAndBound::default();
/// let mut controller = RecedingHorizon::new(program, &mut solver)?;
/// let plant = |state: &[f64], next: &ControlMove| cart.simulate(state, next)?.end();
/// let run = controller.run(&[4.0, 0.0], 20, plant)?;
/// assert!(run.states[20].iter().all(|x| x.abs() < 0.1));
/// assert!(run.moves.iter().all(|next| next.source == MoveSource::Optimal));
/// # Ok::<(), carom::Error>(())
/// ```
pub struct RecedingHorizon<'a> {
    planner: Planner<'a>,
    system: Option<HybridSystem>,
    fallback: Fallback<'a>,
    forecasts: Forecasts<'a>,
    excess: Option<Affine>,
    budget: Option<Duration>,
    first_budget: Option<Duration>,
    steps: usize,
    /// The rest of the last plan.
    rest: LoopPlan,
    /// Whether the last step had no plan.
    missed: bool,
    /// The memory with which the next step begins, beside the state.
    memory: Memory,
}

impl<'a> RecedingHorizon<'a> {
    /// A controller with the horizon of a program, of a system or of a scene, which moves along
    /// with it.
    ///
    /// The state at the first sample becomes a parameter within the domains of the states. Nothing
    /// else in the model may fix it. [Cases](HybridProgram::add_case) begin in the same state, as
    /// far as their states have the same names, and fallbacks are simulated by the first system.
    ///
    /// The program is the same in every step of the loop, so nothing in it may depend on the step:
    /// a limit "x <= 1 from step 4 on" would be four steps ahead for ever. Prices and right-hand
    /// sides that change can be parameters with a [forecast](Self::with_forecast); for everything
    /// else there is [`moving`](Self::moving). What you add to the model yourself, such as a price
    /// for each step, is not checked.
    ///
    /// # Errors
    ///
    /// Those of [`Solver::prepare`]; [`ErrorKind::OutOfRange`] for a
    /// [case](HybridProgram::add_case) that does not share the first step;
    /// [`ErrorKind::DuplicateName`] if the model has a variable `measured_x` for a state `x`;
    /// [`ErrorKind::Unsupported`] if a range, a limit, a guard or a reset of the system, or a
    /// [series](HybridSystem::series), depends on the step, and for a program that fixes the mode
    /// or the [memory](HybridProgram::start_from) of its start, which the controller carries.
    pub fn new(
        program: impl Into<HybridProgram>,
        solver: &'a mut dyn Solver,
    ) -> Result<Self, Error> {
        let mut program = program.into();
        check_moves(&program.model)?;
        check_start(&program)?;
        let handles = Handles::measure(&mut program)?;
        let HybridProgram { model, systems } = program;
        let system = systems.steered().map(|only| only.system().clone());
        let prepared = solver.prepare(&model)?;
        let planner = Planner::Receding { prepared, passed: 0, handles, systems: Some(systems) };
        Ok(RecedingHorizon::of(planner, system))
    }

    /// A controller for any model in which parameters are the measured state. Without a system or a
    /// [check](Self::with_check) nothing is simulated, and the rest of an old plan is trusted while
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
    /// [`ErrorKind::Length`] if there are not as many states as parameters;
    /// [`ErrorKind::Unsupported`] as for [`new`](Self::new).
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
        let handles = Handles::of_model(measured, states, inputs);
        check_moves(model)?;
        let planner = Planner::Receding {
            prepared: solver.prepare(model)?,
            passed: 0,
            handles,
            systems: None,
        };
        Ok(RecedingHorizon::of(planner, None))
    }

    /// A controller that plans towards a fixed time: the horizon is a step shorter after every
    /// move. Each program begins with the last plan.
    ///
    /// # Arguments
    ///
    /// * `steps`: those of the first program.
    /// * `build`: the program of so many steps, of a system or of a scene.
    pub fn shrinking<P: Into<HybridProgram>>(
        steps: usize,
        mut build: impl FnMut(usize) -> Result<P, Error> + 'a,
        solver: &'a mut dyn Solver,
    ) -> Self {
        let build = move |steps| build(steps).map(P::into);
        RecedingHorizon::built(solver, Box::new(build), Clock::Left(steps))
    }

    /// A controller whose programs depend on the step of the loop: limits, prices, references and
    /// courses of obstacles that change with time. Each program is built anew and begins with the
    /// last plan, moved one step ahead.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A cart that wants to be at 3 m, and that must be within 1 m from step 10 on.
    /// let mut cart = HybridSystem::new(0.5); // s
    /// let x = cart.state("x", -5.0, 5.0)?; // m
    /// let v = cart.state("v", -2.0, 2.0)?; // m/s
    /// let a = cart.input("a", -1.0, 1.0)?; // m/s²
    /// let gate = cart.series("gate", [vec![5.0; 10], vec![1.0]].concat())?;
    /// cart.limit("before the gate", x.le(gate))?;
    /// cart.mode("drive")?.rates([x.is(v), v.is(a)])?;
    /// let build = |step: usize| {
    ///     let mut program = cart.from_step(step).program(8)?;
    ///     let cost =
    ///         program.sum((x - 3.0).square() + 0.1 * v.square() + 0.1 * a.square())?;
    ///     program.minimize(cost)?;
    ///     Ok(program)
    /// };
    /// let mut solver = BranchAndBound::default();
    /// let mut controller = RecedingHorizon::moving(build, &mut solver);
    /// let plant = |state: &[f64], next: &ControlMove| {
    ///     cart.from_step(next.step).simulate(state, next)?.end()
    /// };
    /// let run = controller.run(&[0.0, 0.0], 14, plant)?;
    /// assert!(run.states.iter().any(|state| state[0] > 1.5));
    /// assert!(run.states[10..].iter().all(|state| state[0] < 1.0 + 1e-6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `build`: the program that begins with a step of the loop, of a system or of a scene. See
    ///   [`HybridSystem::from_step`] and [`Scene::from_step`](super::scene::Scene::from_step). It
    ///   need not say in which modes it begins; if it does, by
    ///   [`start_from`](HybridProgram::start_from) or by a row of a mode at sample 0, this counts
    ///   instead of what the controller remembers.
    pub fn moving<P: Into<HybridProgram>>(
        mut build: impl FnMut(usize) -> Result<P, Error> + 'a,
        solver: &'a mut dyn Solver,
    ) -> Self {
        let build = move |step| build(step).map(P::into);
        RecedingHorizon::built(solver, Box::new(build), Clock::Passed(0))
    }

    fn built(solver: &'a mut dyn Solver, build: Box<planner::Build<'a>>, clock: Clock) -> Self {
        let last = LastIntegers::default();
        let planner = Planner::Built { solver, build, clock, last, program: None };
        RecedingHorizon::of(planner, None)
    }

    fn of(planner: Planner<'a>, system: Option<HybridSystem>) -> Self {
        RecedingHorizon {
            planner,
            system,
            fallback: Fallback::default(),
            forecasts: Forecasts::default(),
            excess: None,
            budget: None,
            first_budget: None,
            steps: 0,
            rest: LoopPlan::default(),
            missed: false,
            memory: Memory::default(),
        }
    }

    /// Stops each search after this time. A step takes a little longer, because a point is polished
    /// and verified before it counts. Each search first completes the last plan, moved one step
    /// ahead, so a plan is at hand early; after a step without a plan, what is left of the last one
    /// is simulated from the measured state and completed.
    #[must_use]
    pub fn with_budget(mut self, budget: Duration) -> Self {
        self.budget = Some(budget);
        self
    }

    /// Stops the first search after this time instead: it has no plan to begin with, and often
    /// there is time before the loop starts.
    #[must_use]
    pub fn with_first_budget(mut self, budget: Duration) -> Self {
        self.first_budget = Some(budget);
        self
    }

    /// Gives parameters of the horizon's steps 0, 1, ... values by step of the loop: in step k the
    /// parameter t has the value `k + t`, and the last value goes on for ever. So prices,
    /// right-hand sides and references that are parameters move with the loop.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A store that is filled by the hour.
    /// let mut store = HybridSystem::new(3600.0); // s
    /// let full = store.state("full", 0.0, 9.0)?;
    /// let buy = store.input("buy", 0.0, 3.0)?;
    /// store.mode("use")?.next([full.is(full + buy - 1.0)])?;
    /// let mut program = store.program(4)?;
    /// // What must be in the store at each step is forecast.
    /// let mut demand = Vec::new();
    /// for t in 0..4 {
    ///     let need = program.model_mut().parameter(("need", t), 0.0, 0.0, 9.0)?;
    ///     program.add(("covers", t), program.at(full, t + 1)?.ge(need))?;
    ///     demand.push(need);
    /// }
    /// program.minimize(program.sum(buy)?)?;
    /// let mut solver = BranchAndBound::default();
    /// let controller = RecedingHorizon::new(program, &mut solver)?;
    /// let mut controller =
    ///     controller.with_forecast(demand, [vec![0.0; 6], vec![5.0, 0.0]].concat())?;
    /// let plant = |state: &[f64], next: &ControlMove| Ok(vec![state[0] + next.input[0] - 1.0]);
    /// let run = controller.run(&[2.0], 8, plant)?;
    /// assert!(run.states[7][0] > 5.0 - 1e-6 && run.states[4][0] < 3.0);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Model::set_parameter`] for each value; [`ErrorKind::OutOfRange`] without a value;
    /// [`ErrorKind::Unsupported`] for controllers whose programs are built in each step.
    pub fn with_forecast(
        mut self,
        parameters: impl IntoIterator<Item = Variable>,
        values: impl Into<Vec<f64>>,
    ) -> Result<Self, Error> {
        let Some(model) = self.planner.model() else { return Err(builds_its_own("forecasts")) };
        self.forecasts.add(model, parameters.into_iter().collect(), values.into())?;
        Ok(self)
    }

    /// Gives parameters values in each step, as a function of the number of the step and of the
    /// measured state.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`] for controllers whose programs are built in each step.
    pub fn with_parameters(
        mut self,
        values: impl FnMut(usize, &[f64]) -> Vec<(Variable, f64)> + 'a,
    ) -> Result<Self, Error> {
        if self.planner.model().is_none() {
            return Err(builds_its_own("further parameters"));
        }
        self.forecasts.give(values);
        Ok(self)
    }

    /// Sets the input when there is no plan, as a function of the state.
    #[must_use]
    pub fn with_fallback(mut self, input: impl FnMut(&[f64]) -> Vec<f64> + 'a) -> Self {
        self.fallback.given = Some(Box::new(input));
        self
    }

    /// Judges inputs without a plan by a simulation of one's own instead of the system's: whether
    /// from a state on the inputs of some steps, an entry per input, are admissible.
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

    /// The memory with which the next step begins, beside the state: the modes to which the moves
    /// so far lead, how long they have lasted, the number of events.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Tells what the next step begins with, where it is not what the moves so far lead to: at the
    /// start of a loop, and where modes are measured.
    ///
    /// ```
    /// use carom::hybrid::Memory;
    /// use carom::prelude::*;
    ///
    /// // A heater that stays on and off for 3 samples or more.
    /// let mut room = HybridSystem::new(600.0); // s
    /// let t = room.state("temperature", 5.0, 30.0)?; // °C
    /// let [off, on] = room.modes("heater", ["off", "on"])?;
    /// room.stay(off)?.next([t.is(t - 0.5)])?;
    /// room.stay(on)?.next([t.is(t + 0.75)])?;
    /// room.switch(off, on)?;
    /// room.switch(on, off)?;
    /// room.dwell(on, 3, None)?;
    /// room.dwell(off, 3, None)?;
    /// let mut program = room.program(5)?;
    /// program.minimize(program.sum((t - 20.0).square())?)?;
    /// let mut solver = BranchAndBound::default();
    /// let mut controller = RecedingHorizon::new(program, &mut solver)?;
    /// // It has been off for a long time.
    /// controller.set_memory(Memory::default().with_mode("heater", "off", 9));
    /// let run = controller.run(&[18.0], 12, |state: &[f64], next: &ControlMove| {
    ///     room.simulate(state, next)?.end()
    /// })?;
    /// let modes: Vec<_> = run.moves.iter().filter_map(|next| next.mode("heater")).collect();
    /// assert_eq!(modes[..7], ["on", "on", "on", "on", "off", "off", "off"]);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn set_memory(&mut self, memory: Memory) {
        self.memory = memory;
    }
}

/// Refuses models in which something depends on the step.
fn check_moves(model: &Model) -> Result<(), Error> {
    model.by_step().map_or(Ok(()), |what| Err(cannot_move(what)))
}

/// Refuses programs that say with which modes they begin, because every step would begin with them.
fn check_start(program: &HybridProgram) -> Result<(), Error> {
    let choices = program.systems.choices();
    let with_modes = choices.iter().find(|(_, choice)| !choice.modes().is_empty());
    if let (true, Some((_, choice))) = (program.systems.modes_follow_states, with_modes) {
        return Err(ErrorKind::Unsupported {
            solver: "a receding horizon with one program for all steps".into(),
            what: format!("the modes of `{}`, which last from step to step", choice.name),
            help: "build the program of each step with `RecedingHorizon::moving`, and state in it the \
                   mode in which it starts"
                .into(),
        }
        .into());
    }
    let what = match (&program.systems.memory, program.systems.fixed_mode(&program.model)) {
        (Some(_), _) => "a memory of the start".to_owned(),
        (None, Some(choice)) => format!("a start in a mode of `{choice}`"),
        (None, None) => return Ok(()),
    };
    Err(ErrorKind::Unsupported {
        solver: "a receding horizon with one program for all steps".into(),
        what: format!("{what}, because every step would begin with it"),
        help:
            "leave it out, because the controller carries modes along, and tell the first one by \
               `RecedingHorizon::set_memory`"
                .into(),
    }
    .into())
}

fn cannot_move(what: &str) -> Error {
    let kind = ErrorKind::Unsupported {
        solver: "a receding horizon with one program for all steps".into(),
        what: format!(
            "{what}, which depends on the step and would stay where it is while time passes"
        ),
        help: "build the program of each step with `RecedingHorizon::moving`, or make the values \
               parameters and give them `with_forecast`"
            .into(),
    };
    kind.into()
}

fn builds_its_own(what: &str) -> Error {
    let kind = ErrorKind::Unsupported {
        solver: "a controller whose programs are built in each step".into(),
        what: what.into(),
        help: "build each program with the values of its step".into(),
    };
    kind.into()
}

impl std::fmt::Debug for RecedingHorizon<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RecedingHorizon")
            .field("budget", &self.budget)
            .field("steps", &self.steps)
            .field("memory", &self.memory)
            .finish_non_exhaustive()
    }
}
