//! The relaxation of a box: rows, and enclosures of the terms over it.

use std::cell::RefCell;

use super::enclosure::{EnclosureRow, rows, separate};
use super::program::SpatialProgram;
use crate::presolve::{Domain, Reduced};
use crate::relaxation::{
    ConeCut, MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict, WarmState,
};
use crate::solver::{Options, StopToken};
use crate::tolerance::largest_magnitude;

/// Names of rows for each term, by which a basis knows them.
pub(crate) const ROW_NAMES: usize = 64;

/// Most rounds of rows at the root, and at other nodes.
const ROOT_ROUNDS: usize = 20;
const NODE_ROUNDS: usize = 5;

/// The lift of the bound by a round, as a part of the gap to the cutoff or of its size, below which
/// no other one follows.
const LEAST_ROUND_LIFT: f64 = 0.01;

/// The part of the largest value by which a point may be outside of a cone (no unit).
pub(crate) const CONE_MISS: f64 = 1e-9;

/// The verdict on a box from its relaxation.
pub(super) enum BoxVerdict {
    /// No point of the box is better than the cutoff.
    Refuted,
    Stopped,
    /// The objective falls without limit along columns that no term has.
    Falls,
    Relaxed(Box<RelaxedBox>),
}

/// A relaxed box.
pub(super) struct RelaxedBox {
    /// A proved bound.
    pub(super) bound: f64,
    /// The relaxed point, by column of the program; `None` if it is not near the bound.
    pub(super) x: Option<Vec<f64>>,
    /// The program that was solved last, and point and multipliers that prove the bound.
    pub(super) reduced: Reduced,
    pub(super) reduced_x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) warm: Option<WarmState>,
}

/// The round that has proved the best bound so far.
struct BestRound {
    bound: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    warm: Option<WarmState>,
}

/// By how much rows of terms are loosened, relative to their limits (no unit).
const LOOSE_ENCLOSURES: f64 = 1e-9;

/// Most cuts of cones that all relaxations begin with; later ones take the places of earlier ones.
const MAX_CONE_CUTS: usize = 300;

/// Relaxes the boxes of a program.
pub(super) struct BoxRelaxer<'a> {
    pub(super) program: &'a SpatialProgram,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    /// The cuts of cones so far, which hold in all boxes, and how many there have been.
    cone_cuts: RefCell<(Vec<ConeCut>, usize)>,
}

impl<'a> BoxRelaxer<'a> {
    pub(super) fn new(
        program: &'a SpatialProgram,
        options: &'a Options,
        token: &'a StopToken,
    ) -> Self {
        BoxRelaxer { program, options, token, cone_cuts: RefCell::default() }
    }

    /// The program of a box without the rows of terms.
    pub(super) fn plain(&self, domain: &Domain) -> Reduced {
        let mut reduced = self.program.base.clone();
        for j in 0..domain.column_count() {
            [reduced.lower[j], reduced.upper[j]] = domain.bounds(j);
        }
        reduced.wants_vertex = true;
        for (k, cut) in self.cone_cuts.borrow().0.iter().enumerate() {
            self.push_cone_cut(&mut reduced, k, cut);
        }
        reduced
    }

    fn push_cone_cut(&self, reduced: &mut Reduced, k: usize, cut: &ConeCut) {
        reduced.rows.push(cut.terms.iter().copied());
        reduced.row_lower.push(f64::NEG_INFINITY);
        reduced.row_upper.push(0.0);
        let first = self.program.program.row_count() + self.program.terms.len() * ROW_NAMES;
        reduced.origin.push(first + k);
    }

    /// Cuts off the cones that a point is outside of. Whether there is one.
    pub(super) fn cut_cones(&self, reduced: &mut Reduced, x: &[f64]) -> bool {
        let mut is_new = false;
        for cone in &self.program.cones {
            let Some(cut) = ConeCut::at(cone, x) else { continue };
            if cut.violation(x) <= CONE_MISS * largest_magnitude(x).max(1.0) {
                continue;
            }
            is_new = true;
            let (cuts, count) = &mut *self.cone_cuts.borrow_mut();
            let place = *count % MAX_CONE_CUTS;
            *count += 1;
            // In this program, an older one that it replaces stays, and its name is taken.
            let is_free = place == cuts.len();
            self.push_cone_cut(reduced, if is_free { place } else { MAX_CONE_CUTS + place }, &cut);
            if is_free { cuts.push(cut) } else { cuts[place] = cut }
        }
        is_new
    }

