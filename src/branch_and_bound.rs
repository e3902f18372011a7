//! The default backend: the whole pipeline in one short function.

use web_time::Instant;

use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::{Presolve, Presolved, Rule, presolve};
use crate::program::Program;
use crate::reformulate;
use crate::search::cuts::strengthen;
use crate::search::{Found, Task, search};
use crate::solution::{Outcome, Point, Solution, Statistics, Verification};
use crate::solver::{Budget, Control, Options, Solver};

/// Branch and bound over continuous relaxations.
///
/// A model is lowered (indicators and logic to rows), assembled, presolved, and searched; incumbents are
/// accepted only when they pass the model's own [`Verification`], implications included.
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
pub struct BranchAndBound {
    options: Options,
}

impl BranchAndBound {
    /// With options.
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
        let (start, options) = (Instant::now(), &self.options);
        options.check()?;
        let budget = Budget::new(options.time_limit, control.interrupt());
        let lowered = reformulate::lower_until(model, &|| budget.exhausted().is_some())?;
        let program = Program::assemble(lowered.model())?;
        let rules: &[Rule] = if options.presolve { &Rule::ALL } else { &[] };
        let go_on = || budget.exhausted().is_none();
        let mut at_root = Statistics::default();
        let found = match presolve(&program, rules, &go_on)? {
            Presolve::Infeasible => Found::infeasible(),
            Presolve::Presolved(presolved) => {
                let Presolved { program, postsolve } = &*presolved;
                let accept = |values: &[f64]| {
                    Point::new(model, lowered.restore(&postsolve.point(values))).is_ok_and(
                        |point| Verification::of(model, &point, options.feasibility).holds(),
                    )
                };
                let time_left =
                    || options.time_limit.map(|limit| limit.saturating_sub(start.elapsed()));
                let cut = if options.cuts {
                    strengthen(program, &time_left, control.interrupt(), &mut at_root)
                } else {
                    None
                };
                let program = cut.as_ref().unwrap_or(program);
                let found = search(Task { program, accept: &accept, options, start }, control);
                Found { incumbent: found.incumbent.map(|x| postsolve.point(&x)), ..found }
            }
        };
        let mut statistics = found.statistics;
        statistics.relaxations += at_root.relaxations;
        statistics.iterations += at_root.iterations;
        statistics.time = start.elapsed();
        let outcome = Outcome {
            termination: found.termination,
            values: found.incumbent.map(|values| lowered.restore(&values)),
            bound: program.sign * found.bound,
            statistics,
        };
        Solution::new(model, outcome, options.feasibility)
    }
}
