//! Moves a point onto the cones that it misses.
//!
//! A point of an interior-point method misses a cone by some units of the tolerance. The tangent of
//! each missed cone is a row, and the point moves onto these rows and the others; some such steps
//! converge as Newton's method does.

use super::cone_cut::ConeCut;
use super::polish::polish;
use crate::presolve::{FIXED, Reduced};
use crate::program::ConeRole;
use crate::solver::StopToken;

/// Most steps.
const MOST_STEPS: usize = 6;

/// The miss of a cone that needs no step, relative to the reach of its head (no unit).
const ENOUGH: f64 = 1e-13;

/// Moves a point onto the cones of a reduced program, and keeps it on the rows. Leaves it as it is
/// where that does not bring it nearer.
pub(crate) fn polish_cones(program: &Reduced, x: &mut [f64], token: &StopToken) {
    if program.cones.is_empty() {
        return;
    }
    let place = program.places();
    let mut tangents = program.clone();
    let mut best = x.to_vec();
    let mut least = largest_miss(program, x);
    for _ in 0..MOST_STEPS {
        if least <= 0.0 || token.is_over() {
            break;
        }
        tangents.truncate_rows(program.rows.len());
        for cone in program.cones.iter().filter(|cone| cone.role != ConeRole::Part) {
            if cone.miss(x) > 0.0
                && let Some(cut) = ConeCut::at(cone, x)
            {
                tangents.append_row(&cut.terms, &place, FIXED);
            }
        }
        polish(&tangents, x, token);
        let miss = largest_miss(program, x);
        if miss.is_nan() || miss >= least {
            break;
        }
        least = miss;
        best.copy_from_slice(x);
    }
    x.copy_from_slice(&best);
}

/// The largest miss of a cone, relative to its reach; 0 if none is worth a step.
fn largest_miss(program: &Reduced, x: &[f64]) -> f64 {
    let cones = program.cones.iter().filter(|cone| cone.role != ConeRole::Part);
    let miss = |most: f64, miss: f64| if miss > ENOUGH { most.max(miss) } else { most };
    cones.map(|cone| cone.miss(x) / cone.reach(x).abs().max(1.0)).fold(0.0, miss)
}
