//! States from which every way out leads out of the domain, whatever the inputs.
//!
//! The states from which a joint transition can end in the domain are a polyhedron: the inputs are
//! eliminated from its conditions (Fourier and Motzkin). A state outside all of these polyhedra, at
//! which some joint transition is possible, is stuck.

use super::joint_transitions::{JointPiece, joined};
use super::piece::{Facet, Piece};
use super::programs::{Found, gap, is_empty_at};
use super::{IllPosedness, Search, Step};
use crate::error::Error;

/// The most half-spaces of a projection.
const MOST_FACETS: usize = 400;

impl Search<'_> {
    /// Reports, for each combination of modes, a state from which none stays in the domain.
    pub(super) fn stuck(&mut self, step: &Step, transitions: &[JointPiece]) -> Result<(), Error> {
        if self.system.choices.iter().any(|choice| choice.may_end) {
            return Ok(());
        }
        let mut combinations: Vec<&[(String, String)]> = Vec::new();
        for modes in transitions.iter().map(|own| &own.modes[..]) {
            let key = format!("{modes:?}");
            if combinations.contains(&modes) || !self.is_new("stuck", &key, "") {
                continue;
            }
            combinations.push(modes);
            let own: Vec<&JointPiece> = transitions.iter().filter(|m| m.modes == modes).collect();
            if let Some(Found { point, margin }) = self.stuck_among(step, &own)? {
                let mut witness = self.witness(step, &point);
                witness.input.clear();
                let flaw = IllPosedness::Stuck { modes: modes.to_vec(), witness, margin };
                self.report("stuck", &key, "", flaw);
            }
        }
        Ok(())
    }

    /// A state at which one of the joint transitions is possible, but none stays in the domain.
    fn stuck_among(&mut self, step: &Step, joint: &[&JointPiece]) -> Result<Option<Found>, Error> {
        let (n, size) = (self.system.states.len(), step.units.size());
        let all = |piece: &Piece| joined([piece, &step.base]);
        let inside: Vec<Piece> = joint.iter().map(|own| all(&own.inside)).collect();
        let projections: Option<Vec<Piece>> =
            inside.iter().map(|piece| projected(piece, n, size)).collect();
        let Some(projections) = projections else { return Ok(None) };
        let projections: Vec<&Piece> = projections.iter().collect();
        for own in joint {
            let own = all(&own.piece);
            let Some(possible) = projected(&own, n, size) else { continue };
            let Some(mut found) = gap(&possible, &projections, size, self.solver)? else {
                continue;
            };
            // By programs over the inputs, in case that the elimination lost too much by rounding.
            let state = &found.point[..n];
            let mut is_stuck = !is_empty_at(&own, state, size, false, self.solver)?;
            for piece in &inside {
                is_stuck = is_stuck && is_empty_at(piece, state, size, false, self.solver)?;
            }
            if is_stuck {
                found.point[n..].fill(0.0);
                return Ok(Some(found));
            }
        }
        Ok(None)
    }
}

/// The points of the first `n` coordinates that some others in the unit box complete to a point of
/// the piece, without its limits for the planner; `None` if that takes too many half-spaces.
fn projected(piece: &Piece, n: usize, size: usize) -> Option<Piece> {
    if piece.is_empty(false) {
        return Some(piece.clone());
    }
    let mut rows: Vec<(Vec<f64>, f64)> =
        piece.facets(false).map(|facet| (facet.normal.clone(), facet.limit)).collect();
    for k in (n..size).rev() {
        let unit = |sign: f64| (0..size).map(|j| if j == k { sign } else { 0.0 }).collect();
        rows.extend([(unit(1.0), 1.0), (unit(-1.0), 0.0)]);
        let (with, mut left): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|(normal, _)| normal[k].abs() > 1e-12);
        let (above, below): (Vec<_>, Vec<_>) =
            with.into_iter().partition(|(normal, _)| normal[k] > 0.0);
        for (a, b) in above.iter().flat_map(|a| below.iter().map(move |b| (a, b))) {
            let (s, t) = (1.0 / a.0[k], -1.0 / b.0[k]);
            let mut normal: Vec<f64> = a.0.iter().zip(&b.0).map(|(a, b)| s * a + t * b).collect();
            normal[k] = 0.0;
            left.push((normal, s * a.1 + t * b.1));
        }
        rows = pruned(left);
        if rows.len() > MOST_FACETS {
            return None;
        }
    }
    let mut all = Piece::default();
    for (normal, limit) in rows {
        all.add_facet(Facet { normal, limit, is_limit: false });
    }
    Some(all)
}

/// The rows with normals of length 1, without those that hold in the whole unit box and those that
/// are there twice.
fn pruned(rows: Vec<(Vec<f64>, f64)>) -> Vec<(Vec<f64>, f64)> {
    let mut kept: Vec<(Vec<f64>, f64)> = Vec::new();
    for (mut normal, mut limit) in rows {
        let length = normal.iter().map(|a| a * a).sum::<f64>().sqrt();
        if length > 1e-12 {
            normal.iter_mut().for_each(|a| *a /= length);
            limit /= length;
        } else if limit >= -1e-9 {
            continue;
        }
        if normal.iter().map(|a| a.max(0.0)).sum::<f64>() <= limit {
            continue;
        }
        let same = |(own, _): &&mut (Vec<f64>, f64)| {
            own.iter().zip(&normal).all(|(a, b)| (a - b).abs() <= 1e-12)
        };
        match kept.iter_mut().find(same) {
            Some((_, own)) => *own = own.min(limit),
            None => kept.push((normal, limit)),
        }
    }
    kept
}
