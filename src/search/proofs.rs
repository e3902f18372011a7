//! Proofs carried over from an earlier solve of nearly the same program.
//!
//! A node is closed by multipliers: they prove a bound beyond the cutoff, or that nothing is feasible.
//! Multipliers prove *some* bound on every program with the same rows, whatever its limits, bounds and
//! costs are. So in the next solve, before a node is relaxed, the multipliers that closed the same
//! decision are tried on the node as it is now, with all that propagation and tightening have done to
//! it. The bound is proved as ever; where it falls short, the node is relaxed.
//!
//! Where the next solve begins a step later, what was known of a step is tried at the step before.

use std::collections::BTreeMap;

use super::node::Decision;
use crate::presolve::Reduced;
use crate::relaxation::{Verdict, lower_bound, proves_infeasible};

/// Most proofs that are kept of a solve, most numbers in all of them (32 MB), and most proofs that are
/// tried at a node.
const MOST: usize = 2000;
const NUMBERS: usize = 4_000_000;
const TRIED: usize = 3;

/// Multipliers that closed a node.
#[derive(Debug, Clone)]
pub(crate) struct Proof {
    /// The last decision.
    column: usize,
    is_upper: bool,
    /// Whether they prove that nothing is feasible, rather than a bound.
    refutes: bool,
    /// The point that belongs to them, a value a column.
    x: Vec<f64>,
    /// A multiplier a row of the program.
    y: Vec<f64>,
}

impl Proof {
    /// From the relaxation of a node: its point (none for a refutation) and multipliers.
    ///
    /// # Arguments
    ///
    /// * `rows`: the number of rows of the program.
    pub(super) fn new(
        decision: &Decision,
        reduced: &Reduced,
        rows: usize,
        x: &[f64],
        y: &[f64],
    ) -> Self {
        let mut all = vec![0.0; rows];
        for (&row, &y) in reduced.origin.iter().zip(y) {
            if let Some(place) = all.get_mut(row) {
                *place = y;
            }
        }
        let refutes = x.is_empty();
        let x = if refutes { Vec::new() } else { reduced.lift(x) };
        let &Decision { column, is_upper, .. } = decision;
        Proof { column, is_upper, refutes, x, y: all }
    }

    /// The proof as it closes a node, if it does.
    fn close(
        &self,
        reduced: &Reduced,
        cutoff: f64,
        shift: Option<&Shift>,
    ) -> Option<(Verdict, Vec<f64>, Vec<f64>)> {
        let place = |map: fn(&Shift) -> &Vec<usize>, k: usize| match shift {
            Some(shift) => map(shift).get(k).copied().unwrap_or(k),
            None => k,
        };
        let pick = |from: &[f64], k: usize| from.get(k).copied().unwrap_or(0.0);
        let row = |&row: &usize| pick(&self.y, place(|shift| &shift.rows, row));
        let y: Vec<f64> = reduced.origin.iter().map(row).collect();
        if y.len() != reduced.rows.len() {
            return None;
        }
        if self.refutes {
            return proves_infeasible(reduced, &y)
                .then(|| (Verdict::Refuted(Vec::new()), Vec::new(), y));
        }
        let column = |&j: &usize| pick(&self.x, place(|shift| &shift.columns, j));
        let x: Vec<f64> = reduced.columns.iter().map(column).collect();
        let bound = lower_bound(reduced, &x, &y);
        (bound >= cutoff).then(|| {
            let verdict = Verdict::Relaxed {
                bound,
                x: x.clone(),
                y: Vec::new(),
                converged: false,
                warm: None,
            };
            (verdict, x, y)
        })
    }
}

/// Where columns and rows of one step are in the next: by column and by row, the same a step later, or
/// itself.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shift {
    pub(crate) columns: Vec<usize>,
    pub(crate) rows: Vec<usize>,
}

impl Shift {
    /// One step after the other.
    pub(crate) fn then(&self, other: &Shift) -> Shift {
        let after = |one: &[usize], other: &[usize]| {
            one.iter().map(|&k| other.get(k).copied().unwrap_or(k)).collect()
        };
        Shift {
            columns: after(&self.columns, &other.columns),
            rows: after(&self.rows, &other.rows),
        }
    }
}

/// The proofs of an earlier solve.
#[derive(Debug, Clone, Default)]
pub(crate) struct Proofs {
    proofs: Vec<Proof>,
    /// By column and side, the newest last.
    places: BTreeMap<(usize, bool), Vec<usize>>,
    /// By how much this solve begins later.
    shift: Option<Shift>,
}

impl Proofs {
    /// From what was kept of a solve.
    pub(crate) fn new(proofs: Vec<Proof>, shift: Option<Shift>) -> Self {
        let mut places: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (k, proof) in proofs.iter().enumerate() {
            places.entry((proof.column, proof.is_upper)).or_default().push(k);
        }
        Proofs { proofs, places, shift }
    }

    /// How many are kept of a search over so many columns and rows.
    pub(super) fn most(columns: usize, rows: usize) -> usize {
        MOST.min(NUMBERS / (columns + rows).max(1))
    }

    /// Whether a decision was ever closed.
    pub(super) fn knows(&self, &Decision { column, is_upper, .. }: &Decision) -> bool {
        let next = self.shift.as_ref().and_then(|shift| shift.columns.get(column).copied());
        [Some(column), next].into_iter().flatten().any(|j| self.places.contains_key(&(j, is_upper)))
    }

    /// Closes a node after a decision if an earlier proof still does. With the proof, as it is now.
    pub(super) fn close(
        &self,
        reduced: &Reduced,
        decision: &Decision,
        cutoff: f64,
    ) -> Option<(Verdict, Proof)> {
        let &Decision { column, is_upper, .. } = decision;
        let at = |column: usize| {
            let places = self.places.get(&(column, is_upper)).into_iter().flatten();
            places.rev().take(TRIED).map(|&k| &self.proofs[k])
        };
        let later = self.shift.as_ref().and_then(|shift| {
            let next = *shift.columns.get(column)?;
            (next != column).then_some((shift, next))
        });
        let shifted = later.into_iter().flat_map(|(shift, next)| at(next).map(move |p| (p, shift)));
        let all = shifted.map(|(proof, shift)| (proof, Some(shift)));
        let mut all = all.chain(at(column).map(|proof| (proof, None)));
        all.find_map(|(proof, shift)| {
            let (verdict, x, y) = proof.close(reduced, cutoff, shift)?;
            let rows = proof.y.len();
            Some((verdict, Proof::new(decision, reduced, rows, &x, &y)))
        })
    }
}
