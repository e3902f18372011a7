//! Contradictions from relaxations: the multipliers of a node's relaxation, as a sum of facts of
//! the original program.
//!
//! No relaxation is trusted: its multipliers are put together again from facts, tangents and
//! bounds that the log has, and only a sum that is a contradiction is written.

use super::aggregated_row::AggregatedRow;
use super::bounds::{Bounds, Side};
use super::claim::Claim;
use super::cones::{ConeRow, cones_by_column};
use super::conjugate_gradients::curved_solution;
use super::facts::Facts;
use super::simple_sums::ObjectiveFact;
use super::tightened::{RowsBefore, TightRowLemma};
use super::zero_products::ObjectiveTerms;
use crate::presolve::{Domain, Reduced, tighten_coefficients};
use crate::program::Program;
use crate::relaxation::{
    CascadePool, MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict, WarmState,
};
use crate::solver::{Options, StopToken};

/// A sum of facts that contradicts the bounds of a context.
#[derive(Debug, Default)]
pub(super) struct FactRefutation {
    /// Facts and multipliers.
    pub(super) facts: Vec<(usize, f64)>,
    /// The point of the tangent of the objective, which has the multiplier -1.
    pub(super) tangent: Option<Vec<(usize, f64)>>,
    /// Rows that hold in cones, with their multipliers.
    pub(super) cones: Vec<(ConeRow, f64)>,
    /// Tightened rows, with their multipliers.
    pub(super) tight: Vec<(TightRowLemma, f64)>,
    /// The bounds that it needs.
    pub(super) sides: Vec<Side>,
}

/// The verdict of a relaxation on a context.
#[derive(Debug)]
pub(super) enum Relaxed {
    /// It has no point.
    Refuted(FactRefutation),
    /// It may have one: the relaxed point, if there is one, and the sum that falls short.
    Open(Option<Vec<f64>>),
    /// A limit came first.
    Stopped,
}

/// Relaxes contexts.
pub(super) struct Relaxer<'a> {
    /// The program with the claim's objective, its rows among the facts.
    pub(super) program: Program,
    /// By row of the program, its fact.
    pub(super) fact_of_row: Vec<usize>,
    pub(super) claim: Claim,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    pub(super) cascade: MethodCascade,
    pub(super) cascades: &'a CascadePool,
    /// The same program, with the bounds of the context that is searched.
    pub(super) within: Program,
    pub(super) sum: AggregatedRow,
    /// The sum for the proofs of tightened rows.
    pub(super) tight_sum: AggregatedRow,
    /// The state that the last relaxation has left: the next context is near.
    pub(super) warm: Option<WarmState>,
    /// The columns of the block that is proved; `None` for all.
    pub(super) is_inside: Option<Vec<bool>>,
    /// By column, the cones that it is in.
    pub(super) cones_of: Vec<Vec<usize>>,
    /// Whether lemmas are proved: what they leave may be small.
    pub(super) wants_vertex: bool,
    /// Whether the multipliers of relaxations that leave a point are kept, and the last ones.
    pub(super) keeps_multipliers: bool,
    pub(super) multipliers: Option<FactRefutation>,
    /// By column, what the proof of convexity lacks.
    pub(super) deficits: Vec<f64>,
    /// The linear part of the objective and its constant, without rounding.
    pub(super) terms: ObjectiveTerms,
    /// The facts that a linear objective is, the strongest first.
    pub(super) objective: Vec<ObjectiveFact>,
}

impl<'a> Relaxer<'a> {
    /// A relaxer of a program whose rows are the first facts.
    pub(super) fn new(
        program: Program,
        claim: Claim,
        (options, token): (&'a Options, &'a StopToken),
        cascades: &'a CascadePool,
    ) -> Self {
        Relaxer {
            terms: ObjectiveTerms::of(&program),
            within: program.clone(),
            fact_of_row: (0..program.row_count()).collect(),
            cones_of: cones_by_column(&program),
            program,
            claim,
            options,
            token,
            cascade: cascades.take(),
            cascades,
            warm: None,
            wants_vertex: false,
            sum: AggregatedRow::default(),
            tight_sum: AggregatedRow::default(),
            is_inside: None,
            keeps_multipliers: false,
            multipliers: None,
            deficits: Vec::new(),
            objective: Vec::new(),
        }
    }
}

