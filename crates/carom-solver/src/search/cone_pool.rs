//! Cuts of cones at nodes, and the points that they cut off.
//!
//! A cut of a cone holds at every node, but is of use near the point that it was made for. So cuts
//! follow the nodes: the relaxation of a child begins with the rows of its parent's, and with the
//! basis that belongs to them. Cuts that have had no multiplier for a few relaxations in a row are
//! not handed on.

use std::sync::Arc;

use crate::activity::term_ends;
use crate::presolve::{Reduced, ReducedCone};
use crate::program::{ConeRole, Program};
use crate::relaxation::{ConeCut, ConeCutRow};

/// Least miss of a cone that is cut off, relative to the reach of its head (no unit, at least 1).
const LEAST_MISS: f64 = 1e-7;

/// Most relaxations in a row in which a cut may have no multiplier.
const MAX_IDLE_RELAXATIONS: u32 = 6;

/// The names of cuts below which none is looked for that is free again.
const FEW_NAMES: usize = 64;

/// The cuts that a worker has named.
#[derive(Debug)]
pub(super) struct ConePool {
    /// The first name, and the distance between two: other workers have those between them.
    first: usize,
    step: usize,
    /// In the order of names. A name is free once no node has its cut, so that names stay small:
    /// methods index their states by them.
    cuts: Vec<Arc<ConeCut>>,
    free: Vec<usize>,
    /// The number of names at which free ones are looked for.
    sweep: usize,
}

impl ConePool {
    /// The names of a worker.
    ///
    /// # Arguments
    ///
    /// * `rows`: the number of rows of the program, which have the names below.
    /// * `worker`, `workers`: the number of the worker, and how many there are.
    pub(super) fn new(rows: usize, worker: usize, workers: usize) -> Self {
        let (first, step) = (rows + worker, workers.max(1));
        ConePool { first, step, cuts: Vec::new(), free: Vec::new(), sweep: FEW_NAMES }
    }

    /// Names a cut.
    pub(super) fn row(&mut self, cut: ConeCut) -> ConeCutRow {
        let cut = Arc::new(cut);
        if self.free.is_empty() && self.cuts.len() >= self.sweep {
            let cuts = &self.cuts;
            self.free.extend((0..cuts.len()).filter(|k| Arc::strong_count(&cuts[*k]) == 1));
            self.sweep = FEW_NAMES.max(2 * (cuts.len() - self.free.len()));
        }
        let place = self.free.pop().unwrap_or(self.cuts.len());
        match self.cuts.get_mut(place) {
            Some(old) => *old = cut.clone(),
            None => self.cuts.push(cut.clone()),
        }
        ConeCutRow { name: self.first + self.step * place, cut, idle: 0 }
    }
}

/// Appends the cuts that bounds do not imply to a reduced program.
///
/// # Arguments
///
/// * `place`: by column of the program, its column in the reduced one.
pub(super) fn append_cone_rows(rows: &[ConeCutRow], reduced: &mut Reduced, place: &[usize]) {
    for row in rows {
        if !is_implied(&row.cut, reduced, place) {
            reduced.append_row(&row.cut.terms, place, row.name);
        }
    }
}

/// Takes note of the cuts that have a multiplier, and drops those that have had none for long.
///
/// # Arguments
///
/// * `first`: the first row of the reduced program that may be a cut.
/// * `y`: by row, its multiplier.
pub(super) fn note_cone_rows(
    rows: &mut Vec<ConeCutRow>,
    reduced: &Reduced,
    first: usize,
    y: &[f64],
) {
    if y.len() != reduced.origin.len() || y.len() < first {
        return;
    }
    // Appended in their order, but some were left out.
    let mut named = reduced.origin[first..].iter().zip(&y[first..]).peekable();
    rows.retain_mut(|row| {
        let y = named.next_if(|(name, _)| **name == row.name).map_or(0.0, |(_, y)| *y);
        row.idle = if y == 0.0 { row.idle + 1 } else { 0 };
        row.idle <= MAX_IDLE_RELAXATIONS
    });
}

/// Whether bounds alone imply a cut.
fn is_implied(cut: &ConeCut, reduced: &Reduced, place: &[usize]) -> bool {
    let largest = |&(column, a): &(usize, f64)| match place[column] {
        crate::presolve::FIXED => a * reduced.values[column],
        k => term_ends(a, [reduced.lower[k], reduced.upper[k]])[1],
    };
    cut.terms.iter().map(largest).sum::<f64>() <= 0.0
}

/// Cuts that a point of a reduced program violates: at most one for each cone.
pub(super) fn separate_cones(reduced: &Reduced, x: &[f64]) -> Vec<ConeCut> {
    separate(&reduced.cones, x)
}

/// Cuts that a point of a program violates: at most one for each cone.
pub(super) fn separate_program_cones(program: &Program, x: &[f64]) -> Vec<ConeCut> {
    let place: Vec<usize> = (0..program.column_count()).collect();
    let cones = program.cones.iter().map(|cone| ReducedCone::new(cone, &place, x));
    separate(&cones.collect::<Vec<_>>(), x)
}

fn separate(cones: &[ReducedCone], x: &[f64]) -> Vec<ConeCut> {
    let mut cuts = Vec::new();
    for cone in cones {
        if cone.role == ConeRole::Whole {
            continue;
        }
        if cone.miss(x) > LEAST_MISS * cone.reach(x).abs().max(1.0) {
            cuts.extend(ConeCut::at(cone, x));
        }
    }
    cuts
}
