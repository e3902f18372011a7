//! Disjunctions as rows with an M for each pair of terms.
//!
//! Takes a disjunction whose selectors have rows; leaves a row for each side of a row of a term,
//! with an M for each other term (Trespalacios and Grossmann, Improved Big-M reformulation for
//! generalized disjunctive programs, Computers & Chemical Engineering 76, 2015).
//!
//! If term `k` is selected instead of term `i`, a row `a'x <= b` of term `i` can be violated by at
//! most `M_ik = max a'x - b` over the rows of term `k`. Since exactly one selector is true,
//! `a'x <= b + sum M_ik s_k` over the other terms is equivalent to big-M with the largest of them,
//! and its relaxation is never weaker. `M_ik` is negative if term `k` implies more than the row.
//! Inside a term of an outer disjunction, the siblings of that term are other terms as well,
//! because exactly one of all of them is selected.

use std::borrow::Cow;

use super::conic::Raised;
use super::conic_rows::implied_rows;
use super::disjunction::{nested_name, row_name, value};
use super::linear_program::{Maximizer, tidy, tidy_up};
use super::lowering::Lowering;
use super::report::{BigMEntry, BigMSource, Side};
use crate::error::Error;
use crate::interval::add_up;
use crate::model::{Affine, Literal, Model, Name, StoredConic, StoredRow, StoredTerm, Variable};
use crate::tolerance;

/// A term that may be selected instead: its selector and all rows that then hold.
#[derive(Clone)]
struct Other<'a> {
    selector: Literal,
    rows: Vec<Cow<'a, StoredRow>>,
}

/// The rows of a term, and those that its conic rows imply.
pub(super) fn rows_of<'a>(
    term: &'a StoredTerm,
    name: &Name,
    model: &Model,
) -> Result<Vec<Cow<'a, StoredRow>>, Error> {
    let mut rows: Vec<Cow<'a, StoredRow>> = term.rows.iter().map(Cow::Borrowed).collect();
    for conic in &term.conic {
        rows.extend(implied_rows(conic, name, model)?.into_iter().map(Cow::Owned));
    }
    Ok(rows)
}

/// Adds the rows of a disjunction whose selectors already have rows.
pub(super) fn apply(
    name: &Name,
    terms: &[StoredTerm],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    level(name, terms, &[], &[], lowering)
}