    /// The program of a box with rows that are tight at a point.
    pub(super) fn enclosed(&self, domain: &Domain, at: Option<&[f64]>) -> (Reduced, Vec<usize>) {
        let mut reduced = self.plain(domain);
        let mut counts = vec![0; self.program.terms.len()];
        for (k, term) in self.program.terms.iter().enumerate() {
            for row in rows(term, domain, at) {
                self.push(&mut reduced, k, &mut counts[k], &row);
            }
        }
        (reduced, counts)
    }

    fn push(&self, reduced: &mut Reduced, term: usize, count: &mut usize, row: &EnclosureRow) {
        reduced.rows.push(row.entries.iter().copied());
        // Rows below and above a narrow range would contradict each other by rounding.
        let slack = |limit: f64| LOOSE_ENCLOSURES * limit.abs().max(1.0);
        let is_finite = |limit: f64| limit.is_finite();
        let (lower, upper) = (row.lower, row.upper);
        reduced.row_lower.push(if is_finite(lower) { lower - slack(lower) } else { lower });
        reduced.row_upper.push(if is_finite(upper) { upper + slack(upper) } else { upper });
        let first = self.program.program.row_count() + term * ROW_NAMES;
        reduced.origin.push(first + (*count).min(ROW_NAMES - 1));
        *count += 1;
    }

    /// Relaxes a box, in rounds.
    ///
    /// # Arguments
    ///
    /// * `at`: the point of the parent.
    pub(super) fn relax(
        &self,
        cascade: &mut MethodCascade,
        domain: &Domain,
        (at, warm): (Option<&[f64]>, Option<&WarmState>),
        cutoff: f64,
        is_root: bool,
    ) -> BoxVerdict {
        let (mut reduced, mut counts) = self.enclosed(domain, at);
        let rounds = if is_root { ROOT_ROUNDS } else { NODE_ROUNDS };
        let mut warm = warm.cloned();
        let may_fall = is_root && self.program.has_bounded_terms(domain);
        let mut best: Option<BestRound> = None;
        let mut last_point = None;
        for round in 0..=rounds {
            let question = RelaxationQuestion {
                // Without a basis, the simplex method solves roots only.
                purpose: if warm.is_some() { Purpose::Node } else { Purpose::Root },
                cutoff,
                options: self.options,
                constant: self.program.program.constant,
                look_for_descent: may_fall,
                token: self.token,
                warm: warm.as_ref(),
            };
            let verdict = cascade.solve(&mut reduced, &question);
            let (bound, x, y, converged, state) = match verdict {
                RelaxationVerdict::Refuted(_) => return BoxVerdict::Refuted,
                RelaxationVerdict::Stopped => break,
                RelaxationVerdict::Descent => return BoxVerdict::Falls,
                RelaxationVerdict::Relaxed { bound, x, y, converged, warm } => {
                    (bound, x, y, converged, warm)
                }
            };
            if bound >= cutoff {
                return BoxVerdict::Refuted;
            }
            let last = best.as_ref().map_or(f64::NEG_INFINITY, |best| best.bound);
            let lift = bound - last;
            let point = converged.then(|| reduced.lift(&x));
            let is_enough = round == rounds || !converged || {
                let room = if cutoff.is_finite() { cutoff - last } else { last.abs().max(1.0) };
                round > 1 && lift < LEAST_ROUND_LIFT * room
            };
            warm = state.clone().or(warm);
            if bound >= last {
                best = Some(BestRound { bound, x, y, warm: state });
            }
            last_point = point.clone().or(last_point);
            let Some(point) = point.filter(|_| !is_enough) else { break };
            let mut is_new = self.cut_cones(&mut reduced, &point);
            for (k, term) in self.program.terms.iter().enumerate() {
                let size = point[term.result].abs().max(1.0);
                if term.violation(&point) <= 1e-7 * size {
                    continue;
                }
                if let Some(row) = separate(term, domain, &point) {
                    self.push(&mut reduced, k, &mut counts[k], &row);
                    is_new = true;
                }
            }
            if !is_new {
                break;
            }
        }
        let Some(BestRound { bound, x: reduced_x, mut y, warm }) = best else {
            return BoxVerdict::Stopped;
        };
        if !y.is_empty() {
            // Rows that came later need no multipliers.
            y.resize(reduced.rows.len(), 0.0);
        }
        let x = last_point;
        BoxVerdict::Relaxed(Box::new(RelaxedBox { bound, x, reduced, reduced_x, y, warm }))
    }
}
