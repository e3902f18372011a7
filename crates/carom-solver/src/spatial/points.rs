//! Points of a search: relaxed ones, and those of local searches.

use super::local::TangentSearch;
use super::propagation::propagate;
use super::search::{Occasion, SpatialSearch};
use super::state::SearchState;
use crate::presolve::Domain;
use crate::random::SplitMix;

/// Random starts of local searches at the root, if no point is known.
const RANDOM_STARTS: usize = 6;

impl SpatialSearch<'_> {
    /// Offers a relaxed point, settled on the functions.
    pub(super) fn offer(&mut self, state: &mut SearchState<'_>, x: &[f64]) {
        let mut settled = x.to_vec();
        for &j in &self.program.program.integers {
            settled[j] = settled[j].round();
        }
        self.program.settle(&mut settled);
        self.accept(state, &settled);
    }

    /// Makes a point the best one if it is, and if it satisfies the model.
    pub(super) fn accept(&mut self, state: &mut SearchState<'_>, x: &[f64]) {
        let value = self.program.program.objective(x);
        let is_better = state.best.as_ref().is_none_or(|(_, best)| value < *best);
        if value.is_finite() && is_better && (self.accepts)(x) {
            state.statistics.incumbents += 1;
            state.best = Some((x.to_vec(), value));
            self.tell(state, Occasion::Better(x));
        }
    }

    /// Looks for points from random ones, as long as none is known.
    pub(super) fn try_random_starts(&mut self, state: &mut SearchState<'_>, domain: &Domain) {
        let mut random = SplitMix(1);
        for _ in 0..RANDOM_STARTS {
            if state.best.is_some() || self.token.is_over() {
                return;
            }
            let place = |j: usize| {
                let [lower, upper] = domain.bounds(j);
                let (lower, upper) =
                    (lower.max(upper.min(0.0) - 10.0), upper.min(lower.max(0.0) + 10.0));
                lower + random.part() * (upper - lower)
            };
            let start: Vec<f64> = (0..domain.column_count()).map(place).collect();
            self.improve(state, domain, &start);
        }
    }

    /// Looks for a point near another one, with the integers rounded.
    pub(super) fn improve(&mut self, state: &mut SearchState<'_>, domain: &Domain, x: &[f64]) {
        let program = self.program;
        let mut fixed = domain.clone();
        let mark = fixed.mark();
        for &j in &program.program.integers {
            let [lower, upper] = fixed.bounds(j);
            let value = x[j].round().max(lower).min(upper);
            fixed.set_lower(j, value);
            fixed.set_upper(j, value);
        }
        let has_integers = !program.program.integers.is_empty();
        // The cutoff must not exclude what a local search could still improve.
        state.propagator.set_cutoff(&program.program, f64::INFINITY);
        if has_integers
            && propagate(program, &mut state.propagator, &mut fixed, Some(mark)).is_err()
        {
            return;
        }
        state.count();
        let before = state.work();
        let mut found = Vec::new();
        let cutoff = self.cutoff(state);
        let search = TangentSearch { relaxer: &state.relaxer, domain: &fixed, cutoff };
        search.run(&mut state.cascade, x, &mut |x| found.push(x.to_vec()));
        state.count();
        state.local_work += state.work() - before;
        for x in found.iter().rev() {
            self.accept(state, x);
        }
    }
}
