//! A model that is solved many times. Work that holds for all values of its parameters is done
//! once.
//!
//! The lowered model is assembled with parameters as columns between the ends of their ranges, and
//! presolved around them. A solve gives these columns their values and passes through the phases of
//! any solve, with what is known already. Solves that speak of all columns begin with the assembled
//! program.

use std::sync::Arc;

use super::answer::answer;
use super::last_solve::LastSolve;
use super::lower::{LoweredProgram, assemble};
use super::mip_start::GivenStart;
use super::proof::check_path;
use super::refusals::Refusals;
use super::row_rounds::{finds_rows, solve_in_rounds};
use super::solve::{EarlierResults, Solve, SolveResult};
use super::tighten::Tightened;
use crate::error::Error;
use crate::model::{Model, Name, Variable};
use crate::presolve::root::{Presolve, PresolveRule, blocks, presolve, presolve_around};
use crate::program::Program;
use crate::reformulate;
use crate::relaxation::CascadePool;
use crate::search::{SearchResult, Start};
use crate::solution::Solution;
use crate::solver::{Control, Options, Prepared, StopToken};

/// A prepared model.
#[derive(Debug)]
pub(super) struct PreparedProgram<'a> {
    options: &'a mut Options,
    model: Model,
    parameters: Vec<Variable>,
    /// The assembled program, in which the columns of the parameters are those of the model.
    lowered: LoweredProgram,
    reduction: Reduction,
    cascades: CascadePool,
}

/// The result of presolve for all values of the parameters.
#[derive(Debug)]
enum Reduction {
    /// Presolve is off.
    Off,
    /// No value of the parameters has a point.
    Infeasible,
    To(Box<ReducedProgram>),
}

#[derive(Debug)]
struct ReducedProgram {
    lowered: LoweredProgram,
    /// The column of each parameter.
    columns: Vec<usize>,
    /// The integral columns, the earliest steps first.
    integers: Vec<usize>,
    /// Whether it falls into blocks, which are searched one after the other.
    in_blocks: bool,
    tightened: Tightened<'static>,
    last: LastSolve,
}

impl<'a> PreparedProgram<'a> {
    /// Lowers and presolves a model.
    pub(super) fn new(options: &'a mut Options, model: &Model) -> Result<Self, Error> {
        options.check()?;
        let rows = reformulate::lower(model)?;
        let (program, form) = assemble(rows.model(), true, true)?;
        let parameters: Vec<Variable> = model.parameters().collect();
        let names: Vec<Name> = rows.model().variables().map(|v| v.name().clone()).collect();
        let lowered = LoweredProgram::new(program, Arc::new(rows.into_way_back()));
        let lowered = lowered.in_form(form);
        let reduction = match options.parts().reductions && !lowered.program.integers.is_empty() {
            true => ReducedProgram::of(options, model, &lowered, &names, &parameters)?,
            false => Reduction::Off,
        };
        let (cascades, model) = (CascadePool::new(options), model.clone());
        Ok(PreparedProgram { options, model, parameters, lowered, reduction, cascades })
    }
}

impl Prepared for PreparedProgram<'_> {
    fn model(&self) -> &Model {
        &self.model
    }

    fn options_mut(&mut self) -> &mut Options {
        self.options
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
        check_path(options)?;
        if let Reduction::To(reduced) = &mut self.reduction {
            (0..control.steps_passed()).for_each(|_| reduced.last.shift());
        }
        if finds_rows(control) {
            return solve_in_rounds(model, options, control);
        }
        let token = &StopToken::new(options.time_limit, control.interrupt());
        if !self.cascades.suits(options) {
            self.cascades = CascadePool::new(options);
        }
        let (cascades, refusals) = (&self.cascades, &Refusals::default());
        let solve = Solve { model, options, token, cascades, refusals, rows: None };
        let given = control.start().map(|given| GivenStart::new(model, given));
        let start = given.as_ref().map(|given| &given.start);
        let is_about_columns = options.pool > 1 || options.parts().keep_leaves;
        let values = values_of(model, &self.parameters)?;
        let solved = match &mut self.reduction {
            // A proof is about the model with these values.
            _ if options.proof_path().is_some() => {
                solve.run(&EarlierResults { start, ..EarlierResults::default() }, control)?
            }
            Reduction::Infeasible if options.parts().reductions => {
                SolveResult::without_point(SearchResult::infeasible())
            }
            Reduction::To(reduced) if options.parts().reductions && !is_about_columns => {
                reduced.solve(&solve, &values, start, control)?
            }
            _ => {
                let program = &mut self.lowered.program;
                let columns = self.parameters.iter().map(|parameter| parameter.index());
                columns.zip(&values).for_each(|(j, &value)| fix(program, j, value));
                program.constant = program.sign * model.objective_constant();
                let lowered = Some(&self.lowered);
                solve
                    .run(&EarlierResults { lowered, start, ..EarlierResults::default() }, control)?
            }
        };
        answer(&solve, solved, given.as_ref())
    }
}

