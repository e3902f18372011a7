//! Disjunctions by the convex hull of their terms.
//!
//! Takes a disjunction whose selectors have rows; leaves a copy of each variable for each term, and
//! rows over the copies (Balas, Disjunctive programming, Annals of Discrete Mathematics 5, 1979;
//! for convex rows Grossmann and Lee, Generalized convex disjunctive programming: nonlinear convex
//! hull relaxation, Computational Optimization and Applications 26, 2003).
//!
//! Every variable `x` of a disjunction gets a copy `x_i` for each term `i` with selector `s_i`:
//! `x = x_1 + ... + x_n`, and `l s_i <= x_i <= u s_i` with the bounds that the term implies. A row
//! `a'x <= b` of term `i` becomes `a'x_i <= b s_i`, and a norm `|A x + c| <= b` becomes
//! `|A x_i + c s_i| <= b s_i`. The relaxation is the convex hull of the disjunction alone over the
//! bounds. A disjunction inside a term is the hull of the term's copies, with the rows of the terms
//! around it. The hull has no big-M, but still needs bounds.

use std::collections::BTreeMap;

use super::conic::as_norm;
use super::conic_rows::implied_rows;
use super::disjunction::{nested_name, row_name, value};
use super::linear_program::Maximizer;
use super::lowering::Lowering;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{
    Affine, Literal, Model, Name, StandardCone, StoredConic, StoredRow, StoredTerm, Variable,
    VariableKind,
};

/// Bounds of at most this magnitude become 0, in the variable's unit: a millionth of the default
/// feasibility tolerance.
const NEGLIGIBLE_BOUND: f64 = 1e-12;

/// The column of each variable of the model at the current level.
type Copies = BTreeMap<Variable, Variable>;

/// Adds the rows of a disjunction whose selectors already have rows.
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
        term.for_each_conic(&mut |conic| {
            conic.for_each_variable(&mut |variable| {
                columns.insert(variable, variable);
            });
        });
    }
    split(name, terms, &columns, &Inside::default(), lowering)
}

/// The statements that hold in a term: its rows and conic rows, and those of the terms around it.
#[derive(Default)]
struct Inside<'a> {
    rows: Vec<&'a StoredRow>,
    conic: Vec<&'a StoredConic>,
}

