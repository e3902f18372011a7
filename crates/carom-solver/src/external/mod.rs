//! Solvers that run as separate programs and exchange files.
//!
//! [`ExternalSolver`] is a [`Solver`] that runs CBC, GLPK, HiGHS, SCIP or any other program on the
//! `PATH` for which you implement a [`Dialect`]. It writes the model as an MPS file and reads the
//! answer back. Nothing is linked or installed. Models are [lowered](crate::reformulate::lower)
//! first, so a program without indicators or logic can still solve any model; only quadratic
//! objectives and cones need a program that takes them.
//!
//! Points are never trusted: the integers are rounded, [`BranchAndBound`] solves the rest again,
//! and the meaning of every statement is checked ([`certify`]). A claim that the program is
//! unbounded is believed if the program also finds a point when it is run again without the
//! objective. Bounds and claims of infeasibility cannot be checked; they hold up to the tolerances
//! of the program.
//!
//! ```no_run
//! use carom::external::ExternalSolver;
//! use carom::prelude::*;
//!
//! let mut model = Model::new("knapsack");
//! let take = model.binary_family("take", 3)?;
//! model.add("room", (2.0 * take[0] + 3.0 * take[1] + 4.0 * take[2]).le(6.0))?;
//! model.maximize(3.0 * take[0] + 4.0 * take[1] + 6.0 * take[2])?;
//! let solution = ExternalSolver::cbc().solve(&model)?;
//! assert_eq!(solution.objective(), Some(9.0));
//! # Ok::<(), carom::Error>(())
//! ```

mod dialect;
mod process;
mod programs;
mod translate;

pub use dialect::{Dialect, ExternalAnswer, Files, SolverClaim};
pub use programs::{Cbc, Glpk, Highs, Scip};

use crate::branch_and_bound::BranchAndBound;
use crate::error::{Error, ErrorKind};
use crate::model::{Model, Name};
use crate::reformulate;
use crate::setters::setters;
use crate::solution::{Outcome, Solution, Statistics, Termination};
use crate::solver::{Control, Event, Options, Progress, Solver, StopToken, certify};

/// A solver that runs as a separate program.
#[derive(Debug)]
pub struct ExternalSolver {
    dialect: Box<dyn Dialect>,
    program: String,
    options: Options,
}

impl ExternalSolver {
    /// A solver that speaks this dialect. The program has the usual name of the dialect.
    pub fn new(dialect: impl Dialect + 'static) -> Self {
        let program = dialect.program().to_owned();
        ExternalSolver { dialect: Box::new(dialect), program, options: Options::default() }
    }

    /// COIN-OR CBC: mixed-integer linear programs.
    pub fn cbc() -> Self {
        Self::new(Cbc)
    }

    /// GLPK: mixed-integer linear programs.
    pub fn glpk() -> Self {
        Self::new(Glpk)
    }

    /// HiGHS: mixed-integer linear programs.
    pub fn highs() -> Self {
        Self::new(Highs)
    }

    /// SCIP: mixed-integer linear and quadratic programs, also with quadratic rows and cones.
    pub fn scip() -> Self {
        Self::new(Scip)
    }

    setters! {
        /// Sets the options.
        with_options(options: Options) => options = options;
        /// Sets the name or the path of the program.
        with_program(program: impl Into<String>) => program = program.into();
    }
}

impl Solver for ExternalSolver {
    fn name(&self) -> &str {
        self.dialect.program()
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    /// # Errors
    ///
    /// Besides those of every solver, [`ErrorKind::Io`] when the program cannot be started or its
    /// files cannot be written or read, [`ErrorKind::Unsupported`] for a quadratic objective or
    /// cones that it does not take, and [`ErrorKind::Backend`] when it fails or its dialect cannot
    /// read the answer.
    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        self.options.check()?;
        control.refuse_lazy_constraints(self.name())?;
        if let Some(rows) = reformulate::with_some_integers(model)? {
            return self.solve_with(&rows, control);
        }
        let token = StopToken::new(self.options.time_limit, control.interrupt());
        let Some(lowered) = reformulate::lower_until(model, None, &token)? else {
            return stopped(model, &self.options, &token);
        };
        if !self.dialect.takes_quadratic() && !lowered.model().objective().products().is_empty() {
            return Err(ErrorKind::Unsupported {
                solver: self.program.clone(),
                what: "a quadratic objective".into(),
                help: "solve it with `BranchAndBound`, or give it a linear one".into(),
            }
            .into());
        }
        if !self.dialect.takes_cones()
            && let Some(conic) = lowered.model().conic_constraints().next()
        {
            return Err(cones_unsupported(&self.program, conic.name()));
        }
        let Some(translated) = translate::translate(lowered.model())? else {
            let (termination, values) = (Termination::Infeasible, None);
            let bound = model.sense().sign() * f64::INFINITY;
            let mut statistics = Statistics::default();
            statistics.time = token.elapsed();
            let outcome = Outcome::new(termination, values, bound, statistics);
            return Solution::new(model, outcome, self.options.feasibility);
        };
        // Certifying the point may use up the other half of the gap.
        let constant =
            if translated.offset == 0.0 { model.objective_constant() } else { translated.offset };
        let options = with_half_the_gap(&self.options, constant);
        let ask = |text: &str| {
            let run = process::ProgramRun {
                dialect: &*self.dialect,
                program: &self.program,
                options: &options,
                token: &token,
            };
            run.answer(text)
        };
        let (mut answer, mut stopped) = ask(&translated.text)?;
        if answer.claim == SolverClaim::Unbounded && stopped.is_none() {
            // It may have found only an unbounded direction and no feasible point.
            let mut any = lowered.model().clone();
            any.minimize(0.0)?;
            if let Some(any) = translate::translate(&any)? {
                (answer, stopped) = ask(&any.text)?;
                (answer.objective, answer.bound) = (None, None);
                if answer.claim == SolverClaim::Optimal {
                    answer.claim = SolverClaim::Unbounded;
                }
            }
        }
        let (termination, bound) = judged(&options, &answer, stopped, &translated);
        let values = answer.values.as_ref().map(|found| translated.values(found)).transpose();
        let values = values.map_err(|message| {
            Error::from(ErrorKind::Backend { solver: self.program.clone(), message })
        })?;
        let values = values.map(|values| lowered.restore(&values));
        let mut statistics = Statistics::default();
        statistics.nodes = answer.nodes.unwrap_or(0);
        let claimed = Outcome::new(termination, values, bound, statistics);
        settled(model, claimed, &self.options, &token, control)
    }
}

