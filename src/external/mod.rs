//! Other solvers as programs: a model is handed over as an MPS file, the answer is read back.
//!
//! [`ExternalSolver`] is a [`Solver`] that runs CBC, GLPK, HiGHS or SCIP, or any other program with
//! a [`Dialect`] of its own, where it stands on the `PATH`. Nothing is linked and nothing is
//! installed. Models are [lowered](crate::reformulate::lower) first, so programs without
//! indicators or logic solve everything that the language can say; quadratic objectives need a
//! program that takes them.
//!
//! Points are never taken on trust: the integers are rounded, the rest is solved again by
//! [`BranchAndBound`], and every statement is checked as what it means
//! ([`certify`]). Bounds and claims of infeasibility are the program's own and cannot be checked;
//! they are as good as it is, up to its tolerances.
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

pub use dialect::{Answer, Claim, Dialect, Files};
pub use programs::{Cbc, Glpk, Highs, Scip};

use crate::branch_and_bound::BranchAndBound;
use crate::error::Error;
use crate::model::Model;
use crate::reformulate;
use crate::solution::{Outcome, Solution, Statistics, Termination};
use crate::solver::{Budget, Control, Event, Options, Progress, Solver, certify};

/// A solver program on the `PATH`.
#[derive(Debug)]
pub struct ExternalSolver {
    dialect: Box<dyn Dialect>,
    program: String,
    options: Options,
}

impl ExternalSolver {
    /// A program by its dialect, under the dialect's usual name.
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

    /// SCIP: mixed-integer linear and quadratic programs.
    pub fn scip() -> Self {
        Self::new(Scip)
    }

    /// With options.
    #[must_use]
    pub fn with_options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// Under another name, or at a path.
    #[must_use]
    pub fn with_program(mut self, program: impl Into<String>) -> Self {
        self.program = program.into();
        self
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
    /// Besides those of every solver, [`Error::Backend`] when the program cannot be started, fails,
    /// or answers something that its dialect cannot read.
    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        self.options.check()?;
        let budget = Budget::new(self.options.time_limit, control.interrupt());
        let lowered = reformulate::lower_until(model, &|| budget.exhausted().is_some())?;
        if !self.dialect.takes_quadratic() && !lowered.model().objective().products().is_empty() {
            let program = &self.program;
            let message = format!("{program} takes no quadratic objective with integers");
            return Err(Error::Backend { message });
        }
        let Some(translated) = translate::translate(lowered.model())? else {
            let (termination, values) = (Termination::Infeasible, None);
            let bound = model.sense().sign() * f64::INFINITY;
            let statistics = Statistics { time: budget.elapsed(), ..Statistics::default() };
            let outcome = Outcome { termination, values, bound, statistics };
            return Solution::new(model, outcome, self.options.feasibility);
        };
        let run = process::Run {
            dialect: &*self.dialect,
            program: &self.program,
            options: &self.options,
            time_left: budget.remaining(),
            interrupt: control.interrupt(),
        };
        let (answer, stopped) = run.answer(&translated.text)?;
        let (termination, bound) = self.judged(&answer, stopped, &translated);
        let mut values = None;
        if let Some(found) = &answer.values {
            let restored = lowered.restore(&translated.values(found)?);
            let mut solver = BranchAndBound::new(Options {
                time_limit: None,
                node_limit: None,
                ..self.options.clone()
            });
            let certificate = certify(model, &restored, &mut solver)?;
            values = certificate.solution().point().map(|point| point.as_slice().to_vec());
        }
        let statistics = Statistics {
            nodes: answer.nodes.unwrap_or(0),
            incumbents: u64::from(values.is_some()),
            time: budget.elapsed(),
            ..Statistics::default()
        };
        let outcome = Outcome { termination, values, bound, statistics };
        let solution = Solution::new(model, outcome, self.options.feasibility)?;
        let progress = Progress::new(
            statistics.nodes,
            0,
            0,
            solution.objective(),
            solution.bound(),
            budget.elapsed(),
        );
        if solution.objective().is_some() {
            control.report(&Event::Incumbent(progress));
        }
        Ok(solution)
    }
}

impl ExternalSolver {
    /// The termination and the bound, in the sense of the model, that a claim amounts to.
    fn judged(
        &self,
        answer: &Answer,
        stopped: Option<Termination>,
        translated: &translate::Translated,
    ) -> (Termination, f64) {
        let nothing = -translated.sign * f64::INFINITY;
        let bound = |value: f64| translated.sign * (value + translated.offset);
        let claimed = answer.bound.map_or(nothing, bound);
        match (answer.claim, answer.objective) {
            (Claim::Optimal, Some(objective)) => {
                // A program that names no bound has proved its objective up to the gap.
                let gap = self.options.relative_gap * objective.abs();
                let proved = objective - gap.max(self.options.absolute_gap);
                let proved = answer.bound.map_or(proved, |bound| bound.min(objective));
                (Termination::Optimal, bound(proved))
            }
            (Claim::Infeasible, _) => (Termination::Infeasible, -nothing),
            (Claim::Unbounded, _) => (Termination::Unbounded, nothing),
            (Claim::Limit(reason), _) => (stopped.unwrap_or(reason), claimed),
            (Claim::Optimal | Claim::Unknown, _) => {
                (stopped.unwrap_or(Termination::Stalled), claimed)
            }
        }
    }
}
