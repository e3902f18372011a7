//! Cuts of a presolved root as lemmas.
//!
//! A search cuts its presolved program, in whose rows equalities have replaced columns. So each row
//! that a cut was made of is a lemma first, from the row that it was and the equalities that
//! presolve may have added to it. Then the cut follows by the two sums that its rounding is.

use std::collections::BTreeMap;

use super::claim::Claim;
use super::lemma::Lemma;
use super::strengthened::Tried;
use super::tree::{Limit, ProofWriter};
use crate::presolve::root::{Origins, Presolve, PresolveRule, presolve_around};
use crate::program::{Addition, Program};
use crate::search::cuts::{Cut, WholeForm, strengthen};
use crate::search::{PilotResult, Root, RootCuts};

/// Most rows that a row of the presolved program is looked for in.
const MOST_SOURCES: usize = 300;

/// A side of a row of the presolved program as a fact, and by how much that is looser.
type RowFact = (usize, f64);

/// A presolved program in terms of the one that it was made of, and what is proved of it.
struct CutProgram<'a> {
    program: &'a Program,
    /// Its rows are facts.
    origins: &'a Origins,
    /// By row and side, its fact, if it has a proof.
    rows: BTreeMap<(usize, bool), Option<RowFact>>,
    /// By cut, its fact.
    cuts: Vec<Option<usize>>,
}

impl CutProgram<'_> {
    /// Terms in columns of the original, and the constant that they leave.
    fn terms(&self, terms: &[(usize, f64)]) -> (Vec<(usize, f64)>, f64) {
        let mut constant = 0.0;
        let mut term = |&(j, a): &(usize, f64)| {
            let (factor, own) = self.origins.meanings[j].term(a);
            constant += own;
            (self.origins.columns[j], factor)
        };
        let named = terms.iter().map(&mut term).collect();
        (named, constant)
    }
}

impl ProofWriter<'_, '_> {
    /// Proves the cuts of the search's root, or else those of a root of its own. Returns whether
    /// that closes the program.
    pub(super) fn add_cuts(&mut self) -> Result<bool, Limit> {
        let Claim::Bound(bound) = self.relaxer.claim else { return Ok(false) };
        let guide = self.guide.clone();
        if let Some(cuts) = &guide.cuts {
            let own;
            let origins = match &guide.origins {
                Some(origins) => origins,
                None => {
                    own = Origins::of(&cuts.program);
                    &own
                }
            };
            return self.prove_cuts(cuts, origins);
        }
        let (options, token) = (self.relaxer.options, self.relaxer.token);
        let begun = self.bounded();
        // Presolve adds columns to cones.
        let rules = begun.cones.is_empty().then_some(&PresolveRule::FAITHFUL);
        let done = rules.and_then(|rules| presolve_around(&begun, &[], false, rules, token).ok());
        let (program, origins) = match done {
            Some(Presolve::Presolved(done)) => {
                let fact = |row: usize| self.relaxer.fact_of_row[row];
                let mut origins = done.postsolve.origins();
                origins.rows.iter_mut().for_each(|row| *row = fact(*row));
                origins.equations.values_mut().for_each(|row| *row = fact(*row));
                (done.program, origins)
            }
            _ => {
                let rows = self.relaxer.fact_of_row.clone();
                let origins = Origins { rows, ..Origins::of(&begun) };
                (begun, origins)
            }
        };
        let mut root = Root::new(&program, token, options.parts().probing);
        let mut cascade = self.relaxer.cascades.take();
        let mut known = |_: &Root| {
            let (value, bound) = (Some(bound), f64::NEG_INFINITY);
            Some(PilotResult { value, bound, is_closed: false })
        };
        let cut = strengthen(&program, &mut root, options, token, &mut cascade, &mut known);
        self.relaxer.cascades.give_back(cascade);
        let cuts = cut.map(|mut cut| RootCuts::new(&program, &root, &mut cut));
        cuts.map_or(Ok(false), |cuts| self.prove_cuts(&cuts, &origins))
    }

