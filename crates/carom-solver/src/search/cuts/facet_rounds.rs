//! Rounds of facets at the root of a search that has taken many nodes.
//!
//! Ordinary cuts are rows already, so what facets lift is beyond them. The rounds take a share of
//! the work of the search, so they stop and go on in its pauses. They pay once the root is above
//! the bound that all nodes of the search have come to.

use super::facets::{FacetPool, FacetTools};
use super::kept_facets::{KeptFacets, facet_counts};
use super::parameters::CUTS;
use super::{Cut, select, with_cuts};
use crate::program::Program;
use crate::relaxation::MethodCascade;
use crate::search::root::Root;
use crate::search::root_point::{RootPoint, Strengthened};
use crate::search::trace::event;
use crate::solution::FacetCounts;
use crate::solver::{Options, StopToken};

/// A program with facets.
pub(crate) struct LiftedRoot {
    pub(crate) strengthened: Strengthened,
    /// Its root.
    pub(crate) root: Root,
    pub(crate) counts: FacetCounts,
    /// The facets, for another solve.
    pub(crate) kept: KeptFacets,
}

/// The state of the rounds between pauses.
pub(crate) struct FacetRounds<'a> {
    /// The program before it was cut, whose rows the facets are found among.
    begun: &'a Program,
    /// The program of the search.
    program: &'a Program,
    root: &'a Root,
    options: &'a Options,
    token: &'a StopToken,
    pool: Option<FacetPool>,
    cuts: Vec<Cut>,
    /// The relaxed root before facets, and with those that are known.
    points: Option<[RootPoint; 2]>,
    rounds: u32,
    /// The work that they have taken: iterations times rows.
    work: f64,
    /// The lift of the parts of a round so far.
    gain: f64,
    /// Whether the next round looks for new facets of unions whose known ones are violated, too.
    is_thorough: bool,
    is_over: bool,
}

