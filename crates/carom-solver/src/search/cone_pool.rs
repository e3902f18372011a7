//! Cuts of cones that a worker has found, and the rounds that find them at a node.
//!
//! A cut of a cone holds at every node. Those that have not been active for long leave.

use crate::activity::term_ends;
use crate::presolve::{Reduced, ReducedCone};
use crate::program::{ConeRole, Program};
use crate::relaxation::ConeCut;

/// Least miss of a cone that is cut off, relative to the reach of its head (no unit, at least 1).
const LEAST_MISS: f64 = 1e-7;

/// Most cuts of a pool, and most relaxations in a row in which one of them may be slack.
const MAX_CUTS: usize = 4000;
const MAX_IDLE_RELAXATIONS: u32 = 6;

/// The cuts of a worker.
#[derive(Debug, Default)]
pub(super) struct ConePool {
    /// By name: the cut, and the relaxations since it was active.
    cuts: Vec<Option<(ConeCut, u32)>>,
    /// Names that are free.
    free: Vec<usize>,
}

impl ConePool {
    /// Appends the cuts that bounds do not imply to a reduced program.
    ///
    /// # Arguments
    ///
    /// * `place`: by column of the program, its column in the reduced one.
    /// * `rows`: the number of rows of the program; names of cuts begin there.
    pub(super) fn append_to(&mut self, reduced: &mut Reduced, place: &[usize], rows: usize) {
        self.drop_idle();
        for (name, cut) in self.cuts.iter().enumerate() {
            let Some((cut, _)) = cut else { continue };
            if !is_implied(cut, reduced, place) {
                reduced.append_row(&cut.terms, place, rows + name);
            }
        }
    }

    /// Adds a cut to the pool and to a reduced program.
    pub(super) fn add(
        &mut self,
        cut: ConeCut,
        reduced: &mut Reduced,
        place: &[usize],
        rows: usize,
    ) {
        let name = self.free.pop().unwrap_or(self.cuts.len());
        if name == self.cuts.len() {
            self.cuts.push(None);
        }
        reduced.append_row(&cut.terms, place, rows + name);
        self.cuts[name] = Some((cut, 0));
    }

    /// Adds a cut to the pool.
    pub(super) fn keep(&mut self, cut: ConeCut) {
        match self.free.pop() {
            Some(name) => self.cuts[name] = Some((cut, 0)),
            None => self.cuts.push(Some((cut, 0))),
        }
    }

    /// Takes note of the cuts that are active: those with a multiplier.
    pub(super) fn note(&mut self, reduced: &Reduced, y: &[f64], rows: usize) {
        if y.len() != reduced.rows.len() {
            return;
        }
        for (name, y) in reduced.origin.iter().zip(y) {
            let slot = name.checked_sub(rows).and_then(|name| self.cuts.get_mut(name));
            if let Some(Some((_, idle))) = slot {
                *idle = if *y == 0.0 { *idle + 1 } else { 0 };
            }
        }
    }

    fn drop_idle(&mut self) {
        let held = self.cuts.len() - self.free.len();
        let most = if held > MAX_CUTS { MAX_IDLE_RELAXATIONS / 4 } else { MAX_IDLE_RELAXATIONS };
        for (name, slot) in self.cuts.iter_mut().enumerate() {
            if slot.as_ref().is_some_and(|(_, idle)| *idle > most) {
                *slot = None;
                self.free.push(name);
            }
        }
    }
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
