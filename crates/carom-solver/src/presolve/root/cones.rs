//! Shortens second-order cones.
//!
//! Takes second-order cones and bounds; leaves shorter cones, or bounds and rows in their place:
//!
//! * Entries that are 0 leave the tail, and their parts with them.
//! * A tail without open entries bounds the head, and a head without open columns bounds a tail
//!   with one open entry. The bound says all that the cone does.
//! * A norm of one entry is two rows.
//! * A cone goes that bounds imply, or whose bounds leave one point.
//! * A long cone of which few entries are left needs no parts.
//!
//! The columns that leave a cone are like any others from there on.

use super::postsolve::{Restored, Undo};
use super::working_program::{Infeasible, Sparse, WorkingProgram};
use crate::presolve::conic_tightening::{BoundedColumns, is_implied, missed_by, pins};
use crate::presolve::parameters::{CONTRADICTION, FEW_ROUNDINGS};
use crate::presolve::tightening::Tightening;
use crate::program::{Cone, ConeRole, ConeShape, LONGEST_TAIL, conic_columns};
use crate::tolerance;

/// Parts of a cone that is left without them.
#[derive(Debug)]
struct DroppedParts {
    parts: Vec<Cone>,
    /// The column that their sum is at most.
    sum: usize,
}

pub(super) fn apply(work: &mut WorkingProgram) -> Result<usize, Infeasible> {
    if work.cones.is_empty() {
        return Ok(0);
    }
    let cones = std::mem::take(&mut work.cones);
    let mut changes = 0;
    let mut kept = Vec::with_capacity(cones.len());
    for group in cones.chunk_by(|_, next| next.role == ConeRole::Part) {
        let entries = group.iter().map(|cone| cone.columns.len()).sum();
        let is_given = group[0].columns.iter().any(|&j| work.given[j]);
        match !is_given && !work.is_late(entries) {
            true => changes += reduce(work, group, &mut kept)?,
            false => kept.extend_from_slice(group),
        }
    }
    work.cones = kept;
    if changes > 0 {
        work.conic = conic_columns(&work.cones, work.uses.len());
    }
    Ok(changes)
}

/// Reduces a cone with its parts. Returns the number of changes.
fn reduce(
    work: &mut WorkingProgram,
    group: &[Cone],
    kept: &mut Vec<Cone>,
) -> Result<usize, Infeasible> {
    let [cone, parts @ ..] = group else { return Ok(0) };
    let is_constant = |work: &WorkingProgram, j: usize| work.lower[j] == work.upper[j];
    for &j in cone.head() {
        // A column that leaves the cone keeps this in any case.
        work.intersect(j, [0.0, f64::INFINITY], 0.0)?;
    }
    if cone.head().iter().any(|&j| work.upper[j] == 0.0) {
        cone.tail().iter().try_for_each(|&j| work.intersect(j, [0.0, 0.0], 0.0))?;
    } else if cone.columns.iter().all(|&j| work.column_noise[j] == 0.0) {
        pin(work, cone)?;
    }
    let stays = |work: &WorkingProgram, j: &usize| [work.lower[*j], work.upper[*j]] != [0.0, 0.0];
    let tail: Vec<usize> = cone.tail().iter().copied().filter(|j| stays(work, j)).collect();
    let open: Vec<usize> = tail.iter().copied().filter(|&j| !is_constant(work, j)).collect();
    let open_heads = cone.head().iter().filter(|&&j| !is_constant(work, j)).count();
    let mut short = cone.head().to_vec();
    short.extend(&tail);
    let short = Cone { columns: short, ..cone.clone() };
    let is_bound = (open.is_empty() && open_heads <= 1) || (open.len() == 1 && open_heads == 0);
    if tail.is_empty() || is_bound || holds_anyway(work, &short) {
        if !tail.is_empty() && is_bound {
            bound(work, &short, &open)?;
        }
        drop_parts(work, cone.columns[0], parts);
        return Ok(1);
    }
    if let (ConeShape::Norm, &[head], &[entry]) = (cone.shape, cone.head(), &tail[..]) {
        for sign in [1.0, -1.0] {
            let mut terms = vec![(entry, sign), (head, -1.0)];
            terms.sort_unstable_by_key(|term| term.0);
            add_row(work, terms, [f64::NEG_INFINITY, 0.0]);
        }
        drop_parts(work, cone.columns[0], parts);
        return Ok(1);
    }
    if tail.len() == cone.tail().len() {
        kept.extend_from_slice(group);
        return Ok(0);
    }
    if parts.is_empty() || tail.len() <= LONGEST_TAIL {
        drop_parts(work, cone.columns[0], parts);
        kept.push(Cone { role: ConeRole::Single, ..short });
    } else {
        let (left, gone): (Vec<&Cone>, Vec<&Cone>) =
            parts.iter().partition(|part| part.tail().iter().any(|j| stays(work, j)));
        kept.push(short);
        kept.extend(left.into_iter().cloned());
        drop_parts(work, cone.columns[0], &gone.into_iter().cloned().collect::<Vec<_>>());
    }
    Ok(1)
}

/// Whether bounds imply a cone.
fn holds_anyway(work: &WorkingProgram, cone: &Cone) -> bool {
    alone(work, cone, is_implied)
}

