//! Where plans come from: one prepared program, or one that is built for each step.

use std::sync::Arc;

use web_time::Duration;

use super::guess::{LastIntegers, simulated};
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::program::{HybridProgram, Members, as_drift};
use crate::hybrid::system::HybridSystem;
use crate::model::{Affine, Family, Model, Variable};
use crate::solution::{Point, Solution};
use crate::solver::{Control, Prepared, Solver};

/// Where plans come from.
pub(super) enum Planner<'a> {
    /// One program for all steps.
    Receding { prepared: Box<dyn Prepared + 'a>, handles: Handles, members: Option<Arc<Members>> },
    /// A program for each step.
    Built { solver: &'a mut dyn Solver, build: Box<Build<'a>>, clock: Clock, last: LastIntegers },
}

/// Builds the program of a step.
pub(super) type Build<'a> = dyn FnMut(usize) -> Result<HybridProgram, Error> + 'a;

/// The number of steps with which the program of a step is asked for.
pub(super) enum Clock {
    /// The steps that are left.
    Left(usize),
    /// The steps that have passed.
    Passed(usize),
}

/// The request of a step to its planner.
pub(super) struct Question<'q> {
    /// The number of the step.
    pub(super) step: usize,
    pub(super) state: &'q [f64],
    /// Values of parameters other than the measured state.
    pub(super) parameters: &'q [(Variable, f64)],
    pub(super) budget: Option<Duration>,
    pub(super) excess: Option<&'q Affine>,
    /// The rest of the last plan, an input a step, where the last step had no plan.
    pub(super) missed: Option<&'q [Vec<f64>]>,
}

/// The variables of a program that a controller reads and writes.
pub(super) struct Handles {
    pub(super) measured: Vec<Variable>,
    pub(super) states: Vec<Family>,
    pub(super) inputs: Vec<Family>,
}

impl Handles {
    /// Adds parameters for the states at the first sample of a program.
    pub(super) fn measure(program: &mut HybridProgram) -> Result<Self, Error> {
        let HybridProgram { model, members } = program;
        let mut handles = Handles { measured: Vec::new(), states: Vec::new(), inputs: Vec::new() };
        let first = members.first().system();
        for (k, (name, own)) in members.named().enumerate() {
            // Cases begin in the state of the first system.
            let shared = members.cases.get(name);
            if shared == Some(&0) {
                let what = format!("the number of steps that `{name}` shares");
                let range = "at least 1, because a controller applies one input for all cases";
                return Err(Error::out_of_range(what, 0.0, range));
            }
            let number = if k == 0 { String::new() } else { format!("{k}_") };
            for ((name, domain), family) in own.system().states.iter().zip(own.states()) {
                let Some(start) = family.get(0) else { continue };
                let middle = 0.0_f64.clamp(domain.lower, domain.upper);
                let called = format!("measured_{number}{}", name.replace(char::is_whitespace, "_"));
                let twin = first.states.iter().position(|(own, _)| own == name);
                if let (Some(twin), Some(_)) = (twin, shared) {
                    let row = (start - handles.measured[twin]).equals(0.0);
                    model.add(format!("{called}_row").as_str(), row)?;
                    continue;
                }
                let parameter =
                    model.parameter(called.as_str(), middle, domain.lower, domain.upper)?;
                model.add(format!("{called}_row").as_str(), (start - parameter).equals(0.0))?;
                handles.measured.push(parameter);
                handles.states.push(family.clone());
            }
            if shared.is_none() {
                handles.inputs.extend(own.inputs().iter().cloned());
            }
        }
        Ok(handles)
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

/// The result of planning.
pub(super) enum Planned {
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
            // The plan is no run of its inputs.
            Err(error) if as_drift(&error).is_some() => {
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

/// The solution whose states are the run of its inputs, without a second solve.
fn settled(members: &Members, model: &Model, solution: Solution) -> Result<Solution, Error> {
    Ok(members.settled(model, &solution, None)?.into_owned())
}

impl Planner<'_> {
    /// The model of all steps, if there is one.
    pub(super) fn model(&self) -> Option<&Model> {
        match self {
            Planner::Receding { prepared, .. } => Some(prepared.model()),
            Planner::Built { .. } => None,
        }
    }

    /// A step passes.
    pub(super) fn shift(&mut self) {
        match self {
            Planner::Receding { prepared, .. } => prepared.shift(),
            Planner::Built { clock, last, .. } => {
                last.shift();
                match clock {
                    Clock::Left(left) => *left -= 1,
                    Clock::Passed(passed) => *passed += 1,
                }
            }
        }
    }

    /// Plans from a state. The system of the step's own program takes the place of `system`.
    pub(super) fn plan(
        &mut self,
        question: &Question<'_>,
        system: &mut Option<HybridSystem>,
    ) -> Result<Planned, Error> {
        let state = question.state;
        match self {
            Planner::Receding { prepared, handles, members } => {
                check_length("the measured state", state.len(), handles.measured.len())?;
                if question.budget.is_some() {
                    prepared.options_mut().time_limit = question.budget;
                }
                let mut values = handles.values(state);
                values.extend(question.parameters);
                let only = members.as_ref().and_then(|members| members.only());
                let start = match (only, question.missed) {
                    (Some(variables), Some(rest)) => simulated(variables, state, rest)?,
                    _ => None,
                };
                let mut control = Control::default();
                if let Some(start) = &start {
                    control = control.with_start(start);
                }
                let result = prepared.solve(&values, &mut control);
                let model = prepared.model();
                let result = match members {
                    Some(members) => result.and_then(|found| settled(members, model, found)),
                    None => result,
                };
                Planned::of(result, handles, question.excess)
            }
            Planner::Built { solver, build, clock, last } => {
                let step = match clock {
                    Clock::Left(0) => {
                        let what = "the step of a shrinking horizon";
                        return Err(Error::out_of_range(
                            what,
                            question.step as f64,
                            "before its end",
                        ));
                    }
                    Clock::Left(left) => *left,
                    Clock::Passed(passed) => *passed,
                };
                let mut program = build(step)?;
                let handles = Handles::measure(&mut program)?;
                check_length("the measured state", state.len(), handles.measured.len())?;
                let HybridProgram { mut model, members } = program;
                *system = members.steered().map(|only| only.system().clone());
                if question.budget.is_some() {
                    solver.options_mut().time_limit = question.budget;
                }
                let start = match (members.only(), question.missed) {
                    (Some(variables), Some(rest)) => simulated(variables, state, rest)?,
                    _ => None,
                };
                let start = start.or_else(|| last.start(&model));
                let mut control = Control::default();
                if let Some(start) = &start {
                    control = control.with_start(start);
                }
                let result = model
                    .set_parameters(&handles.values(state))
                    .and_then(|()| solver.solve_with(&model, &mut control))
                    .and_then(|found| settled(&members, &model, found));
                let planned = Planned::of(result, &handles, question.excess)?;
                if let Planned::Found(solution, ..) = &planned
                    && let Some(point) = solution.point()
                {
                    last.take_in(&model, point)?;
                }
                Ok(planned)
            }
        }
    }
}
