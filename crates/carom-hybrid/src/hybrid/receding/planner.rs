//! Where plans come from: one prepared program, or one that is built for each step.

use std::sync::Arc;

use web_time::Duration;

use super::guess::{LastIntegers, simulated};
use super::loop_plan::LoopPlan;
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::memory::Memory;
use crate::hybrid::program::{HybridProgram, ProgramSystems, as_drift};
use crate::hybrid::rows::MemoryRow;
use crate::hybrid::system::{InputValues, Measure};
use crate::interval::Interval;
use crate::model::{Affine, Family, Model, Variable};
use crate::solution::{Point, Solution};
use crate::solver::{Control, Prepared, Solver};

/// Where plans come from.
pub(super) enum Planner<'a> {
    /// One program for all steps.
    Receding {
        prepared: Box<dyn Prepared + 'a>,
        /// The steps since its last solve.
        passed: usize,
        handles: Handles,
        systems: Option<Arc<ProgramSystems>>,
    },
    /// A program for each step.
    Built {
        solver: &'a mut dyn Solver,
        build: Box<Build<'a>>,
        clock: Clock,
        last: LastIntegers,
        program: Option<Box<BuiltProgram>>,
    },
}

/// The program of the present step.
pub(super) struct BuiltProgram {
    model: Model,
    systems: Arc<ProgramSystems>,
    handles: Handles,
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
    pub(super) state: &'q [f64],
    pub(super) memory: &'q Memory,
    /// Values of parameters other than the measured state.
    pub(super) parameters: &'q [(Variable, f64)],
    pub(super) budget: Option<Duration>,
    pub(super) excess: Option<&'q Affine>,
    /// The rest of the last plan, where the last step had no plan.
    pub(super) missed: Option<&'q LoopPlan>,
}

/// The variables of a program that a controller reads and writes.
#[derive(Default)]
pub(super) struct Handles {
    pub(super) measured: Vec<Variable>,
    pub(super) states: Vec<Family>,
    pub(super) inputs: Vec<Family>,
    /// The measures of the states and of the inputs.
    measures: [Vec<Measure>; 2],
    /// The values that these inputs take, where they take some only.
    pub(super) values: Vec<Option<InputValues>>,
    /// Parameters that are the limits of rows, from the memory.
    pub(super) memory: Vec<(Variable, MemoryRow)>,
}

impl Handles {
    /// Those of a model without a system.
    pub(super) fn of_model(measured: &[Variable], states: &[Family], inputs: &[Family]) -> Self {
        Handles {
            measured: measured.to_vec(),
            states: states.to_vec(),
            inputs: inputs.to_vec(),
            measures: [states, inputs].map(|families| vec![Measure::PLAIN; families.len()]),
            ..Handles::default()
        }
    }

    /// Adds parameters for the states at the first sample of a program, and for its memory unless
    /// the program states that.
    pub(super) fn measure(program: &mut HybridProgram) -> Result<Self, Error> {
        let HybridProgram { model, systems } = program;
        let mut handles = Handles::default();
        let first = systems.first().computed();
        for (k, (name, own)) in systems.named().enumerate() {
            // Cases begin in the state of the first system.
            let shared = systems.cases.get(name);
            if shared == Some(&0) {
                let what = format!("the number of steps that `{name}` shares");
                let more = ", because a controller applies one input for all cases";
                return Err(Error::out_of_range_with(what, 0.0, 1.0.., more));
            }
            let number = if k == 0 { String::new() } else { format!("{k}_") };
            let states = own.computed().states.iter().zip(own.states()).enumerate();
            for (i, ((name, domain), family)) in states {
                let Some(start) = family.get(0) else { continue };
                let measure = own.coordinates().state(i);
                let middle = 0.0_f64.clamp(domain.lower, domain.upper);
                let called = format!("measured_{number}{}", name.replace(char::is_whitespace, "_"));
                let twin = first.states.iter().position(|(own, _)| own == name);
                if let (Some(twin), Some(_)) = (twin, shared) {
                    let (measured, of_first) = (handles.measured[twin], handles.measures[0][twin]);
                    let row = match measure == of_first {
                        true => (start - measured).equals(0.0),
                        false => {
                            let start = own.in_units(measure, start);
                            let apart = start - own.in_units(of_first, measured);
                            ((1.0 / measure.scale) * apart).equals(0.0)
                        }
                    };
                    model.add(format!("{called}_row").as_str(), row)?;
                    continue;
                }
                let parameter =
                    model.parameter(called.as_str(), middle, domain.lower, domain.upper)?;
                model.add(format!("{called}_row").as_str(), (start - parameter).equals(0.0))?;
                handles.measured.push(parameter);
                handles.states.push(family.clone());
                handles.measures[0].push(measure);
            }
            if shared.is_none() {
                handles.inputs.extend(own.inputs().iter().cloned());
                let count = own.inputs().len();
                handles.measures[1].extend((0..count).map(|u| own.coordinates().input(u)));
                let values = (0..count).map(|u| own.system().values_of_input(u));
                handles.values.extend(values.map(Option::<&_>::cloned));
            }
        }
        if systems.memory.is_none() {
            for (_, prefix, row) in systems.memory_rows() {
                let Interval { lower, upper } = row.range;
                let name = row.name(&["remembered", prefix], "");
                let parameter = model.parameter(name, upper, lower, upper)?;
                let name = row.name(&["remembered", prefix], "row");
                model.add(name, (row.expression.clone() - parameter).le(0.0))?;
                handles.memory.push((parameter, row));
            }
        }
        Ok(handles)
    }

