//! Ranges of arguments from those of values, and the reverse, in turns with the rows.

use super::program::SpatialProgram;
use super::term::{Shape, SmoothTerm, bounds};
use crate::interval::Interval;
use crate::presolve::{Domain, Propagator};

/// The domain holds no point.
#[derive(Debug)]
pub(super) struct EmptyDomain;

/// Most turns between terms and rows.
const MAX_TURNS: usize = 12;

/// The least part of a range that a change has to take away.
const LEAST_RANGE_GAIN: f64 = 0.02;

/// By how much ends may be crossed because of rounding, relative (no unit).
const CROSSED: f64 = 1e-9;

/// Tightens all bounds until little moves.
///
/// # Arguments
///
/// * `mark`: the mark of the domain since which rows have not been propagated; `None` for all.
pub(super) fn propagate(
    program: &SpatialProgram,
    propagator: &mut Propagator,
    domain: &mut Domain,
    mark: Option<usize>,
) -> Result<(), EmptyDomain> {
    let mut first = true;
    let mut mark = mark;
    for _ in 0..MAX_TURNS {
        let next = domain.mark();
        let rows = match mark {
            None => propagator.propagate_all(&program.program, domain),
            Some(mark) => propagator.propagate_since(&program.program, domain, mark),
        };
        rows.map_err(|_| EmptyDomain)?;
        if !first && domain.mark() == next {
            return Ok(());
        }
        first = false;
        let changed = domain.mark();
        for term in &program.terms {
            contract(program, term, domain)?;
        }
        for term in program.terms.iter().rev() {
            contract(program, term, domain)?;
        }
        if domain.mark() == changed {
            return Ok(());
        }
        mark = Some(changed);
    }
    Ok(())
}

/// Tightens the ranges of a term's columns.
fn contract(
    program: &SpatialProgram,
    term: &SmoothTerm,
    domain: &mut Domain,
) -> Result<(), EmptyDomain> {
    let range = term.range(domain);
    narrow(program, domain, term.result, range)?;
    let value = bounds(domain, term.result);
    match &term.shape {
        Shape::Elementary { function, of } => {
            let inverse = function.inverse(value, bounds(domain, *of));
            narrow(program, domain, *of, inverse)
        }
        Shape::Bilinear([a, b]) => {
            for (own, other) in [(*a, *b), (*b, *a)] {
                if own != other {
                    narrow(program, domain, own, quotient(value, bounds(domain, other)))?;
                }
            }
            Ok(())
        }
        Shape::Quotient([a, b]) => {
            narrow(program, domain, *a, value * bounds(domain, *b))?;
            narrow(program, domain, *b, quotient(bounds(domain, *a), value))
        }
    }
}

/// All `q` for which `q * divisor` can be in a range.
fn quotient(range: Interval, divisor: Interval) -> Interval {
    // 0 times anything is 0.
    if divisor.contains(0.0) && range.contains(0.0) {
        return Interval::REALS;
    }
    range / divisor
}

/// Whether a bound that is at or beyond 0 moves to the other side of it, or away from it by a
/// factor: little beside the width of a range, and much for a logarithm or a divisor.
fn leaves_zero(old: f64, new: f64) -> bool {
    let (old, new) = if new > old { (old, new) } else { (-old, -new) };
    new > 0.0 && new > 2.0 * old
}

/// Intersects the bounds of a column with a range.
fn narrow(
    program: &SpatialProgram,
    domain: &mut Domain,
    column: usize,
    range: Interval,
) -> Result<(), EmptyDomain> {
    let own = bounds(domain, column);
    let mut common = own.intersection(range);
    if program.program.integral[column] {
        common = Interval::new((common.lower - 1e-9).ceil(), (common.upper + 1e-9).floor());
    }
    if common.lower.is_nan() || common.upper.is_nan() {
        return Ok(());
    }
    if common.is_empty() {
        let size = own.lower.abs().min(own.upper.abs()).max(1.0);
        if common.lower - common.upper > CROSSED * size || program.program.integral[column] {
            return Err(EmptyDomain);
        }
        // Rounding is no contradiction.
        let nearest = own.nearest(0.5 * common.lower + 0.5 * common.upper);
        common = Interval::new(nearest, nearest);
    }
    let gains = |old: f64, new: f64| {
        old != new
            && (old.is_infinite()
                || (old - new).abs() > LEAST_RANGE_GAIN * own.width().min(1e20)
                || program.program.integral[column]
                || leaves_zero(old, new))
    };
    if gains(own.lower, common.lower) {
        domain.set_lower(column, common.lower);
    }
    if gains(own.upper, common.upper) {
        domain.set_upper(column, common.upper);
    }
    Ok(())
}
