//! Rows that turn out to be constant.

use super::program::SystemVariables;
use crate::hybrid::system::SystemRow;
use crate::model::{Affine, Row, StoredConic, norm};

/// The relative rounding of a constant length.
const CONSTANT_ROUNDING: f64 = 1e-12;

/// Whether a row without variables holds; `None` if it has variables.
pub(super) fn constant(row: &Row) -> Option<bool> {
    let value = row.expression().offset();
    let holds = row.lower() <= value && value <= row.upper();
    row.expression().terms().is_empty().then_some(holds)
}

/// A row at a step; `None` if it is constant and holds. One that is constant and does not hold
/// becomes one that never holds.
pub(super) fn nontrivial(program: &SystemVariables, row: SystemRow, t: usize) -> Option<SystemRow> {
    let conic = match &row {
        SystemRow::Row(linear) => {
            return match constant(linear) {
                None => Some(row),
                Some(true) => None,
                Some(false) => Some(program.infeasible_row_at(t).into()),
            };
        }
        SystemRow::Conic(conic) => conic,
        SystemRow::Nonlinear(_) => return Some(row),
    };
    let StoredConic::Norm { entries, bound } = conic.stored() else { return Some(row) };
    if entries.iter().chain([bound]).any(|part| !part.terms().is_empty()) {
        return Some(row);
    }
    let length = entries.iter().fold(0.0_f64, |length, entry| length.hypot(entry.offset()));
    let slack = CONSTANT_ROUNDING * length.max(bound.offset().abs());
    if length <= bound.offset() + slack {
        return None;
    }
    let any = program.states().first().and_then(|family| family.get(t));
    any.map(|variable| norm([Affine::from(variable)]).le(-1.0).into())
}
