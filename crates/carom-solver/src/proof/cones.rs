//! Rows that hold in cones, as the log has them.

use super::relaxed::Relaxer;
use crate::presolve::Reduced;
use crate::program::{ConeShape, Program};
use crate::relaxation::ConeCut;

/// How much shorter than allowed the weights of a tail are made, for rounding (no unit).
const SHORTENED: f64 = 1e-15;

/// The row `head weights . head - 2 or 1 times tail weights . tail >= 0` of a cone.
#[derive(Debug, Clone)]
pub(super) struct ConeRow {
    pub(super) cone: usize,
    pub(super) head: Vec<f64>,
    pub(super) tail: Vec<f64>,
}

impl ConeRow {
    /// Its terms.
    pub(super) fn terms<'a>(
        &'a self,
        program: &'a Program,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let cone = &program.cones[self.cone];
        let factor = if cone.shape == ConeShape::Rotated { -2.0 } else { -1.0 };
        let head = cone.head().iter().copied().zip(self.head.iter().copied());
        let tail = cone.tail().iter().copied().zip(self.tail.iter().map(move |w| factor * w));
        head.chain(tail).filter(|(_, a)| *a != 0.0)
    }

    /// The row that a cut of a cone is; `None` if it is one of another cone.
    pub(super) fn of(cut: &ConeCut, cone: usize, program: &Program) -> Option<Self> {
        let own = &program.cones[cone];
        let weight = |j: &usize| {
            let term = cut.terms.iter().find(|(column, _)| column == j);
            term.map_or(0.0, |(_, a)| *a)
        };
        if !cut.terms.iter().all(|(j, _)| own.columns.contains(j)) {
            return None;
        }
        let head: Vec<f64> = own.head().iter().map(|j| -weight(j)).collect();
        let halved = if own.shape == ConeShape::Rotated { 0.5 } else { 1.0 };
        let mut tail: Vec<f64> = own.tail().iter().map(|j| halved * weight(j)).collect();
        if head.iter().any(|p| *p < 0.0) {
            return None;
        }
        let square: f64 = tail.iter().map(|w| w * w).sum();
        let allowed = match head[..] {
            [p] => p * p,
            [p, q] => p * q,
            _ => return None,
        };
        if square > allowed * (1.0 - SHORTENED) {
            let factor = (allowed / square).sqrt() * (1.0 - 4.0 * SHORTENED);
            if factor.is_nan() || factor < 0.99 {
                return None;
            }
            tail.iter_mut().for_each(|w| *w *= factor);
        }
        Some(ConeRow { cone, head, tail })
    }
}

/// By column, the cones that it is in.
pub(super) fn cones_by_column(program: &Program) -> Vec<Vec<usize>> {
    let mut cones = vec![Vec::new(); program.column_count()];
    for (k, cone) in program.cones.iter().enumerate() {
        cone.columns.iter().for_each(|&j| cones[j].push(k));
    }
    cones
}

impl Relaxer<'_> {
    /// The rows of cones behind the last rows of a relaxation, with their multipliers.
    pub(super) fn cone_rows(
        &self,
        reduced: &Reduced,
        cuts: &[ConeCut],
        y: &[f64],
    ) -> Vec<(ConeRow, f64)> {
        let first = reduced.rows.len().saturating_sub(cuts.len());
        let mut rows = Vec::new();
        for (k, cut) in cuts.iter().enumerate() {
            let multiplier = y.get(first + k).copied().unwrap_or(0.0);
            if multiplier.is_nan() || multiplier <= 0.0 {
                continue;
            }
            let cones = cut.terms.iter().map(|(j, _)| &self.cones_of[*j]).min_by_key(|c| c.len());
            let mut cones = cones.into_iter().flatten();
            if let Some(row) = cones.find_map(|&c| ConeRow::of(cut, c, &self.program)) {
                rows.push((row, multiplier));
            }
        }
        rows
    }
}
