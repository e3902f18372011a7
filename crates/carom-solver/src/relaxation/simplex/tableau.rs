//! A basis of a linear program, its factors, its point and its reduced costs: what the dual and the
//! primal method share.

use super::factors::{Factors, SolveFor};
use super::parameters::{
    DUAL_TOLERANCE, MAX_PIVOT_DIFFERENCE, MIN_PIVOT, MIN_WEIGHT, PERTURBATION,
};
use super::program::LinearProgram;
use super::ratio::NonbasicStatus;
use super::row_copy::RowCopy;
use super::sparse::{SparseVector, TINY_ENTRY};

/// No slot.
pub(super) const NONBASIC: usize = usize::MAX;

/// The outcome of an iteration.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Iteration {
    Moved,
    /// No exchange improves.
    Optimal,
    /// These multipliers prove that there is no feasible point.
    Infeasible(Vec<f64>),
    /// The objective falls along this ray without limit.
    Unbounded(Vec<f64>),
    /// The numbers are too bad.
    Stuck,
}

/// A basis and its point.
#[derive(Debug)]
pub(super) struct Tableau {
    pub(super) program: LinearProgram,
    /// By slot, the column in the basis, and by column, its slot.
    pub(super) head: Vec<usize>,
    pub(super) slot: Vec<usize>,
    pub(super) rest: Vec<NonbasicStatus>,
    /// By slot, the value of its column and the column's bounds.
    pub(super) value: Vec<f64>,
    pub(super) bounds: Vec<[f64; 2]>,
    /// Reduced costs, and the costs that they are of: the program's, shifted.
    pub(super) cost: Vec<f64>,
    pub(super) used: Vec<f64>,
    /// By slot, the squared norm of its row of the inverse, roughly.
    pub(super) weight: Vec<f64>,
    pub(super) factors: Factors,
    row_copy: RowCopy,
    /// A row of the inverse, its pivot row, and the entering column in the basis.
    pub(super) row: SparseVector,
    pub(super) pivots: SparseVector,
    pub(super) entering: SparseVector,
    /// Work space.
    pub(super) sum: SparseVector,
}

impl Tableau {
    /// Starts from the columns that are wanted in the basis, with their weights; others take the
    /// place of those that depend on each other. Reduced costs and point are still to be computed.
    pub(super) fn new(
        program: LinearProgram,
        wanted: Vec<(usize, f64)>,
        rest: Vec<NonbasicStatus>,
    ) -> Self {
        let (n, m) = program.size();
        let (head, weight) = wanted.into_iter().unzip();
        let mut tableau = Tableau {
            used: program.cost.clone(),
            head,
            slot: vec![NONBASIC; n + m],
            rest,
            value: vec![0.0; m],
            bounds: vec![[0.0; 2]; m],
            cost: vec![0.0; n + m],
            weight,
            factors: Factors::default(),
            row_copy: RowCopy::default(),
            row: SparseVector::zeros(m),
            pivots: SparseVector::zeros(n + m),
            entering: SparseVector::zeros(m),
            sum: SparseVector::zeros(m),
            program,
        };
        tableau.factorise();
        tableau
    }

    /// Whether a column has room to move.
    pub(super) fn is_open(&self, k: usize) -> bool {
        self.program.lower[k] < self.program.upper[k]
    }

    /// Factorises the basis, mended where it is none.
    pub(super) fn factorise(&mut self) {
        let (n, m) = self.program.size();
        let program = &self.program;
        let columns: Vec<_> = self.head.iter().map(|&k| program.column(k)).collect();
        let (factors, column_of) = Factors::new(m, &columns);
        let is_first = self.factors.is_empty();
        self.factors = factors;
        let of = |(i, c): (usize, &Option<usize>)| match *c {
            Some(c) => (self.head[c], self.weight[c]),
            None => (n + i, 1.0),
        };
        let mended = column_of.contains(&None) || self.head.len() != m;
        (self.head, self.weight) = column_of.iter().enumerate().map(of).unzip();
        self.slot.fill(NONBASIC);
        self.head.iter().enumerate().for_each(|(s, &k)| self.slot[k] = s);
        for (s, &k) in self.head.iter().enumerate() {
            self.bounds[s] = [self.program.lower[k], self.program.upper[k]];
        }
        if mended || is_first {
            let (slot, program) = (&self.slot, &self.program);
            let may_enter = |j: usize| slot[j] == NONBASIC && program.lower[j] < program.upper[j];
            self.row_copy = RowCopy::new(program, may_enter);
        }
    }

    /// The value of a column outside the basis.
    pub(super) fn resting(&self, k: usize) -> f64 {
        match self.rest[k] {
            NonbasicStatus::Lower => self.program.lower[k],
            NonbasicStatus::Upper => self.program.upper[k],
            NonbasicStatus::Free => 0.0,
        }
    }

