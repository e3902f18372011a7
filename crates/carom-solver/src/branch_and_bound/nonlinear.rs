//! Models with smooth functions: their statements become rows, and a search over boxes encloses the
//! functions.

use std::cell::RefCell;

use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::reformulate::{lower_around_functions, ties};
use crate::solution::{Heuristic, Outcome, Point, Solution, Statistics, Termination, Verification};
use crate::solver::{Control, Event, Incumbent, Options, PoolMode, Progress, StopToken};
use crate::spatial::{Occasion, SearchFlaw, SearchNews, SpatialProgram, SpatialSearch};

use super::box_proof::write_box_proof;
use super::refusals::Refusals;

/// Whether a model has functions that rows only enclose.
pub(super) fn is_nonlinear(model: &Model) -> bool {
    model.functions().any(|function| function.function().is_smooth())
}

/// Solves a model with smooth functions.
///
/// # Arguments
///
/// * `last`: values of all variables near which a point is looked for first.
///
/// # Errors
///
/// [`ErrorKind::Unsupported`] for what this search cannot do: rows that are found while it runs,
/// other processes. Those of lowering.
pub(super) fn solve_nonlinear(
    model: &Model,
    options: &Options,
    control: &mut Control<'_>,
    last: Option<&[f64]>,
) -> Result<Solution, Error> {
    refuse(model, control)?;
    let token = &StopToken::new(options.time_limit, control.interrupt());
    let has_proof = options.proof_path().is_some();
    let restated = with_affine_objective(model, has_proof)?;
    let stated = restated.as_ref().unwrap_or(model);
    let Some(lowered) = lower_around_functions(stated, token)? else {
        let reason = token.ended().unwrap_or(Termination::Interrupted);
        let bound = -model.sense().sign() * f64::INFINITY;
        let outcome = Outcome::new(reason, None, bound, Statistics::default());
        return Solution::new(model, outcome, options.feasibility);
    };
    let rows = lowered.model().clone();
    let program = SpatialProgram::new(stated, rows, &ties(stated)?, has_proof)?;
    let (sign, count) = (model.sense().sign(), model.variable_count());
    let refusals = Refusals::default();
    let restored = |x: &[f64]| {
        let mut values = lowered.restore(x);
        values.truncate(count);
        Point::new(model, values).ok()
    };
    let accepts = |x: &[f64]| {
        let Some(point) = restored(x) else { return false };
        let check = Verification::of(model, &point, options.feasibility);
        let holds = check.holds();
        if !holds {
            refusals.note(check);
        }
        holds
    };
    let given = control.start().map(|given| {
        let own = given.values.iter().filter(|(own, _)| model.variable_ref(*own).is_ok());
        program.around(own.map(|(own, value)| (own.index(), *value)))
    });
    let last = last.map(|last| program.around(last.iter().copied().enumerate()));
    let starts: Vec<Vec<f64>> = given.into_iter().chain(last).collect();
    let watched = RefCell::new(control);
    watched.borrow_mut().report(&Event::Presolved(
        program.size(),
        Progress::new(0, 0, 0, None, -sign * f64::INFINITY, token.elapsed()),
    ));
    let mut notify = |news: &SearchNews<'_>| {
        report(model, &mut watched.borrow_mut(), token, news, &restored);
    };
    let search =
        SpatialSearch { program: &program, options, token, accepts: &accepts, notify: &mut notify };
    let mut found = search.run(&starts);
    found.statistics.time = token.elapsed();
    if found.termination == Termination::Unbounded {
        return unbounded(model, options, watched.into_inner(), found.statistics);
    }
    if let Some(flaw) = found.flaw {
        return Err(match flaw {
            SearchFlaw::OpenColumn(column) => missing_bound(stated, &program, column),
            SearchFlaw::Pole { result, range } => {
                let function = stated.functions().find(|f| f.result().index() == result);
                let name = |variable| stated.name_of(variable).to_string();
                let function = function.map(|function| function.function().text(&name));
                let range = (range.lower, range.upper);
                ErrorKind::Pole { function: function.unwrap_or_default(), range }.into()
            }
        });
    }
    let proof = options.proof_path().and_then(|path| {
        write_box_proof(path, (&program, &found), (options, token), &mut watched.borrow_mut())
    });
    let best = found.best.as_ref().and_then(|(x, _)| restored(x));
    let values = best.map(|point| point.as_slice().to_vec());
    let outcome = Outcome::new(found.termination, values, sign * found.bound, found.statistics);
    let solution = Solution::new(model, outcome, options.feasibility)?;
    let is_alone = options.pool == 1 && options.pool_mode == PoolMode::Best;
    let complete = is_alone && (solution.is_optimal() || solution.is_infeasible());
    let solution = solution.with_pool(model, std::iter::empty(), complete, options.feasibility)?;
    Ok(solution.with_refused(refusals.take()).with_proof(proof))
}