impl<'a> FacetRounds<'a> {
    /// Rounds that have not begun.
    pub(crate) fn new(
        [begun, program]: [&'a Program; 2],
        root: &'a Root,
        options: &'a Options,
        token: &'a StopToken,
    ) -> Self {
        FacetRounds {
            begun,
            program,
            root,
            options,
            token,
            pool: None,
            cuts: Vec::new(),
            points: None,
            rounds: 0,
            work: 0.0,
            gain: 0.0,
            is_thorough: false,
            is_over: false,
        }
    }

    /// Goes on for a share of the work of a search that has come to a bound. The value of its
    /// incumbent is `+inf` if there is none. Returns whether facets lift the root above the bound.
    pub(crate) fn go_on(
        &mut self,
        [bound, incumbent]: [f64; 2],
        iterations: u64,
        cascade: &mut MethodCascade,
    ) -> bool {
        let is_forced = self.options.parts().facet_nodes == 0;
        let all = match is_forced {
            true => f64::INFINITY,
            false => self.program.row_count() as f64 * iterations as f64,
        };
        self.is_over |= self.relax(cascade).is_none();
        let first = self.points.as_ref().map_or(bound, |[first, _]| first.value);
        let aim = match is_forced {
            true => f64::NEG_INFINITY,
            false => bound + CUTS.facet_margin * (bound - first).max(0.0),
        };
        // A search that has closed much of its gap is likely to close the rest soon.
        let is_late = bound - first > CUTS.facet_gap * (incumbent - first);
        self.is_over |= is_late && !is_forced;
        while !self.is_over && !self.token.is_over() {
            // The share grows with the part of the way to the bound that is done.
            let part = CUTS.share_growth * self.lifted_part(aim);
            let budget = part.clamp(CUTS.facet_share, 1.0) * all;
            if self.work >= budget {
                break;
            }
            self.is_over |= self.run_round(aim, budget, cascade).is_none();
        }
        let lifts = |[first, last]: &[RootPoint; 2]| {
            is_forced || last.value > aim && first.is_lifted_by(CUTS.slight_lift, last.value)
        };
        self.points.as_ref().is_some_and(lifts) && !self.cuts.is_empty()
    }

    /// Relaxes the root, if its relaxed point is not known.
    fn relax(&mut self, cascade: &mut MethodCascade) -> Option<()> {
        if self.points.is_none() {
            let FacetRounds { program, root, options, token, .. } = *self;
            let relax = || RootPoint::new(program, &root.domain, cascade, options, token, None);
            let point = root.point.clone().or_else(relax)?;
            self.points = Some([point.clone(), point]);
        }
        Some(())
    }

    /// The part of the way from the root to an aim that facets have lifted it.
    fn lifted_part(&self, aim: f64) -> f64 {
        let Some([first, last]) = &self.points else { return 0.0 };
        match aim > first.value {
            true => (last.value - first.value) / (aim - first.value),
            false => 1.0,
        }
    }

    /// One round; `None` after the last one.
    fn run_round(&mut self, aim: f64, budget: f64, cascade: &mut MethodCascade) -> Option<()> {
        let FacetRounds { begun, program, root, options, token, .. } = *self;
        let pool = self.pool.get_or_insert_with(|| FacetPool::new(begun, &root.domain));
        let [first, last] = self.points.as_mut()?;
        if pool.is_empty() || self.rounds == CUTS.facet_rounds {
            return None;
        }
        let domain = &root.domain;
        let work = [self.work, budget];
        let mut tools = FacetTools { program: begun, domain, cascade, options, token, work };
        let (found, is_whole) = pool.separate(&last.x, self.is_thorough, &mut tools);
        self.work = tools.work[0];
        // A round that has not looked at all unions says nothing about the next one.
        let found = select(found, &self.cuts, CUTS.most_facet_cosine, &last.x);
        if found.is_empty() {
            let was_thorough = std::mem::replace(&mut self.is_thorough, true);
            return (!is_whole || !was_thorough).then_some(());
        }
        self.rounds += u32::from(is_whole);
        self.cuts.extend(found);
        let more = with_cuts(program, &self.cuts)?;
        let warm = last.warm.as_ref().filter(|_| last.is_vertex);
        let point = RootPoint::new(&more, domain, cascade, options, token, warm)?;
        self.work += point.iterations as f64 * more.row_count() as f64;
        self.gain += (point.value - last.value).max(0.0);
        *last = point;
        if !is_whole {
            return Some(());
        }
        let gain = std::mem::take(&mut self.gain);
        // Later rounds lift the root less and less.
        let is_hopeless = last.value + CUTS.further_gains * gain < aim;
        // Known facets may be slight where new ones are not.
        let is_idle = gain < CUTS.idle_facets * (last.value.max(aim) - first.value);
        let was_thorough = std::mem::replace(&mut self.is_thorough, is_idle);
        let is_last = is_hopeless || is_idle && was_thorough;
        (!is_last).then_some(())
    }

    /// The program with the facets that bind its relaxed root, and its root, which knows a bound.
    pub(crate) fn strengthened(self, bound: f64) -> Option<LiftedRoot> {
        let [first, last] = self.points?;
        let mut cuts = self.cuts;
        cuts.retain(|cut| cut.room(&last.x) <= CUTS.binding * cut.scale(&last.x));
        let program = with_cuts(self.program, &cuts)?;
        let values = [first.value, last.value];
        let pool = self.pool?;
        let counts = facet_counts(&program, &cuts, pool.union_count(), values);
        let kept = KeptFacets { all: cuts.iter().filter_map(|cut| pool.origin(cut)).collect() };
        event!(
            INFO,
            facets = cuts.len(),
            shapes = pool.shape_count(),
            from = first.value,
            to = last.value,
            "facets"
        );
        let mut root = Root { point: Some(last.with_bound(bound)), ..self.root.clone() };
        root.carry_over(&program, self.token);
        let strengthened = Strengthened { program, values, cuts };
        Some(LiftedRoot { strengthened, root, counts, kept })
    }
}
