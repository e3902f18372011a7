//! Lowering: turns a model with indicators, disjunctions, logic, functions, ordered sets and
//! semi-continuous variables into one with only rows, and norms and quadratic rows without a
//! condition.
//!
//! The lowered model is equivalent. It has the same variables, followed by auxiliary ones, so
//! handles carry over. You can compare the text forms of both models, and write the lowered one as
//! an MPS file for any other solver. Each reformulation has its own file.
//!
//! ```
//! use carom::prelude::*;
//! use carom::reformulate;
//!
//! let mut model = Model::new("m");
//! let x = model.continuous("x", -2.0, 10.0)?;
//! let hit = model.binary("hit")?;
//! model.add("contact", hit.on().implies(x.le(0.0)))?;
//! let lowered = reformulate::lower(&model)?;
//! assert!(lowered.model().to_string().contains("contact_upper: x + 10"));
//! assert_eq!(lowered.report().entries()[0].largest.as_deref(), Some("x"));
//! # Ok::<(), carom::Error>(())
//! ```

mod big_m;
mod bounds;
mod cases;
mod circulations;
mod clauses;
mod compare;
mod conic;
mod conic_rows;
mod direction;
mod disjunction;
mod extremum;
mod functions;
mod hull;
mod implied_bounds;
mod linear_program;
mod logic;
mod lowering;
mod missing_bound;
mod multi_m;
mod piecewise;
mod product;
mod relaxed;
mod report;
mod semicontinuous;
mod sos;

pub use compare::{MethodComparison, MethodSize, compare_methods};
pub(crate) use conic::with_slack;
pub use relaxed::relaxed;
pub(crate) use relaxed::with_some_integers;
pub use report::{BigMEntry, BigMReport, BigMShare, BigMSource, Side};

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::{Function, Method, Model, Variable};
use crate::solution::{LeafBox, Outcome, Solution};
use crate::solver::{Solver, StopToken, uninterrupted};
pub(crate) use direction::Tie;
#[cfg(feature = "nonlinear")]
pub(crate) use direction::ties;
use implied_bounds::ImpliedBounds;
use linear_program::Maximizer;
use lowering::Lowering;

/// A model with only rows, and the origin of its big-Ms.
#[derive(Debug, Clone)]
#[must_use]
pub struct Lowered {
    model: Model,
    report: BigMReport,
    original: usize,
    /// The functions of which only one side became rows.
    one_sided: Vec<(Variable, Function, Tie)>,
    /// The state of the model that this was made from.
    revision: u64,
}

impl Lowered {
    /// The lowered model. Handles of the original are valid in it; auxiliary variables come after
    /// the original ones.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Every big-M with its origin.
    pub fn report(&self) -> &BigMReport {
        &self.report
    }

    /// Solves the lowered model for the current parameter values of `model`, from which it was
    /// made, without lowering it again.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Stale`] if anything but values of parameters has changed since, because a big-M
    /// must not outlive its bounds; and the errors of the solver.
    pub fn solve<S: Solver + ?Sized>(
        &self,
        model: &Model,
        solver: &mut S,
    ) -> Result<Solution, Error> {
        if model.tag() != self.model.tag() || model.revision() != self.revision {
            return Err(ErrorKind::Stale { model: model.name().to_owned() }.into());
        }
        let mut plain = self.model.clone();
        plain.take_parameters(model);
        let found = solver.solve(&plain)?;
        if !found.relaxed().is_empty() {
            // Statements about relaxed integers hold as rows only.
            return Ok(found);
        }
        let outcome = Outcome::new(
            found.termination(),
            found.point().map(|point| self.restore(point.as_slice())),
            found.bound(),
            *found.statistics(),
        );
        let feasibility = solver.options().feasibility;
        let others = found.pool().iter().skip(1);
        let others = others.map(|best| self.restore(best.point().as_slice()));
        let complete = found.pool().is_complete();
        let own = |leaf: &LeafBox| {
            let mut leaf = leaf.clone();
            leaf.bounds.retain(|bound| bound.variable.index() < self.original);
            leaf
        };
        let leaves = found.leaves().iter().map(own).collect();
        let solution = Solution::new(model, outcome, feasibility)?.with_leaves(leaves);
        let multipliers = found.multipliers().map(|multipliers| multipliers.of(model));
        let solution = solution.with_pool(model, others, complete, feasibility)?;
        Ok(solution.with_multipliers(multipliers))
    }

