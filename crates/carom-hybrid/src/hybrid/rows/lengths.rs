//! Rows of lengths that turn out to be constant.

use super::program::SystemVariables;
use crate::model::{Affine, ConicRow, StoredConic, norm};

/// The relative rounding of a constant length.
const CONSTANT_ROUNDING: f64 = 1e-12;

/// A row of a length at a step; `None` if it is constant and holds. One that is constant and does
/// not hold becomes one that never holds.
pub(super) fn nontrivial(program: &SystemVariables, row: ConicRow, t: usize) -> Option<ConicRow> {
    let StoredConic::Norm { entries, bound } = row.stored() else { return Some(row) };
    if entries.iter().chain([bound]).any(|part| !part.terms().is_empty()) {
        return Some(row);
    }
    let length = entries.iter().fold(0.0_f64, |length, entry| length.hypot(entry.offset()));
    let slack = CONSTANT_ROUNDING * length.max(bound.offset().abs());
    if length <= bound.offset() + slack {
        return None;
    }
    let any = program.states().first().and_then(|family| family.get(t));
    any.map(|variable| norm([Affine::from(variable)]).le(-1.0))
}
