//! The steps of the dual simplex method.

use super::factors::Factors;
use super::parameters::{MAX_EXCHANGES, MAX_PIVOT_DIFFERENCE, MIN_PIVOT, PRIMAL_TOLERANCE};
use super::program::LinearProgram;
use super::ratio::{EnteringColumn, NonbasicStatus, test};
use crate::presolve::Compressed;

/// No slot.
pub(super) const NONBASIC: usize = usize::MAX;

/// The outcome of an iteration.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Iteration {
    Moved,
    /// The basis is optimal.
    Optimal,
    /// These multipliers prove that there is no feasible point.
    Infeasible(Vec<f64>),
    /// The numbers are too bad.
    Stuck,
}

/// A basis that is dual feasible, and its point.
#[derive(Debug)]
pub(super) struct Dual {
    pub(super) program: LinearProgram,
    /// By slot, the column in the basis, and by column, its slot.
    pub(super) head: Vec<usize>,
    pub(super) slot: Vec<usize>,
    pub(super) rest: Vec<NonbasicStatus>,
    pub(super) x: Vec<f64>,
    /// Reduced costs.
    cost: Vec<f64>,
    /// By slot, the squared norm of its row of the inverse, roughly.
    pub(super) weight: Vec<f64>,
    factors: Factors,
    /// Costs as they are used; some may have been shifted for the start.
    used: Vec<f64>,
    pub(super) is_shifted: bool,
    /// The largest violation of a bound.
    pub(super) allowed: f64,
    // Work space.
    by_row: Vec<f64>,
    row: Vec<f64>,
    entering: Vec<f64>,
    tau: Vec<f64>,
    pivots: Vec<f64>,
    touched: Vec<usize>,
    is_touched: Vec<bool>,
}

impl Dual {
    /// Starts from the columns that are wanted in the basis, with their weights; others take the
    /// place of those that depend on each other.
    ///
    /// # Arguments
    ///
    /// * `y`: multipliers that are dual feasible, or nearly: the basis is brought to them.
    pub(super) fn new(
        program: LinearProgram,
        wanted: Vec<(usize, f64)>,
        rest: Vec<NonbasicStatus>,
        y: &[f64],
    ) -> Option<Self> {
        let (n, m) = program.size();
        let (head, weight) = wanted.into_iter().unzip();
        let mut dual = Dual {
            used: program.cost.clone(),
            head,
            slot: vec![NONBASIC; n + m],
            rest,
            x: vec![0.0; n + m],
            cost: vec![0.0; n + m],
            weight,
            factors: Factors::default(),
            is_shifted: false,
            allowed: PRIMAL_TOLERANCE,
            by_row: vec![0.0; m],
            row: vec![0.0; m],
            entering: vec![0.0; m],
            tau: vec![0.0; m],
            pivots: vec![0.0; n + m],
            touched: Vec::new(),
            is_touched: vec![false; n + m],
            program,
        };
        dual.factorise().then_some(())?;
        dual.row.copy_from_slice(y);
        dual.reduce_costs();
        for slot in 0..m {
            dual.push(slot).then_some(())?;
        }
        dual.compute();
        Some(dual)
    }

    /// Makes the reduced cost of a slot's column zero. If the reduced cost of another column
    /// becomes zero first, that column enters the basis in its place. Returns `false` if the
    /// numbers are too bad.
    fn push(&mut self, slot: usize) -> bool {
        let p = self.head[slot];
        let away = self.cost[p];
        if away.abs() <= PRIMAL_TOLERANCE {
            self.used[p] -= away;
            self.cost[p] = 0.0;
            return true;
        }
        self.price(slot);
        let sign = away.signum();
        let bound = if away > 0.0 { self.program.lower[p] } else { self.program.upper[p] };
        let candidates = self.candidates(sign);
        let nearest = candidates.iter().map(|c| c.cost / c.entry).fold(f64::INFINITY, f64::min);
        let mut step = away;
        let mut entering = None;
        if nearest < away.abs() && bound.is_finite() {
            let near = candidates.iter().filter(|c| c.cost / c.entry <= nearest + PRIMAL_TOLERANCE);
            entering = near.max_by(|a, b| a.entry.total_cmp(&b.entry)).map(|c| c.of);
        } else if nearest < away.abs() {
            // Without this bound the column must stay in the basis: the rest of its reduced cost is
            // taken from its cost.
            step = sign * nearest;
        }
        if let Some(q) = entering {
            step = self.cost[q] / self.pivots[q];
        }
        for &k in self.touched.iter().filter(|&&k| self.slot[k] == NONBASIC) {
            self.cost[k] -= step * self.pivots[k];
        }
        self.cost[p] -= step;
        let Some(q) = entering else {
            self.is_shifted |= self.cost[p] != 0.0;
            self.used[p] -= self.cost[p];
            self.cost[p] = 0.0;
            return true;
        };
        self.cost[q] = 0.0;
        self.rest[p] = if away > 0.0 { NonbasicStatus::Lower } else { NonbasicStatus::Upper };
        self.enter(q);
        if self.entering[slot].abs() < MIN_PIVOT {
            return false;
        }
        self.weight[slot] = 1.0;
        self.swap(slot, q);
        true
    }

