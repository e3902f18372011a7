//! Bounds that hold in every case: of a disjunction, of the conditions of indicators, of a
//! function.
//!
//! Takes the cases of a statement; leaves the bounds that hold in all of them (Van Hentenryck,
//! Saraswat and Deville, Design, implementation, and evaluation of the constraint language cc(FD),
//! Journal of Logic Programming 37, 1998).
//!
//! In each case, its rows tighten the bounds of their variables; the bounds that hold in all cases
//! are those of the smallest box around them. Cases that contradict the bounds do not count, so
//! what a binary with one value left implies holds as it stands.

use std::collections::BTreeMap;

use super::clauses::{Clause, clauses};
use super::conic_rows::implied_rows;
use super::implied_bounds::loosened;
use crate::interval::Interval;
use crate::model::{
    Affine, Formula, Function, FunctionRef, Literal, Logic, Model, Name, StoredConic, StoredTerm,
    Variable, VariableKind,
};
use crate::presolve::{CaseRow, Domain};
use crate::program::Program;

/// The largest number of clauses that are written out for the failure of a condition.
const MAX_FAILING_CLAUSES: usize = 8;

/// The largest number of values of an integer factor that are cases of their own.
const MAX_FACTOR_VALUES: f64 = 16.0;

/// New bounds of columns.
pub(super) type BoundsByColumn = BTreeMap<usize, [f64; 2]>;

/// Cases of which at least one holds.
#[derive(Debug, Default)]
pub(super) struct Alternatives {
    cases: Vec<Alternative>,
    /// The only column for which all cases are told; all columns if there is none.
    only: Option<usize>,
}

/// The literal, the rows and the nested cases that hold in one case.
#[derive(Debug, Default)]
struct Alternative {
    when: Option<Literal>,
    rows: Vec<CaseRow>,
    nested: Vec<Alternatives>,
}

impl Alternatives {
    /// The cases of a model's statements, in its order.
    pub(super) fn of(model: &Model, domain: &Domain) -> Vec<Alternatives> {
        let mut all: Vec<Alternatives> = model
            .functions()
            .filter_map(|function| of_function(model, &function, domain))
            .collect();
        let rows = conditional_rows(model);
        let mut binaries: Vec<Variable> = rows.keys().map(|literal| literal.variable()).collect();
        binaries.dedup();
        let values = binaries.iter().map(|z| vec![z.off(), z.on()]);
        all.extend(values.chain(covering(model, &rows)).map(|clause| {
            let case = |literal: &Literal| Alternative {
                when: Some(*literal),
                rows: rows.get(literal).cloned().unwrap_or_default(),
                nested: Vec::new(),
            };
            Alternatives { cases: clause.iter().map(case).collect(), only: None }
        }));
        all.extend(model.disjunctions().map(|d| of_terms(model, d.stored_terms())));
        all
    }

    /// The work of looking at all cases, in terms of their rows.
    pub(super) fn work(&self) -> usize {
        let of = |case: &Alternative| {
            let nested: usize = case.nested.iter().map(Alternatives::work).sum();
            1 + case.rows.iter().map(|row| 1 + row.len()).sum::<usize>() + nested
        };
        self.cases.iter().map(of).sum()
    }

    /// The bounds that hold in every case and are tighter than the domain's; `None` if no case is
    /// left.
    pub(super) fn bounds(&self, program: &Program, domain: &mut Domain) -> Option<BoundsByColumn> {
        let mut hull: Option<BoundsByColumn> = None;
        for case in &self.cases {
            // The hull is empty: no bound gets tighter, and some case is possible.
            if hull.as_ref().is_some_and(BoundsByColumn::is_empty) {
                break;
            }
            let mark = domain.mark();
            let found = case.apply(program, domain).map(|()| {
                let changed = domain.changed_since(mark).map(|(column, _)| column);
                changed.map(|column| (column, domain.bounds(column))).collect::<BoundsByColumn>()
            });
            domain.undo_to(mark);
            let Some(found) = found else { continue };
            hull = Some(match hull {
                None => found,
                Some(mut hull) => {
                    hull.retain(|column, _| found.contains_key(column));
                    for (column, [lower, upper]) in &mut hull {
                        let [low, high] = found[column];
                        (*lower, *upper) = (lower.min(low), upper.max(high));
                    }
                    hull
                }
            });
        }
        let mut hull = hull?;
        hull.retain(|column, _| self.only.is_none_or(|only| only == *column));
        Some(hull)
    }
}

impl Alternative {
    /// Tightens a domain by everything that holds in the case; `None` if that contradicts it.
    fn apply(&self, program: &Program, domain: &mut Domain) -> Option<()> {
        if let Some(literal) = self.when {
            let (column, value) =
                (literal.variable().index(), f64::from(u8::from(literal.is_on())));
            let [lower, upper] = domain.bounds(column);
            if value < lower || value > upper {
                return None;
            }
            if lower < upper {
                domain.apply(column, !literal.is_on(), value);
            }
        }
        // The second round uses in the first rows what the last ones give.
        for _ in 0..2 {
            let before = domain.mark();
            for row in &self.rows {
                row.tighten(program, domain).ok()?;
            }
            for nested in &self.nested {
                for (column, [lower, upper]) in nested.bounds(program, domain)? {
                    let [low, high] = domain.bounds(column);
                    if lower > low {
                        domain.set_lower(column, lower);
                    }
                    if upper < high {
                        domain.set_upper(column, upper);
                    }
                }
            }
            if domain.mark() == before {
                break;
            }
        }
        Some(())
    }
}

