//! The default backend: the whole pipeline in one short function.

mod seeding;

use web_time::Instant;

use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::{Presolve, Presolved, Rule, presolve};
use crate::program::Program;
use crate::reformulate;
use crate::search::cuts::strengthen;
use crate::search::{Found, Guide, Task, search};
use crate::solution::{Outcome, Point, Solution, Statistics, Verification};
use crate::solver::{Budget, Control, Options, Solver, TreeSeed};
use seeding::{leaf_of, report, seed_of};

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
        #[cfg(feature = "tracing")]
        let _span = tracing::info_span!("solve", model = model.name()).entered();
        let (start, options) = (Instant::now(), &self.options);
        options.check()?;
        let budget = Budget::new(options.time_limit, control.interrupt());
        let lowered = reformulate::lower_until(model, &|| budget.exhausted().is_some())?;
        let program = Program::assemble(lowered.model())?;
        let guide = Guide::new(model, control.guidance())?;
        let given = control.seed().map(|seed: &TreeSeed| seed_of(model, seed));
        let integral: Vec<bool> = model.variables().map(|v| v.kind().is_integral()).collect();
        // Seeds, guidance, pools and leaves speak of the columns as they are.
        let as_is = given.is_some() || !guide.is_idle() || options.pool > 1 || options.keep_leaves;
        let rules: &[Rule] = if options.presolve && !as_is { &Rule::ALL } else { &[] };
        let go_on = || budget.exhausted().is_none();
        let mut at_root = Statistics::default();
        let found = match presolve(&program, rules, &go_on)? {
            Presolve::Infeasible => Found::infeasible(),
            Presolve::Presolved(presolved) => {
                let Presolved { program, postsolve } = &*presolved;
                let restore = |values: &[f64]| lowered.restore(&postsolve.point(values));
                let accept = |values: &[f64]| {
                    Point::new(model, restore(values)).is_ok_and(|point| {
                        Verification::of(model, &point, options.feasibility).holds()
                    })
                };
                let key = |values: &[f64]| {
                    let values = restore(values);
                    let integers = values.iter().zip(&integral).filter(|(_, integral)| **integral);
                    integers.map(|(value, _)| value.round() as i64).collect()
                };
                let describe = |values: &[f64]| Point::new(model, restore(values)).ok();
                let time_left =
                    || options.time_limit.map(|limit| limit.saturating_sub(start.elapsed()));
                let cut = if options.cuts && !as_is {
                    strengthen(program, &time_left, control.interrupt(), &mut at_root)
                } else {
                    None
                };
                let task = Task {
                    guide: &guide,
                    windows: None,
                    program: cut.as_ref().unwrap_or(program),
                    accept: &accept,
                    key: &key,
                    describe: &describe,
                    options,
                    cutoff: f64::INFINITY,
                    start,
                };
                let found = search(task, control, given.as_ref().map(|(seed, _)| seed));
                let points = found.points.iter().map(|values| postsolve.point(values)).collect();
                Found { points, ..found }
            }
        };
        let report = given.as_ref().map(|(_, ignored)| report(model, &found, *ignored));
        let mut statistics = found.statistics;
        statistics.relaxations += at_root.relaxations;
        statistics.iterations += at_root.iterations;
        statistics.time = start.elapsed();
        let outcome = Outcome {
            termination: found.termination,
            values: found.points.first().map(|values| lowered.restore(values)),
            bound: program.sign * found.bound,
            statistics,
        };
        let solution = Solution::new(model, outcome, options.feasibility)?;
        let others = found.points.iter().skip(1).map(|values| lowered.restore(values));
        let leaves = found.leaves.iter().map(|leaf| leaf_of(model, leaf, program.sign)).collect();
        let solution = solution
            .with_pool(model, others, found.pool_complete, options.feasibility)?
            .with_leaves(leaves)
            .with_seed_report(report);
        #[cfg(feature = "tracing")]
        tracing::info!(
            termination = %solution.termination(),
            objective = solution.objective(),
            bound = solution.bound(),
            nodes = solution.statistics().nodes,
            "done"
        );
        Ok(solution)
    }
}