    /// Maps a point of the lowered model, one value per variable, to a point of the original: drops
    /// auxiliary variables, and moves variables of one-sided functions back onto them, which
    /// neither violates anything nor worsens the objective.
    pub fn restore(&self, values: &[f64]) -> Vec<f64> {
        restore(self.original, &self.one_sided, values)
    }

    /// Keeps only what `restore` needs. The rest is as large as the model, and a solve does not
    /// need it.
    pub(crate) fn into_way_back(self) -> WayBack {
        WayBack { original: self.original, one_sided: self.one_sided }
    }
}

/// The part of a lowered model that [`Lowered::restore`] needs.
#[derive(Debug)]
pub(crate) struct WayBack {
    original: usize,
    one_sided: Vec<(Variable, Function, Tie)>,
}

impl WayBack {
    /// The way back to a model that has only rows.
    pub(crate) fn to_rows(model: &Model) -> Self {
        WayBack { original: model.variable_count(), one_sided: Vec::new() }
    }

    /// Same as [`Lowered::restore`].
    pub(crate) fn restore(&self, values: &[f64]) -> Vec<f64> {
        restore(self.original, &self.one_sided, values)
    }
}

fn restore(original: usize, one_sided: &[(Variable, Function, Tie)], values: &[f64]) -> Vec<f64> {
    let mut values: Vec<f64> = values.iter().take(original).copied().collect();
    if values.len() == original {
        for (variable, function, tie) in one_sided {
            direction::restore(*variable, function, *tie, &mut values);
        }
    }
    values
}

/// Replaces all statements that are not rows by rows, as the model's
/// [`Reformulation`](crate::model::Reformulation) asks for.
///
/// The M of an indicator comes from the *current* bounds (of parameters: from their declared
/// ranges) or, for variables without bounds, from those that rows imply. If the model pushes the
/// variable of a function only towards its convex (or concave) side, only that side becomes rows,
/// which need neither binaries nor bounds; [`Lowered::restore`] moves points back. Relaxed integers
/// become continuous.
///
/// # Errors
///
/// [`ErrorKind::UnboundedIndicator`] and [`ErrorKind::UnboundedFunction`] naming the variable whose
/// bound is missing, [`ErrorKind::UnsafeBigM`] for a user's M that the bounds do not prove,
/// [`ErrorKind::OutOfRange`] for an integer factor with a wide range.
#[doc(alias("big-M", "linearise", "linearize"))]
pub fn lower(model: &Model) -> Result<Lowered, Error> {
    lower_by(model, None)
}

/// As [`lower`], with one method for all disjunctions.
fn lower_by(model: &Model, method: Option<Method>) -> Result<Lowered, Error> {
    uninterrupted(|token| lower_until(model, method, token))
}

/// Lowers a model, with one method for all disjunctions if one is given; `None` if the token is
/// over before the end.
///
/// # Errors
///
/// As for [`lower`], from the statements before the one at which it stopped.
pub(crate) fn lower_until(
    model: &Model,
    method: Option<Method>,
    token: &StopToken,
) -> Result<Option<Lowered>, Error> {
    match model.functions().find(|function| function.function().is_smooth()) {
        None => lower_rows(model, method, token),
        Some(function) => Err(ErrorKind::Unsupported {
            solver: "a model of rows".to_owned(),
            what: format!("the function `{}`, which rows only enclose", function.name()),
            help:
                "solve the model itself with `BranchAndBound`, which needs the feature `nonlinear`"
                    .to_owned(),
        }
        .into()),
    }
}

