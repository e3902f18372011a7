//! Redundant rows.
//!
//! Takes rows; leaves only the sides that bounds do not imply (Brearley, Mitra and Williams,
//! Analysis of mathematical programming problems prior to applying the simplex algorithm,
//! Mathematical Programming 8, 1975). Forcing rows, which the bounds satisfy only with equality,
//! fix their columns at bounds.

use super::activity_range::ActivityRange;
use super::postsolve::{Restored, Undo};
use super::working_program::{Infeasible, Sparse, WorkingProgram};
use crate::presolve::parameters::{CONTRADICTION, IMPLIED};
use crate::tolerance;

/// A row forces columns only if each can change its activity by at least this many times the
/// margin.
const MIN_FORCED_CHANGE: f64 = 1e3;

/// A row that leaves each of its columns one bound.
#[derive(Debug)]
struct ForcingRow {
    row: usize,
    entries: Sparse,
    /// The entries of continuous columns, whose reduced costs the row determines.
    continuous: Sparse,
    /// Whether the row holds its columns where its activity is largest (by its lower limit).
    by_lower: bool,
}

pub(super) fn apply(work: &mut WorkingProgram, row: usize) -> Result<usize, Infeasible> {
    let range = work.range(work.rows[row].iter());
    let (lower, upper) = (work.row_lower[row], work.row_upper[row]);
    let noise = range.noise + work.row_noise[row];
    let excess = excess(work, row, &range).max(noise);
    if range.least > upper + excess || range.most < lower - excess {
        return Err(Infeasible);
    }
    let margin = IMPLIED.max(4.0 * f64::EPSILON * range.scale);
    // A row that is violated by more than is accepted forces nothing, because another step refutes
    // it.
    let missed = (CONTRADICTION * range.scale).min(tolerance::FEASIBILITY).max(margin).max(noise);
    let meets = |room: f64| room <= margin && room >= -missed;
    let forcing = if lower.is_finite() && meets(range.most - lower) {
        Some(true)
    } else if upper.is_finite() && meets(upper - range.least) {
        Some(false)
    } else {
        None
    };
    let tells = |&(j, a): &(usize, f64)| {
        let width = work.upper[j] - work.lower[j];
        // Forcing a column moves it by a part of its unit at most, however wide it is.
        let moves = a.abs() * width.min(1.0) >= MIN_FORCED_CHANGE * margin.max(noise);
        !work.is_held(j) && (width == 0.0 || moves)
    };
    if let Some(by_lower) = forcing.filter(|_| work.rows[row].iter().all(tells)) {
        let room = if by_lower { range.most - lower } else { upper - range.least };
        force(work, row, by_lower, room.max(0.0) + noise);
        return Ok(1);
    }
    let mut changes = 0;
    if upper.is_finite() && range.most <= upper + margin {
        work.row_upper[row] = f64::INFINITY;
        changes += 1;
    }
    if lower.is_finite() && range.least >= lower - margin {
        work.row_lower[row] = f64::NEG_INFINITY;
        changes += 1;
    }
    if work.row_lower[row].is_infinite() && work.row_upper[row].is_infinite() {
        work.drop_row(row);
        changes += 1;
    }
    Ok(changes)
}

/// The amount by which rounding may violate a row, in its unit.
fn excess(work: &WorkingProgram, row: usize, range: &ActivityRange) -> f64 {
    let limit = work.limit_size(row);
    let soft = if work.is_equality(row) { range.soft.max(limit) } else { range.soft };
    // Exact terms have no rounding, so their violation counts beyond the tolerance.
    let missed = (CONTRADICTION * soft).max(tolerance::FEASIBILITY);
    let scale = range.scale.max(limit);
    let rounding = f64::EPSILON * work.rows[row].len() as f64 * scale;
    missed.min(CONTRADICTION * scale) + rounding
}

/// Moves the columns of a row to the bounds that it leaves them, up to some room in the row's unit,
/// and drops the row.
fn force(work: &mut WorkingProgram, row: usize, by_lower: bool, room: f64) {
    let entries = work.rows[row].clone();
    for &(j, a) in &entries {
        let at_upper = (a > 0.0) == by_lower;
        if !work.integral[j] && work.lower[j] < work.upper[j] {
            work.column_noise[j] = work.column_noise[j].max(room / a.abs());
        }
        if at_upper {
            work.lower[j] = work.upper[j];
        } else {
            work.upper[j] = work.lower[j];
        }
    }
    let mut continuous = entries.clone();
    continuous.retain(|(j, _)| !work.integral[*j]);
    work.drop_row(row);
    work.push(ForcingRow { row, entries, continuous, by_lower });
}

impl Undo for ForcingRow {
    /// The smallest multiplier with which every column's reduced cost has the sign of its bound.
    fn dual(&self, all: &mut Restored) {
        let wanted = self.continuous.iter().map(|&(j, a)| -all.d[j] / a);
        let y = if self.by_lower { wanted.fold(0.0, f64::min) } else { wanted.fold(0.0, f64::max) };
        all.y[self.row] = y;
        self.entries.iter().for_each(|&(j, a)| all.d[j] += a * y);
    }
}