/// A row over a model's variables that holds in a case.
fn row(model: &Model, terms: &[(Variable, f64)], limits: Interval) -> CaseRow {
    let columns = terms.iter().map(|&(v, a)| (v.index(), a));
    CaseRow::new(columns, loosened(model, terms, limits))
}

/// `expression = 0`.
fn equation(model: &Model, expression: Affine) -> CaseRow {
    let (terms, constant) = expression.into_parts();
    row(model, &terms, Interval::point(-constant))
}

/// The rows that a literal implies, by literal.
fn conditional_rows(model: &Model) -> BTreeMap<Literal, Vec<CaseRow>> {
    let mut rows: BTreeMap<Literal, Vec<CaseRow>> = BTreeMap::new();
    for indicator in model.indicators() {
        for literal in single_conditions(indicator.condition()) {
            let row = row(model, indicator.terms(), indicator.limits());
            rows.entry(literal).or_default().push(row);
        }
    }
    for conic in model.conic_constraints() {
        let Some(condition) = conic.condition() else { continue };
        for literal in single_conditions(condition) {
            let of_conic = conic_rows(model, conic.conic(), conic.name());
            rows.entry(literal).or_default().extend(of_conic);
        }
    }
    rows
}

/// Literals each of which implies a condition.
fn single_conditions(condition: &Logic) -> Vec<Literal> {
    if let Some(literal) = condition.as_literal() {
        return vec![literal];
    }
    let fails = Formula::of(condition, false);
    let clauses = clauses(&fails, MAX_FAILING_CLAUSES).unwrap_or_default();
    let single = |clause: &Clause| (clause.len() == 1).then(|| !clause[0]);
    clauses.iter().filter_map(single).collect()
}

/// The rows that a conic row implies; none if the bounds do not make it a cone, which is an error
/// elsewhere.
fn conic_rows(model: &Model, conic: &StoredConic, name: &Name) -> Vec<CaseRow> {
    let rows = implied_rows(conic, name, model).unwrap_or_default();
    rows.iter().map(|of| row(model, &of.terms, Interval::new(of.lower, of.upper))).collect()
}

/// Clauses that must hold, of literals that all imply rows.
fn covering(model: &Model, rows: &BTreeMap<Literal, Vec<CaseRow>>) -> Vec<Clause> {
    let mut found = Vec::new();
    if rows.is_empty() {
        return found;
    }
    for row in model.constraints().filter(|row| row.limits().lower >= 1.0) {
        let binary = |v: Variable| {
            model.variable_ref(v).is_ok_and(|variable| variable.kind() == VariableKind::Binary)
        };
        if row.terms().iter().all(|&(v, a)| a == 1.0 && binary(v)) {
            found.push(row.terms().iter().map(|(v, _)| v.on()).collect());
        }
    }
    for statement in model.logical_constraints() {
        required(&Formula::of(statement.logic(), true), &mut found);
    }
    found.retain(|clause: &Clause| clause.iter().all(|literal| rows.contains_key(literal)));
    found
}

/// Clauses that a formula implies.
fn required(formula: &Formula, found: &mut Vec<Clause>) {
    match formula {
        Formula::And(of) => of.iter().for_each(|member| required(member, found)),
        Formula::Count { at_least, of, .. } if *at_least > 0 => {
            found.extend(of.iter().map(Formula::as_literal).collect::<Option<Clause>>());
        }
        other => found.extend(clauses(other, MAX_FAILING_CLAUSES).unwrap_or_default()),
    }
}

fn of_terms(model: &Model, terms: &[StoredTerm]) -> Alternatives {
    let name = Name::from("term");
    let case = |term: &StoredTerm| Alternative {
        when: Some(term.selector),
        rows: term
            .rows
            .iter()
            .map(|stored| row(model, &stored.terms, Interval::new(stored.lower, stored.upper)))
            .chain(term.conic.iter().flat_map(|conic| conic_rows(model, conic, &name)))
            .collect(),
        nested: term.nested.iter().map(|inner| of_terms(model, inner)).collect(),
    };
    Alternatives { cases: terms.iter().map(case).collect(), only: None }
}

/// The cases of a function; `None` if rows and bounds tell all that there is.
fn of_function(model: &Model, function: &FunctionRef<'_>, domain: &Domain) -> Option<Alternatives> {
    let result = function.result();
    let equal = |e: &Affine| Alternative {
        rows: vec![equation(model, result - e)],
        ..Alternative::default()
    };
    let (cases, only) = match function.function() {
        Function::Absolute(of) => (vec![equal(of), equal(&-of)], None),
        Function::Maximum(of) | Function::Minimum(of) => (of.iter().map(equal).collect(), None),
        Function::Product { factor, of } => {
            let [low, high] = domain.bounds(factor.index());
            let at = |value: f64| {
                let mut case = equal(&(value * of));
                case.rows.push(row(model, &[(*factor, 1.0)], Interval::point(value)));
                case
            };
            if high - low <= MAX_FACTOR_VALUES {
                let steps = (0..=MAX_FACTOR_VALUES as usize).map(|k| low + k as f64);
                (steps.take_while(|value| *value <= high).map(at).collect(), None)
            } else if low.is_finite() && high.is_finite() {
                // Between both ends, the product lies between theirs; the expression need not.
                let ends = [low, high].map(|value| equal(&(value * of)));
                (ends.into(), Some(result.index()))
            } else {
                return None;
            }
        }
        Function::Piecewise { .. }
        | Function::Elementary { .. }
        | Function::Bilinear(_)
        | Function::Quotient(_) => return None,
    };
    Some(Alternatives { cases, only })
}