    /// Computes the column of the basis in which `q` is written.
    fn enter(&mut self, q: usize) {
        self.by_row.fill(0.0);
        let by_row = &mut self.by_row;
        self.program.each(q, |i, a| by_row[i] += a);
        self.factors.solve(&mut self.by_row, &mut self.entering);
    }

    /// Puts the column that has been written in the basis into a slot.
    fn swap(&mut self, slot: usize, q: usize) {
        let p = self.head[slot];
        self.factors.exchange(slot, &self.entering);
        (self.head[slot], self.slot[q], self.slot[p]) = (q, slot, NONBASIC);
    }

    /// The columns whose reduced costs fall along the pivot row with a sign.
    fn candidates(&self, sign: f64) -> Vec<EnteringColumn> {
        let mut candidates = Vec::with_capacity(self.touched.len());
        for &k in self.touched.iter().filter(|&&k| self.slot[k] == NONBASIC) {
            let bounds = [self.program.lower[k], self.program.upper[k]];
            let (entry, cost) = (sign * self.pivots[k], self.cost[k]);
            candidates.extend(EnteringColumn::new(k, entry, cost, bounds, self.rest[k]));
        }
        candidates
    }

    /// The reduced costs of the multipliers in `row`. Columns outside the basis go to the bound of
    /// their reduced cost; where there is none, the cost is shifted.
    fn reduce_costs(&mut self) {
        for k in 0..self.slot.len() {
            self.cost[k] = self.used[k] - self.program.product(k, &self.row);
            if self.slot[k] == NONBASIC {
                self.settle(k);
            }
        }
    }

    /// Lets a column outside the basis rest where its reduced cost wants it.
    fn settle(&mut self, k: usize) {
        let cost = self.cost[k];
        let (lower, upper) = (self.program.lower[k], self.program.upper[k]);
        let rest = match (lower.is_finite(), upper.is_finite()) {
            (true, true) if cost > PRIMAL_TOLERANCE => NonbasicStatus::Lower,
            (true, true) if cost < -PRIMAL_TOLERANCE => NonbasicStatus::Upper,
            (true, true) if self.rest[k] == NonbasicStatus::Upper => NonbasicStatus::Upper,
            (true, _) => NonbasicStatus::Lower,
            (false, true) => NonbasicStatus::Upper,
            (false, false) => NonbasicStatus::Free,
        };
        let wrong = match rest {
            NonbasicStatus::Lower => lower < upper && cost < -PRIMAL_TOLERANCE,
            NonbasicStatus::Upper => cost > PRIMAL_TOLERANCE,
            NonbasicStatus::Free => cost.abs() > PRIMAL_TOLERANCE,
        };
        if wrong {
            self.is_shifted = true;
            self.used[k] -= cost;
            self.cost[k] = 0.0;
        }
        self.rest[k] = rest;
    }

