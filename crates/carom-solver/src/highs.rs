//! HiGHS as a library, for mixed-integer linear programs: the feature `highs`.
//!
//! [`HighsSolver`] is a [`Solver`] over the crate `highs`, which compiles HiGHS from C++ and needs
//! cmake, a C++ compiler and libclang (Debian: `apt-get install cmake g++ libclang-dev`). If HiGHS
//! is installed as a program, [`external`](crate::external) needs none of this.
//!
//! Models are [lowered](crate::reformulate::lower) first, so it solves any model with a linear
//! objective and without cones. A quadratic objective and cones are errors,
//! [`ErrorKind::Unsupported`]. Points are never trusted: the integers are rounded,
//! [`BranchAndBound`](crate::BranchAndBound) solves the rest again, and the meaning of every
//! statement is checked ([`certify`](crate::solver::certify)). Bounds and claims of infeasibility
//! are those of HiGHS, up to its tolerances.
//!
//! # Options and limits
//!
//! | option | in HiGHS |
//! | --- | --- |
//! | `relative_gap`, `absolute_gap` | `mip_rel_gap`, `mip_abs_gap`: half of ours, because certifying may use up the rest |
//! | `feasibility` | `primal_feasibility_tolerance` |
//! | `integrality` | `mip_feasibility_tolerance` |
//! | `time_limit` | `time_limit`, less what lowering took |
//! | `node_limit` | `mip_max_nodes` |
//! | `threads` | `threads` |
//!
//! The crate `highs` offers no callback. An [`Interrupt`](crate::solver::Interrupt) therefore takes
//! effect only before and after HiGHS runs, so set a time limit for long solves, and there is one
//! progress event, for the returned point. HiGHS checks its clock between the steps of its
//! algorithm, so it can exceed a time limit by one step.
//!
//! ```
//! use carom::highs::HighsSolver;
//! use carom::prelude::*;
//!
//! let mut model = Model::new("knapsack");
//! let take = model.binary_family("take", 3)?;
//! model.add("room", (2.0 * take[0] + 3.0 * take[1] + 4.0 * take[2]).le(6.0))?;
//! model.maximize(3.0 * take[0] + 4.0 * take[1] + 6.0 * take[2])?;
//! let solution = HighsSolver::default().solve(&model)?;
//! assert_eq!(solution.objective(), Some(9.0));
//! # Ok::<(), carom::Error>(())
//! ```

use std::thread;

use ::highs as library;
use library::{ColProblem, HighsModelStatus, HighsSolutionStatus, HighsStatus};
use web_time::Duration;

use crate::error::{Error, ErrorKind};
use crate::external::{cones_unsupported, settled, stopped, with_half_the_gap};
use crate::model::Model;
use crate::program::Program;
use crate::reformulate;
use crate::solution::{Outcome, Solution, Statistics, Termination};
use crate::solver::{Control, Options, Solver, StopToken};
use crate::tolerance;

/// HiGHS, linked into the program.
#[derive(Debug, Clone, Default)]
pub struct HighsSolver {
    options: Options,
}

impl HighsSolver {
    /// A solver with these options.
    pub fn new(options: Options) -> Self {
        HighsSolver { options }
    }
}

/// The result of HiGHS, in terms of the program's minimisation.
struct HighsResult {
    status: HighsModelStatus,
    values: Option<Vec<f64>>,
    /// Objective of its point, without the program's offset.
    objective: f64,
    /// Its bound, without the program's offset; `-inf` if it has none.
    bound: f64,
    iterations: u64,
}

