//! Indicator to big-M rows.
//!
//! Takes a row under a condition; leaves a row for each side, with an M times a binary (Dantzig, On
//! the significance of solving linear programming problems with some integer variables,
//! Econometrica 28, 1960).
//!
//! For `z = 1 => a'x <= u` and any `M >= max a'x - u` over the bounds, the row `a'x + M z <= u + M`
//! is equivalent for `z` in {0, 1}; for `z = 0 => a'x <= u` it is `a'x - M z <= u`. Lower sides
//! mirror this. M comes from interval arithmetic over the current bounds, rounded outward,
//! separately for each side; bounds that a variable does not have come from the rows, see
//! `reformulate/implied_bounds.rs`.
//!
//! A compound condition becomes clauses of which at least one is false if the condition holds, see
//! `reformulate/logic.rs`. For each clause `g1 or g2 or ...` there is one row per side,
//! `a'x <= u + M (g1 + g2 + ...)`; a plain condition is one clause with one literal.

use super::implied_bounds::LARGE_BIG_M;
use super::linear_program::tidy;
use super::lowering::Lowering;
use super::report::{BigMEntry, BigMSource, Side};
use crate::error::{Error, ErrorKind};
use crate::interval::{Interval, add_down, add_up};
use crate::model::{BigM, IndicatorRef, Literal, Name, Variable};
use crate::tolerance;

/// A row that must hold if its condition does.
pub(super) struct Implied<'a> {
    /// Its name in the report.
    pub(super) name: &'a Name,
    pub(super) terms: &'a [(Variable, f64)],
    pub(super) limits: Interval,
    pub(super) big_m: BigM,
}

/// Adds the rows of one indicator and records them in the report.
pub(super) fn apply(
    indicator: &IndicatorRef<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    lowering.begin(indicator.name());
    let row = Implied {
        name: indicator.name(),
        terms: indicator.terms(),
        limits: indicator.limits(),
        big_m: indicator.big_m(),
    };
    for clause in lowering.unless(indicator.condition())? {
        apply_unless(&clause, &row, lowering)?;
    }
    Ok(())
}

/// Adds rows for "the row holds, or one of `guard`".
pub(super) fn apply_unless(
    guard: &[Literal],
    row: &Implied<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let (open, fails) = open_guard(guard, lowering)?;
    // If the row contains its own condition, the condition's value is known.
    let mut terms = row.terms.to_vec();
    let mut limits = row.limits;
    for &literal in guard {
        if let Some(at) = terms.iter().position(|&(v, _)| v == literal.variable()) {
            let (_, coefficient) = terms.remove(at);
            if !literal.is_on() {
                limits = Interval::new(
                    add_down(limits.lower, -coefficient),
                    add_up(limits.upper, -coefficient),
                );
            }
        }
    }

    for side in [Side::Lower, Side::Upper] {
        let limit = if side == Side::Lower { limits.lower } else { limits.upper };
        if limit.is_infinite() {
            continue;
        }
        let mut need = need(lowering, &terms, limit, side)?;
        let mut entry = BigMEntry::new(row.name, side, BigMSource::Bounds);
        entry.needed = need.value.max(0.0);
        entry.note_shares(lowering, &terms, side)?;
        // An implied bound may come from this statement, so it does not make the row needless.
        if need.value <= 0.0 && !need.by_rows {
            entry.source = BigMSource::Implied;
        } else if fails {
            entry.source = BigMSource::ConditionFails;
        } else if open.is_empty() && !terms.is_empty() {
            entry.source = BigMSource::ConditionHolds;
            push(lowering, side, terms.clone(), limit)?;
            entry.row = lowering.newest_row();
        } else {
            // A row without variables keeps its guard, because a fixed binary costs nothing.
            let guard = if terms.is_empty() { guard } else { &open };
            need.tighten(&terms, limit, side, guard, lowering);
            (entry.value, entry.source) = choose((row.name, row.big_m), lowering, side, &need)?;
            let (row, limit) = switched(&terms, limit, entry.value, guard, side);
            push(lowering, side, row, limit)?;
            entry.row = lowering.newest_row();
        }
        lowering.report.entries.push(entry);
    }
    Ok(())
}

/// The literals of a guard that may be true, and whether one of them is.
pub(super) fn open_guard(
    guard: &[Literal],
    lowering: &Lowering<'_>,
) -> Result<(Vec<Literal>, bool), Error> {
    let (mut open, mut fails) = (Vec::new(), false);
    for &literal in guard {
        let bounds = lowering.model.variable_ref(literal.variable())?.bounds();
        let never = if literal.is_on() { bounds.upper < 1.0 } else { bounds.lower > 0.0 };
        fails |= if literal.is_on() { bounds.lower > 0.0 } else { bounds.upper < 1.0 };
        if !never {
            open.push(literal);
        }
    }
    Ok((open, fails))
}