impl Relaxer<'_> {
    /// Whether a block is proved by itself.
    pub(super) fn has_block(&self) -> bool {
        self.is_inside.is_some()
    }

    /// Relaxes and searches some columns alone: all others are 0.
    pub(super) fn keep_only(&mut self, columns: &[usize]) {
        let mut is_inside = vec![false; self.program.column_count()];
        columns.iter().for_each(|&j| is_inside[j] = true);
        self.is_inside = Some(is_inside);
        self.within = self.program.clone();
    }

    /// Relaxes and searches all columns again.
    pub(super) fn keep_all(&mut self) {
        self.is_inside = None;
        self.within = self.program.clone();
    }

    /// Whether a column is fixed, and in no cone: then it links no blocks.
    pub(super) fn is_fixed(&self, bounds: &Bounds, j: usize) -> bool {
        let [lower, upper] = bounds.of(j);
        lower == upper && !self.program.is_in_cone(j)
    }

    /// The bounds of a column in relaxations.
    pub(super) fn range(&self, bounds: &Bounds, j: usize) -> [f64; 2] {
        let is_inside = self.is_inside.as_ref().is_none_or(|is_inside| is_inside[j]);
        if is_inside || self.is_fixed(bounds, j) { bounds.of(j) } else { [0.0; 2] }
    }

    /// The program of some bounds with all its rows and columns.
    fn whole(&self, bounds: &Bounds) -> Reduced {
        let mut whole = Reduced::whole(&self.program);
        for j in 0..self.program.column_count() {
            [whole.lower[j], whole.upper[j]] = self.range(bounds, j);
        }
        whole
    }

    /// The program of some bounds, and its rows before big-Ms are made smaller.
    fn reduced(
        &mut self,
        bounds: &Bounds,
        [is_whole, is_tight, has_costs]: [bool; 3],
    ) -> Option<(Reduced, RowsBefore)> {
        let mut domain = Domain::new(&self.program);
        for j in 0..self.program.column_count() {
            let [lower, upper] = self.range(bounds, j);
            domain.apply(j, false, lower);
            domain.apply(j, true, upper);
        }
        let mut reduced = match is_whole {
            true => self.whole(bounds),
            false => self.cascade.reducer().reduce(&self.program, &domain)?,
        };
        reduced.wants_vertex = self.wants_vertex;
        let before = RowsBefore::of(&reduced);
        if is_tight {
            tighten_coefficients(&mut reduced, &self.program.integral);
        }
        if has_costs {
            let limits = reduced.lower.iter().zip(&reduced.upper);
            let cost = |(lower, upper): (&f64, &f64)| match (lower.is_finite(), upper.is_finite()) {
                (true, _) => 1.0,
                (false, true) => -1.0,
                (false, false) => 0.0,
            };
            reduced.linear = limits.map(cost).collect();
        }
        Some((reduced, before))
    }

    /// Relaxes the context of some bounds.
    ///
    /// # Arguments
    ///
    /// * `is_whole`: whether to keep all rows and columns; `is_tight`: whether big-Ms are made
    ///   smaller.
    pub(super) fn relax(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        [is_whole, is_tight]: [bool; 2],
    ) -> Relaxed {
        self.relax_with(facts, bounds, [is_whole, is_tight, false])
    }

    /// As [`relax`](Self::relax); `has_costs`: whether a program without an objective gets one, so
    /// that the dual simplex method solves it, whose multipliers have fewer wrong digits.
    fn relax_with(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        [is_whole, is_tight, has_costs]: [bool; 3],
    ) -> Relaxed {
        // Those of another context may name facts that are gone.
        self.multipliers = None;
        let Some((mut reduced, before)) = self.reduced(bounds, [is_whole, is_tight, has_costs])
        else {
            return Relaxed::Open(None);
        };
        let cutoff = match (self.claim, self.objective.first()) {
            (Claim::Bound(_), Some(objective)) => objective.most,
            (Claim::Bound(bound), None) => bound,
            (Claim::Infeasible, _) => f64::INFINITY,
        };
        let warm = self.warm.take();
        let question = RelaxationQuestion {
            purpose: if warm.is_some() { Purpose::Node } else { Purpose::Root },
            cutoff,
            options: self.options,
            constant: self.program.constant,
            look_for_descent: false,
            token: self.token,
            warm: warm.as_ref(),
        };
        let mut verdict = self.cascade.solve(&mut reduced, &question);
        let mut is_short = false;
        let cuts = self.cascade.take_cone_cuts();
        let relaxed = match &verdict {
            RelaxationVerdict::Stopped => return Relaxed::Stopped,
            RelaxationVerdict::Relaxed { converged: false, bound, .. }
                if *bound <= cutoff && self.token.is_over() =>
            {
                return Relaxed::Stopped;
            }
            RelaxationVerdict::Descent => Relaxed::Open(None),
            RelaxationVerdict::Refuted(y) => {
                let mut found = self.gather(facts, (&reduced, &before), bounds, y);
                found.cones = self.cone_rows(&reduced, &cuts, y);
                is_short = !self.closes(facts, bounds, &mut found);
                if is_short { Relaxed::Open(None) } else { Relaxed::Refuted(found) }
            }
            RelaxationVerdict::Relaxed { bound, x, y, .. } => {
                let point = reduced.lift(x);
                let mut relaxed = None;
                if self.keeps_multipliers && *bound <= cutoff {
                    let found = self.gather(facts, (&reduced, &before), bounds, y);
                    self.multipliers = Some(found);
                }
                if *bound > cutoff {
                    let mut found = self.gather(facts, (&reduced, &before), bounds, y);
                    found.cones = self.cone_rows(&reduced, &cuts, y);
                    is_short = !self.closes_by_objective(facts, bounds, &mut found, &point);
                    if !is_short {
                        relaxed = Some(Relaxed::Refuted(found));
                    }
                }
                relaxed.unwrap_or(Relaxed::Open(Some(point)))
            }
        };
        self.warm = match &mut verdict {
            RelaxationVerdict::Relaxed { warm: state, .. } => state.take().or(warm),
            _ => warm,
        };
        self.cascade.reuse(verdict);
        self.cascade.reducer().reuse(reduced);
        // What has changed the rows may have no proof.
        let may_have_costs = self.claim == Claim::Infeasible && self.program.cones.is_empty();
        match (is_short, is_whole, is_tight) {
            (true, _, true) => self.relax(facts, bounds, [is_whole, false]),
            (true, false, false) => self.relax(facts, bounds, [true, false]),
            (true, true, false) if may_have_costs && !has_costs => {
                self.relax_with(facts, bounds, [true, false, true])
            }
            _ => relaxed,
        }
    }

    /// Whether the multipliers of a program without a point close the context, in one way or
    /// another.
    pub(super) fn closes(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
    ) -> bool {
        self.check(facts, bounds, found).is_some()
            || self.check_simpler(facts, bounds, found).is_some()
            || self.check(facts, bounds, found).is_some()
            || self.check_repaired(facts, bounds, found).is_some()
    }

    /// Whether the multipliers of a bound beyond the claim's close the context, with a fact of a
    /// linear objective or a tangent at a point.
    fn closes_by_objective(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
        point: &[f64],
    ) -> bool {
        if self.check_objective(facts, bounds, found).is_some() {
            return true;
        }
        if !self.objective.is_empty() {
            return false;
        }
        found.tangent = Some(self.tangent_point(point));
        if self.check(facts, bounds, found).is_some()
            || self.check_repaired(facts, bounds, found).is_some()
        {
            return true;
        }
        self.check(facts, bounds, found).is_some()
            || self.move_tangent(bounds, found)
                && (self.check(facts, bounds, found).is_some()
                    || self.check_repaired(facts, bounds, found).is_some())
    }

    /// The entries of a point that the objective is not linear in.
    pub(super) fn tangent_point(&self, point: &[f64]) -> Vec<(usize, f64)> {
        let curved = |j: &usize| !self.program.quadratic_column(*j).0.is_empty();
        let columns = (0..point.len()).filter(curved);
        columns.map(|j| (j, point[j])).filter(|(_, value)| *value != 0.0).collect()
    }

    /// The facts behind the rows of a reduced program, and their multipliers in the log.
    fn gather(
        &self,
        facts: &Facts,
        (reduced, before): (&Reduced, &RowsBefore),
        bounds: &Bounds,
        y: &[f64],
    ) -> FactRefutation {
        let mut found = FactRefutation::default();
        let mut merged_rows: Vec<(usize, usize, f64)> = reduced.merged.clone();
        merged_rows.sort_by_key(|row| row.0);
        for (k, &multiplier) in y.iter().enumerate() {
            let fact_of = |row: &usize| self.fact_of_row.get(*row).copied();
            let Some(row) = reduced.origin.get(k).and_then(fact_of) else { continue };
            if multiplier == 0.0 {
                continue;
            }
            let begin = merged_rows.partition_point(|row| row.0 < k);
            let own = merged_rows[begin..].iter().take_while(|row| row.0 == k);
            let merged = own.filter_map(|(_, row, ratio)| Some((fact_of(row)?, *ratio)));
            let sources = std::iter::once((row, 1.0)).chain(merged.clone());
            if let Some(tight) = before.changed(reduced, k, sources.collect()) {
                if (multiplier > 0.0) == tight.is_upper {
                    found.tight.push((tight, -multiplier));
                }
                continue;
            }
            let candidates = std::iter::once((row, 1.0)).chain(merged);
            // Of parallel rows, the one whose limit is the nearest in the direction of the
            // multiplier.
            let limit = |&(row, ratio): &(usize, f64)| {
                let fixed = |j: usize| {
                    let [lower, upper] = bounds.of(j);
                    (!reduced.keeps(j)).then_some(0.5 * (lower + upper))
                };
                let terms = facts.terms(row).filter_map(|(j, a)| Some(a * fixed(j)?));
                let constant: f64 = terms.sum();
                let [lower, upper] = facts.limits(row);
                let is_upper = (multiplier > 0.0) == (ratio > 0.0);
                let limit = if is_upper { upper } else { lower };
                let limit = (limit - constant) / ratio;
                if multiplier > 0.0 { limit } else { -limit }
            };
            let best = match reduced.merged.is_empty() {
                true => (row, 1.0),
                false => {
                    candidates.min_by(|a, b| limit(a).total_cmp(&limit(b))).unwrap_or((row, 1.0))
                }
            };
            let (row, multiplier) = (best.0, -multiplier / best.1);
            let [lower, upper] = facts.limits(row);
            let side = if multiplier > 0.0 { lower } else { upper };
            if side.is_finite() {
                found.facts.push((row, multiplier));
            }
        }
        found
    }

    /// Moves the tangent's point so that the gradient there is the sum of the other facts, as well
    /// as it can be: then the sum leaves little over that the bounds would multiply.
    fn move_tangent(&self, bounds: &Bounds, found: &mut FactRefutation) -> bool {
        let Some(tangent) = &mut found.tangent else { return false };
        let program = &self.program;
        let n = program.column_count();
        let mut point = vec![0.0; n];
        tangent.iter().for_each(|&(j, p)| point[j] = p);
        // Where the sum leaves something to a bound that the point is at, the move would lose more.
        let is_moved = |j: &usize| {
            let [lower, upper] = bounds.of(*j);
            let own = program.quadratic_entry(*j, *j);
            let left = self.sum.coefficient(*j);
            let room = if left > 0.0 { upper - point[*j] } else { point[*j] - lower };
            lower < upper && 2.0 * own * room > left.abs()
        };
        let curved: Vec<usize> = (0..n).filter(is_moved).collect();
        if curved.is_empty() {
            return false;
        }
        let left: Vec<f64> = curved.iter().map(|&j| self.sum.coefficient(j)).collect();
        let moved = curved_solution(program, &curved, &left, MOST_MOVES);
        curved.iter().zip(&moved).for_each(|(&j, step)| point[j] += step);
        *tangent = self.tangent_point(&point);
        true
    }

    /// Whether a sum of facts is a contradiction; then it gets the sides that it needs.
    pub(super) fn check(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
    ) -> Option<()> {
        let sum = &mut self.sum;
        sum.clear(self.program.column_count());
        found.sides.clear();
        for &(fact, y) in &found.facts {
            let [lower, upper] = facts.limits(fact);
            sum.add_to_limit(y, if y > 0.0 { lower } else { upper });
            facts.terms(fact).for_each(|(j, a)| sum.add(j, a, y));
        }
        let own = &mut self.tight_sum;
        for (row, y) in &mut found.tight {
            let columns = self.program.column_count();
            row.steps.clear();
            let needed = row.prove(facts, &|j| bounds.of(j), own, columns);
            found.sides.extend(needed?);
            sum.add_to_limit(*y, row.limit);
            row.terms.iter().for_each(|&(j, a)| sum.add(j, a, *y));
        }
        for (row, y) in &found.cones {
            row.terms(&self.program).for_each(|(j, a)| sum.add(j, a, *y));
        }
        if let (Some(point), Claim::Bound(bound)) = (&found.tangent, self.claim) {
            let program = &self.program;
            // -(gradient) x >= -(bound - f(p) + gradient p + slack)
            sum.add_to_limit(bound, -1.0);
            self.terms.constant.iter().for_each(|&(a, b)| sum.add_to_limit(a, b));
            self.terms.linear.iter().for_each(|&(j, a, b)| sum.add(j, -a, b));
            for &(j, p) in point {
                let (rows, values) = program.quadratic_column(j);
                for (&i, &a) in rows.iter().zip(values) {
                    sum.add(i, -a, p);
                }
            }
            // f(p) - gradient p = offset - p'Pp / 2; the point is sparse, and sorted.
            for &(j, p) in point {
                let (rows, values) = program.quadratic_column(j);
                for (&i, &a) in rows.iter().zip(values) {
                    if let Ok(k) = point.binary_search_by_key(&i, |(column, _)| *column) {
                        sum.add_rounded_to_limit(-0.5 * a * p * point[k].1);
                    }
                }
            }
            for (j, &deficit) in self.deficits.iter().enumerate().filter(|(_, d)| **d > 0.0) {
                let [lower, upper] = bounds.of(j);
                let k = point.binary_search_by_key(&j, |(column, _)| *column);
                let p = k.map_or(0.0, |k| point[k].1);
                let reach = (lower - p).abs().max((upper - p).abs());
                if reach.is_infinite() {
                    return None;
                }
                sum.add_rounded_to_limit(-0.5 * deficit * reach * reach);
            }
        }
        found.sides.extend(sum.contradiction(&|j| bounds.of(j))?);
        if found.tangent.is_some() {
            let lacking = self.deficits.iter().enumerate().filter(|(_, d)| **d > 0.0);
            found.sides.extend(lacking.flat_map(|(j, _)| [(j, false), (j, true)]));
        }
        Some(())
    }
}

/// Steps of a move of a tangent's point.
const MOST_MOVES: usize = 60;
