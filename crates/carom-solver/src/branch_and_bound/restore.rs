//! The phase after the search: its result becomes an answer about the model.

use super::multipliers::derivatives;
use super::presolve::Presolution;
use super::solve::{EarlierResults, Solve, SolveResult};
use crate::error::Error;
use crate::search::{Completion, Contradiction, SearchResult};
use crate::solution::Termination;

/// Least rounding of a bound that is charged, relative to the bound (no unit).
const LEAST_ROUNDING: f64 = 1e-10;

/// Restores points, the outcome of a start and multipliers. Lowers the bound by the part of the
/// objective that presolve may have lost to rounding.
pub(super) fn restore(
    solve: &Solve<'_>,
    known: &EarlierResults<'_>,
    presolved: &Presolution<'_>,
    mut found: SearchResult,
) -> Result<SolveResult, Error> {
    let point = found.points.first().cloned();
    let derivatives = point.as_ref().and_then(|values| {
        let own = presolved.presolved.as_ref()?;
        let program = &presolved.lowered.program;
        let is_wanted = found.termination == Termination::Optimal && program.integers.is_empty();
        let mut cascade = is_wanted.then(|| solve.cascades.take())?;
        let point = own.postsolve.point(values);
        let derivatives = derivatives(program, own, &point, &mut cascade, solve.token);
        solve.cascades.give_back(cascade);
        derivatives
    });
    if point.as_ref().is_some_and(|values| presolved.changes_objective(values)) {
        found.contradiction = Some(Contradiction::Objective);
    }
    found.points = found.points.iter().map(|values| presolved.restore(values)).collect();
    found.completion = match found.completion {
        Some(Completion::Point(values)) => Some(Completion::Point(presolved.restore(&values))),
        Some(Completion::Contradiction(column)) => {
            Some(Completion::Contradiction(presolved.column(column).unwrap_or(column)))
        }
        // Presolve has decided all integers of the start.
        None if known.start.is_some_and(|start| !start.integers.is_empty()) => {
            found.points.first().cloned().map(Completion::Point)
        }
        other => other,
    };
    let program = &presolved.lowered.program;
    let value = point.as_ref().map(|x| program.objective(&presolved.lowered_point(x)));
    charge(solve, presolved.rounding(), value, &mut found);
    let own = presolved.presolved.as_ref().filter(|_| solve.options.proof_path().is_some());
    let origins = own.map(|own| own.postsolve.origins());
    let lowered_point = point.as_deref().map(|x| match own {
        Some(_) => presolved.lowered_point(x),
        None => x.to_vec(),
    });
    Ok(SolveResult { found, derivatives, point, lowered_point, proof: None, origins })
}

/// Lowers the bound by the part of the objective that presolve may have lost to rounding, unless
/// that is negligible. The gap that was asked for may then be missed, as it may be where columns of
/// the point followed from others.
///
/// # Arguments
///
/// * `value`: that of the best point in the lowered program.
fn charge(solve: &Solve<'_>, rounding: f64, value: Option<f64>, found: &mut SearchResult) {
    if !found.bound.is_finite() {
        return;
    }
    let is_negligible = rounding <= LEAST_ROUNDING * found.bound.abs().max(1.0);
    found.bound -= if is_negligible { 0.0 } else { rounding };
    if let (Termination::Optimal, Some(value)) = (found.termination, value) {
        let constant = solve.model.sense().sign() * solve.model.objective_constant();
        let spare = if is_negligible { LEAST_ROUNDING * value.abs().max(1.0) } else { 0.0 };
        if value - found.bound > solve.options.allowed_gap(value, constant) + spare {
            found.termination = Termination::Stalled;
        }
    }
}
