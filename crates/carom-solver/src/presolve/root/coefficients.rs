//! Tightens coefficients and limits of rows with integers.
//!
//! Takes rows with integers; leaves smaller coefficients of binaries, and tighter limits
//! (Savelsbergh, Preprocessing and probing techniques for mixed integer programming problems, ORSA
//! Journal on Computing 6, 1994).
//!
//! If all columns of a row are integral, its limits are rounded to multiples of the greatest common
//! divisor of its coefficients. If a row with one limit is redundant at one value of a binary, the
//! binary's coefficient and the row's limit are changed together until it is only just redundant.

use super::postsolve::{Restored, Undo};
use super::working_program::{Infeasible, Sparse, WorkingProgram};
use crate::presolve::coefficients::{Columns, round_limits, tighten_terms};

/// The distance from its limit up to which a row counts as binding, relative to its terms.
const BINDING_DISTANCE: f64 = 1e-6;

/// A row as it was before it was tightened.
#[derive(Debug)]
struct TightenedRow {
    row: usize,
    /// The row in the form `sign * entries <= limit`.
    entries: Sparse,
    sign: f64,
    limit: f64,
    /// The entries after it was.
    tight: Sparse,
}

pub(super) fn apply(work: &mut WorkingProgram, row: usize) -> Result<usize, Infeasible> {
    if work.rows[row].len() < 2 {
        return Ok(0);
    }
    // Limits of whole coefficients first: smaller ones may be whole no longer.
    let rounded = round(work, row)?;
    let tightened = tighten(work, row);
    Ok(usize::from(tightened) + usize::from(rounded | round(work, row)?))
}

/// Rounds the limits of a row of integers; whether they have moved.
fn round(work: &mut WorkingProgram, row: usize) -> Result<bool, Infeasible> {
    let (limits, noise) = ([work.row_lower[row], work.row_upper[row]], work.row_noise[row]);
    let rounded = round_limits(&work.rows[row], limits, columns(work), noise);
    let Some(([lower, upper], news)) = rounded else { return Ok(false) };
    if lower > upper {
        return Err(Infeasible);
    }
    (work.row_lower[row], work.row_upper[row]) = (lower, upper);
    Ok(news)
}

fn columns(work: &WorkingProgram) -> Columns<'_> {
    Columns { lower: &work.lower, upper: &work.upper, integral: &work.integral }
}

/// Tightens the binaries of a one-sided row.
fn tighten(work: &mut WorkingProgram, row: usize) -> bool {
    let old = [work.row_lower[row], work.row_upper[row]];
    let mut terms = std::mem::take(&mut work.memory);
    terms.clone_from(&work.rows[row]);
    let of_columns = terms.iter().map(|&(j, a)| a.abs() * work.column_noise[j]).sum::<f64>();
    let noise = of_columns + work.row_noise[row];
    let new = tighten_terms(&mut terms, old, columns(work), noise);
    if let Some([lower, upper]) = new {
        (work.row_lower[row], work.row_upper[row]) = (lower, upper);
        let tight: Sparse = terms.iter().copied().filter(|(_, a)| *a != 0.0).collect();
        let entries = work.set_row(row, tight);
        if entries.iter().any(|&(j, _)| !work.integral[j]) {
            let tight = work.rows[row].clone();
            let (sign, limit) = if old[1].is_finite() { (1.0, old[1]) } else { (-1.0, -old[0]) };
            work.push(TightenedRow { row, entries, sign, limit, tight });
        }
    }
    work.memory = terms;
    new.is_some()
}

impl Undo for TightenedRow {
    /// A row that only binds in its tight form binds because its columns are at their bounds, so
    /// the bounds take the pressure over.
    fn dual(&self, all: &mut Restored) {
        let y = all.y[self.row];
        if y == 0.0 {
            return;
        }
        let activity: f64 = self.entries.iter().map(|&(j, a)| self.sign * a * all.x[j]).sum();
        let scale = self.entries.iter().map(|&(j, a)| (a * all.x[j]).abs()).fold(1.0, f64::max);
        self.tight.iter().for_each(|&(j, a)| all.d[j] -= a * y);
        if self.limit - activity > BINDING_DISTANCE * scale {
            all.y[self.row] = 0.0;
        } else {
            self.entries.iter().for_each(|&(j, a)| all.d[j] += a * y);
        }
    }
}
