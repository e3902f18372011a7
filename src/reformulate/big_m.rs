//! Indicator to big-M rows.
//!
//! For `z = 1 => a'x <= u` and any `M >= max a'x - u` over the bounds, the row
//! `a'x + M z <= u + M` says the same for `z` in {0, 1}; for `z = 0 => a'x <= u` it is
//! `a'x - M z <= u`. Lower sides mirror this. M comes from interval arithmetic over the current
//! bounds, rounded outward, a side at a time.

use super::report::{BigMEntry, BigMReport, BigMSource, Side};
use crate::error::Error;
use crate::interval::{Interval, add_down, add_up};
use crate::model::{BigM, IndicatorRef, Model, Name, StoredRow, Variable};

/// Adds the rows of one indicator to `lowered` and notes them in the report.
pub(super) fn apply(
    indicator: &IndicatorRef<'_>,
    lowered: &mut Model,
    report: &mut BigMReport,
) -> Result<(), Error> {
    let condition = indicator.condition();
    let binary = lowered.variable_ref(condition.variable())?.bounds();
    let holds = if condition.is_on() { binary.lower > 0.0 } else { binary.upper < 1.0 };
    let fails = if condition.is_on() { binary.upper < 1.0 } else { binary.lower > 0.0 };

    // Where the row mentions its own condition, the condition's value is known.
    let mut terms = indicator.terms().to_vec();
    let mut limits = indicator.limits();
    if let Some(at) = terms.iter().position(|&(v, _)| v == condition.variable()) {
        let (_, coefficient) = terms.remove(at);
        if condition.is_on() {
            limits = Interval::new(
                add_down(limits.lower, -coefficient),
                add_up(limits.upper, -coefficient),
            );
        }
    }

    for side in [Side::Lower, Side::Upper] {
        let limit = if side == Side::Lower { limits.lower } else { limits.upper };
        if limit.is_infinite() {
            continue;
        }
        let need = need(lowered, &terms, limit, side)?;
        let mut entry = BigMEntry {
            indicator: indicator.name().to_string(),
            side,
            source: BigMSource::Bounds,
            value: 0.0,
            needed: need.value.max(0.0),
            largest: need.largest.map(|v| lowered.name_of(v)),
        };
        if need.value <= 0.0 {
            entry.source = BigMSource::Implied;
        } else if fails {
            entry.source = BigMSource::ConditionFails;
        } else if holds && !terms.is_empty() {
            entry.source = BigMSource::ConditionHolds;
            push(lowered, indicator.name(), side, terms.clone(), limit)?;
        } else {
            (entry.value, entry.source) = choose(indicator, lowered, side, &need)?;
            let (row, limit) = switched(&terms, limit, entry.value, indicator, side);
            push(lowered, indicator.name(), side, row, limit)?;
        }
        report.entries.push(entry);
    }
    Ok(())
}

/// How far the bounds let a side be missed.
struct Need {
    /// The largest possible miss, rounded up; infinite when a bound is missing.
    value: f64,
    /// The variable with the largest share in it.
    largest: Option<Variable>,
    /// The variable without the bound that is needed, and which bound.
    unbounded: Option<(Variable, &'static str)>,
}

fn need(model: &Model, terms: &[(Variable, f64)], limit: f64, side: Side) -> Result<Need, Error> {
    let sign = if side == Side::Upper { 1.0 } else { -1.0 };
    let mut total = Interval::point(-sign * limit);
    let (mut largest, mut unbounded, mut share) = (None, None, -1.0);
    for &(variable, coefficient) in terms {
        let part = model.variable_ref(variable)?.bounds() * (sign * coefficient);
        if part.upper.is_infinite() && unbounded.is_none() {
            unbounded = Some((variable, if sign * coefficient > 0.0 { "upper" } else { "lower" }));
        }
        let spread = part.width();
        if spread > share || part.upper.is_infinite() {
            (largest, share) =
                (Some(variable), if spread.is_nan() { f64::INFINITY } else { spread });
        }
        total = total + part;
    }
    Ok(Need { value: total.upper, largest, unbounded })
}

/// The M of a side, or why there is none.
fn choose(
    indicator: &IndicatorRef<'_>,
    model: &Model,
    side: Side,
    need: &Need,
) -> Result<(f64, BigMSource), Error> {
    if let BigM::Assumed(value) = indicator.big_m() {
        return Ok((value, BigMSource::Assumed));
    }
    if let Some((variable, bound)) = need.unbounded {
        return Err(Error::UnboundedIndicator {
            indicator: indicator.name().to_string(),
            side: side.word(),
            variable: model.name_of(variable),
            bound,
        });
    }
    match indicator.big_m() {
        BigM::Given(value) => {
            // The outward rounding of `need` must not refuse an M that is exactly right.
            if value < need.value * (1.0 - 1e-12) {
                return Err(Error::UnsafeBigM {
                    indicator: indicator.name().to_string(),
                    side: side.word(),
                    given: value,
                    needed: need.value,
                    variable: need.largest.map_or_else(String::new, |v| model.name_of(v)),
                });
            }
            Ok((value.max(need.value), BigMSource::Given))
        }
        _ => Ok((need.value, BigMSource::Bounds)),
    }
}

/// The switched row and its limit, rounded so that it never cuts more than the implication.
fn switched(
    terms: &[(Variable, f64)],
    limit: f64,
    big_m: f64,
    indicator: &IndicatorRef<'_>,
    side: Side,
) -> (Vec<(Variable, f64)>, f64) {
    let condition = indicator.condition();
    let mut row = terms.to_vec();
    let (coefficient, limit) = match (side, condition.is_on()) {
        (Side::Upper, true) => (big_m, add_up(limit, big_m)),
        (Side::Upper, false) => (-big_m, limit),
        (Side::Lower, true) => (-big_m, add_down(limit, -big_m)),
        (Side::Lower, false) => (big_m, limit),
    };
    // An assumed M may be 0, and rows hold no zeros.
    if coefficient != 0.0 {
        let at = row.partition_point(|&(v, _)| v < condition.variable());
        row.insert(at, (condition.variable(), coefficient));
    }
    (row, limit)
}

fn push(
    model: &mut Model,
    name: &Name,
    side: Side,
    terms: Vec<(Variable, f64)>,
    limit: f64,
) -> Result<(), Error> {
    let (lower, upper) = match side {
        Side::Lower => (limit, f64::INFINITY),
        Side::Upper => (f64::NEG_INFINITY, limit),
    };
    let mut family = format!("{}_{}", name.family(), side.word());
    loop {
        let candidate = match name.step() {
            Some(step) => Name::from((family.as_str(), step)),
            None => Name::from(family.as_str()),
        };
        let row = StoredRow { terms: terms.clone(), lower, upper };
        match model.push_constraint(candidate, row) {
            Ok(_) => return Ok(()),
            Err(Error::DuplicateName { .. }) => family.push('_'),
            Err(other) => return Err(other),
        }
    }
}