/// The error of a solver that takes no cones.
pub(crate) fn cones_unsupported(solver: &str, name: &Name) -> Error {
    ErrorKind::Unsupported {
        solver: solver.into(),
        what: format!("norms and quadratic rows such as `{name}`"),
        help: "solve it with `BranchAndBound`, or write linear rows in their place".into(),
    }
    .into()
}

/// The answer if a limit came before the other solver was asked.
pub(crate) fn stopped(
    model: &Model,
    options: &Options,
    token: &StopToken,
) -> Result<Solution, Error> {
    let termination = token.ended().unwrap_or(Termination::Interrupted);
    let bound = -model.sense().sign() * f64::INFINITY;
    let mut statistics = Statistics::default();
    statistics.time = token.elapsed();
    let outcome = Outcome::new(termination, None, bound, statistics);
    Solution::new(model, outcome, options.feasibility)
}

/// The options with half the gap. The other solver measures its relative gap without the constant
/// of the objective, so with a constant only the absolute gap is passed on.
pub(crate) fn with_half_the_gap(options: &Options, constant: f64) -> Options {
    let (relative, absolute) = (0.5 * options.relative_gap, 0.5 * options.absolute_gap);
    let relative = if constant == 0.0 { relative } else { 0.0 };
    options.clone().with_relative_gap(relative).with_absolute_gap(absolute)
}

/// The solution that the claims of another solver amount to once its point is certified. A claim of
/// optimality needs a certified point that meets the gap, a claim of unboundedness any certified
/// point.
pub(crate) fn settled(
    model: &Model,
    claimed: Outcome,
    options: &Options,
    token: &StopToken,
    control: &mut Control<'_>,
) -> Result<Solution, Error> {
    let sign = model.sense().sign();
    let Outcome { mut termination, mut values, mut bound, mut statistics, .. } = claimed;
    let mut certified = None;
    if let Some(found) = values.take() {
        let mut options = options.clone();
        (options.time_limit, options.node_limit) = (None, None);
        let certificate = certify(model, &found, &mut BranchAndBound::new(options))?;
        let solution = certificate.solution();
        certified = solution.objective();
        values = solution.point().map(|point| point.as_slice().to_vec());
    }
    match (termination, certified) {
        (Termination::Unbounded, None) => termination = Termination::Stalled,
        (Termination::Unbounded | Termination::Infeasible, _) | (_, None) => {}
        (_, Some(objective)) => {
            // A certified point is better than the bound by tolerances only.
            bound = sign * (sign * bound).min(sign * objective);
            let gap = options.allowed_gap(objective, model.objective_constant());
            if termination == Termination::Optimal && sign * (objective - bound) > gap {
                termination = Termination::Stalled;
            }
        }
    }
    statistics.incumbents = u64::from(values.is_some());
    statistics.time = token.elapsed();
    let outcome = Outcome::new(termination, values, bound, statistics);
    let solution = Solution::new(model, outcome, options.feasibility)?;
    let (objective, bound) = (solution.objective(), solution.bound());
    if objective.is_some() {
        let progress = Progress::new(statistics.nodes, 0, 0, objective, bound, token.elapsed());
        control.report(&Event::Incumbent(progress));
    }
    Ok(solution)
}

/// The termination and the bound, in the sense of the model, that follow from a claim.
fn judged(
    options: &Options,
    answer: &ExternalAnswer,
    stopped: Option<Termination>,
    translated: &translate::Translated,
) -> (Termination, f64) {
    let nothing = -translated.sign * f64::INFINITY;
    let bound = |value: f64| translated.sign * (value + translated.offset);
    let claimed = answer.bound.map_or(nothing, bound);
    match (answer.claim, answer.objective) {
        (SolverClaim::Optimal, Some(objective)) => {
            // A program that reports no bound has proved its objective up to the gap.
            let gap = options.relative_gap * objective.abs();
            let proved = objective - gap.max(options.absolute_gap);
            let proved = answer.bound.map_or(proved, |bound| bound.min(objective));
            (Termination::Optimal, bound(proved))
        }
        (SolverClaim::Infeasible, _) => (Termination::Infeasible, -nothing),
        (SolverClaim::Unbounded, _) => (Termination::Unbounded, nothing),
        (SolverClaim::Limit(reason), _) => (stopped.unwrap_or(reason), claimed),
        (SolverClaim::Optimal | SolverClaim::Unknown, _) => {
            (stopped.unwrap_or(Termination::Stalled), claimed)
        }
    }
}
