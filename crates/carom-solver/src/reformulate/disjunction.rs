//! Disjunctions as rows: the selectors, and big-M.
//!
//! Takes a disjunction; leaves a row over its selectors, and the rows of its terms by one of the
//! methods (Raman and Grossmann, Modelling and computational techniques for logic based integer
//! programming, Computers & Chemical Engineering 18, 1994).
//!
//! Exactly one selector of a disjunction is true. In a disjunction inside a term, exactly one is
//! true if the term's selector is, and none otherwise: `s1 + ... + sn = s`. So a selector alone
//! implies the rows of its term, and with big-M each of them is an indicator. The other methods are
//! `reformulate/multi_m.rs` and `reformulate/hull.rs`.

use super::big_m::{Implied, apply_unless};
use super::conic::{self, ImpliedConic};
use super::lowering::Lowering;
use super::{hull, multi_m};
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, BigM, DisjunctionRef, Literal, Method, Name, StoredTerm};

/// Adds the rows of a disjunction by a method.
pub(super) fn apply(
    disjunction: &DisjunctionRef<'_>,
    method: Method,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let (name, terms) = (disjunction.name(), disjunction.stored_terms());
    lowering.begin(name);
    select_one(terms, None, lowering)?;
    match method {
        Method::BigM => big_m(name, terms, lowering),
        Method::MultiM => multi_m::apply(name, terms, lowering),
        Method::Hull => hull::apply(name, terms, lowering),
    }
}

/// A literal as an expression: 1 if it is true, 0 if it is false.
pub(super) fn value(literal: Literal) -> Affine {
    match literal.is_on() {
        true => literal.variable().into(),
        false => 1.0 - literal.variable(),
    }
}

/// `s1 + ... + sn = s`, or `= 1` at the outermost level; the same inside the terms.
fn select_one(
    terms: &[StoredTerm],
    outer: Option<Literal>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let mut sum: Affine = terms.iter().map(|term| value(term.selector)).sum();
    match outer {
        Some(outer) => sum -= value(outer),
        None => sum -= 1.0,
    }
    // Two selectors on one binary add up to a constant.
    if !sum.terms().is_empty() || sum.offset() != 0.0 {
        lowering.affine_row(sum, 0.0, 0.0)?;
    }
    for term in terms {
        for inner in &term.nested {
            select_one(inner, Some(term.selector), lowering)?;
        }
    }
    Ok(())
}

fn big_m(name: &Name, terms: &[StoredTerm], lowering: &mut Lowering<'_>) -> Result<(), Error> {
    for (k, term) in terms.iter().enumerate() {
        let name = name.suffixed(&format!("_{}", k + 1));
        for (r, row) in term.rows.iter().enumerate() {
            let name = row_name(&name, r);
            lowering.begin(&name);
            let limits = Interval::new(row.lower, row.upper);
            let row = Implied { name: &name, terms: &row.terms, limits, big_m: BigM::Automatic };
            apply_unless(&[!term.selector], &row, lowering)?;
        }
        for (r, conic) in term.conic.iter().enumerate() {
            let name = row_name(&name, term.rows.len() + r);
            lowering.begin(&name);
            let row = ImpliedConic { name: &name, conic, big_m: BigM::Automatic };
            conic::apply_unless(&[!term.selector], &row, lowering)?;
        }
        for (r, inner) in term.nested.iter().enumerate() {
            big_m(&nested_name(&name, r), inner, lowering)?;
        }
    }
    Ok(())
}

/// The name of a row of the term `name`.
pub(super) fn row_name(term: &Name, row: usize) -> Name {
    term.suffixed(&format!("_row{}", row + 1))
}

/// The name of a disjunction inside the term `name`.
pub(super) fn nested_name(term: &Name, nested: usize) -> Name {
    term.suffixed(&format!("_in{}", nested + 1))
}
