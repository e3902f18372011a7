//! Lemmas: rows that are proved by the contradiction of their negation, with a few splits.
//!
//! A relaxation looks for the best that the rows around a lemma allow of its terms. What it finds
//! has the multipliers, even if the negation is impossible by a small margin only.

use super::claim::Claim;
use super::facts::is_whole;
use super::relaxed::{FactRefutation, Relaxed};
use super::simple_sums::ObjectiveFact;
use super::split_places::is_counted;
use super::tightened::LOOSENING;
use super::tree::{FRACTIONAL, Limit, ProofPart, ProofWriter};
use crate::program::Program;
use crate::search::Decision;
use crate::search::cuts::{CutSide, WholeForm};

/// Most splits of the proof of a lemma.
const LEMMA_SPLITS: u32 = 4;

/// Most rows around a lemma that its proof may use, and the longest of them.
const MOST_NEAR_ROWS: usize = 120;
const LONGEST_NEAR_ROW: usize = 200;

/// A row with one side.
pub(super) struct Lemma {
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) is_upper: bool,
    pub(super) limit: f64,
    /// Where to split first. The rows of its sides are facts.
    pub(super) form: Option<WholeForm>,
    /// The facts that it follows from, if they are known.
    pub(super) sources: Option<Vec<usize>>,
}

impl Lemma {
    /// A bound of a column.
    pub(super) fn bound(column: usize, is_upper: bool, limit: f64, is_integral: bool) -> Self {
        let spare = if is_integral { 0.0 } else { LOOSENING * limit.abs().max(1.0) };
        let limit = if is_upper { limit + spare } else { limit - spare };
        Lemma { terms: vec![(column, 1.0)], is_upper, limit, form: None, sources: None }
    }

    pub(super) fn limits(&self) -> [f64; 2] {
        if self.is_upper { [f64::NEG_INFINITY, self.limit] } else { [self.limit, f64::INFINITY] }
    }
}

impl ProofWriter<'_, '_> {
    /// By how much a lemma may be looser than what it was found as.
    pub(super) fn spare(&self, lemma: &Lemma) -> f64 {
        let reach = |&(j, a): &(usize, f64)| {
            let [lower, upper] = self.bounds.of(j);
            a.abs() * lower.abs().max(upper.abs())
        };
        let reaches = lemma.terms.iter().map(reach).filter(|size| size.is_finite());
        LOOSENING * reaches.fold(lemma.limit.abs(), f64::max)
    }

    /// Derives what the facts say of all columns; whether that closes the program.
    pub(super) fn propagate_root(&mut self) -> bool {
        let conflict = self.bounds.propagate(&self.facts).err();
        conflict.inspect(|&what| self.write_conflict(what)).is_some()
    }

    /// Proves a lemma; returns its fact, or `None` if few splits do not suffice.
    pub(super) fn prove(&mut self, lemma: &Lemma) -> Result<Option<usize>, Limit> {
        let Lemma { terms, is_upper, limit, .. } = lemma;
        let is_integral = |&(j, a): &(usize, f64)| self.relaxer.program.integral[j] && is_whole(a);
        let next = if terms.iter().all(is_integral) && is_whole(*limit) { 1.0 } else { 0.0 };
        let negation = match is_upper {
            true => [limit + next, f64::INFINITY],
            false => [f64::NEG_INFINITY, limit - next],
        };
        let (mark, first) = (self.bounds.mark(), self.facts.len());
        let (mut program, facts) = self.around(lemma).ok_or(Limit)?;
        // What the negation allows is compared with the best that the rows allow: the difference
        // may be small.
        let (ratio, most) = if *is_upper { (-1.0, -negation[0]) } else { (1.0, negation[1]) };
        terms.iter().for_each(|&(j, a)| program.linear[j] = ratio * a);
        let own = vec![ObjectiveFact { fact: first, ratio, most }];
        let objective = std::mem::replace(&mut self.relaxer.objective, own);
        let before = std::mem::replace(&mut self.relaxer.program, program);
        let facts = std::mem::replace(&mut self.relaxer.fact_of_row, facts);
        let claim = std::mem::replace(&mut self.relaxer.claim, Claim::Bound(most));
        self.relaxer.warm = None;
        self.log.begin_trial();
        self.log.lemma(*is_upper, *limit, terms.iter().copied());
        self.lemma_splits = LEMMA_SPLITS + 2 * self.lemma_cases.len() as u32;
        self.lemma_fact = first;
        let fact = self.facts.push(terms.iter().copied(), negation);
        self.bounds.enqueue(fact as u32);
        self.relaxer.wants_vertex = true;
        let closed = self.close_lemma(lemma);
        self.relaxer.wants_vertex = false;
        (self.relaxer.program, self.relaxer.claim) = (before, claim);
        self.relaxer.objective = objective;
        self.relaxer.fact_of_row = facts;
        self.relaxer.warm = None;
        self.bounds.undo_to(mark);
        self.facts.truncate(first);
        if closed.is_err() {
            self.log.drop_trial();
            return if self.relaxer.token.is_over() { Err(Limit) } else { Ok(None) };
        }
        self.log.keep_trial();
        let fact = self.facts.push(terms.iter().copied(), lemma.limits());
        self.bounds.enqueue(fact as u32);
        Ok(Some(fact))
    }