    /// The multipliers of some costs, in `sum`.
    pub(super) fn solve_multipliers(&mut self, is_true: bool) {
        let cost = if is_true { &self.program.cost } else { &self.used };
        self.sum.clear();
        for (s, &k) in self.head.iter().enumerate().filter(|e| cost[*e.1] != 0.0) {
            self.sum.value[s] = cost[k];
            self.sum.index.push(s as u32);
        }
        self.factors.solve_transposed(&mut self.sum, SolveFor::Sum);
    }

    /// Computes the reduced costs of the multipliers in `sum`.
    pub(super) fn reduce_costs(&mut self) {
        for k in 0..self.slot.len() {
            self.cost[k] = self.used[k] - self.program.product(k, &self.sum.value);
        }
    }

    /// Computes reduced costs from the basis.
    pub(super) fn compute_costs(&mut self) {
        self.solve_multipliers(false);
        self.reduce_costs();
        self.head.iter().for_each(|&k| self.cost[k] = 0.0);
    }

    /// Computes the point from the basis.
    pub(super) fn compute_point(&mut self) {
        self.sum.clear();
        for k in (0..self.slot.len()).filter(|&k| self.slot[k] == NONBASIC) {
            let value = self.resting(k);
            if value != 0.0 {
                let by_row = &mut self.sum.value;
                self.program.each(k, |i, a| by_row[i] -= a * value);
            }
        }
        self.sum.list();
        self.factors.solve(&mut self.sum, SolveFor::Sum);
        self.value.copy_from_slice(&self.sum.value);
    }

    /// The bound that the reduced cost of a column outside the basis wants.
    pub(super) fn settle(&mut self, k: usize) {
        let cost = self.cost[k];
        let (lower, upper) = (self.program.lower[k], self.program.upper[k]);
        self.rest[k] = match (lower.is_finite(), upper.is_finite()) {
            (true, true) if cost > DUAL_TOLERANCE => NonbasicStatus::Lower,
            (true, true) if cost < -DUAL_TOLERANCE => NonbasicStatus::Upper,
            (true, true) if self.rest[k] == NonbasicStatus::Upper => NonbasicStatus::Upper,
            (true, _) => NonbasicStatus::Lower,
            (false, true) => NonbasicStatus::Upper,
            (false, false) => NonbasicStatus::Free,
        };
    }

    /// By how much the reduced cost of a column outside the basis has the wrong sign.
    pub(super) fn dual_miss(&self, k: usize) -> f64 {
        let cost = self.cost[k];
        match self.rest[k] {
            _ if !self.is_open(k) => 0.0,
            NonbasicStatus::Lower => -cost,
            NonbasicStatus::Upper => cost,
            NonbasicStatus::Free => cost.abs(),
        }
    }

    /// Makes the reduced cost of a column zero by its cost.
    pub(super) fn shift(&mut self, k: usize) {
        self.used[k] -= self.cost[k];
        self.cost[k] = 0.0;
    }

    /// Moves the costs of the columns outside the basis away from zero reduced costs, by random
    /// amounts: then few steps have length zero.
    pub(super) fn perturb(&mut self) {
        let mut seed = 1_u32;
        for k in 0..self.slot.len() {
            // A linear congruence.
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if self.slot[k] != NONBASIC || !self.is_open(k) {
                continue;
            }
            let part = 1.0 + f64::from(seed) / f64::from(u32::MAX);
            let by = PERTURBATION * part * (1.0 + self.used[k].abs());
            let by = match self.rest[k] {
                NonbasicStatus::Lower => by,
                NonbasicStatus::Upper => -by,
                NonbasicStatus::Free => continue,
            };
            self.used[k] += by;
            self.cost[k] += by;
        }
    }

    /// The dual objective of the reduced costs, scaled.
    pub(super) fn dual_value(&self) -> f64 {
        let outside = (0..self.slot.len()).filter(|&k| self.slot[k] == NONBASIC);
        let outside: f64 = outside.map(|k| self.used[k] * self.resting(k)).sum();
        let inside = self.head.iter().zip(&self.value).map(|(&k, x)| self.used[k] * x);
        outside + inside.sum::<f64>()
    }

    /// The bound that the multipliers of the true costs prove, scaled.
    pub(super) fn true_bound(&mut self) -> f64 {
        self.solve_multipliers(true);
        let program = &self.program;
        let part = |k: usize| {
            let cost = program.cost[k] - program.product(k, &self.sum.value);
            let bound = if cost > 0.0 { program.lower[k] } else { program.upper[k] };
            if cost.abs() <= DUAL_TOLERANCE { 0.0 } else { cost * bound }
        };
        (0..self.slot.len()).map(part).sum()
    }

    /// Computes the row of a slot in the inverse.
    pub(super) fn solve_row(&mut self, slot: usize) {
        self.row.clear();
        self.row.value[slot] = 1.0;
        self.row.index.push(slot as u32);
        self.factors.solve_transposed(&mut self.row, SolveFor::Row);
    }

