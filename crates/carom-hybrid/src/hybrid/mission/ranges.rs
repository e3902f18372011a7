//! Ranges of a model's variables, from its bounds and rows: they decide predicates before any is
//! written.

use crate::interval::Interval;
use crate::model::Model;

/// Sweeps over all rows, forwards and backwards in turn: a start comes forwards through the horizon
/// in one of them, and a goal backwards in the next.
const RANGE_SWEEPS: usize = 4;

/// Ranges of all variables, by index. Empty ones are left as they are: that there is no plan is for
/// the solver to prove.
pub(super) fn ranges(model: &Model) -> Vec<Interval> {
    // A parameter may still take any value of its range, and a semi-continuous variable may be 0.
    let range =
        |own: crate::model::VariableRef<'_>| match (own.parameter_range(), own.semicontinuous()) {
            (Some(range), _) => range,
            (None, Some(range)) => range.hull(Interval::point(0.0)),
            _ => own.bounds(),
        };
    let mut ranges: Vec<Interval> = model.variables().map(range).collect();
    let rows: Vec<_> = model.constraints().collect();
    for sweep in 0..RANGE_SWEEPS {
        let mut changed = false;
        let count = rows.len();
        for k in 0..count {
            let row = &rows[if sweep % 2 == 0 { k } else { count - 1 - k }];
            changed |= propagate(row.terms(), row.limits(), &mut ranges);
        }
        if !changed {
            break;
        }
    }
    ranges
}

/// Narrows the ranges of a row's variables; says whether one has become clearly narrower.
fn propagate(
    terms: &[(crate::model::Variable, f64)],
    limits: Interval,
    ranges: &mut [Interval],
) -> bool {
    let mut changed = false;
    let parts: Vec<Interval> = terms.iter().map(|&(v, a)| ranges[v.index()] * a).collect();
    // At most one unbounded side may be left out for the rest to say something.
    let (mut open_below, mut open_above) = (0, 0);
    for part in &parts {
        open_below += usize::from(part.lower.is_infinite());
        open_above += usize::from(part.upper.is_infinite());
    }
    if open_below > 1 && open_above > 1 {
        return false;
    }
    for (k, &(variable, factor)) in terms.iter().enumerate() {
        let others = parts.iter().enumerate().filter(|(other, _)| *other != k);
        let rest = others.fold(Interval::point(0.0), |sum, (_, part)| sum + *part);
        let value = Interval::new(limits.lower, limits.upper) + (-rest);
        let inverse = 1.0 / factor;
        let found = value * inverse;
        // The inverse is rounded: give way by more than that. The same for values of a start would
        // only blur them.
        let is_exact = factor.abs() == 1.0;
        let give = if is_exact { 0.0 } else { 1e-9 * (1.0 + found.magnitude()) };
        let wider = |end: f64, by: f64| if end.is_finite() { end + by } else { end };
        let found = Interval::new(wider(found.lower, -give), wider(found.upper, give));
        let own = ranges[variable.index()];
        let both = own.intersection(found);
        if both.lower.is_nan() || both.upper.is_nan() || both.is_empty() {
            continue;
        }
        let gain = |new: f64, old: f64| new != old && (new - old).abs() >= 1e-6 * (1.0 + old.abs());
        if gain(both.lower, own.lower) || gain(both.upper, own.upper) {
            ranges[variable.index()] = both;
            changed = true;
        }
    }
    changed
}