/// Splits the columns of one level among the terms of a disjunction; `above` are the rows of the
/// terms around it.
fn split(
    name: &Name,
    terms: &[StoredTerm],
    columns: &Copies,
    above: &Inside<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    lowering.begin(name);
    let mut copies = vec![Copies::new(); terms.len()];
    // The variables of this disjunction; a level above may have more.
    let mut own = Copies::new();
    let mut take = |row: &StoredRow| {
        own.extend(row.terms.iter().filter_map(|&(v, _)| Some((v, *columns.get(&v)?))));
    };
    above.rows.iter().for_each(|row| take(row));
    terms.iter().for_each(|term| term.for_each_row(&mut take));
    let mut take = |conic: &StoredConic| {
        conic.for_each_variable(&mut |v| own.extend(columns.get(&v).map(|column| (v, *column))));
    };
    above.conic.iter().for_each(|conic| take(conic));
    terms.iter().for_each(|term| term.for_each_conic(&mut take));
    let inside: Vec<Inside<'_>> = terms
        .iter()
        .map(|term| Inside {
            rows: above.rows.iter().copied().chain(&term.rows).collect(),
            conic: above.conic.iter().copied().chain(&term.conic).collect(),
        })
        .collect();
    let mut ranges = Vec::with_capacity(terms.len());
    for (term, inside) in terms.iter().zip(&inside) {
        let mut implied = Vec::new();
        for conic in &inside.conic {
            implied.extend(implied_rows(conic, name, &lowering.model)?);
        }
        let rows: Vec<&StoredRow> = inside.rows.iter().copied().chain(&implied).collect();
        let all: Vec<(Variable, f64)> = own.keys().map(|&variable| (variable, 0.0)).collect();
        let bounds = |variable| lowering.bounds(variable);
        let range = Maximizer::of_rows(&lowering.model, &rows, &all, &bounds, lowering.token)?;
        if range.0.is_empty() {
            lowering.affine_row(value(term.selector), 0.0, 0.0)?;
        }
        ranges.push(range);
    }
    for (&variable, &column) in &own {
        let mut rest = Affine::from(column);
        for ((term, copies), (range, renamed)) in terms.iter().zip(&mut copies).zip(&ranges) {
            // The bounds of the variable itself, tightened by the rows of the term. Bounds of an
            // outer copy hold only if that copy is selected.
            let within = match range.is_empty() {
                true => Interval::REALS,
                false => range.bounds(renamed[&variable]),
            };
            let mut bounds = lowering.bounds(variable)?.intersection(within);
            if !bounds.is_bounded() {
                bounds = lowering.finite_bounds(variable)?.intersection(within);
            }
            let bounds = without_rounding(bounds);
            let (low, high) = (bounds.lower.min(0.0), bounds.upper.max(0.0));
            let copy = lowering.column("copy", VariableKind::Continuous, low, high)?;
            rest -= copy;
            scaled(copy.into(), bounds.lower, bounds.upper, term.selector, lowering)?;
            copies.insert(variable, copy);
        }
        lowering.affine_row(rest, 0.0, 0.0)?;
    }
    for (k, ((term, copies), inside)) in terms.iter().zip(&copies).zip(&inside).enumerate() {
        let name = name.suffixed(&format!("_{}", k + 1));
        // Copies of inner disjunctions carry the rows of all terms around them, which is tighter
        // than rows on the sums of the copies.
        for (r, row) in inside.rows.iter().enumerate().filter(|_| term.nested.is_empty()) {
            lowering.begin(&row_name(&name, r));
            let mut of = Affine::zero();
            row.terms.iter().for_each(|&(v, a)| of.add_term(a, copies[&v]));
            scaled(of, row.lower, row.upper, term.selector, lowering)?;
        }
        for (r, conic) in inside.conic.iter().enumerate().filter(|_| term.nested.is_empty()) {
            let name = row_name(&name, inside.rows.len() + r);
            lowering.begin(&name);
            let perspective = perspective(conic, &name, copies, term.selector, &lowering.model)?;
            lowering.conic(perspective)?;
        }
        for (r, inner) in term.nested.iter().enumerate() {
            split(&nested_name(&name, r), inner, copies, inside, lowering)?;
        }
    }
    Ok(())
}

/// Bounds that a term leaves of a variable, without what rounding makes of 0 or of one value: rows
/// of a slight coefficient, or that cross, would hold only where the term is not selected.
fn without_rounding(Interval { lower, upper }: Interval) -> Interval {
    let tidy = |end: f64| if end.abs() <= NEGLIGIBLE_BOUND { 0.0 } else { end };
    Interval::new(tidy(lower.min(upper)), tidy(lower.max(upper)))
}

/// A conic row over the copies of its variables, its constants times the selector: a norm that is
/// at most its bound also where the selector is between 0 and 1.
fn perspective(
    conic: &StoredConic,
    name: &Name,
    copies: &Copies,
    selector: Literal,
    model: &Model,
) -> Result<StoredConic, Error> {
    let StandardCone { head, tail } = model.standard_cone(conic, name)?;
    let scaled = |e: &Affine| {
        let mut scaled = e.offset() * value(selector);
        e.terms().iter().for_each(|(v, a)| scaled.add_term(*a, copies[v]));
        scaled
    };
    let head: Vec<Affine> = head.iter().map(scaled).collect();
    let (entries, bound) = as_norm(&head, tail.iter().map(scaled).collect());
    Ok(StoredConic::Norm { entries, bound })
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
