//! The limits of a number, and the words for them.

use std::ops::{Bound, RangeBounds};

/// The numbers above 0, without infinity.
pub const FINITE_POSITIVE: (Bound<f64>, Bound<f64>) =
    (Bound::Excluded(0.0), Bound::Excluded(f64::INFINITY));

/// The lower and the upper limit, where there are any.
pub(super) fn limits(range: &impl RangeBounds<f64>) -> (Option<f64>, Option<f64>) {
    let finite = |bound: Bound<&f64>| match bound {
        Bound::Included(&limit) | Bound::Excluded(&limit) => limit.is_finite().then_some(limit),
        Bound::Unbounded => None,
    };
    (finite(range.start_bound()), finite(range.end_bound()))
}

/// "at least 1", "within [0, 1]", "finite and positive", ...
pub(super) fn words(range: &impl RangeBounds<f64>) -> String {
    use Bound::{Excluded, Included};
    let (lower, upper) = (range.start_bound().cloned(), range.end_bound().cloned());
    match (lower, upper) {
        (Excluded(0.0), Excluded(f64::INFINITY)) => return "finite and positive".into(),
        (Included(lower), Included(upper)) if lower == upper => return lower.to_string(),
        (Included(lower), Included(upper)) if lower.is_finite() && upper.is_finite() => {
            return format!("within [{lower}, {upper}]");
        }
        _ => {}
    }
    let mut parts = Vec::new();
    // An infinite end that belongs to the range is none.
    let excludes = |end, infinite| matches!(end, Excluded(limit) if limit == infinite);
    if excludes(lower, f64::NEG_INFINITY) || excludes(upper, f64::INFINITY) {
        parts.push("finite".to_owned());
    }
    match lower {
        Included(limit) if limit > f64::NEG_INFINITY => parts.push(format!("at least {limit}")),
        Excluded(limit) if limit > f64::NEG_INFINITY => parts.push(format!("above {limit}")),
        _ => {}
    }
    match upper {
        Included(limit) if limit < f64::INFINITY => parts.push(format!("at most {limit}")),
        Excluded(limit) if limit < f64::INFINITY => parts.push(format!("below {limit}")),
        _ => {}
    }
    parts.join(" and ")
}
