//! Cuts at the root: rows that every integral point satisfies and the relaxed point violates.
//!
//! Rounds of relaxing and cutting continue while they lift the bound. Cuts that stay slack leave, in
//! the end all that are not active, and all of them if the bound has hardly improved.

mod cut;
mod implied_bounds;
mod mixed_integer_rounding;
mod rounding;

pub use cut::Cut;
pub use implied_bounds::implied_bound_cuts;
pub use mixed_integer_rounding::{ROWS, mixed_integer_rounding_cuts};

use super::root::Root;
use super::root_point::RootPoint;
use crate::program::Program;
use crate::relaxation::Ladder;
use crate::solver::{Options, StopToken};

const ROUNDS: usize = 15;

/// Most cuts of a round.
const CUTS: usize = 300;

/// A round that lifts the bound by less than this, relative, is idle; so many idle ones end it.
const LIFT: f64 = 1e-3;
const IDLE: usize = 3;

/// A first round that lifts the bound by less than this, relative, is the last: under a linear
/// objective, whose relaxed optimum is a corner, and under a curved one, where it rarely is.
const HOPELESS: [f64; 2] = [1e-5, 5e-3];

/// All rounds together must lift the bound by this much, relative.
const WORTH: [f64; 2] = [5e-3, 1e-2];

/// Cuts more parallel than this to a better one are left out (cosine).
const PARALLEL: f64 = 0.7;

/// Rounds for which a cut may be slack before it leaves: the point is inside the face of all optima,
/// and the next round may move it back.
const PATIENCE: u32 = 2;

/// Room, relative to the cut's terms, up to which a cut counts as binding.
const BINDING: f64 = 1e-6;

/// Adds cuts to a program. Returns `None` if they do not pay. The root gets the relaxed point of the
/// program that is left.
///
/// # Arguments
///
/// * `token`: ends the rounds.
/// * `ladder`: keeps count of the relaxations.
pub(crate) fn strengthen(
    program: &Program,
    root: &mut Root,
    options: &Options,
    token: &StopToken,
    ladder: &mut Ladder,
) -> Option<Program> {
    let idle = program.integers.is_empty() || program.is_feasibility_problem();
    if idle || root.conflict.is_some() || token.is_over() {
        return None;
    }
    let point = root.point.take();
    let point = point.or_else(|| RootPoint::new(program, &root.domain, ladder, options, token))?;
    let curved = usize::from(program.quadratic.compute_nnz() > 0);
    let mut rounds = Rounds { program, root, curved, cuts: Vec::new(), ages: Vec::new() };
    let last = rounds.run(&point, options, token, ladder);
    let last = last.filter(|last| point.is_lifted_by(WORTH[curved], last.value));
    let more = last.as_ref().and_then(|last| {
        rounds.drop_idle(&last.x, 0);
        with_cuts(program, &rounds.cuts)
    });
    root.point = last.filter(|_| more.is_some()).or(Some(point));
    more
}

/// Rounds of cutting the relaxed point off.
struct Rounds<'a> {
    program: &'a Program,
    root: &'a mut Root,
    /// 1 for a curved objective, 0 for a linear one.
    curved: usize,
    cuts: Vec<Cut>,
    /// By cut, the rounds since it was active.
    ages: Vec<u32>,
}

impl Rounds<'_> {
    /// Cuts as long as it lifts the bound. Returns the last relaxed point, if there was a round.
    ///
    /// Cuts are found among the rows of the program and the cuts before them: a cut `x <= d z + s`
    /// is the tight form of `x <= m z` from which the next one follows.
    fn run(
        &mut self,
        root: &RootPoint,
        options: &Options,
        token: &StopToken,
        ladder: &mut Ladder,
    ) -> Option<RootPoint> {
        let (mut last, mut more): (Option<RootPoint>, Option<Program>) = (None, None);
        let mut idle = 0;
        for round in 0..ROUNDS {
            if token.is_over() {
                return None;
            }
            let before = last.as_ref().unwrap_or(root);
            let found =
                self.separate(more.as_ref().unwrap_or(self.program), &before.x, round, token);
            if found.is_empty() {
                break;
            }
            self.drop_idle(&before.x, PATIENCE);
            self.ages.extend(found.iter().map(|_| 0));
            self.cuts.extend(found);
            let program = more.insert(with_cuts(self.program, &self.cuts)?);
            let point = RootPoint::new(program, &self.root.domain, ladder, options, token);
            let Some(point) = point else { break };
            idle = if before.is_lifted_by(LIFT, point.value) { 0 } else { idle + 1 };
            let hopeless = round == 0 && !root.is_lifted_by(HOPELESS[self.curved], point.value);
            last = Some(point);
            if idle >= IDLE || hopeless {
                break;
            }
        }
        last
    }

    /// The best cuts that a point violates, from the rows of a program.
    fn separate(
        &mut self,
        program: &Program,
        x: &[f64],
        round: usize,
        token: &StopToken,
    ) -> Vec<Cut> {
        let Root { domain, propagator, .. } = &mut *self.root;
        // Most curved programs gain nothing, and a look at single rows tells.
        let rows = if self.curved == 1 && round == 0 { 1 } else { ROWS };
        let mut found = mixed_integer_rounding_cuts(program, domain, x, rows, token);
        if self.curved == 0 {
            found.extend(implied_bound_cuts(self.program, domain, propagator, x));
        }
        select(found, x)
    }

    /// Drops the cuts that were not active for more than some rounds.
    fn drop_idle(&mut self, x: &[f64], most: u32) {
        for (cut, age) in self.cuts.iter().zip(&mut self.ages) {
            let active = cut.room(x) <= BINDING * cut.scale(x);
            *age = if active { 0 } else { *age + 1 };
        }
        let mut ages = self.ages.iter();
        self.cuts.retain(|_| ages.next().is_some_and(|age| *age <= most));
        self.ages.retain(|age| *age <= most);
    }
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
