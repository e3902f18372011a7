//! A model that is solved many times: what holds for all values of its parameters is done once.
//!
//! The lowered model is assembled with parameters as columns between the ends of their ranges, and
//! presolved around them. A solve gives these columns their values and goes on from there, with
//! all that the values imply. Solves that speak of the tree or of all columns begin with the
//! assembled program instead, as solves from nothing do.

use super::answer::answer;
use super::curvature::check_curvature;
use super::history::History;
use super::pipeline::Pipeline;
use super::refusals::Refusals;
use super::row_rounds::{finds_rows, solve_in_rounds};
use super::seeding::{report, seed_of};
use super::stage::{Stage, Tightened};
use crate::error::Error;
use crate::model::{Model, Name, Variable};
use crate::presolve::root::{Postsolve, Presolve, Rule, blocks, presolve, presolve_around};
use crate::program::Program;
use crate::reformulate::{self, WayBack};
use crate::relaxation::LadderPool;
use crate::search::{ColumnGuidance, Found, GuessEnd, Seed, Start};
use crate::solution::{Heuristic, Solution, Termination};
use crate::solver::{BranchingRule, Control, Options, Prepared, StopToken, TreeSeed};

/// A prepared model.
#[derive(Debug)]
pub(super) struct PreparedProgram<'a> {
    options: &'a mut Options,
    model: Model,
    lowered: LoweredProgram,
    reduced: Reduced,
    ladders: LadderPool,
}

/// The assembled program of a lowered model.
#[derive(Debug)]
struct LoweredProgram {
    program: Program,
    way_back: WayBack,
    /// The parameters, whose columns are those of the model.
    parameters: Vec<Variable>,
}

/// The result of presolve for all values of the parameters.
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
    /// The columns of parameters have their last values.
    program: Program,
    postsolve: Postsolve,
    rounding: f64,
    /// The column of each parameter.
    columns: Vec<usize>,
    /// The integral columns, the earliest steps first.
    integers: Vec<usize>,
    /// Whether it falls into blocks, which are searched one after the other.
    in_blocks: bool,
    tightened: Tightened,
    history: History,
}

impl<'a> PreparedProgram<'a> {
    /// Lowers and presolves a model.
    pub(super) fn new(options: &'a mut Options, model: &Model) -> Result<Self, Error> {
        options.check()?;
        let lowered = reformulate::lower(model)?;
        let program = Program::assemble(lowered.model())?;
        check_curvature(model, &program, true)?;
        let parameters: Vec<Variable> = model.parameters().collect();
        let reduced = match options.reductions && !program.integers.is_empty() {
            true => ReducedProgram::of(options, model, lowered.model(), &program, &parameters)?,
            false => Reduced::Not,
        };
        let lowered = LoweredProgram { program, way_back: lowered.into_way_back(), parameters };
        let ladders = LadderPool::new(options);
        Ok(PreparedProgram { options, model: model.clone(), lowered, reduced, ladders })
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
        if let Reduced::To(reduced) = &mut self.reduced {
            reduced.history.shift();
        }
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
        if finds_rows(control) {
            return solve_in_rounds(model, options, control);
        }
        let token = StopToken::new(options.time_limit, control.interrupt());
        let guidance = ColumnGuidance::new(model, control.guidance())?;
        let given = control.seed().map(|seed: &TreeSeed| seed_of(model, seed));
        let seed = given.as_ref().map(|(seed, _)| seed);
        if !self.ladders.suits(options) {
            self.ladders = LadderPool::new(options);
        }
        let (guidance, ladders, token) = (&guidance, &self.ladders, &token);
        let (refusals, judge) = (&Refusals::default(), None);
        let pipeline = Pipeline { model, options, token, guidance, ladders, refusals, judge, seed };
        let about_columns = pipeline.is_about_columns() || !guidance.is_idle();
        let (mut found, derivatives) = match &mut self.reduced {
            Reduced::Infeasible if options.reductions => (Found::infeasible(), None),
            Reduced::To(reduced) if options.reductions && !about_columns => {
                (reduced.solve(&self.lowered, &pipeline, control)?, None)
            }
            _ => {
                let LoweredProgram { program, way_back, parameters } = &self.lowered;
                let mut program = program.clone();
                for parameter in parameters {
                    let value = model.variable_ref(*parameter)?.bounds().lower;
                    let j = parameter.index();
                    (program.lower[j], program.upper[j]) = (value, value);
                }
                pipeline.run_program(program, &|values| way_back.restore(values), control)?
            }
        };
        found.statistics.time = token.elapsed();
        let report = given.as_ref().map(|(seed, ignored)| report(model, &found, seed, *ignored));
        answer(model, options, found, derivatives, report, refusals.take())
    }
}

