//! The default backend: the phases of a solve, from the model to the verified solution.

mod alternation;
mod answer;
mod binary_curvature;
mod blocks;
#[cfg(feature = "nonlinear")]
mod box_proof;
mod convex_objective;
mod curvature_dual;
mod cut;
mod cutoff;
mod equation_squares;
mod events;
mod facets;
mod far;
mod last_solve;
mod lossy;
mod lower;
mod mip_start;
mod multipliers;
#[cfg(feature = "nonlinear")]
mod nonlinear;
mod phases;
mod prepared;
#[cfg(feature = "nonlinear")]
mod prepared_nonlinear;
mod presolve;
pub(crate) mod proof;
mod refusals;
mod restore;
mod row_judge;
mod row_rounds;
mod rows;
mod search;
mod solve;
mod start;
mod tighten;
mod user_cuts;
mod verify;

use crate::error::Error;
use crate::model::Model;
use crate::presolve::Domain;
use crate::program::Program;
use crate::reformulate;
use crate::relaxation::CascadePool;
use crate::search::{SearchResult, SolveTask};
use crate::solution::Solution;
use crate::solver::{Control, Options, Prepared, Solver, StopToken};
use answer::answer;
use mip_start::GivenStart;
#[cfg(feature = "nonlinear")]
use nonlinear::{is_nonlinear, solve_nonlinear};
use prepared::PreparedProgram;
#[cfg(feature = "nonlinear")]
use prepared_nonlinear::PreparedNonlinear;
use proof::check_path;
use refusals::Refusals;
use row_rounds::{finds_rows, solve_in_rounds};
use solve::{EarlierResults, Solve};

/// Branch and bound over continuous relaxations.
///
/// A model is lowered to rows, assembled, presolved and searched. An incumbent is accepted only if
/// it passes the [`Verification`](crate::solution::Verification) against the model, including its
/// implications.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("either");
/// let x = model.continuous("x", 0.0, 10.0)?;
/// let far = model.binary("far")?;
/// model.add("far", far.on().implies(x.ge(7.0)))?;
/// model.add("near", far.off().implies(x.le(2.0)))?;
/// model.minimize((x - 5.0).square())?;
///
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!(solution.is_optimal());
/// assert!((solution.value(x)? - 7.0).abs() < 1e-6);
/// assert!(solution.verification().is_some_and(|v| v.holds()));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
#[doc(alias("MIP solver", "MIQP solver", "MISOCP"))]
pub struct BranchAndBound {
    options: Options,
}

impl BranchAndBound {
    /// A solver with these options.
    pub fn new(options: Options) -> Self {
        BranchAndBound { options }
    }
}

impl Solver for BranchAndBound {
    fn name(&self) -> &str {
        "carom"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        #[cfg(feature = "tracing")]
        let _span = tracing::info_span!("solve", model = model.name()).entered();
        let options = &self.options;
        options.check()?;
        check_path(options)?;
        #[cfg(feature = "nonlinear")]
        if is_nonlinear(model) {
            return solve_nonlinear(model, options, control, None);
        }
        if let Some(rows) = reformulate::with_some_integers(model)? {
            return self.solve_with(&rows, control);
        }
        if finds_rows(control) {
            return solve_in_rounds(model, options, control);
        }
        let token = &StopToken::new(options.time_limit, control.interrupt());
        let (cascades, refusals) = (&CascadePool::new(options), &Refusals::default());
        let solve = Solve { model, options, token, cascades, refusals, rows: None };
        let given = control.start().map(|given| GivenStart::new(model, given));
        let start = given.as_ref().map(|given| &given.start);
        let solved = solve.run(&EarlierResults { start, ..EarlierResults::default() }, control)?;
        answer(&solve, solved, given.as_ref())
    }

    fn prepare<'a>(&'a mut self, model: &Model) -> Result<Box<dyn Prepared + 'a>, Error> {
        #[cfg(feature = "nonlinear")]
        if is_nonlinear(model) {
            return Ok(Box::new(PreparedNonlinear::new(&mut self.options, model)));
        }
        let rows = reformulate::with_some_integers(model)?;
        Ok(Box::new(PreparedProgram::new(&mut self.options, rows.as_ref().unwrap_or(model))?))
    }
}

/// Tightens, cuts and searches the program of a task, for `internals` only.
pub(crate) fn search_tightened(task: SolveTask<'_>) -> SearchResult {
    search::search_once(task, &EarlierResults::default(), &mut Control::default())
}

/// A model that has only rows, with an objective that is convex, for `internals` only.
pub(crate) fn convex_model(model: &Model) -> Result<Model, Error> {
    let domain = Domain::new(&Program::assemble(model)?);
    Ok(convex_objective::convex_form(model, &domain, true)?.model)
}

/// A program with other squares of binaries, for `internals` only.
pub(crate) fn with_raised_squares(program: &Program) -> Option<Program> {
    binary_curvature::with_raised_squares(program)
}
