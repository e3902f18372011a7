//! Programs with few, long cones by a sequence of quadratic programs.
//!
//! In a program with a norm `|T x + t| <= g'x + h`, the multiplier `y` of the norm times its
//! curvature, `y (T'T - u u') / |T x + t|` with `u` the gradient, is the curvature of the
//! Lagrangian. With it and with the tangent plane of the norm, the program is a quadratic one,
//! whose optimum is the next point (sequential quadratic programming: Nocedal and Wright,
//! Numerical Optimization, 2006, chapter 18). That converges quadratically, and each program
//! begins with the working set of the last one, as the first does with that of the parent. A norm
//! near 0 has no curvature: such programs are left to others, as is what does not converge.
//!
//! Tangent planes hold in the cone, so that multipliers of any step prove a bound.

use super::active_set::{ActiveSet, CentredAnswer, HeldLimit, LAST_PLACED_NAME};
use super::cone_cut::length;
use super::conic_form::ConicForm;
use super::{Effort, RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::{Compressed, Reduced, ReducedCone};
use crate::program::{ConeRole, FEW_LONG_CONES, LONG_TAIL};
use crate::tolerance::largest_magnitude;

/// Most columns.
const MOST_QUADRATIC_COLUMNS: usize = 1000;

/// Most quadratic programs.
const MOST_QUADRATIC_PROGRAMS: usize = 14;

/// By how much the norm may exceed the head in the end, relative to the head.
const MOST_EXCESS: f64 = 1e-9;

/// The least length of a tail that has a curvature, relative to the head.
const LEAST_TAIL: f64 = 1e-7;

/// The state that a node leaves to its children: the point by the names of columns, the multipliers
/// of the cones, and the working set.
#[derive(Debug)]
struct ConicState {
    x: Vec<(usize, f64)>,
    cones: Vec<f64>,
    held: Vec<HeldLimit>,
}

/// The method.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SequentialQuadratic {}

impl SequentialQuadratic {
    /// Whether the method suits a program.
    pub(super) fn suits(program: &Reduced) -> bool {
        let is_whole = |cone: &&ReducedCone| cone.role != ConeRole::Part && !cone.is_fixed();
        let cones = || program.cones.iter().filter(is_whole);
        (1..=FEW_LONG_CONES).contains(&cones().count())
            && cones().all(|cone| cone.tail().len() >= LONG_TAIL)
            && program.columns.len() <= MOST_QUADRATIC_COLUMNS
    }

    /// Whether a state is one of this method.
    pub(super) fn knows(state: &WarmState) -> bool {
        state.get::<ConicState>().is_some()
    }

    /// Solves a program with its cones. Also returns the multipliers of the rows of the cones.
    pub(super) fn solve_cones(
        &self,
        form: &ConicForm<'_>,
        effort: &Effort<'_>,
    ) -> (RelaxationResult, Vec<f64>) {
        let state = effort.warm.and_then(WarmState::get::<ConicState>);
        let mut run = QuadraticSequence::new(form, state);
        let claim = run.finish(effort);
        run.answer(claim)
    }
}

/// One solve.
struct QuadraticSequence<'a> {
    form: &'a ConicForm<'a>,
    x: Vec<f64>,
    /// By cone: its multiplier, its tail, and the part of the tail's length that each entry is.
    multipliers: Vec<f64>,
    tails: Vec<Vec<f64>>,
    /// By cone: `T'T`, the upper triangle by columns.
    squares: Vec<Vec<f64>>,
    held: Vec<HeldLimit>,
    /// The multipliers of the program's rows, and the directions of the planes that belong to them.
    y: Vec<f64>,
    planes: Vec<Vec<f64>>,
    steps: u64,
}