    /// Assumes a row, as the next fact.
    fn assume(&mut self, terms: &[(usize, f64)], limits: [f64; 2]) -> Result<(), Limit> {
        let fact = self.facts.push(terms.iter().copied(), limits);
        self.bounds.enqueue(fact as u32);
        self.relaxer.fact_of_row.push(fact);
        let row = (terms.to_vec(), limits);
        self.relaxer.program.append(&[], &[row]).ok_or(Limit)
    }

    /// Closes the context of a lemma's negation: by the two sides of its form, if it has one.
    fn close_lemma(&mut self, lemma: &Lemma) -> Result<(), Limit> {
        let Some(WholeForm { terms, value, sides }) = &lemma.form else {
            return self.close(ProofPart::Lemma);
        };
        let is_integral = |&(j, a): &(usize, f64)| self.relaxer.program.integral[j] && is_whole(a);
        if !terms.iter().all(is_integral) || !is_whole(*value) {
            return self.close(ProofPart::Lemma);
        }
        self.log.split_form(*value, terms.iter().copied());
        let (mark, first) = (self.bounds.mark(), self.facts.len());
        let rows = self.relaxer.fact_of_row.len();
        let begun = self.relaxer.program.clone();
        let limits = [[f64::NEG_INFINITY, *value], [value + 1.0, f64::INFINITY]];
        for (limits, side) in limits.into_iter().zip(sides) {
            if self.close_side(lemma, side, limits) {
                continue;
            }
            // What the negation says is derived again on each side.
            self.bounds.enqueue(first as u32 - 1);
            self.assume(terms, limits)?;
            self.close(ProofPart::Lemma)?;
            self.bounds.undo_to(mark);
            self.facts.truncate(first);
            self.relaxer.fact_of_row.truncate(rows);
            self.relaxer.program = begun.clone();
        }
        Ok(())
    }

    /// Closes a side of a form by the sum that the rounding is, if rounding in the sum allows it.
    /// Returns whether it does.
    fn close_side(&mut self, lemma: &Lemma, side: &CutSide, limits: [f64; 2]) -> bool {
        let Some(form) = &lemma.form else { return false };
        let (mark, first) = (self.bounds.mark(), self.facts.len());
        self.facts.push(form.terms.iter().copied(), limits);
        let mut found = FactRefutation::default();
        found
            .facts
            .extend([(first - 1, if lemma.is_upper { 1.0 } else { -1.0 }), (first, side.form)]);
        found.facts.extend(&side.rows);
        let is_closed = self.relaxer.check(&self.facts, &self.bounds, &mut found).is_some();
        if is_closed {
            self.write(found);
        }
        self.bounds.undo_to(mark);
        self.facts.truncate(first);
        is_closed
    }

