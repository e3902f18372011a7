//! The root of a search as lemmas: smaller big-Ms, tighter bounds.
//!
//! They are found on the lowered program as a search finds them, and none of that is trusted: each
//! is proved by a contradiction with a few splits, or left out.

use super::lemma::Lemma;
use super::tree::{Limit, ProofPart, ProofWriter};
use crate::presolve::{tighten_big_ms, tighten_rows};
use crate::program::{Addition, Program};
use crate::search::Root;

/// Splits besides those of the search after which a proof begins again with lemmas.
const FEW_OWN_SPLITS: u64 = 30;

/// Most passes over the rows: a smaller big-M often follows from another one.
const MOST_ROW_PASSES: usize = 4;

/// Most binaries of a row whose changed coefficients are split first.
const MOST_CHANGED_BINARIES: usize = 4;

/// Lemmas of a kind, in a row, that may have no proof.
const MOST_UNPROVED: u32 = 25;

/// The least change of a bound of a continuous column that is worth a lemma, relative to the width
/// (no unit).
const BOUND_GAIN: f64 = 1e-2;

/// The end of a try to prove a lemma.
pub(super) enum Tried {
    Unproved,
    /// It is a fact.
    Proved(usize),
    /// It is, and closes the program.
    Closed,
}

impl ProofWriter<'_, '_> {
    /// Closes the program if few splits besides those of the search suffice.
    pub(super) fn closes_at_once(&mut self, part: ProofPart) -> Result<bool, Limit> {
        let (mark, splits) = (self.bounds.mark(), self.splits_left);
        let facts = self.facts.len();
        self.log.begin_trial();
        self.trial_left = Some(FEW_OWN_SPLITS);
        let closed = self.close(part);
        self.trial_left = None;
        if closed.is_ok() || self.relaxer.token.is_over() {
            self.log.keep_trial();
            return closed.map(|()| true);
        }
        self.log.drop_trial();
        self.bounds.undo_to(mark);
        self.facts.truncate(facts);
        self.splits_left = splits;
        Ok(false)
    }

    /// Proves what the root of a search knows beyond the program. Returns whether that closes the
    /// program.
    pub(super) fn strengthen(&mut self) -> Result<bool, Limit> {
        let (options, token) = (self.relaxer.options, self.relaxer.token);
        if self.bound_by_cases()? {
            return Ok(true);
        }
        for _ in 0..MOST_ROW_PASSES {
            let mut tight = self.bounded();
            if tighten_rows(&mut tight).is_none() {
                tight = self.bounded();
            }
            let tight = tighten_big_ms(&tight, token).unwrap_or(tight);
            let facts = self.facts.len();
            if self.prove_rows(&tight)? {
                return Ok(true);
            }
            if self.facts.len() == facts {
                break;
            }
        }
        let root = Root::new(&self.bounded(), token, options.parts().probing);
        if self.prove_bounds(&|j| root.bounds(j))? || self.add_cuts()? {
            return Ok(true);
        }
        self.relaxer.within = self.relaxer.program.clone();
        if !self.relaxer.has_block() {
            let all = 0..self.relaxer.program.column_count();
            self.write_bounds(all.flat_map(|j| [(j, false), (j, true)]));
            self.bounds.set_written();
        }
        Ok(false)
    }

    /// Tries a lemma, and derives what it says of all columns.
    ///
    /// # Arguments
    ///
    /// * `unproved`: lemmas in a row without a proof.
    pub(super) fn try_lemma(&mut self, lemma: &Lemma, unproved: &mut u32) -> Result<Tried, Limit> {
        if *unproved >= MOST_UNPROVED {
            return Ok(Tried::Unproved);
        }
        let Some(fact) = self.prove(lemma)? else {
            *unproved += 1;
            return Ok(Tried::Unproved);
        };
        *unproved = 0;
        Ok(if self.propagate_root() { Tried::Closed } else { Tried::Proved(fact) })
    }

    /// The program with the present bounds.
    pub(super) fn bounded(&self) -> Program {
        let mut program = self.relaxer.program.clone();
        for j in 0..program.column_count() {
            [program.lower[j], program.upper[j]] = self.bounds.of(j);
        }
        program
    }