impl<'a> QuadraticSequence<'a> {
    fn new(form: &'a ConicForm<'a>, state: Option<&ConicState>) -> Self {
        let program = &*form.program;
        let (n, count) = (program.columns.len(), form.cones.len());
        let middle = |j: usize| match (program.lower[j].is_finite(), program.upper[j].is_finite()) {
            (true, true) => 0.5 * (program.lower[j] + program.upper[j]),
            _ => 0.0_f64.max(program.lower[j]).min(program.upper[j]),
        };
        let mut x: Vec<f64> = (0..n).map(middle).collect();
        let (mut multipliers, mut held) = (vec![f64::NAN; count], Vec::new());
        if let Some(state) = state {
            // Both are in the order of the program's columns.
            let mut known = state.x.iter().peekable();
            for (x, &name) in x.iter_mut().zip(&program.columns) {
                while known.next_if(|(other, _)| *other < name).is_some() {}
                if let Some(&(_, value)) = known.next_if(|(other, _)| *other == name) {
                    *x = value;
                }
            }
            if state.cones.len() == count {
                multipliers.clone_from(&state.cones);
            }
            held.clone_from(&state.held);
        }
        let (tails, planes) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        let tail_rows = |cone| form.cones.rows_of(cone).skip(1);
        let squares = (0..count).map(|cone| squares(n, &form.cones.rows, tail_rows(cone)));
        QuadraticSequence {
            form,
            x,
            multipliers,
            tails,
            squares: squares.collect(),
            held,
            y: Vec::new(),
            planes,
            steps: 0,
        }
    }

    fn entry(&self, row: usize) -> f64 {
        let sum: f64 = self.form.cones.rows.entries(row).map(|(j, a)| a * self.x[j]).sum();
        sum + self.form.cones.constant[row]
    }

    /// Computes heads and tails at the point; returns the largest excess of a norm over its head,
    /// relative to it, or `None` if a tail is too short for a curvature.
    fn measure(&mut self) -> Option<f64> {
        let mut worst = 0.0_f64;
        for cone in 0..self.form.cones.len() {
            let mut rows = self.form.cones.rows_of(cone);
            let head = self.entry(rows.next()?);
            let tail: Vec<f64> = rows.map(|row| self.entry(row)).collect();
            let length = length(&tail);
            if !(length > LEAST_TAIL * head.abs() && length > 0.0 && length.is_finite()) {
                return None;
            }
            worst = worst.max((length - head) / head.abs().max(length));
            self.tails[cone] = tail;
        }
        Some(worst)
    }

