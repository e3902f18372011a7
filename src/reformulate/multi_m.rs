//! Disjunctions by an M for each pair of terms.
//!
//! Where term `k` is selected instead of term `i`, a row `a'x <= b` of term `i` can be missed by
//! at most `M_ik = max a'x - b` over the rows of term `k`. Since exactly one selector is true,
//! `a'x <= b + sum M_ik s_k` over the other terms says the same as big-M with the largest of them,
//! and its relaxation is never weaker (Trespalacios and Grossmann 2015). An `M_ik` may be negative:
//! then term `k` asks for more than the row. Inside a term of an outer disjunction, the terms that
//! stand beside it are others as well: of all of them together exactly one is selected.

use super::disjunction::{nested_name, row_name, value};
use super::linear_program::{Maximizer, tidy};
use super::lowering::Lowering;
use super::report::{BigMEntry, BigMSource, Side};
use crate::error::Error;
use crate::interval::{Interval, add_up};
use crate::model::{Affine, Literal, Name, StoredRow, StoredTerm, Variable};

/// A term that may be selected instead: its selector and all rows that then hold.
#[derive(Clone)]
struct Other<'a> {
    selector: Literal,
    rows: Vec<&'a StoredRow>,
}

/// Adds the rows of a disjunction whose selectors have theirs.
pub(super) fn apply(
    name: &Name,
    terms: &[StoredTerm],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    level(name, terms, &[], &[], lowering)
}

/// The terms of one level: `above` are the rows of the terms around it, `beside` the terms that
/// stand beside those.
fn level(
    name: &Name,
    terms: &[StoredTerm],
    above: &[&StoredRow],
    beside: &[Other<'_>],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    for (k, term) in terms.iter().enumerate() {
        let name = name.suffixed(&format!("_{}", k + 1));
        let siblings = terms.iter().enumerate().filter(|&(other, _)| other != k);
        let mut others: Vec<Other<'_>> = beside.to_vec();
        others.extend(siblings.map(|(_, other)| Other {
            selector: other.selector,
            rows: above.iter().copied().chain(&other.rows).collect(),
        }));
        for (r, row) in term.rows.iter().enumerate() {
            let name = row_name(&name, r);
            lowering.begin(&name);
            for (side, limit) in [(Side::Lower, row.lower), (Side::Upper, row.upper)] {
                if limit.is_finite() {
                    relaxed(&name, &row.terms, limit, side, &others, lowering)?;
                }
            }
        }
        let inside: Vec<&StoredRow> = above.iter().copied().chain(&term.rows).collect();
        for (r, inner) in term.nested.iter().enumerate() {
            level(&nested_name(&name, r), inner, &inside, &others, lowering)?;
        }
    }
    Ok(())
}

/// Adds one side of a row, with an M for each of the others.
fn relaxed(
    name: &Name,
    terms: &[(Variable, f64)],
    limit: f64,
    side: Side,
    others: &[Other<'_>],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let sign = if side == Side::Upper { 1.0 } else { -1.0 };
    let up: Vec<(Variable, f64)> = terms.iter().map(|&(v, a)| (v, sign * a)).collect();
    let mut slack = Affine::zero();
    let mut entry = BigMEntry::new(name, side, BigMSource::LinearProgram);
    for other in others {
        let most = largest(&up, other, lowering)?;
        let from_bounds = lowering.largest(&up)?.upper;
        entry.needed = entry.needed.max(add_up(from_bounds, -sign * limit));
        if most == f64::NEG_INFINITY {
            // That term cannot be selected at all; any M is right.
            continue;
        }
        let m = tidy(add_up(most.min(from_bounds), -sign * limit));
        entry.value = entry.value.max(m);
        slack += m * value(other.selector);
    }
    entry.note_shares(&lowering.model, terms, side)?;
    let mut row = Affine::zero();
    up.iter().for_each(|&(v, a)| row.add_term(a, v));
    lowering.affine_row(row - slack, f64::NEG_INFINITY, sign * limit)?;
    entry.row = lowering.newest_row();
    lowering.report.entries.push(entry);
    Ok(())
}

/// The largest value of an expression where another term is selected.
fn largest(
    up: &[(Variable, f64)],
    other: &Other<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<f64, Error> {
    let (mut small, renamed) = Maximizer::of_rows(&lowering.model, &other.rows, up)?;
    let terms: Vec<(Variable, f64)> = up.iter().map(|&(v, a)| (renamed[&v], a)).collect();
    let mut most = small.most(&terms, &[]);
    if let Some(whole) = &mut lowering.maximizer {
        most = most.min(whole.most(up, &[other.selector]));
    }
    if most == f64::INFINITY {
        let mut of = Affine::zero();
        up.iter().for_each(|&(v, a)| of.add_term(a, v));
        return Err(lowering.unbounded(&of, 1.0)?);
    }
    Ok(most)
}

impl Lowering<'_> {
    /// The range of terms over the present bounds.
    fn largest(&self, terms: &[(Variable, f64)]) -> Result<Interval, Error> {
        let mut range = Interval::point(0.0);
        for &(variable, a) in terms {
            range = range + self.model.variable_ref(variable)?.bounds() * a;
        }
        Ok(range)
    }
}
