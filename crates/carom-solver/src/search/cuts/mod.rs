//! Cuts at the root: rows that every integral point satisfies and the relaxed point violates.
//!
//! Rounds of relaxing and cutting continue while they lift the bound, unless a search of one node
//! without cuts closes the gap. Cuts that stay slack leave, in the end all that are not active, and
//! all of them if the bound has hardly improved.

mod cut;
mod cut_sets;
mod facet_rounds;
mod facets;
mod gomory;
mod hull_exit;
mod kept_facets;
mod mixed_integer_rounding;
mod parameters;
mod polymatroid;
mod rounded_cut;
mod rounding;
mod separated_point;
mod unions;

pub use cut::{Cut, CutSide, WholeForm};
pub use cut_sets::cut_set_cuts;
pub(crate) use facet_rounds::{FacetRounds, LiftedRoot};
pub use facets::facet_cuts;
pub use gomory::gomory_cuts;
pub(crate) use kept_facets::KeptFacets;
pub use mixed_integer_rounding::{MOST_ROWS, mixed_integer_rounding_cuts};
pub use polymatroid::polymatroid_cuts;

use parameters::CUTS;

use super::cone_pool::separate_program_cones;
use super::root::Root;
use super::root_point::{PilotResult, RootPoint, Strengthened};

use crate::presolve::Domain;
use crate::program::Program;
use crate::relaxation::{ConeCut, MethodCascade};
use crate::solver::{Options, StopToken};
use crate::tolerance::largest_magnitude;

/// A search of one node from a root; `None` if it is not wanted.
pub(crate) type PilotSearch<'a> = dyn FnMut(&Root) -> Option<PilotResult> + 'a;

/// Adds cuts to a program. Returns `None` if they do not pay. The root gets the relaxed point of
/// the program that is left.
///
/// # Arguments
///
/// * `token`: ends the rounds.
/// * `cascade`: keeps count of the relaxations.
/// * `pilot`: a search of one node from a root.
pub(crate) fn strengthen(
    program: &Program,
    root: &mut Root,
    options: &Options,
    token: &StopToken,
    cascade: &mut MethodCascade,
    pilot: &mut PilotSearch<'_>,
) -> Option<Strengthened> {
    let idle = program.integers.is_empty() || program.is_feasibility_problem();
    if idle || root.conflict.is_some() || token.is_over() {
        return None;
    }
    let point = root.point.take();
    let relax = || RootPoint::or_bound(program, &root.domain, cascade, options, token, None);
    let point = point.or_else(relax)?;
    let curved = usize::from(program.quadratic.compute_nnz() > 0);
    let start = Root { point: Some(point.clone()), ..root.clone() };
    let piloted = pilot(&start);
    let best = piloted.and_then(|piloted| piloted.value);
    let bound = piloted.map_or(point.bound, |piloted| piloted.bound.max(point.bound));
    if piloted.is_some_and(|piloted| piloted.is_closed) {
        root.point = Some(point.with_bound(bound));
        return None;
    }
    let domain = &root.domain;
    let mut rounds = CutRounds {
        program,
        domain,
        best,
        curved,
        cuts: Vec::new(),
        found: Vec::new(),
        places: Vec::new(),
        keeps_found: options.proof_path().is_some(),
        ages: Vec::new(),
        sets: Sets::Untried,
    };
    let last = rounds.run(&point, options, token, cascade);
    let last = last.filter(|last| {
        rounds.pays([CUTS.total_lift[curved], CUTS.closed_share[1]], &point, last.value)
    });
    let more = last.as_ref().and_then(|last| {
        rounds.drop_idle(&last.x, 0);
        let program = with_cuts(program, &rounds.cuts)?;
        let cuts = std::mem::take(&mut rounds.found);
        Some(Strengthened { program, values: [point.value, last.value], cuts })
    });
    let point = last.filter(|_| more.is_some()).unwrap_or(point);
    root.point = Some(point.with_bound(bound));
    more
}

/// The state of the rounds that cut off the relaxed point.
struct CutRounds<'a> {
    program: &'a Program,
    domain: &'a Domain,
    /// The value of the best point that the pilot search has found.
    best: Option<f64>,
    /// 1 for a curved objective, 0 for a linear one.
    curved: usize,
    cuts: Vec<Cut>,
    /// The cuts of all rounds, if a proof wants to know them. The rows of their forms count on
    /// behind those of the program with these cuts.
    found: Vec<Cut>,
    /// By cut, its place among those.
    places: Vec<usize>,
    keeps_found: bool,
    /// By cut, the rounds since it was active.
    ages: Vec<u32>,
    sets: Sets,
}