/// The terms of one level: `above` are the rows of the terms around it, `beside` their siblings.
fn level(
    name: &Name,
    terms: &[StoredTerm],
    above: &[Cow<'_, StoredRow>],
    beside: &[Other<'_>],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let of_terms = terms.iter().map(|term| rows_of(term, name, &lowering.model));
    let of_terms = of_terms.collect::<Result<Vec<_>, Error>>()?;
    for (k, term) in terms.iter().enumerate() {
        let name = name.suffixed(&format!("_{}", k + 1));
        let siblings = terms.iter().zip(&of_terms).enumerate().filter(|&(other, _)| other != k);
        let mut others: Vec<Other<'_>> = beside.to_vec();
        others.extend(siblings.map(|(_, (other, rows))| Other {
            selector: other.selector,
            rows: above.iter().chain(rows).cloned().collect(),
        }));
        for (r, row) in term.rows.iter().enumerate() {
            let name = row_name(&name, r);
            lowering.begin(&name);
            for (side, limit) in [(Side::Lower, row.lower), (Side::Upper, row.upper)] {
                if limit.is_finite() {
                    add_side(&name, &row.terms, limit, side, &others, lowering)?;
                }
            }
        }
        for (r, conic) in term.conic.iter().enumerate() {
            let name = row_name(&name, term.rows.len() + r);
            lowering.begin(&name);
            add_conic(&name, conic, &others, lowering)?;
        }
        let inside: Vec<_> = above.iter().chain(&of_terms[k]).cloned().collect();
        for (r, inner) in term.nested.iter().enumerate() {
            level(&nested_name(&name, r), inner, &inside, &others, lowering)?;
        }
    }
    Ok(())
}

/// Adds one side of a row, with an M for each of the others.
fn add_side(
    name: &Name,
    terms: &[(Variable, f64)],
    limit: f64,
    side: Side,
    others: &[Other<'_>],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    // A lower side is the upper one of the negated row.
    let sign = if side == Side::Upper { 1.0 } else { -1.0 };
    let up: Vec<(Variable, f64)> = terms.iter().map(|&(v, a)| (v, sign * a)).collect();
    let limit = sign * limit;
    let mut row = Affine::zero();
    up.iter().for_each(|&(variable, a)| row.add_term(a, variable));
    let from_bounds = add_up(lowering.range(&row)?.upper, -limit);
    let mut entry = BigMEntry::new(name, side, BigMSource::LinearProgram);
    entry.needed = from_bounds.max(0.0);
    entry.note_shares(lowering, terms, side)?;
    let mut slack = Affine::zero();
    for other in others {
        let most = upper_bound_if_selected(&up, other, lowering)?;
        if most >= tolerance::INFINITE {
            return Err(lowering.unbounded(&row, 1.0)?);
        }
        if most == f64::NEG_INFINITY {
            // That term can never be selected, so any M is valid.
            continue;
        }
        let m = tidy(add_up(most, -limit).min(from_bounds));
        entry.value = entry.value.max(m);
        slack += m * value(other.selector);
    }
    lowering.affine_row(row - slack, f64::NEG_INFINITY, limit)?;
    entry.row = lowering.newest_row();
    lowering.report.entries.push(entry);
    Ok(())
}

/// Adds a conic row, with an M for each of the others.
fn add_conic(
    name: &Name,
    conic: &StoredConic,
    others: &[Other<'_>],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let raised = Raised::of(conic, name, false, &lowering.model)?;
    let from_bounds = raised.need(lowering, &mut |e, sign, lowering| lowering.largest(e, sign))?;
    let mut entry = BigMEntry::new(name, Side::Upper, BigMSource::LinearProgram);
    entry.needed = from_bounds.value.max(0.0);
    entry.note_shares(lowering, &raised.terms(lowering)?, Side::Upper)?;
    let mut raise = Affine::zero();
    for other in others {
        let need = raised.need(lowering, &mut |e, sign, lowering| {
            let up: Vec<(Variable, f64)> =
                e.terms().into_iter().map(|(v, a)| (v, sign * a)).collect();
            Ok(add_up(upper_bound_if_selected(&up, other, lowering)?, sign * e.offset()))
        })?;
        if need.value == f64::NEG_INFINITY {
            // That term can never be selected, so any M is valid.
            continue;
        }
        if let Some((variable, bound)) = need.unbounded {
            return Err(lowering.unbounded_function(variable, bound));
        }
        let m = tidy_up(need.value.min(from_bounds.value));
        entry.value = entry.value.max(m);
        raise += m * value(other.selector);
    }
    lowering.conic(raised.by(raise))?;
    entry.row = lowering.newest_conic();
    lowering.report.entries.push(entry);
    Ok(())
}

/// The largest value of an expression if another term is selected; infinite if neither the bounds
/// nor that term's rows limit it.
fn upper_bound_if_selected(
    up: &[(Variable, f64)],
    other: &Other<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<f64, Error> {
    let bounds = |variable| lowering.bounds(variable);
    let rows: Vec<&StoredRow> = other.rows.iter().map(AsRef::as_ref).collect();
    let (mut small, renamed) =
        Maximizer::of_rows(&lowering.model, &rows, up, &bounds, lowering.token)?;
    let terms: Vec<(Variable, f64)> = up.iter().map(|&(v, a)| (renamed[&v], a)).collect();
    let mut most = small.upper_bound(&terms, &[]);
    if most >= tolerance::INFINITE {
        most = lowering.upper_bound_by_rows(up);
    }
    Ok(match &mut lowering.maximizer {
        Some(whole) => most.min(whole.upper_bound(up, &[other.selector])),
        None => most,
    })
}