/// The answer for a model whose objective falls without limit, if it has a point: a search without
/// the objective tells.
fn unbounded(
    model: &Model,
    options: &Options,
    control: &Control<'_>,
    statistics: Statistics,
) -> Result<Solution, Error> {
    let mut any = model.clone();
    any.minimize(0.0)?;
    let mut options = options.clone();
    options.time_limit = options.time_limit.map(|limit| limit.saturating_sub(statistics.time));
    options.proof = None;
    let mut quiet = Control::default().with_interrupt(control.interrupt());
    let found = solve_nonlinear(&any, &options, &mut quiet, None)?;
    let (sign, values) = (model.sense().sign(), found.point().map(|p| p.as_slice().to_vec()));
    let (termination, bound) = match (&values, found.termination()) {
        (Some(_), _) => (Termination::Unbounded, -sign * f64::INFINITY),
        (None, Termination::Infeasible) => (Termination::Infeasible, sign * f64::INFINITY),
        (None, reason) => (reason, -sign * f64::INFINITY),
    };
    let outcome = Outcome::new(termination, values, bound, *found.statistics());
    Solution::new(model, outcome, options.feasibility)
}

/// Reports how the search stands, and stops it if that is asked for.
fn report(
    model: &Model,
    control: &mut Control<'_>,
    token: &StopToken,
    news: &SearchNews<'_>,
    restored: &dyn Fn(&[f64]) -> Option<Point>,
) {
    let sign = model.sense().sign();
    let (best, bound) = (news.best.map(|value| sign * value), sign * news.bound);
    let (nodes, relaxations) = (news.statistics.nodes, news.statistics.relaxations);
    let elapsed = token.elapsed();
    let mut progress = Progress::new(nodes, news.open, relaxations, best, bound, elapsed);
    (progress.depth, progress.iterations) = (news.statistics.depth, news.statistics.iterations);
    progress.constant = model.objective_constant();
    control.report(&match news.occasion {
        Occasion::Root => Event::Root(progress),
        Occasion::Better(_) => Event::Incumbent(progress),
        Occasion::Time => Event::Progress(progress),
    });
    if let (Occasion::Better(x), Some(objective)) = (&news.occasion, best)
        && control.watches_incumbents()
        && let Some(point) = restored(x)
    {
        let incumbent = Incumbent::new(&point, objective, Heuristic::Relaxation, progress);
        if control.report_incumbent(&incumbent).is_break() {
            token.stop();
        }
    }
}

/// The model with variables for the squares and products of its objective, if they are squares of
/// single variables, which tangents cut off quickly, if they are not convex, or `always`: a proof
/// knows no such objective beside functions. `None` otherwise.
fn with_affine_objective(model: &Model, always: bool) -> Result<Option<Model>, Error> {
    let products = model.objective().products();
    let squares_only = products.iter().all(|(a, b, _)| a == b);
    if products.is_empty() || !(always || squares_only || model.is_convex_within_bounds()) {
        return Ok(None);
    }
    let mut stated = model.clone();
    let affine = stated.nonlinear("objective", model.objective())?;
    stated.set_objective(model.sense(), affine)?;
    Ok(Some(stated))
}

fn refuse(model: &Model, control: &Control<'_>) -> Result<(), Error> {
    let unsupported = |what: &str, help: &str| {
        let (solver, what, help) = ("carom".to_owned(), what.to_owned(), help.to_owned());
        Err(ErrorKind::Unsupported { solver, what, help }.into())
    };
    if control.lazy_constraints().is_some() || control.user_cuts().is_some() {
        return unsupported(
            "rows that are found while a model with smooth functions is solved",
            "add all rows to the model",
        );
    }
    if model.relaxed_integers().next().is_some() {
        return unsupported(
            "relaxed integers in a model with smooth functions",
            "let them be continuous variables",
        );
    }
    if control.has_exchange() {
        return unsupported(
            "a tree of several processes for a model with smooth functions",
            "solve it in one process",
        );
    }
    Ok(())
}

/// The error that a relaxation has no bound, because a column has none.
fn missing_bound(model: &Model, program: &SpatialProgram, column: usize) -> Error {
    let names: Vec<String> = model.variables().map(|v| v.name().to_string()).collect();
    let of = program.variables_of(column);
    let user = of.first().copied().unwrap_or(column);
    let function = model.functions().filter(|function| function.function().is_smooth());
    let mut function = function.filter(|function| {
        let terms = function.function().expressions().iter().flat_map(|e| e.terms());
        terms.into_iter().any(|(variable, _)| variable.index() == user)
    });
    let name = |j: usize| names.get(j).cloned().unwrap_or_default();
    let text = function.next().map(|function| function.function().text(&|v| name(v.index())));
    let remedy: Vec<String> = of.iter().map(|&j| format!("`{}`", name(j))).collect();
    ErrorKind::UnboundedFunction {
        function: text.unwrap_or_else(|| name(user)),
        variable: name(user),
        bound: if program.has_lower(column) { "upper" } else { "lower" },
        chain: String::new(),
        remedy: remedy.join(" and "),
    }
    .into()
}