    /// The rows around a lemma, without an objective, and their facts.
    fn around(&self, lemma: &Lemma) -> Option<(Program, Vec<usize>)> {
        let all = &self.relaxer.program;
        let mut own = all.clone();
        own.make_feasibility_problem();
        let facts: Vec<usize> = match &lemma.sources {
            Some(facts) => facts.clone(),
            None if all.row_count() <= MOST_NEAR_ROWS => {
                return Some((own, self.relaxer.fact_of_row.clone()));
            }
            None => {
                let is_cut = lemma.form.is_some();
                let rows = if is_cut { behind(all, lemma) } else { near(all, lemma) };
                rows.into_iter().map(|row| self.relaxer.fact_of_row[row]).collect()
            }
        };
        let limits: Vec<[f64; 2]> = facts.iter().map(|&fact| self.facts.limits(fact)).collect();
        let terms = facts
            .iter()
            .enumerate()
            .flat_map(|(k, &fact)| self.facts.terms(fact).map(move |(j, a)| (k, j, a)));
        own.replace_rows(terms, &limits)?;
        Some((own, facts))
    }

    /// The split of a context within the proof of a lemma; `None` if the context is closed.
    pub(super) fn split_lemma(&mut self) -> Result<Option<Decision>, Limit> {
        let is_open = |j: &usize| self.bounds.of(*j) == [0.0, 1.0];
        if let Some(column) = self.lemma_cases.iter().copied().find(is_open) {
            self.lemma_splits = self.lemma_splits.checked_sub(1).ok_or(Limit)?;
            return Ok(Some(Decision { column, is_upper: true, value: 0.0 }));
        }
        let point = match self.relaxer.relax(&self.facts, &self.bounds, [false, true]) {
            Relaxed::Refuted(refutation) => {
                self.write(refutation);
                return Ok(None);
            }
            Relaxed::Open(Some(point)) => point,
            Relaxed::Open(None) | Relaxed::Stopped => return Err(Limit),
        };
        self.lemma_splits = self.lemma_splits.checked_sub(1).ok_or(Limit)?;
        // The binaries of the lemma itself, as far as they are open, tell the most.
        let negation = self.lemma_fact;
        let is_open = |j: &usize| {
            let [lower, upper] = self.bounds.of(*j);
            self.relaxer.program.integral[*j] && upper - lower == 1.0 && is_counted(lower)
        };
        if let Some(column) = self.facts.terms(negation).map(|(j, _)| j).find(is_open) {
            let [value, _] = self.bounds.of(column);
            return Ok(Some(Decision { column, is_upper: true, value }));
        }
        let split = self.own_split(Some(&point)).ok_or(Limit)?;
        let distance = (point[split.column] - point[split.column].round()).abs();
        if distance > FRACTIONAL { Ok(Some(split)) } else { Err(Limit) }
    }
}

/// The rows that a lemma may follow from: those of its columns, those of their other columns, and
/// so on.
fn near(program: &Program, lemma: &Lemma) -> Vec<usize> {
    let mut columns: Vec<usize> = lemma.terms.iter().map(|(j, _)| *j).collect();
    let mut has_column = vec![false; program.column_count()];
    let mut has_row = vec![false; program.row_count()];
    columns.iter().for_each(|&j| has_column[j] = true);
    let (mut rows, mut at) = (Vec::new(), 0);
    while let Some(&column) = columns.get(at).filter(|_| rows.len() < MOST_NEAR_ROWS) {
        at += 1;
        for &row in program.column(column).0 {
            let own = program.row(row).0;
            if std::mem::replace(&mut has_row[row], true) || own.len() > LONGEST_NEAR_ROW {
                continue;
            }
            rows.push(row);
            for &j in own {
                if !std::mem::replace(&mut has_column[j], true) {
                    columns.push(j);
                }
            }
        }
    }
    rows
}

/// The rows that a cut may have been made of: those with the fewest columns that it does not have.
fn behind(program: &Program, lemma: &Lemma) -> Vec<usize> {
    let mut is_own = vec![false; program.column_count()];
    lemma.terms.iter().for_each(|&(j, _)| is_own[j] = true);
    let rows = lemma.terms.iter().flat_map(|&(j, _)| program.column(j).0.iter().copied());
    let mut rows: Vec<usize> = rows.collect();
    rows.sort_unstable();
    rows.dedup();
    rows.sort_by_cached_key(|&row| program.row(row).0.iter().filter(|j| !is_own[**j]).count());
    rows.truncate(MOST_NEAR_ROWS);
    rows
}