/// Fixes the entries of a cone that is one point.
fn pin(work: &mut WorkingProgram, cone: &Cone) -> Result<(), Infeasible> {
    for Tightening { column, is_upper, value } in alone(work, cone, pins) {
        let [below, above] = [f64::NEG_INFINITY, f64::INFINITY];
        let bounds = if is_upper { [below, value] } else { [value, above] };
        work.intersect(cone.columns[column], bounds, 0.0)?;
    }
    Ok(())
}

/// Applies a function to a cone whose columns are numbered by its entries.
fn alone<T>(work: &WorkingProgram, cone: &Cone, of: impl Fn(BoundedColumns<'_>, &Cone) -> T) -> T {
    let bounds: Vec<[f64; 2]> =
        cone.columns.iter().map(|&j| [work.lower[j], work.upper[j]]).collect();
    let integral: Vec<bool> = cone.columns.iter().map(|&j| work.integral[j]).collect();
    let here = Cone { columns: (0..bounds.len()).collect(), ..cone.clone() };
    of(BoundedColumns { integral: &integral, bounds: &bounds }, &here)
}

/// Makes a cone a bound of its only open column, or checks it if there is none.
///
/// Values that presolve has computed are known but for their noise, and a root makes much of it:
/// `x^2 <= 0` misses by 1e-7 where `x` should be 0 and is 1e-7.
fn bound(work: &mut WorkingProgram, cone: &Cone, open: &[usize]) -> Result<(), Infeasible> {
    let is_fixed = |j: &&usize| work.lower[**j] == work.upper[**j];
    let value = |j: usize| work.lower[j];
    let noise = |j: usize| work.column_noise[j];
    let tail = || cone.tail().iter().filter(is_fixed).copied();
    let fixed: f64 = tail().map(|j| value(j) * value(j)).sum();
    let noise_of_fixed: f64 = tail().map(|j| (2.0 * value(j).abs() + noise(j)) * noise(j)).sum();
    if let Some(head) = cone.head().iter().copied().find(|j| !is_fixed(&j)) {
        let others = || cone.head().iter().copied().filter(|&j| j != head);
        let (least, noise) = match cone.shape {
            ConeShape::Norm => (fixed.sqrt(), tail().map(noise).sum()),
            ConeShape::Rotated => {
                let other: f64 = others().map(value).product();
                let noise = others().map(noise).sum::<f64>();
                if other <= 2.0 * noise {
                    // The tail is 0 but for rounding.
                    return Ok(());
                }
                let least = fixed / other;
                (least, (noise_of_fixed + least * noise) / (other - noise))
            }
        };
        let noise = noise + FEW_ROUNDINGS * least;
        return work.intersect(head, [least - noise, f64::INFINITY], noise);
    }
    // The room of the tail, squared.
    let (room, noise_of_room) = match *cone.head() {
        [first, second] => {
            let [a, b] = [first, second].map(noise);
            let (x, y) = (value(first), value(second));
            (x * y, (x.abs() + a) * b + (y.abs() + b) * a)
        }
        [head] => (value(head).powi(2), (2.0 * value(head).abs() + noise(head)) * noise(head)),
        _ => (0.0, 0.0),
    };
    let error = FEW_ROUNDINGS * (room.abs() + fixed) + noise_of_fixed + noise_of_room;
    let noise: f64 = cone.head().iter().copied().chain(tail()).map(noise).sum();
    let (miss, size) = alone(work, cone, |columns, cone| missed_by(columns, cone, fixed.sqrt()));
    // The unit of a rotated cone is that of its row.
    let is_rotated = cone.shape == ConeShape::Rotated;
    if miss > noise + CONTRADICTION * size
        || is_rotated && fixed - room > error + tolerance::FEASIBILITY * fixed.max(1.0)
    {
        return Err(Infeasible);
    }
    let &[entry] = open else { return Ok(()) };
    let most = (room - fixed + error).max(0.0).sqrt() * (1.0 + FEW_ROUNDINGS);
    work.intersect(entry, [-most, most], FEW_ROUNDINGS * most)
}

/// Adds a row with some terms (sorted by column, none of them 0) and limits; returns its number.
pub(super) fn add_row(work: &mut WorkingProgram, terms: Sparse, [lower, upper]: [f64; 2]) -> usize {
    let row = work.rows.len();
    terms.iter().for_each(|&(column, _)| work.uses[column].push(row));
    work.rows.push(terms);
    work.row_lower.push(lower);
    work.row_upper.push(upper);
    work.row_alive.push(true);
    work.row_noise.push(0.0);
    row
}

/// Fixes the columns of parts that no cone needs; any value between 0 and what the head leaves
/// would do.
fn drop_parts(work: &mut WorkingProgram, sum: usize, parts: &[Cone]) {
    if parts.is_empty() {
        return;
    }
    for part in parts {
        work.upper[part.columns[0]] = 0.0;
    }
    work.push(DroppedParts { parts: parts.to_vec(), sum });
}

impl Undo for DroppedParts {
    fn primal(&self, x: &mut [f64]) {
        let most = x[self.sum];
        self.parts.iter().for_each(|part| part.complete(x, most));
    }

    fn dual(&self, _all: &mut Restored) {}
}