/// The violation of a side that the bounds allow.
#[derive(Debug, Default)]
pub(super) struct Need {
    /// The largest possible violation, rounded up; infinite if a bound is missing.
    pub(super) value: f64,
    /// Whether a linear program proved a smaller value than the bounds.
    pub(super) by_program: bool,
    /// Whether one of the bounds is implied by rows.
    pub(super) by_rows: bool,
    /// The variable that contributes most.
    pub(super) largest: Option<Variable>,
    /// The variable whose bound is missing, and which bound.
    pub(super) unbounded: Option<(Variable, &'static str)>,
}

fn need(
    lowering: &Lowering<'_>,
    terms: &[(Variable, f64)],
    limit: f64,
    side: Side,
) -> Result<Need, Error> {
    let sign = if side == Side::Upper { 1.0 } else { -1.0 };
    let mut total = Interval::point(-sign * limit);
    let (mut largest, mut unbounded, mut share) = (None, None, -1.0);
    let mut by_rows = false;
    for &(variable, coefficient) in terms {
        let part = lowering.bounds(variable)? * (sign * coefficient);
        let own = lowering.model.variable_ref(variable)?.bounds() * (sign * coefficient);
        by_rows |= part.upper < own.upper;
        let bound = (variable, if sign * coefficient > 0.0 { "upper" } else { "lower" });
        if part.upper.is_infinite() && unbounded.is_none() {
            unbounded = Some(bound);
        }
        let spread = part.width();
        if spread > share || part.upper.is_infinite() {
            (largest, share) = (Some(bound), if spread.is_nan() { f64::INFINITY } else { spread });
        }
        total = total + part;
    }
    if by_rows {
        total.upper = total.upper.max(0.0);
    }
    // Bounds whose M is treated as infinite are as good as none.
    if total.upper >= tolerance::INFINITE {
        unbounded = unbounded.or(largest);
    }
    let largest = largest.map(|(variable, _)| variable);
    Ok(Need { value: total.upper, by_program: false, by_rows, largest, unbounded })
}

impl Need {
    /// Tightens the violation by a linear program, if requested.
    fn tighten(
        &mut self,
        terms: &[(Variable, f64)],
        limit: f64,
        side: Side,
        guard: &[Literal],
        lowering: &mut Lowering<'_>,
    ) {
        let original = lowering.original;
        let sign = if side == Side::Upper { 1.0 } else { -1.0 };
        let up: Vec<(Variable, f64)> = terms.iter().map(|&(v, a)| (v, sign * a)).collect();
        // Rows together may bound what no bound does, or better than large bounds.
        if self.unbounded.is_some() || self.by_rows && self.value > LARGE_BIG_M {
            let most = tidy(add_up(lowering.upper_bound_by_rows(&up), -sign * limit)).max(0.0);
            if most < self.value && most < tolerance::INFINITE {
                (self.value, self.by_program, self.unbounded) = (most, true, None);
            }
        }
        let Some(maximizer) = &mut lowering.maximizer else { return };
        if self.unbounded.is_some() {
            return;
        }
        // The M is used only if the guard is true.
        let when = match guard {
            [only] if only.variable().index() < original => guard,
            _ => &[],
        };
        let miss = tidy(add_up(maximizer.upper_bound(&up, when), -sign * limit)).max(0.0);
        if miss < self.value {
            (self.value, self.by_program) = (miss, true);
        }
    }
}

/// The M of a side, or why there is none.
pub(super) fn choose(
    (name, big_m): (&Name, BigM),
    lowering: &Lowering<'_>,
    side: Side,
    need: &Need,
) -> Result<(f64, BigMSource), Error> {
    if let BigM::Assumed(value) = big_m {
        return Ok((value, BigMSource::Assumed));
    }
    if let Some((variable, bound)) = need.unbounded {
        let (chain, remedy) = lowering.missing(variable, bound);
        return Err(ErrorKind::UnboundedIndicator {
            indicator: name.to_string(),
            side: side.word(),
            variable: lowering.model.name_of(variable),
            bound,
            chain,
            remedy,
        }
        .into());
    }
    match big_m {
        BigM::Given(value) => {
            // The outward rounding of `need` must not refuse an M that is exactly right.
            if value < need.value * (1.0 - 1e-12) {
                return Err(ErrorKind::UnsafeBigM {
                    indicator: name.to_string(),
                    side: side.word(),
                    given: value,
                    needed: need.value,
                    variable: need.largest.map_or_else(String::new, |v| lowering.model.name_of(v)),
                }
                .into());
            }
            Ok((value.max(need.value), BigMSource::Given))
        }
        _ if need.by_program => Ok((need.value, BigMSource::LinearProgram)),
        _ if need.by_rows => Ok((need.value, BigMSource::ImpliedBounds)),
        _ => Ok((need.value, BigMSource::Bounds)),
    }
}

/// The switched row and its limit, rounded so that it never cuts more than the implication.
fn switched(
    terms: &[(Variable, f64)],
    mut limit: f64,
    big_m: f64,
    guard: &[Literal],
    side: Side,
) -> (Vec<(Variable, f64)>, f64) {
    let mut row = terms.to_vec();
    for literal in guard {
        let coefficient = match (side, literal.is_on()) {
            (Side::Upper, true) | (Side::Lower, false) => -big_m,
            (Side::Upper, false) | (Side::Lower, true) => big_m,
        };
        if !literal.is_on() {
            limit = match side {
                Side::Upper => add_up(limit, big_m),
                Side::Lower => add_down(limit, -big_m),
            };
        }
        // An assumed M may be 0, and rows hold no zeros.
        if coefficient != 0.0 {
            let at = row.partition_point(|&(v, _)| v < literal.variable());
            row.insert(at, (literal.variable(), coefficient));
        }
    }
    (row, limit)
}

fn push(
    lowering: &mut Lowering<'_>,
    side: Side,
    terms: Vec<(Variable, f64)>,
    limit: f64,
) -> Result<(), Error> {
    let (lower, upper) = match side {
        Side::Lower => (limit, f64::INFINITY),
        Side::Upper => (f64::NEG_INFINITY, limit),
    };
    lowering.row_named(&format!("_{}", side.word()), terms, lower, upper)
}