    fn values(&self, question: &Question<'_>) -> Vec<(Variable, f64)> {
        let state = question.state.iter().zip(&self.measures[0]);
        let state = state.map(|(x, measure)| measure.inward(*x));
        let memory = self.memory.iter();
        let memory = memory.map(|(parameter, row)| (*parameter, row.limit(question.memory)));
        self.measured.iter().copied().zip(state).chain(memory).collect()
    }

    /// The values of families, by step.
    fn read(
        families: &[Family],
        measures: &[Measure],
        point: &Point,
    ) -> Result<Vec<Vec<f64>>, Error> {
        let steps = families.iter().map(Family::len).min().unwrap_or(0);
        let at = |t: usize| {
            let own = families.iter().zip(measures);
            own.map(|(family, measure)| Ok(measure.outward(point.value(family[t])?))).collect()
        };
        (0..steps).map(at).collect()
    }
}

/// The result of planning.
pub(super) enum Planned {
    /// A solution with its plan and excess.
    Found(Box<Solution>, LoopPlan, Option<f64>),
    /// No point, and why.
    Nothing(Option<Box<Solution>>, String),
}

impl Planned {
    fn of(
        result: Result<Solution, Error>,
        handles: &Handles,
        systems: Option<&ProgramSystems>,
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
        let mut plan = LoopPlan {
            states: Handles::read(&handles.states, &handles.measures[0], point)?,
            inputs: Handles::read(&handles.inputs, &handles.measures[1], point)?,
            ..LoopPlan::default()
        };
        for (u, values) in handles.values.iter().enumerate() {
            let Some(values) = values else { continue };
            let own = plan.inputs.iter_mut().filter_map(|input| input.get_mut(u));
            own.for_each(|value| *value = values.nearest(*value));
        }
        if let Some(systems) = systems {
            plan.choose(systems, point)?;
            if let Some(steps) = systems.integer_steps {
                plan = plan.head(steps);
            }
        }
        let excess = excess.map(|excess| point.value(excess)).transpose()?;
        Ok(Planned::Found(solution, plan, excess))
    }
}

