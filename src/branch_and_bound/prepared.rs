//! A model that is solved many times: what holds for all values of its parameters is done once.
//!
//! The lowered model is assembled with parameters as columns between the ends of their ranges, and
//! presolved around them. A solve gives these columns their values and goes on from there, with
//! all that the values imply. Solves that speak of the tree or of all columns begin with the
//! assembled program instead, as solves from nothing do.

use super::answer;
use super::history::History;
use super::pipeline::Pipeline;
use super::seeding::{report, seed_of};
use crate::error::Error;
use crate::model::{Model, Variable};
use crate::presolve::root::{Postsolve, Presolve, Rule, presolve_around};
use crate::program::Program;
use crate::reformulate::{self, WayBack};
use crate::search::{ColumnGuidance, Found, GuessEnd, Seed};
use crate::solution::{Solution, Termination};
use crate::solver::{Control, Options, Prepared, StopToken, TreeSeed};

/// A prepared model.
#[derive(Debug)]
pub(super) struct PreparedProgram<'a> {
    options: &'a mut Options,
    model: Model,
    /// The lowered model; the columns of parameters have their last values.
    program: Program,
    way_back: WayBack,
    parameters: Vec<Variable>,
    reduced: Reduced,
    history: History,
}

/// What presolve has left, for all values of the parameters.
#[derive(Debug)]
enum Reduced {
    /// Presolve is off.
    Not,
    /// No value of the parameters has a point.
    Infeasible,
    To(Box<ReducedProgram>),
}

#[derive(Debug)]
struct ReducedProgram {
    program: Program,
    postsolve: Postsolve,
    rounding: f64,
    /// The column of each parameter.
    columns: Vec<usize>,
}

impl<'a> PreparedProgram<'a> {
    /// Lowers and presolves a model.
    pub(super) fn new(options: &'a mut Options, model: &Model) -> Result<Self, Error> {
        options.check()?;
        let lowered = reformulate::lower(model)?;
        let program = Program::assemble(lowered.model())?;
        let parameters: Vec<Variable> = model.parameters().collect();
        let reduced = match options.reductions && !program.integers.is_empty() {
            true => reduce(model, &program, &parameters)?,
            false => Reduced::Not,
        };
        let history = History::new(model);
        let (model, way_back) = (model.clone(), lowered.into_way_back());
        Ok(PreparedProgram { options, model, program, way_back, parameters, reduced, history })
    }

    /// Searches what presolve has left.
    fn run_reduced(
        &self,
        pipeline: Pipeline<'_>,
        reduced: &ReducedProgram,
        control: &mut Control<'_>,
    ) -> Result<Found, Error> {
        let ReducedProgram { program, postsolve, rounding, columns } = reduced;
        let mut program = program.clone();
        for (&column, &parameter) in columns.iter().zip(&self.parameters) {
            let value = self.model.variable_ref(parameter)?.bounds().lower;
            (program.lower[column], program.upper[column]) = (value, value);
        }
        let seed = pipeline
            .seed
            .map(|seed| Seed { guess: postsolve.carry(&seed.guess), ..Seed::default() });
        let restore = |values: &[f64]| self.way_back.restore(&postsolve.point(values));
        let held = match &seed {
            Some(seed) if pipeline.options.time_limit.is_some() => {
                hold(&pipeline, program.clone(), seed, &restore)?
            }
            _ => None,
        };
        let inner = Pipeline { seed: seed.as_ref(), ..pipeline };
        let (mut found, _) = inner.run_program(program, &restore, control)?;
        if let Some(held) = held {
            found.statistics.add(&held.statistics);
            if found.points.is_empty() && found.termination != Termination::Infeasible {
                found.points = held.points;
            }
        }
        if let Some(GuessEnd::Contradiction(column)) = &mut found.guess {
            *column = postsolve.columns().get(*column).copied().unwrap_or(*column);
        }
        if found.guess.is_none() && pipeline.seed.is_some_and(|seed| !seed.guess.is_empty()) {
            // Presolve has decided all that was guessed.
            found.guess = found.points.first().cloned().map(GuessEnd::Point);
        }
        pipeline.charge(*rounding, &mut found)?;
        Ok(found)
    }
}

