//! Disjunctions by the convex hull of their terms.
//!
//! Every variable `x` of a disjunction gets a copy `x_i` for each term `i` with selector `s_i`:
//! `x = x_1 + ... + x_n`, `l s_i <= x_i <= u s_i` over its bounds, and a row `a'x <= b` of term
//! `i` becomes `a'x_i <= b s_i` (Balas 1979; Grossmann and Lee 2003 for the use in modelling).
//! The relaxation is the convex hull of the disjunction alone over the bounds. A disjunction
//! inside a term is the hull of the term's copies. There is no big-M in it, but bounds are needed
//! all the same.

use std::collections::BTreeMap;

use super::disjunction::{nested_name, row_name, value};
use super::lowering::Lowering;
use crate::error::Error;
use crate::model::{Affine, Literal, Name, StoredTerm, Variable, VariableKind};

/// What each variable of the model is called at the present level.
type Copies = BTreeMap<Variable, Variable>;

/// Adds the rows of a disjunction whose selectors have theirs.
pub(super) fn apply(
    name: &Name,
    terms: &[StoredTerm],
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let mut columns = Copies::new();
    for term in terms {
        term.for_each_row(&mut |row| {
            columns.extend(row.terms.iter().map(|&(variable, _)| (variable, variable)));
        });
    }
    split(name, terms, &columns, lowering)
}

/// Splits the columns of one level among the terms of a disjunction.
fn split(
    name: &Name,
    terms: &[StoredTerm],
    columns: &Copies,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    lowering.begin(name);
    let mut copies = vec![Copies::new(); terms.len()];
    // The variables of this disjunction; a level above may have more.
    let mut own = Copies::new();
    for term in terms {
        term.for_each_row(&mut |row| {
            own.extend(row.terms.iter().filter_map(|&(v, _)| Some((v, *columns.get(&v)?))));
        });
    }
    for (&variable, &column) in &own {
        // The bounds of the variable itself: those of a copy above hold only where it is selected.
        let bounds = lowering.model.variable_ref(variable)?.bounds();
        for (end, bound) in [(bounds.lower, "lower"), (bounds.upper, "upper")] {
            if end.is_infinite() {
                return Err(lowering.unbounded_function(variable, bound));
            }
        }
        let mut rest = Affine::from(column);
        for (term, copies) in terms.iter().zip(&mut copies) {
            let (low, high) = (bounds.lower.min(0.0), bounds.upper.max(0.0));
            let copy = lowering.column("copy", VariableKind::Continuous, low, high)?;
            rest -= copy;
            scaled(copy.into(), bounds.lower, bounds.upper, term.selector, lowering)?;
            copies.insert(variable, copy);
        }
        lowering.affine_row(rest, 0.0, 0.0)?;
    }
    for (k, (term, copies)) in terms.iter().zip(&copies).enumerate() {
        let name = name.suffixed(&format!("_{}", k + 1));
        for (r, row) in term.rows.iter().enumerate() {
            lowering.begin(&row_name(&name, r));
            let mut of = Affine::zero();
            row.terms.iter().for_each(|&(v, a)| of.add_term(a, copies[&v]));
            scaled(of, row.lower, row.upper, term.selector, lowering)?;
        }
        for (r, inner) in term.nested.iter().enumerate() {
            split(&nested_name(&name, r), inner, copies, lowering)?;
        }
    }
    Ok(())
}

/// Adds `lower s <= of <= upper s` for the sides that are finite.
fn scaled(
    of: Affine,
    lower: f64,
    upper: f64,
    selector: Literal,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let (none, any) = (f64::NEG_INFINITY, f64::INFINITY);
    if lower == upper {
        return lowering.affine_row(of - lower * value(selector), 0.0, 0.0);
    }
    if lower.is_finite() {
        lowering.affine_row(&of - lower * value(selector), 0.0, any)?;
    }
    if upper.is_finite() {
        lowering.affine_row(of - upper * value(selector), none, 0.0)?;
    }
    Ok(())
}