/// The experience with cut sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sets {
    Untried,
    Help,
    Idle,
}

impl CutRounds<'_> {
    /// Cuts while the bound rises. Returns the last relaxed point; `None` if there was no round.
    ///
    /// Cuts are found among the rows of the program and the cuts before them: a cut `x <= d z + s`
    /// is the tight form of `x <= m z` from which the next one follows.
    fn run(
        &mut self,
        root: &RootPoint,
        options: &Options,
        token: &StopToken,
        cascade: &mut MethodCascade,
    ) -> Option<RootPoint> {
        let (mut last, mut more): (Option<RootPoint>, Option<Program>) = (None, None);
        let mut idle = 0;
        for round in 0..CUTS.most_rounds {
            if token.is_over() {
                return None;
            }
            let before = last.as_ref().unwrap_or(root);
            let how = (options, token);
            let Some(point) = self.cut(before, &mut more, round, how, cascade) else { break };
            let part = CUTS.idle_share * (point.value - root.value).max(0.0);
            let moved = before.is_lifted_by(CUTS.idle_lift, point.value)
                || point.value - before.value > part;
            idle = if moved { 0 } else { idle + 1 };
            let hopeless = if round == 0 {
                !self.pays([CUTS.first_lift[self.curved], CUTS.closed_share[0]], root, point.value)
            } else {
                let ahead = point.value + CUTS.rounds_ahead * (point.value - before.value).max(0.0);
                !self.pays([CUTS.total_lift[self.curved], CUTS.closed_share[1]], root, ahead)
            };
            last = Some(point);
            if idle >= CUTS.idle_rounds || hopeless {
                break;
            }
        }
        last
    }

    /// One round: the relaxed point with further cuts, and the program with them; `None` if there
    /// are none, or no optimum.
    fn cut(
        &mut self,
        before: &RootPoint,
        more: &mut Option<Program>,
        round: usize,
        (options, token): (&Options, &StopToken),
        cascade: &mut MethodCascade,
    ) -> Option<RootPoint> {
        let program = more.as_ref().unwrap_or(self.program);
        let mut found = self.separate(program, before, round, token);
        let mut sets = self.separate_sets(&before.x, &found, round, token);
        found.iter_mut().for_each(|cut| self.name_rows(cut));
        found.extend(tangents(self.program, &before.x));
        if self.sets == Sets::Help {
            found.append(&mut sets);
        }
        if found.is_empty() && sets.is_empty() {
            return None;
        }
        self.drop_idle(&before.x, CUTS.slack_rounds);
        // A warm start of the interior-point method ends less deep inside the face of optima, which
        // makes cuts worse. A vertex is as good.
        let warm = before.warm.as_ref().filter(|_| before.is_vertex);
        let mut relax = |cuts: &[Cut]| {
            let program = with_cuts(self.program, cuts)?;
            let point = RootPoint::new(&program, self.domain, cascade, options, token, warm)?;
            Some((program, point))
        };
        let some = !found.is_empty();
        self.add(found);
        let mut best = if some { relax(&self.cuts) } else { None };
        if !sets.is_empty() {
            let value = best.as_ref().map_or(before.value, |(_, point)| point.value);
            let lift = CUTS.set_factor * (value - before.value).max(0.0);
            let all = [&self.cuts[..], &sets].concat();
            let both = relax(&all).filter(|(_, point)| {
                before.is_lifted_by(CUTS.idle_lift, point.value)
                    && point.value - before.value >= lift
            });
            self.sets = if both.is_some() { Sets::Help } else { Sets::Idle };
            if both.is_some() {
                self.add(sets);
                best = both;
            }
        }
        let (program, point) = best?;
        *more = Some(program);
        Some(point)
    }

    /// Whether a lift of the root's value to another one is large enough, or closes enough of the
    /// gap.
    fn pays(&self, [large, closed]: [f64; 2], root: &RootPoint, value: f64) -> bool {
        let closes = |gap| value - root.value >= closed * gap;
        // Next to the nodes of a large program, rows cost little.
        let large = if root.is_vertex { CUTS.slight_lift } else { large };
        root.is_lifted_by(large, value)
            || (root.is_lifted_by(CUTS.slight_lift, value)
                && self.best.is_some_and(|best| closes(best - root.value)))
    }

    /// The best cuts that a point violates, from the rows of a program.
    fn separate(
        &self,
        program: &Program,
        point: &RootPoint,
        round: usize,
        token: &StopToken,
    ) -> Vec<Cut> {
        let x = &point.x;
        // Most programs with a curved objective gain nothing; a first round over single rows shows
        // it.
        let rows = if self.looks_at_single_rows(round) { 1 } else { MOST_ROWS };
        let mut cuts = mixed_integer_rounding_cuts(program, self.domain, x, rows, token);
        cuts.extend(gomory_cuts(program, self.domain, x, &point.inverse, token));
        cuts.extend(polymatroid_cuts(program, self.domain, x, token));
        select(cuts, &[], CUTS.most_cosine, x)
    }

    /// Whether a round rounds single rows only.
    fn looks_at_single_rows(&self, round: usize) -> bool {
        self.curved == 1 && round == 0
    }

    /// The best cut sets that a point violates, besides the cuts of a round; none if they have not
    /// helped. They are those of the program as it was: cuts would be further ends of its arcs.
    fn separate_sets(&self, x: &[f64], found: &[Cut], round: usize, token: &StopToken) -> Vec<Cut> {
        if self.sets == Sets::Idle || self.looks_at_single_rows(round) {
            return Vec::new();
        }
        select(cut_set_cuts(self.program, self.domain, x, token), found, CUTS.most_cosine, x)
    }

    /// Drops the cuts that were not active for more than some rounds.
    fn drop_idle(&mut self, x: &[f64], most: u32) {
        for (cut, age) in self.cuts.iter().zip(&mut self.ages) {
            let active = cut.room(x) <= CUTS.binding * cut.scale(x);
            *age = if active { 0 } else { *age + 1 };
        }
        let mut ages = self.ages.iter();
        self.cuts.retain(|_| ages.next().is_some_and(|age| *age <= most));
        let mut ages = self.ages.iter();
        self.places.retain(|_| ages.next().is_some_and(|age| *age <= most));
        self.ages.retain(|age| *age <= most);
    }

    fn add(&mut self, cuts: Vec<Cut>) {
        for cut in cuts {
            self.ages.push(0);
            self.places.push(self.found.len());
            if self.keeps_found {
                self.found.push(cut.clone());
            }
            self.cuts.push(cut);
        }
    }

    /// Has the form of a cut name the cuts that it is made of by their places among all that were
    /// found.
    fn name_rows(&self, cut: &mut Cut) {
        let rows = self.program.row_count();
        let sides = cut.form.iter_mut().flat_map(|form| &mut form.sides);
        for (row, _) in sides.flat_map(|side| &mut side.rows) {
            if let Some(place) = row.checked_sub(rows).and_then(|k| self.places.get(k)) {
                *row = rows + place;
            }
        }
    }
}

