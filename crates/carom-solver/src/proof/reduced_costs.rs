//! Reduced-cost fixing in a proof: where the multipliers of a relaxation leave a point, bounds of
//! integral columns still follow from the bound of the claim.
//!
//! The sum of the multipliers' facts and of the objective says `c x >= limit` of all columns. Those
//! for which this is a bound become a lemma, with all others at their best, and the bounds follow
//! from that by propagation. A search prunes below such bounds, so its tree has proofs with them.

use super::lemma::Lemma;
use super::tightened::LOOSENING;
use super::tree::ProofWriter;

impl ProofWriter<'_, '_> {
    /// Bounds integral columns by the multipliers of the last relaxation. Returns whether that
    /// closes the context.
    pub(super) fn fix_by_reduced_costs(&mut self) -> bool {
        let Some(mut found) = self.relaxer.multipliers.take() else { return false };
        let Some(objective) = self.relaxer.objective.first() else { return false };
        found.facts.push((objective.fact, -objective.ratio));
        if self.relaxer.check(&self.facts, &self.bounds, &mut found).is_some() {
            self.write(found);
            return true;
        }
        let Some(lemma) = self.bounding_part() else { return false };
        let first = self.facts.len();
        let negation = [f64::NEG_INFINITY, lemma.limit];
        self.facts.push(lemma.terms.iter().copied(), negation);
        found.facts.push((first, -1.0));
        let is_proved = self.relaxer.check(&self.facts, &self.bounds, &mut found).is_some();
        if is_proved {
            self.log.lemma(false, lemma.limit, lemma.terms.iter().copied());
            self.write(found);
        }
        self.facts.truncate(first);
        if !is_proved {
            return false;
        }
        let fact = self.facts.push(lemma.terms.iter().copied(), lemma.limits());
        self.bounds.enqueue(fact as u32);
        self.propagate_root()
    }

    /// The part of the last sum that bounds columns: the terms of these, with all others at their
    /// best. `None` if it bounds none.
    fn bounding_part(&self) -> Option<Lemma> {
        let (sum, integral) = (&self.relaxer.sum, &self.relaxer.program.integral);
        let ranges = |j: usize| (sum.coefficient(j), self.bounds.of(j));
        let best = |j: usize| match ranges(j) {
            (0.0, _) => 0.0,
            (a, [lower, upper]) => (a * lower).max(a * upper),
        };
        let all = sum.columns();
        let (most, size) = all.iter().fold((0.0, sum.limit().abs()), |(most, size), &j| {
            let own = best(j);
            (most + own, size + own.abs())
        });
        let loose = LOOSENING * size;
        let room = most - sum.limit() + 2.0 * loose;
        if !room.is_finite() {
            return None;
        }
        let bounds_column = |j: &usize| {
            let (a, [lower, upper]) = ranges(*j);
            integral[*j] && a.abs() * (upper - lower) > room
        };
        let mut columns: Vec<usize> = all.iter().copied().filter(bounds_column).collect();
        columns.sort_unstable();
        let rest = most - columns.iter().map(|&j| best(j)).sum::<f64>();
        let terms: Vec<_> = columns.into_iter().map(|j| (j, sum.coefficient(j))).collect();
        let limit = sum.limit() - rest - loose;
        let lemma = Lemma { terms, is_upper: false, limit, form: None, sources: None };
        (!lemma.terms.is_empty()).then_some(lemma)
    }
}
