//! The places where integral columns can be split.

use crate::search::Decision;

/// The largest place of a split; the next whole number and its neighbours are floats, too (no
/// unit).
pub(super) const LARGEST_PLACE: f64 = ((1_u64 << 53) - 2) as f64;

/// Whether a column can be split at a number: into what is at most it, and what is at least the
/// next one.
pub(super) fn is_counted(place: f64) -> bool {
    place == place.round() && place.abs() <= LARGEST_PLACE
}

/// The place of a split.
pub(super) fn place_of(decision: Decision) -> f64 {
    if decision.is_upper { decision.value } else { decision.value - 1.0 }
}