/// The deepest cuts, no two of them nearly parallel, and at most so many.
pub(super) fn select_deepest(cuts: Vec<Cut>, most: usize, x: &[f64]) -> Vec<Cut> {
    let mut chosen = select(cuts, &[], CUTS.most_cosine, x);
    chosen.truncate(most);
    chosen
}

/// The deepest cuts, no two of them nearly parallel, nor to those that there are.
fn select(mut cuts: Vec<Cut>, others: &[Cut], most_cosine: f64, x: &[f64]) -> Vec<Cut> {
    cuts.sort_by(|a, b| b.depth(x).total_cmp(&a.depth(x)));
    let mut chosen: Vec<Cut> = Vec::new();
    for cut in cuts {
        if chosen.len() == CUTS.most_cuts {
            break;
        }
        if others.iter().chain(&chosen).all(|other| cut.cosine(other) <= most_cosine) {
            chosen.push(cut);
        }
    }
    chosen
}

/// The tangents at which a point misses cones, if relaxations cut off cones: cuts move the point
/// away from those before.
fn tangents(program: &Program, x: &[f64]) -> Vec<Cut> {
    if program.cone_cuts.is_none() {
        return Vec::new();
    }
    let tangent = |cut: ConeCut| {
        let mut terms = cut.terms;
        terms.sort_unstable_by_key(|term| term.0);
        // A power of two, so that nothing is rounded.
        let scale = (-largest_magnitude(terms.iter().map(|term| &term.1)).log2().ceil()).exp2();
        terms.iter_mut().for_each(|term| term.1 *= scale);
        Cut { terms, limit: 0.0, form: None, cases: Vec::new(), facet: None }
    };
    separate_program_cones(program, x).into_iter().map(tangent).collect()
}

/// A program with further rows.
fn with_cuts(program: &Program, cuts: &[Cut]) -> Option<Program> {
    let row = |cut: &Cut| (cut.terms.clone(), [f64::NEG_INFINITY, cut.limit]);
    let rows: Vec<_> = cuts.iter().map(row).collect();
    let mut more = program.clone();
    more.append(&[], &rows)?;
    Some(more)
}