/// Lowers a model but for its smooth functions, whose variables get the bounds of their values and
/// no rows.
pub(crate) fn lower_around_functions(
    model: &Model,
    token: &StopToken,
) -> Result<Option<Lowered>, Error> {
    lower_rows(model, None, token)
}

fn lower_rows(
    model: &Model,
    method: Option<Method>,
    token: &StopToken,
) -> Result<Option<Lowered>, Error> {
    let open = model.parameters().next().is_some().then(|| model.with_open_parameters());
    let open = open.as_ref().unwrap_or(model);
    // Bounds that rows imply are looked for where the variables' own do not suffice.
    let first = match lower_with(open, method, (None, None), token) {
        Err(error) if is_missing_bound(&error) => {
            let Some(implied) = ImpliedBounds::of(open, token)? else { return Ok(None) };
            lower_with(open, method, (None, Some(implied)), token)?
        }
        other => other?,
    };
    let Some((mut lowered, implied)) = first else { return Ok(None) };
    if model.reformulation().linear_programs() && !lowered.report.entries.is_empty() {
        let maximizer = Maximizer::of(&lowered.model, token)?;
        let Some((tighter, _)) = lower_with(open, method, (Some(maximizer), implied), token)?
        else {
            return Ok(None);
        };
        lowered = tighter;
    }
    lowered.model.make_relaxed_continuous();
    lowered.model.take_parameters(model);
    lowered.revision = model.revision();
    Ok(Some(lowered))
}

/// For each variable, its bounds, or bounds well beyond those that rows imply; some may be
/// infinite. They need not hold where statements are dropped or give. `None` if the token is over
/// first.
pub(crate) fn wide_bounds(
    model: &Model,
    token: &StopToken,
) -> Result<Option<Vec<Interval>>, Error> {
    Ok(ImpliedBounds::of(model, token)?.map(|implied| implied.wide(model)))
}

/// Whether the bounds of variables did not suffice.
pub(crate) fn is_missing_bound(error: &Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::UnboundedIndicator { .. } | ErrorKind::UnboundedFunction { .. }
    )
}

/// The cost of lowering a statement, in visited entries.
const STATEMENT_WORK: usize = 500;

/// A lowered model, and what its rows imply if that was needed.
type Made<'a> = (Lowered, Option<ImpliedBounds<'a>>);

fn lower_with<'a>(
    model: &Model,
    method: Option<Method>,
    (maximizer, implied): (Option<Maximizer<'a>>, Option<ImpliedBounds<'a>>),
    token: &'a StopToken,
) -> Result<Option<Made<'a>>, Error> {
    let mut lowering = Lowering::new(model, maximizer, implied, token);
    let mut one_sided = Vec::new();
    for variable in model.variables() {
        let Some(values) = variable.semicontinuous() else { continue };
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        semicontinuous::apply(&variable, values, &mut lowering)?;
    }
    // Functions come before the rest because they bound their variables, and in this order because
    // later ones depend on earlier ones.
    for (function, tie) in model.functions().zip(direction::ties(model)?) {
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        functions::apply(&function, tie, &mut lowering)?;
        if tie != Tie::Exact {
            one_sided.push((function.result(), function.function().clone(), tie));
        }
    }
    for conic in model.conic_constraints() {
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        conic::apply(&conic, &mut lowering)?;
    }
    for indicator in model.indicators() {
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        big_m::apply(&indicator, &mut lowering)?;
    }
    for disjunction in model.disjunctions() {
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        let own = disjunction.method().unwrap_or(model.reformulation().method());
        disjunction::apply(&disjunction, method.unwrap_or(own), &mut lowering)?;
    }
    for statement in model.logical_constraints() {
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        logic::apply(&statement, &mut lowering)?;
    }
    for set in model.special_ordered_sets() {
        if token.spend(STATEMENT_WORK) {
            return Ok(None);
        }
        sos::apply(&set, &mut lowering)?;
    }
    let Lowering { model: lowered, report, original, implied, .. } = lowering;
    let lowered =
        Lowered { model: lowered, report, original, one_sided, revision: model.revision() };
    Ok(Some((lowered, implied)))
}