/// The solution whose states are the run of its inputs, without a second solve.
fn settled(systems: &ProgramSystems, model: &Model, solution: Solution) -> Result<Solution, Error> {
    Ok(systems.settled(model, &solution, None)?.into_owned())
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
            Planner::Receding { passed, .. } => *passed += 1,
            Planner::Built { clock, last, .. } => {
                last.shift();
                match clock {
                    Clock::Left(left) => *left -= 1,
                    Clock::Passed(passed) => *passed += 1,
                }
            }
        }
    }

    /// The systems of the present step, if there are any.
    pub(super) fn systems(&self) -> Option<&ProgramSystems> {
        match self {
            Planner::Receding { systems, .. } => systems.as_deref(),
            Planner::Built { program, .. } => program.as_ref().map(|own| &*own.systems),
        }
    }

    fn handles(&self) -> Option<&Handles> {
        match self {
            Planner::Receding { handles, .. } => Some(handles),
            Planner::Built { program, .. } => program.as_ref().map(|own| &own.handles),
        }
    }

    /// Builds the program of a step, if each step has its own. What that says of the memory of its
    /// start takes the place of what is remembered.
    pub(super) fn begin(&mut self, number: usize, memory: &mut Memory) -> Result<(), Error> {
        if let Planner::Built { build, clock, program, .. } = self {
            let step = match clock {
                Clock::Left(0) => {
                    let (what, number) = ("the step of a shrinking horizon", number as f64);
                    let range = "before its end";
                    return Err(Error::out_of_range_in_words(what, number, ..number, range));
                }
                Clock::Left(left) => *left,
                Clock::Passed(passed) => *passed,
            };
            let mut own = build(step)?;
            match &own.systems.memory {
                Some(told) => *memory = told.clone(),
                None => {
                    for told in own.systems.told_modes(&own.model, memory) {
                        memory.forget(&told);
                    }
                }
            }
            let handles = Handles::measure(&mut own)?;
            let HybridProgram { model, systems } = own;
            *program = Some(Box::new(BuiltProgram { model, systems, handles }));
        }
        if self.systems().is_some_and(|systems| systems.modes_follow_states) {
            *memory = Memory::default().with_events(memory.events);
        }
        match self.systems() {
            Some(systems) => memory.check_choices(&systems.choices()),
            None => Ok(()),
        }
    }

    /// The ranges of the measured states.
    pub(super) fn ranges(&self) -> Result<Vec<Interval>, Error> {
        let model = match self {
            Planner::Receding { prepared, .. } => Some(prepared.model()),
            Planner::Built { program, .. } => program.as_ref().map(|own| &own.model),
        };
        let measured = self.handles().map_or(&[][..], |handles| &handles.measured);
        let range = |parameter: &Variable| -> Result<Interval, Error> {
            let Some(model) = model else { return Ok(Interval::REALS) };
            let range = model.variable_ref(*parameter)?.parameter_range();
            Ok(range.unwrap_or(Interval::REALS))
        };
        measured.iter().map(range).collect()
    }

    /// Plans from a state by the program of the present step.
    pub(super) fn plan(&mut self, question: &Question<'_>) -> Result<Planned, Error> {
        let measured = self.handles().map_or(0, |handles| handles.measured.len());
        check_length("the measured state", question.state.len(), measured)?;
        let start = match (self.systems().and_then(ProgramSystems::only), question.missed) {
            (Some(variables), Some(rest)) => {
                simulated(variables, question.state, question.memory, rest)?
            }
            _ => None,
        };
        match self {
            Planner::Receding { prepared, handles, systems, passed } => {
                if question.budget.is_some() {
                    prepared.options_mut().time_limit = question.budget;
                }
                let mut values = handles.values(question);
                values.extend(question.parameters);
                let mut control = Control::default().with_steps_passed(std::mem::take(passed));
                if let Some(start) = &start {
                    control = control.with_start(start);
                }
                let result = prepared.solve(&values, &mut control);
                let model = prepared.model();
                let result = match systems.as_deref() {
                    Some(systems) => result.and_then(|found| settled(systems, model, found)),
                    None => result,
                };
                Planned::of(result, handles, systems.as_deref(), question.excess)
            }
            Planner::Built { solver, last, program, .. } => {
                let Some(BuiltProgram { model, systems, handles }) = program.as_deref_mut() else {
                    return Ok(Planned::Nothing(None, "there is no program".to_owned()));
                };
                if question.budget.is_some() {
                    solver.options_mut().time_limit = question.budget;
                }
                let start = start.or_else(|| last.start(model));
                let mut control = Control::default();
                if let Some(start) = &start {
                    control = control.with_start(start);
                }
                let result = model
                    .set_parameters(&handles.values(question))
                    .and_then(|()| solver.solve_with(model, &mut control))
                    .and_then(|found| settled(systems, model, found));
                let planned = Planned::of(result, handles, Some(systems), question.excess)?;
                if let Planned::Found(solution, ..) = &planned
                    && let Some(point) = solution.point()
                {
                    last.take_in(model, point)?;
                }
                Ok(planned)
            }
        }
    }
}
