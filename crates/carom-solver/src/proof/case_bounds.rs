//! Bounds that hold in every case of a disjunction, as lemmas: one of the binaries of a covering
//! row is 1, and a binary is 0 or 1.
//!
//! As in presolve, but each case is propagated with all facts, and each bound is proved.

use super::lemma::Lemma;
use super::tree::{Limit, ProofPart, ProofWriter};
use crate::presolve::{
    CASE_COUNTS, ColumnBounds, MAX_CASE_TRIALS, covering_rows, narrow_to_hull, write_changes,
};
use crate::search::{Decision, opposite};

/// Most rounds over all disjunctions.
const MOST_CASE_ROUNDS: usize = 3;

impl ProofWriter<'_, '_> {
    /// Proves the bounds that hold in all cases of a disjunction. Returns whether that closes the
    /// program.
    pub(super) fn bound_by_cases(&mut self) -> Result<bool, Limit> {
        let program = &self.relaxer.program;
        let rows = covering_rows(program, &CASE_COUNTS);
        let mut all: Vec<Vec<usize>> =
            rows.iter().map(|&row| program.row(row).0.to_vec()).collect();
        all.extend(program.integers.iter().map(|&j| vec![j]));
        let mut trials = MAX_CASE_TRIALS;
        for _ in 0..MOST_CASE_ROUNDS {
            let mut has_gained = false;
            for columns in &all {
                let Some(left) = trials.checked_sub(columns.len().max(2)) else { return Ok(false) };
                trials = left;
                let cases = self.open_cases(columns);
                if cases.is_empty() {
                    continue;
                }
                let hull = self.hull(cases);
                self.lemma_cases = columns.clone();
                let is_closed = self.prove_hull(hull, &mut has_gained);
                self.lemma_cases.clear();
                if is_closed? {
                    return Ok(true);
                }
            }
            if !has_gained {
                break;
            }
        }
        Ok(false)
    }

    /// Proves the bounds of a hull; without one, closes the program.
    fn prove_hull(
        &mut self,
        hull: Option<Vec<ColumnBounds>>,
        has_gained: &mut bool,
    ) -> Result<bool, Limit> {
        let Some(hull) = hull else {
            self.lemma_splits = 2 * self.lemma_cases.len() as u32;
            return self.close(ProofPart::Lemma).map(|()| true);
        };
        for ColumnBounds { column, bounds: [lower, upper] } in hull {
            for (is_upper, limit) in [(false, lower), (true, upper)] {
                if !self.is_gain(column, is_upper, limit) {
                    continue;
                }
                let is_integral = self.relaxer.program.integral[column];
                let lemma = Lemma::bound(column, is_upper, limit, is_integral);
                if self.prove(&lemma)?.is_some() {
                    *has_gained = true;
                    if self.propagate_root() {
                        return Ok(true);
                    }
                }
            }
        }
        Ok(false)
    }

    /// The cases of some binaries; none if one is decided, or if nothing is open.
    fn open_cases(&self, columns: &[usize]) -> Vec<Decision> {
        if columns.iter().any(|&j| self.bounds.of(j)[0] > 0.0) {
            return Vec::new();
        }
        let open = columns.iter().filter(|j| self.bounds.of(**j) == [0.0, 1.0]);
        let one = |&column: &usize| Decision { column, is_upper: false, value: 1.0 };
        let mut cases: Vec<Decision> = open.map(one).collect();
        if columns.len() == 1 {
            cases.extend(cases.first().copied().map(opposite));
        }
        cases
    }

    /// The hull of the bounds in some cases, by presolve; `None` if no case is possible.
    fn hull(&mut self, cases: Vec<Decision>) -> Option<Vec<ColumnBounds>> {
        let mut hull: Option<Vec<ColumnBounds>> = None;
        for case in cases {
            let mark = self.bounds.mark();
            if self.enter(case).is_none() {
                let mut changed = Vec::new();
                let sides = self.bounds.changed_since(mark).map(|(side, _)| side);
                write_changes(sides, |j| self.bounds.of(j), &mut changed);
                match &mut hull {
                    Some(hull) => narrow_to_hull(hull, &changed),
                    None => hull = Some(changed),
                }
            }
            self.bounds.undo_to(mark);
        }
        hull
    }
}