impl ReducedProgram {
    /// Presolves a program around the columns of its parameters, between the ends of their ranges.
    fn of(
        options: &Options,
        model: &Model,
        lowered: &Model,
        program: &Program,
        parameters: &[Variable],
    ) -> Result<Reduced, Error> {
        let mut open = program.clone();
        let given: Vec<usize> = parameters.iter().map(|parameter| parameter.index()).collect();
        for &parameter in parameters {
            if let Some(range) = model.variable_ref(parameter)?.parameter_range() {
                let j = parameter.index();
                (open.lower[j], open.upper[j]) = (range.lower, range.upper);
            }
        }
        let presolved =
            match presolve_around(&open, &given, &Rule::FAITHFUL, &StopToken::default())? {
                Presolve::Infeasible => return Ok(Reduced::Infeasible),
                Presolve::Stopped => return Ok(Reduced::Not),
                Presolve::Presolved(presolved) => *presolved,
            };
        let (program, postsolve) = (presolved.program, presolved.postsolve);
        let place = |j: &usize| postsolve.columns().binary_search(j).ok();
        // A column that stays has a place.
        let Some(columns) = given.iter().map(place).collect::<Option<Vec<usize>>>() else {
            return Ok(Reduced::Not);
        };
        let names: Vec<&Name> = lowered.variables().map(|variable| variable.name()).collect();
        let columns_of: Vec<&Name> = postsolve.columns().iter().map(|&j| names[j]).collect();
        let history = History::new(&columns_of);
        let mut integers = program.integers.clone();
        integers.sort_by_key(|&j| (program.step[j], j));
        let in_blocks = is_in_blocks(&program, &columns)?;
        let rounding = presolved.rounding;
        let tightened = Tightened::new(&program, options, &StopToken::default());
        Ok(Reduced::To(Box::new(ReducedProgram {
            program,
            postsolve,
            rounding,
            columns,
            integers,
            in_blocks,
            tightened,
            history,
        })))
    }

    /// Searches for the present values of the parameters.
    fn solve(
        &mut self,
        lowered: &LoweredProgram,
        pipeline: &Pipeline<'_>,
        control: &mut Control<'_>,
    ) -> Result<Found, Error> {
        let (program, postsolve) = (&mut self.program, &self.postsolve);
        for (&column, &parameter) in self.columns.iter().zip(&lowered.parameters) {
            let value = pipeline.model.variable_ref(parameter)?.bounds().lower;
            for program in [&mut *program, &mut self.tightened.program] {
                (program.lower[column], program.upper[column]) = (value, value);
            }
        }
        program.constant = program.sign * pipeline.model.objective_constant();
        self.tightened.program.constant = program.constant;
        let restore = |values: &[f64]| lowered.way_back.restore(&postsolve.point(values));
        let carried = |seed: &Seed| Seed { guess: postsolve.carry(&seed.guess), ..Seed::default() };
        let given = pipeline.seed.map(carried);
        let guidance = pipeline.guidance.presolved(postsolve, &lowered.program);
        let mut found = if self.in_blocks {
            let inner = Pipeline { seed: given.as_ref(), guidance: &guidance, ..*pipeline };
            inner.run_program(program.clone(), &restore, control)?.0
        } else {
            let stage = Stage {
                model: pipeline.model,
                options: pipeline.options,
                token: pipeline.token,
                guidance: &guidance,
                ladders: pipeline.ladders,
                refusals: pipeline.refusals,
                judge: None,
                program,
                restore: &restore,
                as_is: false,
                tightened: self.history.expects_few_nodes().then_some(&self.tightened),
                strengthens: self.history.tries_cuts(),
            };
            let own = self.history.seed();
            let guess = given.map_or(own.guess, |given| given.guess);
            let root_first = self.history.expects_no_tree();
            let mut found = search_from(&stage, Seed { guess, ..own }, root_first, control);
            self.history.take_in(&mut found, &self.integers);
            found.points = found.points.iter().map(|values| restore(values)).collect();
            if let Some(GuessEnd::Point(values)) = &mut found.guess {
                *values = restore(values);
            }
            found
        };
        if let Some(GuessEnd::Contradiction(column)) = &mut found.guess {
            *column = postsolve.columns().get(*column).copied().unwrap_or(*column);
        }
        if found.guess.is_none() && pipeline.seed.is_some_and(|seed| !seed.guess.is_empty()) {
            // Presolve has decided all that was guessed.
            found.guess = found.points.first().cloned().map(GuessEnd::Point);
        }
        pipeline.charge(self.rounding, &mut found)?;
        Ok(found)
    }
}

