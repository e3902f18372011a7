//! Facts that hold everywhere: the objective below the claim, convexity, heads of cones.

use super::bounds::Clash;
use std::rc::Rc;

use super::claim::Claim;
use super::cones::ConeRow;
use super::convexity::ConvexityProof;
use super::simple_sums::ObjectiveFact;
use super::tree::{Limit, Probing, ProofPart, ProofWriter};
use crate::interval::add_up;
use crate::search::granularity;

impl ProofWriter<'_, '_> {
    /// Derives what holds everywhere, and closes the whole program.
    ///
    /// # Arguments
    ///
    /// * `point`: the best point that is known.
    pub(super) fn run(&mut self, point: Option<&[f64]>) -> Result<(), Limit> {
        self.declare()?;
        let is_empty = |j: &usize| {
            let [lower, upper] = self.bounds.of(*j);
            lower > upper
        };
        if let Some(column) = (0..self.relaxer.program.column_count()).find(is_empty) {
            self.log.conflict(Clash::Column(column));
            return Ok(());
        }
        for fact in 0..self.facts.len() as u32 {
            self.bounds.enqueue(fact);
        }
        self.add_objective();
        self.add_cones();
        if let Err(what) = self.bounds.propagate(&self.facts) {
            self.write_conflict(what);
            return Ok(());
        }
        if self.relaxer.program.quadratic.compute_nnz() > 0 {
            self.add_curvature();
        }
        if self.close_blocks(point)? {
            return Ok(());
        }
        let order: Vec<usize> = self.relaxer.program.integers.iter().rev().copied().collect();
        let begin = Probing::new(order, ProofPart::Node(self.guide.clone(), 0), None);
        self.close_strengthened(ProofPart::Probing(Box::new(begin)))
    }

    /// Closes the program, or a block of it: at once if that takes few splits besides those of the
    /// search, and else behind the lemmas of its root.
    pub(super) fn close_strengthened(&mut self, part: ProofPart) -> Result<(), Limit> {
        let has_integers = !self.relaxer.program.integers.is_empty();
        if !has_integers {
            return self.close(part);
        }
        if self.closes_at_once(part.clone())? || self.strengthen()? {
            return Ok(());
        }
        self.relaxer.keeps_multipliers = true;
        if self.closes_at_once(part.clone())? {
            return Ok(());
        }
        // The search had another relaxation: its splits are those of a search of this one.
        let most = FEWEST_NODES.max(NODES_PER_SPLIT * self.guide.splits.len() as u64);
        let guide = self.relaxer.search(&self.bounds, most)?;
        let part = if guide.splits.is_empty() { part } else { ProofPart::Node(Rc::new(guide), 0) };
        self.close(part)
    }

    /// States what is known of a quadratic objective: a tighter form of it, that it is convex, and
    /// bounds that follow.
    fn add_curvature(&mut self) {
        self.add_zero_products();
        let program = &self.relaxer.program;
        let is_open = |j: usize| program.lower[j].is_infinite() || program.upper[j].is_infinite();
        self.state_convexity(ConvexityProof::of(&self.relaxer.program, &is_open));
        self.bound_by_curvature();
        // A proof that is rounded has small deficits, which a column without a bound cannot have.
        // What columns with bounds pay for its steepness bounds it; then the small deficits do.
        let lacks_bound = |j: usize| self.bounds.of(j).iter().any(|bound| bound.is_infinite());
        let deficits = self.relaxer.deficits.iter().enumerate();
        if !deficits.into_iter().any(|(j, &lack)| lack > 0.0 && lacks_bound(j)) {
            return;
        }
        if let Some(steep) = ConvexityProof::steep(&self.relaxer.program, &lacks_bound) {
            self.state_convexity(steep);
            self.bound_by_curvature();
            let lacks_bound = |j: usize| self.bounds.of(j).iter().any(|bound| bound.is_infinite());
            self.state_convexity(ConvexityProof::of(&self.relaxer.program, &lacks_bound));
        }
    }

    fn state_convexity(&mut self, ConvexityProof { factor, deficits }: ConvexityProof) {
        let lacking = deficits.iter().copied().enumerate().filter(|(_, lack)| *lack != 0.0);
        self.log.convexity(lacking, &factor);
        self.relaxer.deficits = deficits;
    }

    /// Adds the rows by which the head of a cone bounds each entry of its tail: `|entry| <= head`,
    /// or twice an entry at most the sum of both heads.
    fn add_cones(&mut self) {
        for cone in 0..self.relaxer.program.cones.len() {
            let own = &self.relaxer.program.cones[cone];
            let (heads, entries) = (own.head().len(), own.tail().len());
            for (entry, weight) in (0..entries).flat_map(|entry| [(entry, 1.0), (entry, -1.0)]) {
                let mut tail = vec![0.0; entries];
                tail[entry] = weight;
                let row = ConeRow { cone, head: vec![1.0; heads], tail };
                self.log.cone_row(cone, &row.head, &row.tail);
                let terms: Vec<(usize, f64)> = row.terms(&self.relaxer.program).collect();
                let fact = self.facts.push(terms.into_iter(), [0.0, f64::INFINITY]);
                self.bounds.enqueue(fact as u32);
            }
        }
    }

    /// Adds the facts that a linear objective is: it is below the bound, and a multiple of what its
    /// whole coefficients have in common.
    fn add_objective(&mut self) {
        let Claim::Bound(bound) = self.relaxer.claim else { return };
        let program = &self.relaxer.program;
        if program.quadratic.compute_nnz() > 0 {
            return;
        }
        let costs = program.linear.iter().copied().enumerate().filter(|(_, cost)| *cost != 0.0);
        let costs: Vec<(usize, f64)> = costs.collect();
        self.log.tangent(std::iter::empty());
        let limit = add_up(bound, -program.offset);
        let unit = granularity(program);
        let fact = self.facts.push(costs.iter().copied(), [f64::NEG_INFINITY, limit]);
        self.bounds.enqueue(fact as u32);
        let offset = program.offset;
        self.relaxer.objective.push(ObjectiveFact { fact, ratio: 1.0, most: bound });
        let least = (limit / unit).floor();
        if unit > 0.0 && least.abs() < MOST_WHOLE && (least + 1.0) * unit > limit {
            // Not at most `least` units would be at least one more, and that is beyond the limit.
            let terms = costs.iter().map(|(j, cost)| (*j, cost / unit));
            self.log.lemma(true, least, terms.clone());
            let next = self.facts.len();
            self.log.contradiction([(fact, -1.0), (next, unit)].into_iter());
            let lemma = self.facts.push(terms, [f64::NEG_INFINITY, least]);
            self.bounds.enqueue(lemma as u32);
            let most = add_up(least * unit, offset);
            self.relaxer.objective.insert(0, ObjectiveFact { fact: lemma, ratio: unit, most });
        }
    }
}

/// The limit of nodes of the search of a strengthened program: the least one, and the multiple of
/// the first search's splits.
const FEWEST_NODES: u64 = 2000;
const NODES_PER_SPLIT: u64 = 4;

/// The largest whole numbers that are counted in (no unit).
const MOST_WHOLE: f64 = 1e9;
