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
pub use mixed_integer_rounding::{ROWS, mixed_integer_rounding_cuts};

use super::root_point::RootPoint;
use crate::presolve::{Domain, Propagator};
use crate::program::Program;
use crate::relaxation::Ladder;
use crate::solver::StopToken;

const ROUNDS: usize = 15;

/// Most cuts of a round.
const CUTS: usize = 60;

/// A round that lifts the bound by less than this, relative, is idle; so many idle ones end it.
const LIFT: f64 = 1e-3;
const IDLE: usize = 3;

/// A first round that lifts the bound by less than this, relative, is the last: under a linear
/// objective, whose relaxed optimum is a corner, and under a curved one, where it rarely is.
const HOPELESS: [f64; 2] = [1e-5, 5e-3];

/// All rounds together must lift the bound by this much, relative.
const WORTH: [f64; 2] = [5e-3, 1e-2];

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
/// * `known`: the relaxed point, where it is known.
pub(crate) fn strengthen(
    program: &Program,
    token: &StopToken,
    ladder: &mut Ladder,
    known: Option<RootPoint>,
) -> Option<Program> {
    if program.integers.is_empty() || program.is_feasibility_problem() {
        return None;
    }
    let curved = usize::from(program.quadratic.compute_nnz() > 0);
    let mut domain = Domain::new(program);
    let mut propagator = Propagator::new(program);
    propagator.set_stop_token(token);
    propagator.propagate_all(program, &mut domain).ok()?;
    if token.is_over() {
        return None;
    }
    let root = known.or_else(|| RootPoint::new(program, &domain, ladder, token))?;
    let (first, mut x) = (root.value, root.x);
    let (mut last, mut idle) = (first, 0);
    let mut cuts: Vec<Cut> = Vec::new();
    for round in 0..ROUNDS {
        if token.is_over() {
            return None;
        }
        // Most curved programs gain nothing, and a look at single rows tells.
        let rows = if curved == 1 && round == 0 { 1 } else { ROWS };
        let mut found = mixed_integer_rounding_cuts(program, &domain, &x, rows, token);
        if curved == 0 {
            found.extend(implied_bound_cuts(program, &mut domain, &mut propagator, &x));
        }
        let found = select(found, &x);
        if found.is_empty() {
            break;
        }
        cuts.retain(|cut| cut.room(&x) <= BINDING * cut.scale(&x));
        cuts.extend(found);
        let more = with_cuts(program, &cuts)?;
        let Some(relaxed) = RootPoint::new(&more, &domain, ladder, token) else { break };
        let bound = relaxed.value;
        x = relaxed.x;
        idle = if bound - last < LIFT * last.abs().max(1e-6) { idle + 1 } else { 0 };
        let hopeless = last == first && bound - first < HOPELESS[curved] * first.abs().max(1e-6);
        last = bound;
        if idle >= IDLE || hopeless {
            break;
        }
    }
    if last - first < WORTH[curved] * first.abs().max(1e-6) {
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

/// A program with further rows.
fn with_cuts(program: &Program, cuts: &[Cut]) -> Option<Program> {
    let row = |cut: &Cut| (cut.terms.clone(), [f64::NEG_INFINITY, cut.limit]);
    let rows: Vec<_> = cuts.iter().map(row).collect();
    let mut more = program.clone();
    more.append(&[], &rows)?;
    Some(more)
}
