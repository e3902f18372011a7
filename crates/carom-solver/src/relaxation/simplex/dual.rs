//! The steps of the dual simplex method.
//!
//! The row is chosen by steepest edges, the column by the ratio test of `ratio.rs`. Bases stay dual
//! feasible: where rounding or the tolerance of the ratio test would give a reduced cost the wrong
//! sign, the cost is shifted. So the dual objective never falls.

use super::parameters::{DUAL_TOLERANCE, MIN_PIVOT, PRIMAL_TOLERANCE};
use super::ratio::{EnteringColumn, NonbasicStatus, test};
use super::tableau::{Iteration, NONBASIC, Tableau};
use super::violations::{Violations, violation};

/// The least part of the weight of an edge that its estimate may be. Others are chosen again.
const MIN_WEIGHT_PART: f64 = 0.25;

/// The least dual step that counts as one, scaled.
const MIN_STEP: f64 = 1e-12;

/// A basis that is dual feasible.
#[derive(Debug)]
pub(super) struct Dual {
    pub(super) tableau: Tableau,
    violations: Violations,
    /// The largest violation of a bound, relative, and the least that this may be.
    allowed: f64,
    least_allowed: f64,
    /// The dual objective, scaled.
    pub(super) value: f64,
    /// Steps of length zero.
    pub(super) idle_steps: u32,
    candidates: Vec<EnteringColumn>,
}

impl Dual {
    /// Brings the basis to multipliers that are dual feasible, or nearly. `None` if the numbers are
    /// too bad.
    pub(super) fn new(mut tableau: Tableau, y: Option<&[f64]>) -> Option<Self> {
        if let Some(y) = y {
            tableau.sum.clear();
            tableau.sum.value.copy_from_slice(y);
            tableau.sum.list();
            tableau.reduce_costs();
        } else {
            tableau.compute_costs();
        }
        let mut dual = Dual {
            tableau,
            violations: Violations::default(),
            allowed: PRIMAL_TOLERANCE,
            least_allowed: 0.0,
            value: 0.0,
            idle_steps: 0,
            candidates: Vec::new(),
        };
        dual.make_feasible();
        for slot in 0..dual.tableau.head.len() {
            dual.push(slot).then_some(())?;
        }
        dual.restart();
        Some(dual)
    }

    /// Lets columns outside the basis rest where their reduced costs want them. Where there is no
    /// such bound, the cost is shifted.
    pub(super) fn make_feasible(&mut self) {
        let tableau = &mut self.tableau;
        for k in 0..tableau.slot.len() {
            if tableau.slot[k] == NONBASIC {
                tableau.settle(k);
                if tableau.dual_miss(k) > DUAL_TOLERANCE {
                    tableau.shift(k);
                }
            }
        }
    }

    /// Computes everything from the basis.
    pub(super) fn restart(&mut self) {
        self.tableau.compute_costs();
        self.make_feasible();
        self.tableau.compute_point();
        self.value = self.tableau.dual_value();
        self.violations.find(&self.tableau, self.allowed);
    }

    /// Sets the largest violation of a bound, relative, but not below the rounding of the point.
    pub(super) fn allow(&mut self, tolerance: f64) {
        self.allowed = PRIMAL_TOLERANCE;
        if tolerance < PRIMAL_TOLERANCE {
            let size = self.tableau.value.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            self.allowed = (0.1 * tolerance * size).clamp(tolerance, PRIMAL_TOLERANCE);
            self.allowed = self.allowed.max(self.least_allowed);
        }
        self.violations.find(&self.tableau, self.allowed);
    }