    /// Proves bounds of columns.
    pub(super) fn prove_bounds(
        &mut self,
        found: &dyn Fn(usize) -> Option<[f64; 2]>,
    ) -> Result<bool, Limit> {
        let mut unproved = 0;
        for j in 0..self.relaxer.program.column_count() {
            let Some(limits) = found(j) else { continue };
            for (is_upper, limit) in [(false, limits[0]), (true, limits[1])] {
                if !self.is_gain(j, is_upper, limit) {
                    continue;
                }
                let is_integral = self.relaxer.program.integral[j];
                let lemma = Lemma::bound(j, is_upper, limit, is_integral);
                if let Tried::Closed = self.try_lemma(&lemma, &mut unproved)? {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Whether a bound changes the present one by enough.
    pub(super) fn is_gain(&self, column: usize, is_upper: bool, limit: f64) -> bool {
        let [lower, upper] = self.bounds.of(column);
        let gain = if is_upper { upper - limit } else { limit - lower };
        let is_integral = self.relaxer.program.integral[column];
        let least = if is_integral { 0.5 } else { BOUND_GAIN * (upper - lower) };
        limit.is_finite() && (gain == f64::INFINITY || gain > least)
    }

    /// Proves the rows of a program with smaller big-Ms, and puts them into the place of those that
    /// they were.
    fn prove_rows(&mut self, tight: &Program) -> Result<bool, Limit> {
        let before = self.relaxer.program.clone();
        let facts = self.relaxer.fact_of_row.clone();
        let (mut rows, mut unproved): (Vec<(usize, Addition)>, u32) = (Vec::new(), 0);
        for (row, &fact) in facts.iter().enumerate() {
            let terms = tight.row_terms(row);
            let limits = [tight.row_lower[row], tight.row_upper[row]];
            let old = (before.row_terms(row), [before.row_lower[row], before.row_upper[row]]);
            let is_same = old.0 == terms;
            let mut is_replaced = false;
            for (side, is_upper) in [(0, false), (1, true)] {
                let is_old = limits[side].is_infinite() || (is_same && limits[side] == old.1[side]);
                if is_old {
                    continue;
                }
                let (terms, limit, form) = (terms.clone(), limits[side], None);
                let mut lemma = Lemma { terms, is_upper, limit, form, sources: None };
                let spare = self.spare(&lemma);
                lemma.limit += if is_upper { spare } else { -spare };
                self.lemma_cases = switches(&old.0, &lemma.terms);
                self.lemma_cases.retain(|&j| self.relaxer.program.integral[j]);
                let tried = self.try_lemma(&lemma, &mut unproved);
                self.lemma_cases.clear();
                let fact = match tried? {
                    Tried::Closed => return Ok(true),
                    Tried::Unproved => continue,
                    Tried::Proved(fact) => fact,
                };
                let limits = lemma.limits();
                is_replaced = true;
                rows.push((fact, (lemma.terms, limits)));
            }
            // A row with two sides says more than one of them.
            if !is_replaced || (limits[0].is_finite() && limits[1].is_finite()) {
                rows.push((fact, old));
            }
        }
        let entries = rows.iter().enumerate().flat_map(|(k, (_, row))| {
            let terms = row.0.iter();
            terms.map(move |&(j, a)| (k, j, a))
        });
        let limits: Vec<[f64; 2]> = rows.iter().map(|(_, row)| row.1).collect();
        self.relaxer.program.replace_rows(entries, &limits).ok_or(Limit)?;
        self.relaxer.fact_of_row = rows.iter().map(|(fact, _)| *fact).collect();
        Ok(false)
    }
}

/// The columns whose coefficients differ.
fn switches(before: &[(usize, f64)], after: &[(usize, f64)]) -> Vec<usize> {
    let is_changed = |term: &&(usize, f64)| !after.contains(term);
    before.iter().filter(is_changed).map(|(j, _)| *j).take(MOST_CHANGED_BINARIES).collect()
}
