//! The cuts that a worker has found at nodes.
//!
//! They hold at all nodes. Those that have had no multiplier for long leave.

use super::cuts::Cut;
use crate::presolve::{Domain, FIXED, Reduced};
use crate::program::Program;
use crate::solver::Options;

/// The relaxed nodes of a worker before it looks for cuts: small trees need none.
const FIRST_NODE: u64 = 30;

/// The least part of the gap to the cutoff that all rounds at a node close if they pay.
const PAYING_SHARE: f64 = 0.1;

/// Most nodes that are passed over between two that are cut.
const MOST_PASSED: u64 = 256;

/// The relaxations in a row in which a cut may be without a multiplier, and how many if the pool is
/// full; and the cuts that fill it.
const MOST_UNUSED: u32 = 100;
const MOST_UNUSED_IN_FULL_POOL: u32 = 20;
const FULL_NODE_CUT_POOL: usize = 300;

/// A miss of a cut by an accepted point beyond this proves the cut wrong, in units of its largest
/// coefficient and relative to its terms (no unit).
const WRONG_CUT: f64 = 1e-4;

/// The cuts of a worker.
#[derive(Debug)]
pub(super) struct NodeCutPool {
    /// Whether nodes are cut.
    pub(super) is_on: bool,
    /// By name: the cut, and the relaxations since it had a multiplier.
    cuts: Vec<Option<(Cut, u32)>>,
    /// Names that are free.
    free: Vec<usize>,
    /// Nodes to pass over before the next one that is cut, and how many they were last time.
    left: u64,
    pause: u64,
}

impl NodeCutPool {
    /// No cuts yet; none at all for programs and options that they do not suit. A proof has the
    /// cuts of the root alone.
    pub(super) fn new(program: &Program, options: &Options) -> Self {
        let is_linear = program.quadratic.compute_nnz() == 0 && program.cones.is_empty();
        let is_on = is_linear
            && options.cuts
            && options.proof_path().is_none()
            && !options.parts().keep_leaves
            && !program.is_feasibility_problem();
        NodeCutPool { is_on, cuts: Vec::new(), free: Vec::new(), left: FIRST_NODE, pause: 0 }
    }

    /// Whether a point is beyond a cut by more than it may miss rows.
    pub(super) fn exclude(&self, point: &[f64]) -> bool {
        self.cuts.iter().flatten().any(|(cut, _)| is_wrong(cut, point))
    }

    /// Whether the node in hand is to be cut.
    pub(super) fn is_due(&mut self) -> bool {
        self.left = self.left.saturating_sub(1);
        self.left == 0
    }

    /// Books the part of the gap that the cuts of a node have closed.
    pub(super) fn book(&mut self, share: f64) {
        self.pause = match share >= PAYING_SHARE {
            true => self.pause / 2,
            false => (2 * self.pause + 1).min(MOST_PASSED),
        };
        self.left = self.pause + 1;
    }

    /// Appends the cuts to a reduced program.
    pub(super) fn append_to(&mut self, reduced: &mut Reduced, domain: &Domain, rows: usize) {
        if self.cuts.len() == self.free.len() {
            return;
        }
        let place = reduced.places();
        for (name, cut) in self.cuts.iter().enumerate() {
            if let Some((cut, _)) = cut {
                append(cut, reduced, &place, domain, rows + name);
            }
        }
    }

    /// Adds a cut to the pool and to a reduced program.
    ///
    /// # Arguments
    ///
    /// * `place`: by column of the program, its column in the reduced one.
    /// * `rows`: the number of rows of the program; names of cuts begin there.
    pub(super) fn add(
        &mut self,
        cut: Cut,
        reduced: &mut Reduced,
        place: &[usize],
        domain: &Domain,
        rows: usize,
    ) {
        let name = self.free.pop().unwrap_or(self.cuts.len());
        if name == self.cuts.len() {
            self.cuts.push(None);
        }
        append(&cut, reduced, place, domain, rows + name);
        self.cuts[name] = Some((cut, 0));
    }

    /// Takes note of the cuts with a multiplier, and drops those that have had none for long.
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
        let held = self.cuts.len() - self.free.len();
        let most = if held > FULL_NODE_CUT_POOL { MOST_UNUSED_IN_FULL_POOL } else { MOST_UNUSED };
        for (name, slot) in self.cuts.iter_mut().enumerate() {
            if slot.take_if(|(_, idle)| *idle > most).is_some() {
                self.free.push(name);
            }
        }
    }
}

/// Appends a cut to a reduced program as a row, without columns that are not there: their terms are
/// at least what the bounds of the node say.
fn append(cut: &Cut, reduced: &mut Reduced, place: &[usize], domain: &Domain, name: usize) {
    let (mut limit, mut size) = (cut.limit, cut.limit.abs());
    let (mut room, mut kept) = (0.0, 0);
    for &(column, a) in &cut.terms {
        match place[column] {
            FIXED => {
                let [lower, upper] = domain.bounds(column);
                let least = a * if a > 0.0 { lower } else { upper };
                limit -= least;
                size += least.abs();
            }
            k => {
                room += a * if a > 0.0 { reduced.upper[k] } else { reduced.lower[k] };
                kept += 1;
            }
        }
    }
    limit += cut.terms.len() as f64 * f64::EPSILON * size;
    // Bounds imply it, or it lacks one.
    if room <= limit
        || kept == 0
        || !limit.is_finite()
        || reduced.origin.len() != reduced.rows.len()
    {
        return;
    }
    let terms = cut.terms.iter().filter(|(column, _)| place[*column] != FIXED);
    reduced.rows.push(terms.map(|&(column, a)| (place[column], a)));
    reduced.row_lower.push(f64::NEG_INFINITY);
    reduced.row_upper.push(limit);
    reduced.origin.push(name);
}

/// Whether a point is beyond a cut by more than it may miss rows.
pub(super) fn is_wrong(cut: &Cut, point: &[f64]) -> bool {
    cut.room(point) < -WRONG_CUT * cut.scale(point)
}