    fn finish(&mut self, effort: &Effort<'_>) -> RelaxationClaim {
        let active_set = ActiveSet::new();
        for _ in 0..MOST_QUADRATIC_PROGRAMS {
            if effort.token.is_over() || self.measure().is_none() {
                return RelaxationClaim::Unknown;
            }
            let program = self.quadratic_program();
            let answer = active_set.solve_centred(&program, &self.x, &self.held, effort);
            let Some(CentredAnswer { claim, x, y, held, pull, iterations }) = answer else {
                return RelaxationClaim::Unknown;
            };
            self.steps += iterations;
            let rows = self.form.program.rows.len();
            for (cone, tail) in self.tails.iter().enumerate() {
                self.multipliers[cone] = y[rows + cone].max(0.0);
                let length = length(tail);
                self.planes[cone] = tail.iter().map(|t| t / length).collect();
            }
            self.y = y[..rows].to_vec();
            if claim != RelaxationClaim::Solved {
                return claim;
            }
            let moved = self.x.iter().zip(&x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            (self.x, self.held) = (x, held);
            let Some(excess) = self.measure() else { return RelaxationClaim::Unknown };
            let size = self.form.program.objective(&self.x).abs().max(1e-3);
            if excess <= MOST_EXCESS && pull <= effort.tolerance * size && moved <= 1e-4 {
                return RelaxationClaim::Solved;
            }
        }
        RelaxationClaim::Unknown
    }

    /// The program with the curvature of the Lagrangian and with tangent planes of the cones, whose
    /// rows come last.
    fn quadratic_program(&self) -> Reduced {
        let form = self.form;
        let base = &*form.program;
        let n = base.columns.len();
        let mut curvature = vec![0.0; n * n];
        for j in 0..n {
            base.quadratic.entries(j).for_each(|(i, p)| curvature[j * n + i] += p);
        }
        let mut linear = base.linear.clone();
        let (mut planes, mut limits) = (Vec::new(), Vec::new());
        for cone in 0..form.cones.len() {
            let mut rows = form.cones.rows_of(cone);
            let head = rows.start;
            rows.start += 1;
            let tail = &self.tails[cone];
            let length = length(tail);
            let mut gradient = vec![0.0; n];
            let mut limit = form.cones.constant[head];
            for (row, t) in rows.zip(tail) {
                form.cones.rows.entries(row).for_each(|(j, a)| gradient[j] += t / length * a);
                limit -= t / length * form.cones.constant[row];
            }
            let mut plane = gradient.clone();
            form.cones.rows.entries(head).for_each(|(j, a)| plane[j] -= a);
            let known = self.multipliers[cone];
            let multiplier = match known.is_finite() {
                true => known,
                false => largest_magnitude(&base.linear) / largest_magnitude(&plane).max(1e-9),
            };
            let bend = multiplier / length;
            if bend > 0.0 {
                for (j, &slope) in gradient.iter().enumerate() {
                    let column = j * n..=j * n + j;
                    let known = self.squares[cone][column.clone()].iter().zip(&gradient);
                    let sums = curvature[column].iter_mut().zip(known);
                    sums.for_each(|(sum, (square, g))| *sum += bend * (square - g * slope));
                }
            }
            planes.push(plane);
            limits.push(limit);
        }
        let mut quadratic = Compressed::with_capacity(n, n * n);
        for j in 0..n {
            for i in 0..=j {
                let own = base.quadratic.entries(j).find(|(k, _)| *k == i);
                let bent = curvature[j * n + i] - own.map_or(0.0, |(_, p)| p);
                linear[j] -= bent * self.x[i];
                if i != j {
                    linear[i] -= bent * self.x[j];
                }
            }
            quadratic.push((0..=j).map(|i| (i, curvature[j * n + i])).filter(|e| e.1 != 0.0));
        }
        let mut program = Reduced { quadratic, linear, ..base.clone() };
        for (cone, (plane, limit)) in planes.iter().zip(limits).enumerate() {
            program.rows.push(plane.iter().copied().enumerate().filter(|(_, a)| *a != 0.0));
            program.row_lower.push(f64::NEG_INFINITY);
            program.row_upper.push(limit);
            program.origin.push(LAST_PLACED_NAME + 1 + cone);
        }
        program
    }

    fn answer(self, claim: RelaxationClaim) -> (RelaxationResult, Vec<f64>) {
        let program = &self.form.program;
        let mut z = vec![0.0; self.form.cones.constant.len()];
        let mut y = self.y;
        y.resize(program.rows.len(), 0.0);
        for (cone, plane) in self.planes.iter().enumerate() {
            let multiplier = self.multipliers[cone];
            if plane.is_empty() || multiplier.is_nan() || multiplier <= 0.0 {
                continue;
            }
            // At the end, the direction of the point is as good as that of the last plane.
            let tail = match claim {
                RelaxationClaim::Solved => {
                    let tail = &self.tails[cone];
                    let length = length(tail);
                    tail.iter().map(|t| t / length).collect()
                }
                _ => plane.clone(),
            };
            let rows = self.form.cones.rows_of(cone);
            z[rows.start] = multiplier;
            for (row, part) in rows.skip(1).zip(tail) {
                z[row] = -multiplier * part;
            }
        }
        let names = program.columns.iter().copied();
        let state = ConicState {
            x: names.zip(self.x.iter().copied()).collect(),
            cones: self.multipliers,
            held: self.held,
        };
        let warm = (claim == RelaxationClaim::Solved).then(|| WarmState::new(state));
        (RelaxationResult { claim, x: self.x, y, iterations: self.steps, warm }, z)
    }
}

/// `T'T` for some rows of a matrix: the upper triangle by columns.
fn squares(n: usize, matrix: &Compressed, rows: impl Iterator<Item = usize>) -> Vec<f64> {
    let mut sum = vec![0.0; n * n];
    let mut dense = vec![0.0; n];
    for row in rows {
        let (index, value) = matrix.vector(row);
        dense.fill(0.0);
        index.iter().zip(value).for_each(|(&j, a)| dense[j] += a);
        for (j, &b) in dense.iter().enumerate().filter(|(_, b)| **b != 0.0) {
            let column = &mut sum[j * n..=j * n + j];
            column.iter_mut().zip(&dense).for_each(|(sum, a)| *sum += a * b);
        }
    }
    sum
}