/// Completes the guess of a seed, and searches from there. A search that is stopped before it has
/// looked at a point returns the completed one, and the bound that the last root proves. Where it may be
/// stopped, a point is looked for before anything else even without a guess.
///
/// # Arguments
///
/// * `root_first`: whether it looks no further than the root at first.
fn search_from(
    stage: &Stage<'_>,
    mut seed: Seed,
    root_first: bool,
    control: &mut Control<'_>,
) -> Found {
    let begun = (stage.options.may_stop() || !seed.guess.is_empty()).then(|| stage.complete(&seed));
    if let Some(begun) = &begun {
        seed.guess.clear();
        seed.point = start_of(begun, begun.found_by.unwrap_or(Heuristic::Guess));
    }
    // Callbacks would see two searches.
    let may_search_twice = stage.options.node_limit.is_none() && !control.is_watched();
    let mut found = if root_first && may_search_twice {
        search_root_first(stage, &mut seed, control)
    } else {
        stage.run(control, Some(&seed))
    };
    if let Some(begun) = begun {
        found.guess.clone_from(&begun.guess);
        go_on_from(begun, &mut found);
    }
    found
}

/// Searches no further than the root, and tightens the program for the values of the parameters if that
/// is not enough: if a tree is unexpected, tightening is likely to save it.
fn search_root_first(stage: &Stage<'_>, seed: &mut Seed, control: &mut Control<'_>) -> Found {
    let (node_limit, branching) = (Some(1), BranchingRule::LatestFirst);
    let options = &Options { node_limit, branching, ..stage.options.clone() };
    let mut root = Stage { options, strengthens: false, ..*stage }.run(control, Some(seed));
    if !matches!(root.termination, Termination::NodeLimit | Termination::Stalled) {
        return root;
    }
    let point = start_of(&root, root.found_by.unwrap_or(Heuristic::Rounding));
    seed.point = point.or(seed.point.take());
    let mut found = Stage { tightened: None, ..*stage }.run(control, Some(seed));
    // It has the same root.
    root.statistics.nodes -= root.statistics.nodes.min(1);
    go_on_from(root, &mut found);
    found
}

/// The best point of a search, as the start of another one.
fn start_of(found: &Found, found_by: Heuristic) -> Option<Start> {
    let values = found.points.first()?.clone();
    Some(Start { values, found_by })
}

/// Adds what a search knew that another one has begun with.
fn go_on_from(begun: Found, found: &mut Found) {
    let mut counts = begun.statistics;
    if found.points.is_empty() && found.termination != Termination::Infeasible {
        (found.points, found.found_by) = (begun.points, begun.found_by);
    } else {
        counts.forget_incumbents();
    }
    found.statistics.add(&counts);
    if found.termination.is_limit() && begun.bound.is_finite() {
        found.bound = found.bound.max(begun.bound);
    }
}

/// Whether a program falls into blocks with integers once the columns of its parameters have values. What
/// has none is searched with the others: a block would not begin with the last plan.
fn is_in_blocks(program: &Program, parameters: &[usize]) -> Result<bool, Error> {
    let mut program = program.clone();
    for &j in parameters {
        program.upper[j] = program.lower[j];
    }
    Ok(match presolve(&program, &[Rule::FixedColumns], &StopToken::default())? {
        Presolve::Presolved(presolved) => {
            let blocks = blocks(&presolved.program);
            blocks.iter().filter(|block| !block.program.integers.is_empty()).count() > 1
        }
        _ => false,
    })
}