    /// Computes the pivot row of the row of the inverse, of the columns that may enter.
    pub(super) fn price(&mut self) {
        let n = self.program.size().0;
        self.pivots.clear();
        let SparseVector { value, index } = &mut self.pivots;
        for (i, rho) in self.row.entries().filter(|e| e.1.abs() > TINY_ENTRY) {
            let k = n + i;
            if self.slot[k] == NONBASIC && self.program.lower[k] < self.program.upper[k] {
                value[k] = -rho;
                index.push(k as u32);
            }
            let (columns, entries) = self.row_copy.entering(i);
            for (&j, a) in columns.iter().zip(entries) {
                let pivot = &mut value[j as usize];
                if *pivot == 0.0 {
                    index.push(j);
                }
                *pivot += rho * a;
                if *pivot == 0.0 {
                    *pivot = f64::MIN_POSITIVE;
                }
            }
        }
    }

    /// Computes the column of the basis in which `q` is written.
    pub(super) fn solve_column(&mut self, q: usize) {
        self.entering.clear();
        let entering = &mut self.entering;
        self.program.each(q, |i, a| {
            entering.value[i] += a;
            entering.index.push(i as u32);
        });
        self.factors.solve(&mut self.entering, SolveFor::Column);
    }

    /// Whether a pivot is large enough and the same by row and by column.
    pub(super) fn is_sound(&self, slot: usize, q: usize) -> bool {
        let (pivot, other) = (self.entering.value[slot], self.pivots.value[q]);
        let differs = (pivot - other).abs() > MAX_PIVOT_DIFFERENCE * pivot.abs();
        pivot.abs() >= MIN_PIVOT && !differs
    }

    /// Puts a column into a slot, whose own column goes to a bound. The row of the slot, its pivot
    /// row and the column in the basis have been computed. Returns whether the factors are fine.
    ///
    /// # Arguments
    ///
    /// * `keeps_signs`: shifts costs whose reduced costs would get the wrong sign.
    pub(super) fn exchange(
        &mut self,
        slot: usize,
        q: usize,
        to: NonbasicStatus,
        keeps_signs: bool,
    ) -> bool {
        let p = self.head[slot];
        let pivot = self.entering.value[slot];
        let dual_step = self.cost[q] / self.pivots.value[q];
        if dual_step != 0.0 {
            for at in 0..self.pivots.index.len() {
                let k = self.pivots.index[at] as usize;
                self.cost[k] -= dual_step * self.pivots.value[k];
                if keeps_signs && self.dual_miss(k) > 0.0 {
                    self.shift(k);
                }
            }
        }
        (self.cost[q], self.cost[p]) = (0.0, -dual_step);
        self.rest[p] = to;
        let step = (self.value[slot] - self.resting(p)) / pivot;
        let start = self.resting(q);
        if step != 0.0 {
            for (s, entry) in self.entering.entries() {
                self.value[s] -= step * entry;
            }
        }
        self.value[slot] = start + step;
        self.bounds[slot] = [self.program.lower[q], self.program.upper[q]];
        self.update_weights(slot, pivot);
        (self.head[slot], self.slot[q], self.slot[p]) = (q, slot, NONBASIC);
        let n = self.program.size().0;
        if q < n {
            self.row_copy.move_column(&self.program, q, false);
        }
        if p < n && self.is_open(p) {
            self.row_copy.move_column(&self.program, p, true);
        }
        self.factors.exchange(slot, pivot)
    }

    /// Updates the weights of dual steepest edges (Forrest and Goldfarb, Steepest-edge simplex
    /// algorithms for linear programming).
    fn update_weights(&mut self, slot: usize, pivot: f64) {
        self.sum.copy_from(&self.row);
        self.factors.solve(&mut self.sum, SolveFor::Weights);
        let own = self.row.square();
        for (s, entry) in self.entering.entries() {
            let ratio = entry / pivot;
            let weight = self.weight[s] + ratio * (ratio * own - 2.0 * self.sum.value[s]);
            self.weight[s] = weight.max(MIN_WEIGHT);
        }
        self.weight[slot] = (own / (pivot * pivot)).max(MIN_WEIGHT);
    }

    /// Moves columns outside the basis to their other bounds.
    pub(super) fn jump(&mut self, columns: impl Iterator<Item = usize>) {
        self.sum.clear();
        for k in columns {
            let from = self.resting(k);
            self.rest[k] = match self.rest[k] {
                NonbasicStatus::Lower => NonbasicStatus::Upper,
                _ => NonbasicStatus::Lower,
            };
            let step = self.resting(k) - from;
            let sum = &mut self.sum;
            self.program.each(k, |i, a| sum.add(i, -a * step));
        }
        if self.sum.index.is_empty() {
            return;
        }
        self.factors.solve(&mut self.sum, SolveFor::Sum);
        for (s, by) in self.sum.entries() {
            self.value[s] += by;
        }
    }

    /// The values of the columns proper.
    pub(super) fn point(&self) -> Vec<f64> {
        let value = |k: usize| match self.slot[k] {
            NONBASIC => self.resting(k),
            slot => self.value[slot],
        };
        (0..self.program.size().0).map(value).collect()
    }
}