    /// Makes the reduced cost of a slot's column zero. If the reduced cost of another column
    /// becomes zero first, that column enters the basis in its place. Returns `false` if the
    /// numbers are too bad.
    fn push(&mut self, slot: usize) -> bool {
        let p = self.tableau.head[slot];
        let away = self.tableau.cost[p];
        if away.abs() <= DUAL_TOLERANCE {
            self.tableau.shift(p);
            return true;
        }
        self.tableau.solve_row(slot);
        self.tableau.price();
        let sign = away.signum();
        let bound = self.tableau.bounds[slot][usize::from(away < 0.0)];
        self.list_candidates(sign);
        let candidates = &self.candidates;
        let nearest = candidates.iter().map(|c| c.cost / c.entry).fold(f64::INFINITY, f64::min);
        let mut step = away;
        let mut entering = None;
        if nearest < away.abs() && bound.is_finite() {
            let near = candidates.iter().filter(|c| c.cost / c.entry <= nearest + DUAL_TOLERANCE);
            entering = near.max_by(|a, b| a.entry.total_cmp(&b.entry)).map(|c| c.of);
        } else if nearest < away.abs() {
            // Without this bound the column must stay in the basis: the rest of its reduced cost is
            // taken from its cost.
            step = sign * nearest;
        }
        let tableau = &mut self.tableau;
        let Some(q) = entering else {
            for &k in &tableau.pivots.index {
                tableau.cost[k as usize] -= step * tableau.pivots.value[k as usize];
            }
            tableau.cost[p] -= step;
            tableau.shift(p);
            return true;
        };
        tableau.solve_column(q);
        if tableau.entering.value[slot].abs() < MIN_PIVOT {
            return false;
        }
        let to = if away > 0.0 { NonbasicStatus::Lower } else { NonbasicStatus::Upper };
        let fine = tableau.exchange(slot, q, to, true);
        tableau.cost[p] += away;
        if !fine || tableau.factors.is_worn() {
            tableau.factorise();
        }
        true
    }

    /// Whether no column violates a bound.
    pub(super) fn is_optimal(&mut self) -> bool {
        self.violations.largest(&self.tableau.weight).is_none()
    }

    /// The columns whose reduced costs fall along the pivot row with a sign.
    fn list_candidates(&mut self, sign: f64) {
        let Tableau { program, pivots, cost, rest, .. } = &self.tableau;
        self.candidates.clear();
        self.candidates.extend(pivots.entries().filter_map(|(k, pivot)| {
            let bounds = [program.lower[k], program.upper[k]];
            EnteringColumn::new(k, sign * pivot, cost[k], bounds, rest[k])
        }));
    }

    /// One exchange of the basis.
    pub(super) fn step(&mut self) -> Iteration {
        if self.tableau.factors.is_worn() {
            self.refresh();
        }
        let Some(slot) = self.leaving() else { return Iteration::Optimal };
        let by = violation(&self.tableau, slot, self.allowed);
        let sign = by.signum();
        self.tableau.price();
        self.list_candidates(sign);
        let (jumps, entering) = test(&mut self.candidates, by.abs());
        let Some(entering) = entering else {
            if self.tableau.factors.exchanges() > 0 {
                self.refresh();
                return Iteration::Moved;
            }
            if violation(&self.tableau, slot, PRIMAL_TOLERANCE) == 0.0 {
                // Rounding of the limits may be as large, so that this refutes nothing.
                self.least_allowed = PRIMAL_TOLERANCE;
                self.allowed = PRIMAL_TOLERANCE;
                self.violations.find(&self.tableau, self.allowed);
                return Iteration::Moved;
            }
            return Iteration::Infeasible(
                self.tableau.row.value.iter().map(|v| sign * v).collect(),
            );
        };
        let q = entering.of;
        self.tableau.solve_column(q);
        if !self.tableau.is_sound(slot, q) {
            // Fresh factors, or none that help.
            if self.tableau.factors.exchanges() == 0 {
                return Iteration::Stuck;
            }
            self.refresh();
            return Iteration::Moved;
        }
        let step = entering.cost / entering.entry;
        self.value += step * by.abs();
        self.idle_steps += u32::from(step <= MIN_STEP);
        if jumps > 0 {
            let jumping = &self.candidates[..jumps];
            self.value -= jumping.iter().map(|c| (step * c.entry - c.cost) * c.width).sum::<f64>();
            self.tableau.jump(jumping.iter().map(|c| c.of));
            for &s in &self.tableau.sum.index {
                self.violations.note(&self.tableau, s as usize, self.allowed);
            }
        }
        let to = if sign > 0.0 { NonbasicStatus::Upper } else { NonbasicStatus::Lower };
        let fine = self.tableau.exchange(slot, q, to, true);
        for &s in &self.tableau.entering.index {
            self.violations.note(&self.tableau, s as usize, self.allowed);
        }
        if !fine {
            self.refresh();
        }
        Iteration::Moved
    }

    /// The slot that leaves, with its row of the inverse.
    fn leaving(&mut self) -> Option<usize> {
        loop {
            let slot = self.violations.largest(&self.tableau.weight)?;
            self.tableau.solve_row(slot);
            let true_weight = self.tableau.row.square();
            let known = std::mem::replace(&mut self.tableau.weight[slot], true_weight);
            if known >= MIN_WEIGHT_PART * true_weight {
                return Some(slot);
            }
        }
    }

    /// Factorises the basis again, and computes everything from it.
    fn refresh(&mut self) {
        self.tableau.factorise();
        self.restart();
    }
}
