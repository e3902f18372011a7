//! Cuts at the root: rows that every integral point satisfies and the relaxed point violates.
//!
//! Rounds of relaxing and cutting continue while they lift the bound. Cuts that are not active in
//! the last relaxation are dropped, and all of them if the bound has hardly improved.

mod cut;
mod implied_bounds;
mod mixed_integer_rounding;
mod rounding;

pub use cut::Cut;
pub use implied_bounds::implied_bound_cuts;
pub use mixed_integer_rounding::mixed_integer_rounding_cuts;

use crate::presolve::{Domain, Propagator, Reduced, Reduction, reduce};
use crate::program::Program;
use crate::relaxation::{Claim, Ladder, Purpose};
use crate::solver::StopToken;

const ROUNDS: usize = 15;

/// Most cuts of a round.
const CUTS: usize = 60;

/// A round that lifts the bound by less than this, relative, is idle; so many idle ones end it.
const LIFT: f64 = 1e-3;
const IDLE: usize = 3;

/// A first round that lifts the bound by less than this, relative, is the last.
const HOPELESS: f64 = 1e-5;

/// All rounds together must lift the bound by this much, relative.
const WORTH: f64 = 5e-3;

/// Cuts more parallel than this to a better one are left out (cosine).
const PARALLEL: f64 = 0.9;

/// Room, relative to the cut's terms, up to which a cut counts as binding.
const BINDING: f64 = 1e-6;

/// Adds cuts to a program. Returns `None` if they do not pay.
///
/// # Arguments
///
/// * `token`: ends the rounds.
/// * `ladder`: keeps count of the relaxations.
pub(crate) fn strengthen(
    program: &Program,
    token: &StopToken,
    ladder: &mut Ladder,
) -> Option<Program> {
    // Under a curved objective the relaxed optimum is rarely at a corner that a cut takes off.
    let curved = program.quadratic.compute_nnz() > 0;
    if program.integers.is_empty() || curved || program.is_feasibility_problem() {
        return None;
    }
    let mut domain = Domain::new(program);
    let mut propagator = Propagator::new(program);
    propagator.set_stop_token(token);
    propagator.propagate_all(program, &mut domain).ok()?;
    if token.is_over() {
        return None;
    }
    let (first, mut x) = relax(program, &domain, ladder, token)?;
    let (mut last, mut idle) = (first, 0);
    let mut cuts: Vec<Cut> = Vec::new();
    for _ in 0..ROUNDS {
        if token.is_over() {
            return None;
        }
        let mut found = mixed_integer_rounding_cuts(program, &domain, &x, token);
        found.extend(implied_bound_cuts(program, &mut domain, &mut propagator, &x));
        let found = select(found, &x);
        if found.is_empty() {
            break;
        }
        cuts.retain(|cut| cut.room(&x) <= BINDING * cut.scale(&x));
        cuts.extend(found);
        let Some((bound, point)) = relax(&with_cuts(program, &cuts)?, &domain, ladder, token)
        else {
            break;
        };
        x = point;
        idle = if bound - last < LIFT * last.abs().max(1e-6) { idle + 1 } else { 0 };
        last = bound;
        if idle >= IDLE || last - first < HOPELESS * first.abs().max(1e-6) {
            break;
        }
    }
    if last - first < WORTH * first.abs().max(1e-6) {
        return None;
    }
    cuts.retain(|cut| cut.room(&x) <= BINDING * cut.scale(&x));
    with_cuts(program, &cuts)
}

/// The deepest cuts, no two of them nearly parallel.
fn select(mut cuts: Vec<Cut>, x: &[f64]) -> Vec<Cut> {
    cuts.sort_by(|a, b| b.depth(x).total_cmp(&a.depth(x)));
    let mut chosen: Vec<Cut> = Vec::new();
    for cut in cuts {
        if chosen.len() == CUTS {
            break;
        }
        if chosen.iter().all(|other| cut.cosine(other) <= PARALLEL) {
            chosen.push(cut);
        }
    }
    chosen
}

/// Value and point of a relaxation.
fn relax(
    program: &Program,
    domain: &Domain,
    ladder: &mut Ladder,
    token: &StopToken,
) -> Option<(f64, Vec<f64>)> {
    let Reduction::Reduced(reduced) = reduce(program, domain) else { return None };
    let reduced: Reduced = *reduced;
    if reduced.columns.is_empty() {
        return None;
    }
    let answer = ladder.solve_once(&reduced, Purpose::Separation, token);
    let solved = answer.claim == Claim::Solved && answer.x.iter().all(|v| v.is_finite());
    solved.then(|| (reduced.objective(&answer.x), reduced.lift(&answer.x)))
}

/// A program with further rows.
fn with_cuts(program: &Program, cuts: &[Cut]) -> Option<Program> {
    let row = |cut: &Cut| (cut.terms.clone(), [f64::NEG_INFINITY, cut.limit]);
    let rows: Vec<_> = cuts.iter().map(row).collect();
    let mut more = program.clone();
    more.append(&[], &rows)?;
    Some(more)
}