impl Prepared for PreparedProgram<'_> {
    fn model(&self) -> &Model {
        &self.model
    }

    fn options_mut(&mut self) -> &mut Options {
        self.options
    }

    fn shift(&mut self) {
        self.history.shift();
    }

    fn solve(
        &mut self,
        parameters: &[(Variable, f64)],
        control: &mut Control<'_>,
    ) -> Result<Solution, Error> {
        #[cfg(feature = "tracing")]
        let _span = tracing::info_span!("solve", model = self.model.name()).entered();
        self.model.set_parameters(parameters)?;
        let (model, options) = (&self.model, &*self.options);
        options.check()?;
        let token = StopToken::new(options.time_limit, control.interrupt());
        let guidance = ColumnGuidance::new(model, control.guidance())?;
        let given = control.seed().map(|seed: &TreeSeed| seed_of(model, seed));
        let seed = given.as_ref().map(|(seed, _)| seed);
        let own = self.history.seed().filter(|_| seed.is_none());
        let pipeline = Pipeline { model, options, token: &token, guidance: &guidance, seed };
        let about_columns = pipeline.is_about_columns() || !guidance.is_idle();
        let (mut found, derivatives) = match &self.reduced {
            Reduced::Infeasible if options.reductions => (Found::infeasible(), None),
            Reduced::To(reduced) if options.reductions && !about_columns => {
                let pipeline = Pipeline { seed: seed.or(own.as_ref()), ..pipeline };
                (self.run_reduced(pipeline, reduced, control)?, None)
            }
            _ => {
                let mut program = self.program.clone();
                for parameter in &self.parameters {
                    let value = model.variable_ref(*parameter)?.bounds().lower;
                    let j = parameter.index();
                    (program.lower[j], program.upper[j]) = (value, value);
                }
                let restore = |values: &[f64]| self.way_back.restore(values);
                pipeline.run_program(program, &restore, control)?
            }
        };
        self.history.take_in(&self.model, &found);
        found.statistics.time = token.elapsed();
        let report = given.as_ref().map(|(seed, ignored)| report(model, &found, seed, *ignored));
        answer(model, options, found, derivatives, report)
    }
}

/// The best point with the integers of a start: what a search returns that is stopped before it has
/// looked at the start. With the integers held, presolve leaves next to nothing.
fn hold(
    pipeline: &Pipeline<'_>,
    mut program: Program,
    start: &Seed,
    restore: &(dyn Fn(&[f64]) -> Vec<f64> + Sync),
) -> Result<Option<Found>, Error> {
    for &(column, value) in &start.guess {
        if value < program.lower[column] || value > program.upper[column] {
            return Ok(None);
        }
        (program.lower[column], program.upper[column]) = (value, value);
    }
    let alone = Pipeline { seed: None, ..*pipeline };
    let (found, _) = alone.run_program(program, restore, &mut Control::default())?;
    Ok((!found.points.is_empty()).then_some(found))
}

/// Presolves a program around the columns of its parameters, between the ends of their ranges.
fn reduce(model: &Model, program: &Program, parameters: &[Variable]) -> Result<Reduced, Error> {
    let mut open = program.clone();
    let given: Vec<usize> = parameters.iter().map(|parameter| parameter.index()).collect();
    for &parameter in parameters {
        if let Some(range) = model.variable_ref(parameter)?.parameter_range() {
            let j = parameter.index();
            (open.lower[j], open.upper[j]) = (range.lower, range.upper);
        }
    }
    let rules = &Rule::FAITHFUL;
    match presolve_around(&open, &given, rules, &StopToken::default())? {
        Presolve::Infeasible => Ok(Reduced::Infeasible),
        Presolve::Stopped => Ok(Reduced::Not),
        Presolve::Presolved(presolved) => {
            let place = |j: &usize| presolved.postsolve.columns().binary_search(j).ok();
            // A column that stays has a place.
            let Some(columns) = given.iter().map(place).collect() else { return Ok(Reduced::Not) };
            let presolved = *presolved;
            Ok(Reduced::To(Box::new(ReducedProgram {
                program: presolved.program,
                postsolve: presolved.postsolve,
                rounding: presolved.rounding,
                columns,
            })))
        }
    }
}
