//! Bounds that hold in every case of a disjunction, as lemmas: one of the binaries of a covering
//! row is 1, and a binary is 0 or 1.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::bounds::Side;
use super::lemma::Lemma;
use super::tree::{Limit, ProofPart, ProofWriter};
use crate::presolve::covering_rows;
use crate::search::Decision;

/// The numbers of cases of the rows that are tried.
const ROW_CASES: RangeInclusive<usize> = 2..=12;

/// Most rounds over all disjunctions, and most trials of cases in all of them.
const MOST_CASE_ROUNDS: usize = 3;
const MOST_CASE_TRIALS: usize = 4000;

/// The bounds in all cases of a disjunction.
enum CaseHull {
    /// No case is possible.
    NoCase,
    /// The bounds that change in every case, each as far as in the case where it changes the least.
    Bounds(BTreeMap<Side, f64>),
}

impl ProofWriter<'_, '_> {
    /// Proves the bounds that hold in all cases of a disjunction. Returns whether that closes the
    /// program.
    pub(super) fn bound_by_cases(&mut self) -> Result<bool, Limit> {
        let program = &self.relaxer.program;
        let rows = covering_rows(program, &ROW_CASES);
        let mut all: Vec<Vec<usize>> =
            rows.iter().map(|&row| program.row(row).0.to_vec()).collect();
        all.extend(program.integers.iter().map(|&j| vec![j]));
        let mut trials = MOST_CASE_TRIALS;
        for _ in 0..MOST_CASE_ROUNDS {
            let mut has_gained = false;
            for columns in &all {
                let Some(left) = trials.checked_sub(columns.len().max(2)) else { return Ok(false) };
                trials = left;
                let Some(hull) = self.hull(columns) else { continue };
                self.lemma_cases = columns.clone();
                let is_closed = self.prove_hull(&hull, &mut has_gained);
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

    /// Proves the bounds of a hull; those of no case close the program.
    fn prove_hull(&mut self, hull: &CaseHull, has_gained: &mut bool) -> Result<bool, Limit> {
        let CaseHull::Bounds(hull) = hull else {
            self.lemma_splits = 2 * self.lemma_cases.len() as u32;
            return self.close(ProofPart::Lemma).map(|()| true);
        };
        for (&(column, is_upper), &limit) in hull {
            if !self.is_gain(column, is_upper, limit) {
                continue;
            }
            let lemma =
                Lemma::bound(column, is_upper, limit, self.relaxer.program.integral[column]);
            if self.prove(&lemma)?.is_some() {
                *has_gained = true;
                if self.propagate_root() {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// The hull of the cases of some binaries; `None` if nothing is open.
    fn hull(&mut self, columns: &[usize]) -> Option<CaseHull> {
        let is_open = |j: &usize| self.bounds.of(*j) == [0.0, 1.0];
        let is_decided = columns.iter().any(|&j| self.bounds.of(j)[0] > 0.0);
        let open: Vec<usize> = columns.iter().copied().filter(is_open).collect();
        if is_decided || open.is_empty() {
            return None;
        }
        let ones = open.iter().map(|&column| Decision { column, is_upper: false, value: 1.0 });
        let zero = (columns.len() == 1).then(|| Decision {
            column: columns[0],
            is_upper: true,
            value: 0.0,
        });
        let mut hull: Option<BTreeMap<Side, f64>> = None;
        for case in ones.chain(zero) {
            let mark = self.bounds.mark();
            if self.enter(case).is_none() {
                let changed: BTreeMap<Side, f64> = self.bounds.changed_since(mark).collect();
                hull = Some(match hull {
                    None => changed,
                    Some(mut hull) => {
                        hull.retain(|side, value| {
                            let other = changed.get(side).copied();
                            let worse = if side.1 { f64::max } else { f64::min };
                            *value = other.map_or(*value, |other| worse(*value, other));
                            other.is_some()
                        });
                        hull
                    }
                });
            }
            self.bounds.undo_to(mark);
        }
        Some(hull.map_or(CaseHull::NoCase, CaseHull::Bounds))
    }
}