impl Solver for HighsSolver {
    fn name(&self) -> &str {
        "highs"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    /// # Errors
    ///
    /// Besides those of every solver, [`ErrorKind::Unsupported`] for a quadratic objective and for
    /// cones.
    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        self.options.check()?;
        control.refuse_lazy_constraints("HiGHS")?;
        let token = StopToken::new(self.options.time_limit, control.interrupt());
        let Some(lowered) = reformulate::lower_until(model, None, &token)? else {
            return stopped(model, &self.options, &token);
        };
        if let Some(conic) = lowered.model().conic_constraints().next() {
            return Err(cones_unsupported("HiGHS", conic.name()));
        }
        let program = Program::assemble(lowered.model())?;
        if program.quadratic.compute_nnz() > 0 {
            return Err(ErrorKind::Unsupported {
                solver: "HiGHS".into(),
                what: "a quadratic objective".into(),
                help: "solve it with `BranchAndBound`, or give it a linear one".into(),
            }
            .into());
        }
        let sign = program.sign;
        let nothing = (-sign * f64::INFINITY, None, Statistics::default());
        let (mut termination, (bound, values, statistics)) = match self.early(&program, &token) {
            Some(Termination::Infeasible) => {
                let bound = sign * f64::INFINITY;
                (Termination::Infeasible, (bound, None, Statistics::default()))
            }
            Some(ended) => (ended, nothing),
            None => self.run(&program, &token)?,
        };
        if let Some(interrupted) = token.ended().filter(|&e| e == Termination::Interrupted) {
            // Whatever is proved stays proved.
            let proved = matches!(termination, Termination::Optimal | Termination::Infeasible);
            termination = if proved { termination } else { interrupted };
        }
        let values = values.map(|found| lowered.restore(&found));
        let claimed = Outcome::new(termination, values, bound, statistics);
        settled(model, claimed, &self.options, &token, control)
    }
}

impl HighsSolver {
    /// Cases that need no HiGHS: limits that are reached at once, empty bounds, programs without
    /// columns.
    fn early(&self, program: &Program, token: &StopToken) -> Option<Termination> {
        if let Some(ended) = token.ended() {
            return Some(ended);
        }
        if self.options.node_limit == Some(0) {
            return Some(Termination::NodeLimit);
        }
        let empty = |j: usize| program.lower[j] > program.upper[j];
        let untrue = |i: usize| {
            let slack = self.options.feasibility;
            program.row(i).0.is_empty()
                && !(program.row_lower[i] <= slack && program.row_upper[i] >= -slack)
        };
        let infeasible =
            (0..program.column_count()).any(empty) || (0..program.row_count()).any(untrue);
        infeasible.then_some(Termination::Infeasible)
    }

    #[allow(clippy::type_complexity)]
    fn run(
        &self,
        program: &Program,
        token: &StopToken,
    ) -> Result<(Termination, (f64, Option<Vec<f64>>, Statistics)), Error> {
        let (sign, nothing) = (program.sign, -program.sign * f64::INFINITY);
        let outside = |bound: f64| sign * (bound + program.offset);
        if program.column_count() == 0 {
            let found = (outside(0.0), Some(Vec::new()), Statistics::default());
            return Ok((Termination::Optimal, found));
        }
        let mut found = self.call(program, &program.linear, token.left())?;
        let mut statistics = Statistics::default();
        statistics.iterations = found.iterations;
        use HighsModelStatus as Status;
        let open = matches!(found.status, Status::Unbounded | Status::UnboundedOrInfeasible);
        if open {
            // It may have seen a falling direction only, and no feasible point.
            found = self.call(program, &vec![0.0; program.column_count()], token.left())?;
            statistics.iterations += found.iterations;
        }
        let answer = match found.status {
            Status::Optimal if open => (Termination::Unbounded, nothing, found.values),
            Status::Optimal => {
                // A linear program has no gap of its own: proved is its objective up to ours.
                let options = with_half_the_gap(&self.options, constant(program));
                let gap = options.relative_gap * found.objective.abs();
                let proved = found.objective - gap.max(options.absolute_gap);
                let bound = if program.integers.is_empty() { proved } else { found.bound };
                (Termination::Optimal, outside(bound.min(found.objective)), found.values)
            }
            Status::Infeasible => (Termination::Infeasible, -nothing, None),
            Status::ReachedTimeLimit | Status::ReachedInterrupt => {
                let bound = if open { nothing } else { outside(found.bound) };
                (Termination::TimeLimit, bound, found.values)
            }
            Status::ReachedSolutionLimit | Status::ReachedIterationLimit => {
                let bound = if open { nothing } else { outside(found.bound) };
                (Termination::NodeLimit, bound, found.values)
            }
            _ => (Termination::Stalled, nothing, found.values),
        };
        let (termination, bound, values) = answer;
        Ok((termination, (bound, values, statistics)))
    }

