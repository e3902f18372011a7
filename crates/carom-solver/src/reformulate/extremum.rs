//! Absolute values, maxima and minima as rows.
//!
//! Takes a variable that is an absolute value, a maximum or a minimum; leaves rows, and binaries if
//! one side does not suffice.
//!
//! `w = max(e1, ..., en)` is `w >= ei` for all of them and `w <= ei + Mi (1 - zi)` for one, chosen
//! by binaries with `z1 + ... + zn = 1` (one binary for two expressions). `Mi` is the largest
//! `ej - ei` over the bounds. Expressions that are never the largest according to the bounds are
//! omitted, so the maximum of expressions in a known order is one equation. If the model pushes `w`
//! only down, the first rows suffice, see `reformulate/direction.rs`; they need no bounds. A
//! minimum is a maximum with all signs changed (`sign` = -1).

use super::direction::Tie;
use super::lowering::Lowering;
use super::report::{BigMEntry, BigMSource, Side};
use crate::error::Error;
use crate::interval::add_up;
use crate::model::{Affine, Variable, VariableKind};
use crate::tolerance;

/// Adds the rows of `sign * result = max(sign * of)`.
pub(super) fn apply(
    result: Variable,
    of: &[Affine],
    sign: f64,
    tie: Tie,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let kept = undominated(of, sign, lowering)?;
    let (none, any) = (f64::NEG_INFINITY, f64::INFINITY);
    if let [only] = kept[..] {
        return lowering.affine_row(result - only, 0.0, 0.0);
    }
    for &expression in &kept {
        let (lower, upper) = if sign > 0.0 { (0.0, any) } else { (none, 0.0) };
        lowering.affine_row(result - expression, lower, upper)?;
    }
    if tie != Tie::Exact {
        return Ok(());
    }
    let mut misses = Vec::with_capacity(kept.len());
    for &expression in &kept {
        misses.push(miss(expression, &kept, sign, lowering)?);
    }
    let mut one = Affine::zero();
    let single = match kept.len() {
        2 => Some(lowering.column("first", VariableKind::Binary, 0.0, 1.0)?),
        _ => None,
    };
    for (k, (&expression, mut entry)) in kept.iter().zip(misses).enumerate() {
        let m = entry.value;
        // sign (w - e) <= M (1 - z), with 1 - z in place of z for the second of two.
        let gap = sign * (result - expression);
        match single {
            Some(first) if k == 1 => lowering.affine_row(gap - m * first, none, 0.0)?,
            Some(first) => lowering.affine_row(gap + m * first, none, m)?,
            None => {
                let chosen = lowering.column("is", VariableKind::Binary, 0.0, 1.0)?;
                one += chosen;
                lowering.affine_row(gap + m * chosen, none, m)?;
            }
        }
        entry.row = lowering.newest_row();
        lowering.report.entries.push(entry);
    }
    if single.is_none() {
        lowering.affine_row(one, 1.0, 1.0)?;
    }
    Ok(())
}

/// The expressions that can be the largest (times `sign`); among equal ones, the first. Implied
/// bounds do not count, because they may come from the function itself.
fn undominated<'a>(
    of: &'a [Affine],
    sign: f64,
    lowering: &Lowering<'_>,
) -> Result<Vec<&'a Affine>, Error> {
    let mut kept: Vec<&Affine> = of.iter().collect();
    let mut k = kept.len();
    // In reverse, to keep the first of equal ones.
    while k > 0 && kept.len() > 1 {
        k -= 1;
        for j in (0..kept.len()).filter(|&j| j != k) {
            let ahead = lowering.model.range(&(sign * (kept[k] - kept[j])))?.upper;
            if ahead <= 0.0 {
                kept.remove(k);
                break;
            }
        }
    }
    Ok(kept)
}

/// The largest excess of the extremum over one of its expressions, as an entry of the report.
fn miss(
    expression: &Affine,
    kept: &[&Affine],
    sign: f64,
    lowering: &mut Lowering<'_>,
) -> Result<BigMEntry, Error> {
    let (mut most, mut proved) = (0.0, 0.0);
    let side = if sign > 0.0 { Side::Upper } else { Side::Lower };
    let mut entry = BigMEntry::new(lowering.statement(), side, BigMSource::Bounds);
    for &other in kept {
        let ahead = sign * (other - expression);
        let mut upper = lowering.range(&ahead)?.upper;
        if upper >= tolerance::INFINITE {
            upper = add_up(lowering.upper_bound_by_rows(&ahead.terms()), ahead.offset());
            entry.source = BigMSource::ImpliedBounds;
        }
        if upper >= tolerance::INFINITE {
            return Err(lowering.unbounded(&ahead, 1.0)?);
        }
        if upper > most {
            most = upper;
            entry.shares.clear();
            entry.note_shares(lowering, &ahead.terms(), Side::Upper)?;
        }
        let program = lowering.maximizer.as_mut().map(|m| m.upper_bound(&ahead.terms(), &[]));
        let program = program.map_or(f64::INFINITY, |most| add_up(most, ahead.offset()));
        proved = upper.min(program).max(proved);
    }
    (entry.needed, entry.value) = (add_up(most, 0.0), add_up(proved, 0.0));
    if entry.shares.iter().any(|share| share.implied) {
        entry.source = BigMSource::ImpliedBounds;
    }
    if entry.value < entry.needed {
        entry.source = BigMSource::LinearProgram;
    }
    Ok(entry)
}
