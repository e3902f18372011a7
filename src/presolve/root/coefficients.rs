//! Tightens coefficients and limits of rows with integers.
//!
//! A row over integers only is divided by the greatest common divisor of its coefficients, and its
//! limits are rounded. If a row is redundant at one value of a binary, the binary's coefficient and
//! the row's limit are changed together until it is only just redundant.

use super::postsolve::{Restored, Undo};
use super::work::{Infeasible, Sparse, Work, is_whole};
use crate::presolve::coefficients::{MARGIN, OneSided};

/// Largest coefficient of an integer row that is divided.
const LARGEST: f64 = 1e9;

/// Distance from 0 up to which a row counts as binding, relative to its terms.
const BINDING: f64 = 1e-6;

/// A row as it was before it was tightened.
#[derive(Debug)]
struct Tightened {
    row: usize,
    /// The row in the form `sign * entries <= limit`.
    entries: Sparse,
    sign: f64,
    limit: f64,
    /// The entries after it was.
    tight: Sparse,
}

pub(super) fn apply(work: &mut Work, row: usize) -> Result<usize, Infeasible> {
    if work.rows[row].len() < 2 {
        return Ok(0);
    }
    let mut changes = usize::from(tighten(work, row));
    if work.rows[row].iter().all(|&(j, _)| work.integral[j]) {
        changes += usize::from(divide(work, row)?);
    }
    Ok(changes)
}

/// Rounds the limits of a row of integers.
fn divide(work: &mut Work, row: usize) -> Result<bool, Infeasible> {
    let mut divisor = 0u64;
    for &(_, a) in &work.rows[row] {
        if a.abs() > LARGEST || a != a.round() {
            return Ok(false);
        }
        let (mut p, mut q) = (divisor, a.abs() as u64);
        while q > 0 {
            (p, q) = (q, p % q);
        }
        divisor = p;
    }
    let divisor = divisor as f64;
    if divisor == 0.0 {
        return Ok(false);
    }
    let (lower, upper) = (work.row_lower[row], work.row_upper[row]);
    let slack = 1e-6_f64.min(1e-6 * divisor).max(work.row_noise[row]);
    if slack >= 0.5 * divisor {
        return Ok(false);
    }
    let new_lower = divisor * ((lower - slack) / divisor).ceil();
    let new_upper = divisor * ((upper + slack) / divisor).floor();
    if new_lower > new_upper {
        return Err(Infeasible);
    }
    let moved = |old: f64, new: f64| old.is_finite() && (old - new).abs() > slack;
    let changed = moved(lower, new_lower) || moved(upper, new_upper);
    if lower.is_finite() {
        work.row_lower[row] = new_lower;
    }
    if upper.is_finite() {
        work.row_upper[row] = new_upper;
    }
    Ok(changed)
}

/// Tightens the binaries of a one-sided row.
fn tighten(work: &mut Work, row: usize) -> bool {
    let Some(mut side) = OneSided::new(work.row_lower[row], work.row_upper[row]) else {
        return false;
    };
    let OneSided { sign, limit, .. } = side;
    let range = work.range(work.rows[row].iter());
    side.most = if sign > 0.0 { range.most } else { -range.least };
    if !side.can_be_violated() {
        return false;
    }
    let old = &work.rows[row];
    let whole = old.iter().all(|&(j, a)| work.integral[j] && is_whole(a)) && is_whole(limit);
    let scale = range.scale * old.len() as f64;
    let noise = range.noise + work.row_noise[row];
    // Limits are rounded to their last digit each time; whole numbers are not.
    let (margin, rounding) =
        if whole { (0.0, 0.0) } else { (MARGIN * scale + noise, 2.0 * f64::EPSILON * scale) };
    let is_binary = |j: usize| work.integral[j] && work.lower[j] == 0.0 && work.upper[j] == 1.0;
    let shrink = |side: &mut OneSided, (j, value): &mut (usize, f64)| {
        is_binary(*j) && side.shrink(value, margin, rounding)
    };
    // Most rows stay as they are.
    let mut trial = side;
    if !old.iter().copied().any(|mut term| shrink(&mut trial, &mut term)) {
        return false;
    }
    let old = old.clone();
    let mut entries = old.clone();
    entries.iter_mut().for_each(|term| _ = shrink(&mut side, term));
    entries.retain(|(_, a)| *a != 0.0);
    work.set_row(row, entries.clone());
    side.write_limit(&mut work.row_lower[row], &mut work.row_upper[row]);
    if old.iter().any(|&(j, _)| !work.integral[j]) {
        work.push(Tightened { row, entries: old, sign, limit, tight: entries });
    }
    true
}

impl Undo for Tightened {
    /// A row that only binds in its tight form binds because its columns are at their bounds, so the
    /// bounds take the pressure over.
    fn dual(&self, all: &mut Restored) {
        let y = all.y[self.row];
        if y == 0.0 {
            return;
        }
        let activity: f64 = self.entries.iter().map(|&(j, a)| self.sign * a * all.x[j]).sum();
        let scale = self.entries.iter().map(|&(j, a)| (a * all.x[j]).abs()).fold(1.0, f64::max);
        self.tight.iter().for_each(|&(j, a)| all.d[j] -= a * y);
        if self.limit - activity > BINDING * scale {
            all.y[self.row] = 0.0;
        } else {
            self.entries.iter().for_each(|&(j, a)| all.d[j] += a * y);
        }
    }
}