    /// Runs HiGHS on a separate thread, because its pool of threads belongs to the calling thread
    /// and keeps the number of threads of the first call.
    fn call(
        &self,
        program: &Program,
        cost: &[f64],
        time_left: Option<Duration>,
    ) -> Result<HighsResult, Error> {
        let failed =
            |message: String| Error::from(ErrorKind::Backend { solver: "HiGHS".into(), message });
        thread::scope(|scope| {
            let run = || self.call_here(program, cost, time_left);
            let worker = thread::Builder::new().spawn_scoped(scope, run);
            let worker = worker.map_err(|error| {
                let what = "cannot start a thread for HiGHS".into();
                let help = "stop some of the threads of this process";
                Error::with_source(ErrorKind::Io { what, help }, error)
            })?;
            let ended = worker.join().map_err(|_| failed("it panicked".into()))?;
            ended.map_err(|status| failed(format!("it refused the program ({status:?})")))
        })
    }

    fn call_here(
        &self,
        program: &Program,
        cost: &[f64],
        time_left: Option<Duration>,
    ) -> Result<HighsResult, HighsStatus> {
        let options = with_half_the_gap(&self.options, constant(program));
        let mut problem = ColProblem::new();
        let limits = program.row_lower.iter().zip(&program.row_upper);
        let rows: Vec<library::Row> =
            limits.map(|(&lower, &upper)| problem.add_row(lower..=upper)).collect();
        for (j, &cost) in cost.iter().enumerate() {
            let (index, entries) = program.column(j);
            let terms = index.iter().zip(entries).map(|(&i, &a)| (rows[i], a));
            let bounds = program.lower[j]..=program.upper[j];
            problem.add_column_with_integrality(cost, bounds, terms, program.integral[j]);
        }
        let mut model = problem.try_optimise(library::Sense::Minimise)?;
        let mut set = |option: &str, value: f64| {
            model.try_set_option(option, value).map_err(|_| HighsStatus::Error)
        };
        set("mip_rel_gap", options.relative_gap)?;
        set("mip_abs_gap", options.absolute_gap)?;
        set("primal_feasibility_tolerance", options.feasibility)?;
        set("mip_feasibility_tolerance", options.integrality)?;
        if let Some(time) = time_left {
            set("time_limit", time.as_secs_f64())?;
        }
        let mut set = |option: &str, value: u64| {
            let value = i32::try_from(value).unwrap_or(i32::MAX);
            model.try_set_option(option, value).map_err(|_| HighsStatus::Error)
        };
        set("threads", options.threads as u64)?;
        if let Some(nodes) = options.node_limit {
            set("mip_max_nodes", nodes)?;
        }
        let solved = model.try_solve()?;
        let point = solved.primal_solution_status() == HighsSolutionStatus::Feasible;
        let values = point.then(|| solved.get_solution().columns().to_vec());
        let bound = solved.double_info_value(c"mip_dual_bound").ok();
        let infinite = |bound: &f64| !bound.is_finite() || bound.abs() >= tolerance::INFINITE;
        let bound = bound.filter(|b| !infinite(b) && !program.integers.is_empty());
        Ok(HighsResult {
            status: solved.status(),
            values,
            objective: solved.objective_value(),
            bound: bound.unwrap_or(f64::NEG_INFINITY),
            iterations: u64::try_from(solved.simplex_iteration_count()).unwrap_or(0),
        })
    }
}

/// A constant of the objective, if there is any: stated, or of fixed columns.
fn constant(program: &Program) -> f64 {
    if program.offset == 0.0 { program.constant } else { program.offset }
}