impl ReducedProgram {
    /// Presolves a program around the columns of its parameters, between the ends of their ranges.
    fn of(
        options: &Options,
        model: &Model,
        lowered: &LoweredProgram,
        names: &[Name],
        parameters: &[Variable],
    ) -> Result<Reduction, Error> {
        let mut open = lowered.program.clone();
        let given: Vec<usize> = parameters.iter().map(|parameter| parameter.index()).collect();
        for &parameter in parameters {
            if let Some(range) = model.variable_ref(parameter)?.parameter_range() {
                let j = parameter.index();
                (open.lower[j], open.upper[j]) = (range.lower, range.upper);
            }
        }
        let presolved = match presolve_around(
            &open,
            &given,
            false,
            &PresolveRule::FAITHFUL,
            &StopToken::default(),
        )? {
            Presolve::Infeasible => return Ok(Reduction::Infeasible),
            Presolve::Stopped => return Ok(Reduction::Off),
            Presolve::Presolved(presolved) => *presolved,
        };
        let (program, postsolve) = (presolved.program, presolved.postsolve);
        let place = |j: &usize| postsolve.columns().binary_search(j).ok();
        // A column that stays has a place.
        let Some(columns) = given.iter().map(place).collect::<Option<Vec<usize>>>() else {
            return Ok(Reduction::Off);
        };
        // Columns of cones follow those of variables, and have no names.
        let names: Vec<&Name> = postsolve.columns().iter().filter_map(|&j| names.get(j)).collect();
        let last = LastSolve::new(&names);
        let mut integers = program.integers.clone();
        integers.sort_by_key(|&j| (program.step[j], j));
        let in_blocks = is_in_blocks(&program, &columns)?;
        let whole = options.clone().with_leaves(false);
        let tightened = Tightened::new(&program, &whole, &StopToken::default()).into_owned();
        let lowered = lowered.presolved(program, postsolve, presolved.rounding);
        Ok(Reduction::To(Box::new(ReducedProgram {
            lowered,
            columns,
            integers,
            in_blocks,
            tightened,
            last,
        })))
    }

    /// Solves the model for these values of the parameters, from the user's start or else from what
    /// the last solve has left.
    fn solve(
        &mut self,
        solve: &Solve<'_>,
        values: &[f64],
        given: Option<&Start>,
        control: &mut Control<'_>,
    ) -> Result<SolveResult, Error> {
        let ReducedProgram { lowered, columns, integers, in_blocks, tightened, last } = self;
        for program in [&mut lowered.program, tightened.program.to_mut()] {
            columns.iter().zip(values).for_each(|(&j, &value)| fix(program, j, value));
            program.constant = program.sign * solve.model.objective_constant();
        }
        let given = given.map(|given| lowered.carry(&given.integers));
        let given = given.map(|integers| Start { integers, ..Start::default() });
        let known = EarlierResults { lowered: Some(lowered), ..EarlierResults::default() };
        if *in_blocks {
            return solve.run(&EarlierResults { start: given.as_ref(), ..known }, control);
        }
        let start = match given {
            Some(given) => Start { integers: given.integers, ..last.start() },
            None => last.start(),
        };
        let within = last.expects_few_nodes();
        let within = within.then(|| tightened.within_bounds(solve.options, solve.token));
        let known = EarlierResults {
            is_presolved: true,
            tightened: within.as_ref(),
            start: Some(&start),
            cone_cuts: last.cone_cuts(),
            skips_cuts: last.skips_cuts(),
            facets: last.facets(),
            ..known
        };
        let mut solved = solve.run(&known, control)?;
        last.take_in(&mut solved.found, solved.point.as_deref(), integers);
        Ok(solved)
    }
}

/// The values of some parameters.
fn values_of(model: &Model, parameters: &[Variable]) -> Result<Vec<f64>, Error> {
    let value = |&parameter| Ok(model.variable_ref(parameter)?.bounds().lower);
    parameters.iter().map(value).collect()
}

/// Gives a column one value.
fn fix(program: &mut Program, column: usize, value: f64) {
    (program.lower[column], program.upper[column]) = (value, value);
}

/// Whether a program falls into several blocks with integers once the columns of its parameters
/// have values. Blocks without integers do not count: the program is then searched as a whole,
/// which can begin with the last plan.
fn is_in_blocks(program: &Program, parameters: &[usize]) -> Result<bool, Error> {
    let mut program = program.clone();
    for &j in parameters {
        program.upper[j] = program.lower[j];
    }
    Ok(match presolve(&program, &[PresolveRule::FixedColumns], &StopToken::default())? {
        Presolve::Presolved(presolved) => {
            let blocks = blocks(&presolved.program);
            blocks.iter().filter(|block| !block.program.integers.is_empty()).count() > 1
        }
        _ => false,
    })
}