    /// Proves cuts, of which the last ones become rows.
    fn prove_cuts(&mut self, cuts: &RootCuts, origins: &Origins) -> Result<bool, Limit> {
        let bounds = |j: usize| {
            let place = origins.columns.binary_search(&j).ok()?;
            let meaning = origins.meanings[place];
            let [lower, upper] = cuts.bounds.get(place)?.map(|bound| meaning.value(bound));
            Some(if meaning.factor > 0.0 { [lower, upper] } else { [upper, lower] })
        };
        if self.prove_bounds(&bounds)? {
            return Ok(true);
        }
        let before = self.relaxer.program.clone();
        let mut presolved = CutProgram {
            program: &cuts.program,
            origins,
            rows: BTreeMap::new(),
            cuts: Vec::with_capacity(cuts.found.len()),
        };
        let columns = origins.columns.len();
        let (mut kept, mut unproved) = (Vec::new(), 0);
        for cut in &cuts.found {
            // A column that presolve has added has no name in the log.
            let is_known = cut.terms.iter().all(|&(j, _)| j < columns);
            let lemma = if is_known { Some(self.cut_lemma(&mut presolved, cut)?) } else { None };
            let named = cut.cases.iter().filter(|&&j| j < columns);
            self.lemma_cases = named.map(|&j| origins.columns[j]).collect();
            let tried = lemma.as_ref().map(|lemma| self.try_lemma(lemma, &mut unproved));
            self.lemma_cases.clear();
            let fact = match tried.transpose()? {
                Some(Tried::Closed) => return Ok(true),
                Some(Tried::Proved(fact)) => Some(fact),
                Some(Tried::Unproved) | None => None,
            };
            presolved.cuts.push(fact);
            let Some((fact, lemma)) = fact.zip(lemma) else { continue };
            let limits = lemma.limits();
            let row: Addition = (lemma.terms, limits);
            self.relaxer.program.append(&[], std::slice::from_ref(&row)).ok_or(Limit)?;
            self.relaxer.fact_of_row.push(fact);
            // Rows that no point of the last round has made use of would be in the way.
            if cuts.last.contains(&cut.terms) {
                kept.push((fact, row));
            }
        }
        self.relaxer.program = before;
        self.relaxer.fact_of_row.truncate(self.relaxer.program.row_count());
        self.relaxer.fact_of_row.extend(kept.iter().map(|(fact, _)| *fact));
        let kept: Vec<Addition> = kept.into_iter().map(|(_, row)| row).collect();
        self.relaxer.program.append(&[], &kept).ok_or(Limit)?;
        Ok(false)
    }

    /// A cut in the program's columns, with facts as the rows of its form. It is looser by what
    /// these are looser than the rows of the presolved program.
    fn cut_lemma(&mut self, presolved: &mut CutProgram<'_>, cut: &Cut) -> Result<Lemma, Limit> {
        let count = presolved.program.row_count();
        let mut form: Option<WholeForm> = cut.form.clone();
        let mut limit = cut.limit;
        for side in form.iter_mut().flat_map(|form| &mut form.sides) {
            let mut facts = Vec::with_capacity(side.rows.len());
            for &(row, y) in &side.rows {
                let fact = match row.checked_sub(count) {
                    Some(place) => presolved.cuts[place].map(|fact| (fact, 0.0)),
                    None => self.row_fact(presolved, row, y < 0.0)?,
                };
                if let Some((fact, spare)) = fact {
                    facts.push((fact, y));
                    limit += spare * y.abs();
                }
            }
            side.rows = facts;
        }
        if let Some(form) = &mut form {
            let (terms, constant) = presolved.terms(&form.terms);
            (form.terms, form.value) = (terms, form.value - constant);
        }
        let (terms, constant) = presolved.terms(&cut.terms);
        Ok(Lemma { terms, is_upper: true, limit: limit - constant, form, sources: None })
    }

    /// A side of a row of the presolved program as a fact.
    fn row_fact(
        &mut self,
        presolved: &mut CutProgram<'_>,
        row: usize,
        is_upper: bool,
    ) -> Result<Option<RowFact>, Limit> {
        if let Some(known) = presolved.rows.get(&(row, is_upper)) {
            return Ok(*known);
        }
        let fact = self.prove_row(presolved, row, is_upper)?;
        presolved.rows.insert((row, is_upper), fact);
        Ok(fact)
    }

    /// Proves a side of a row of the presolved program, unless it is one of the program.
    fn prove_row(
        &mut self,
        presolved: &CutProgram<'_>,
        row: usize,
        is_upper: bool,
    ) -> Result<Option<RowFact>, Limit> {
        let origins = presolved.origins;
        let terms = presolved.program.row_terms(row);
        if terms.iter().any(|&(j, _)| j >= origins.columns.len()) {
            return Ok(None);
        }
        let (terms, constant) = presolved.terms(&terms);
        let limits = [presolved.program.row_lower[row], presolved.program.row_upper[row]];
        let (side, origin) = (usize::from(is_upper), origins.rows.get(row).copied());
        let limit = limits[side] - constant;
        if let Some(origin) = origin
            && self.facts.limits(origin)[side] == limit
            && self.facts.terms(origin).eq(terms.iter().copied())
        {
            return Ok(Some((origin, 0.0)));
        }
        let sources = origin.map(|origin| self.sources(origins, origin));
        let mut lemma = Lemma { terms, is_upper, limit, form: None, sources };
        let spare = self.spare(&lemma);
        lemma.limit += if is_upper { spare } else { -spare };
        Ok(self.prove(&lemma)?.map(|fact| (fact, spare)))
    }

    /// The facts that a row of a presolved program may be the sum of: the row that it was, and the
    /// equalities of the replaced columns in these.
    fn sources(&self, origins: &Origins, origin: usize) -> Vec<usize> {
        let mut found = vec![origin];
        let mut at = 0;
        while let Some(&source) = found.get(at).filter(|_| found.len() < MOST_SOURCES) {
            at += 1;
            for (column, _) in self.facts.terms(source) {
                if let Some(&equation) = origins.equations.get(&column)
                    && !found.contains(&equation)
                {
                    found.push(equation);
                }
            }
        }
        found
    }
}