    /// Factorises the basis, mended where it is none; `false` if that fails.
    fn factorise(&mut self) -> bool {
        let (n, m) = self.program.size();
        for _ in 0..3 {
            let mut columns = Compressed::with_capacity(0, 0);
            for &k in &self.head {
                match k.checked_sub(n) {
                    None => columns.push(self.program.columns.entries(k)),
                    Some(i) => columns.push(std::iter::once((i, -1.0))),
                }
            }
            match Factors::new(columns, m) {
                Ok(factors) => {
                    self.factors = factors;
                    self.slot.fill(NONBASIC);
                    self.head.iter().enumerate().for_each(|(s, &k)| self.slot[k] = s);
                    return true;
                }
                Err(deficit) => {
                    let mut keep = vec![true; self.head.len()];
                    deficit.slots.iter().for_each(|&s| keep[s] = false);
                    let mut kept = keep.iter();
                    self.head.retain(|_| *kept.next().unwrap_or(&true));
                    let mut kept = keep.iter();
                    self.weight.retain(|_| *kept.next().unwrap_or(&true));
                    let rows = deficit.rows.iter().map(|i| n + i);
                    let rows: Vec<usize> = rows.filter(|k| !self.head.contains(k)).collect();
                    self.weight.resize(self.head.len() + rows.len(), 1.0);
                    self.head.extend(rows);
                }
            }
        }
        false
    }

    /// Computes reduced costs and the point from the basis.
    pub(super) fn compute(&mut self) {
        for (s, &k) in self.head.iter().enumerate() {
            self.entering[s] = self.used[k];
        }
        self.factors.solve_transposed(&mut self.entering, &mut self.row);
        self.reduce_costs();
        self.by_row.fill(0.0);
        for k in 0..self.slot.len() {
            if self.slot[k] != NONBASIC {
                self.cost[k] = 0.0;
                continue;
            }
            self.x[k] = match self.rest[k] {
                NonbasicStatus::Lower => self.program.lower[k],
                NonbasicStatus::Upper => self.program.upper[k],
                NonbasicStatus::Free => 0.0,
            };
            let value = self.x[k];
            if value != 0.0 {
                let by_row = &mut self.by_row;
                self.program.each(k, |i, a| by_row[i] -= a * value);
            }
        }
        self.factors.solve(&mut self.by_row, &mut self.entering);
        for (s, &k) in self.head.iter().enumerate() {
            self.x[k] = self.entering[s];
        }
    }

    /// Goes back to the true costs; columns that may jump do so.
    pub(super) fn unshift(&mut self) {
        self.used.copy_from_slice(&self.program.cost);
        self.is_shifted = false;
        self.compute();
    }

    /// The multipliers of the true costs.
    pub(super) fn multipliers(&mut self) -> &[f64] {
        for (s, &k) in self.head.iter().enumerate() {
            self.entering[s] = self.program.cost[k];
        }
        self.factors.solve_transposed(&mut self.entering, &mut self.row);
        &self.row
    }

    /// The value of the dual objective, scaled.
    pub(super) fn value(&self) -> f64 {
        self.used.iter().zip(&self.x).map(|(c, x)| c * x).sum()
    }

    /// The largest violation of a bound, relative: not less than the rounding of the point.
    fn allowed_miss(&self) -> f64 {
        if self.allowed >= PRIMAL_TOLERANCE {
            return PRIMAL_TOLERANCE;
        }
        let size = self.head.iter().map(|&k| self.x[k].abs()).fold(1.0, f64::max);
        (0.1 * self.allowed * size).clamp(self.allowed, PRIMAL_TOLERANCE)
    }

    /// The slot whose column violates its bounds most, and by how much: negative below the lower
    /// one.
    fn leaving(&self) -> Option<(usize, f64)> {
        let mut most = 0.0;
        let mut found = None;
        let allowed = self.allowed_miss();
        for (s, &k) in self.head.iter().enumerate() {
            let (x, lower, upper) = (self.x[k], self.program.lower[k], self.program.upper[k]);
            let by = if x < lower { x - lower } else { x - upper };
            let limit = if x < lower { lower } else { upper };
            if (x >= lower && x <= upper) || by.abs() <= allowed * limit.abs().max(1.0) {
                continue;
            }
            let merit = by * by / self.weight[s];
            if merit > most {
                (most, found) = (merit, Some((s, by)));
            }
        }
        found
    }

    /// Computes the row of a slot in the inverse into `row`, and the pivot row into `pivots`.
    fn price(&mut self, slot: usize) {
        self.entering.fill(0.0);
        self.entering[slot] = 1.0;
        self.factors.solve_transposed(&mut self.entering, &mut self.row);
        let n = self.program.size().0;
        for k in self.touched.drain(..) {
            (self.pivots[k], self.is_touched[k]) = (0.0, false);
        }
        for (i, &rho) in self.row.iter().enumerate().filter(|(_, v)| v.abs() > 1e-14) {
            (self.pivots[n + i], self.is_touched[n + i]) = (-rho, true);
            self.touched.push(n + i);
            for (j, a) in self.program.rows.entries(i) {
                if !self.is_touched[j] {
                    self.is_touched[j] = true;
                    self.touched.push(j);
                }
                self.pivots[j] += rho * a;
            }
        }
    }

