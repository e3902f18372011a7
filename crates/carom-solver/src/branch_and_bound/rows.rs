//! Rows that callbacks return: their names, their place in a model, and their violations.

use std::collections::BTreeSet;

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::{Model, Name, StoredRow};
use crate::solution::{Point, Verification};
use crate::sum::Sum;

/// The name of a row that a callback returned.
pub(super) fn row_name(family: &str, number: usize) -> Name {
    Name::from((family, number))
}

/// The family of lazy constraints.
pub(super) const LAZY: &str = "lazy_constraint";

/// The family of user cuts.
pub(super) const CUT: &str = "user_cut";

/// By how much a point may miss a cut that is right, in units of the largest coefficient, and
/// relative to the sum of its terms (no unit): points miss the rows that cuts are derived from by
/// up to the tolerance.
const CUT_COEFFICIENT_MISS: f64 = 1e-4;
const CUT_TERMS_MISS: f64 = 1e-8;

/// Whether a point violates a row by more than the tolerance.
pub(super) fn is_violated(model: &Model, row: &StoredRow, point: &Point, feasibility: f64) -> bool {
    let limits = Interval::new(row.lower, row.upper);
    Verification::of_row(model, point, (&row.terms, limits), feasibility).1
}

/// Adds rows that are not known yet, in an order that does not depend on when they were found.
/// Returns how many there are.
pub(super) fn add_new(known: &mut Vec<StoredRow>, mut rows: Vec<StoredRow>) -> usize {
    let key = |row: &StoredRow| {
        let terms = row.terms.iter().map(|(variable, a)| (variable.index(), a.to_bits()));
        (terms.collect::<Vec<_>>(), row.lower.to_bits(), row.upper.to_bits())
    };
    rows.sort_by_cached_key(key);
    rows.dedup();
    let before = known.len();
    let old: BTreeSet<_> = known.iter().map(key).collect();
    known.extend(rows.into_iter().filter(|row| !old.contains(&key(row))));
    known.len() - before
}

/// A model with further rows.
pub(super) fn with_rows(model: &Model, family: &str, rows: &[StoredRow]) -> Result<Model, Error> {
    let mut more = model.clone();
    for (k, row) in rows.iter().enumerate() {
        let name = row_name(family, k).free(|name| more.has_statement(name));
        more.push_constraint(name, row.clone())?;
    }
    more.touch();
    Ok(more)
}

/// The first of some cuts that a verified point violates, as an error.
pub(super) fn wrong_cut(model: &Model, cuts: &[StoredRow], point: &Point) -> Option<Error> {
    let (k, cut, amount) = cuts.iter().enumerate().find_map(|(k, cut)| {
        let (mut sum, mut size, mut largest) = (Sum::new(0.0), 0.0, 0.0_f64);
        for &(variable, a) in &cut.terms {
            let value = point.value(variable).ok()?;
            sum.add_product(a, value);
            size += (a * value).abs();
            largest = largest.max(a.abs());
        }
        let (below, above) = (cut.lower - sum.value(), sum.value() - cut.upper);
        let limit = if below > above { cut.lower } else { cut.upper };
        let amount = below.max(above);
        (amount > CUT_COEFFICIENT_MISS * largest + CUT_TERMS_MISS * (size + limit.abs()))
            .then_some((k, cut, amount))
    })?;
    let row = model.row_text(&cut.terms, Interval::new(cut.lower, cut.upper));
    let objective = point.value(model.objective()).unwrap_or(f64::NAN);
    let cut = row_name(CUT, k).to_string();
    Some(ErrorKind::WrongCut { cut, row, amount, objective }.into())
}