    /// One exchange of the basis.
    pub(super) fn step(&mut self) -> Iteration {
        if self.factors.exchanges() >= MAX_EXCHANGES && !self.refresh() {
            return Iteration::Stuck;
        }
        let Some((slot, by)) = self.leaving() else { return Iteration::Optimal };
        self.price(slot);
        let sign = by.signum();
        let mut candidates = self.candidates(sign);
        let (jumps, entering) = test(&mut candidates, by.abs());
        let Some(entering) = entering else {
            return Iteration::Infeasible(self.row.iter().map(|v| sign * v).collect());
        };
        let q = entering.of;
        self.enter(q);
        let pivot = self.entering[slot];
        let differs = (pivot - self.pivots[q]).abs() > MAX_PIVOT_DIFFERENCE * pivot.abs();
        if pivot.abs() < MIN_PIVOT || differs {
            // Fresh factors, or none that help.
            let fresh = self.factors.exchanges() == 0;
            return if fresh || !self.refresh() { Iteration::Stuck } else { Iteration::Moved };
        }
        self.jump(&candidates[..jumps]);
        self.exchange(slot, q, pivot, sign);
        Iteration::Moved
    }

    /// Factorises the basis again, and computes everything from it.
    fn refresh(&mut self) -> bool {
        let fine = self.factorise();
        if fine {
            self.compute();
        }
        fine
    }

    /// Moves columns to their other bounds.
    fn jump(&mut self, columns: &[EnteringColumn]) {
        if columns.is_empty() {
            return;
        }
        self.by_row.fill(0.0);
        for &EnteringColumn { of: k, .. } in columns {
            let (lower, upper) = (self.program.lower[k], self.program.upper[k]);
            let (rest, to) = match self.rest[k] {
                NonbasicStatus::Lower => (NonbasicStatus::Upper, upper),
                _ => (NonbasicStatus::Lower, lower),
            };
            let step = to - self.x[k];
            (self.rest[k], self.x[k]) = (rest, to);
            let by_row = &mut self.by_row;
            self.program.each(k, |i, a| by_row[i] -= a * step);
        }
        self.factors.solve(&mut self.by_row, &mut self.tau);
        for (s, &k) in self.head.iter().enumerate() {
            self.x[k] += self.tau[s];
        }
    }

    /// Lets a column into a slot, whose own column goes to the bound that it violates.
    fn exchange(&mut self, slot: usize, q: usize, pivot: f64, sign: f64) {
        let p = self.head[slot];
        let dual_step = self.cost[q] / self.pivots[q];
        for &k in &self.touched {
            if self.slot[k] == NONBASIC {
                self.cost[k] -= dual_step * self.pivots[k];
            }
        }
        (self.cost[q], self.cost[p]) = (0.0, -dual_step);
        let (rest, bound) = match sign > 0.0 {
            true => (NonbasicStatus::Upper, self.program.upper[p]),
            false => (NonbasicStatus::Lower, self.program.lower[p]),
        };
        let step = (self.x[p] - bound) / pivot;
        for (s, &k) in self.head.iter().enumerate() {
            self.x[k] -= step * self.entering[s];
        }
        self.x[q] += step;
        (self.x[p], self.rest[p]) = (bound, rest);
        self.by_row.copy_from_slice(&self.row);
        self.factors.solve(&mut self.by_row, &mut self.tau);
        let own = self.row.iter().map(|v| v * v).sum::<f64>();
        for (s, &entry) in
            self.entering.iter().enumerate().filter(|(s, v)| *s != slot && **v != 0.0)
        {
            let ratio = entry / pivot;
            let weight = self.weight[s] - 2.0 * ratio * self.tau[s] + ratio * ratio * own;
            self.weight[s] = weight.max(1e-4);
        }
        self.weight[slot] = (own / (pivot * pivot)).max(1e-4);
        self.swap(slot, q);
    }
}
