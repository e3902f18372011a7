//! A dual active-set method for small dense programs with curvature in every direction.
//!
//! The method of Goldfarb and Idnani in the form of a least distance: the limits that hold with
//! equality are a *working set*, whose multipliers have the right signs throughout. A step moves
//! them towards the values at which the whole set holds. One that becomes zero on the way is let
//! go; at the end of the way, the limit that is violated most enters. Every step raises the dual
//! objective, so the method may stop as soon as it exceeds the cutoff.
//!
//! Any multipliers with the right signs are a start, and a child of a node differs from it by a few
//! bounds. It starts from the multipliers of its parent and needs a few steps, where an
//! interior-point method would begin from nothing.

mod metric;
mod parameters;
mod triangle;
mod working_set;

use super::{Effort, Relaxation, RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::Reduced;
use metric::{LimitSide, Metric};
use parameters::MAX_DENSE_COLUMNS;
use working_set::WorkingSet;

/// The active-set method for small dense programs.
#[derive(Debug, Clone, Default)]
pub struct ActiveSet {}

/// The limits that are active at an optimum.
#[derive(Debug)]
struct ActiveLimits(Vec<HeldLimit>);

/// A limit of the parent, by its row or column of the program, with its multiplier.
#[derive(Debug, Clone, Copy)]
struct HeldLimit {
    is_row: bool,
    of: usize,
    multiplier: f64,
}

impl ActiveSet {
    /// A fresh instance.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether the method suits a program.
    pub fn suits(program: &Reduced) -> bool {
        let n = program.columns.len();
        let curved = |j: usize| program.quadratic.vector(j).0.contains(&j);
        let dense = 8 * program.quadratic.index.len() >= n * n;
        n <= MAX_DENSE_COLUMNS && dense && (0..n).all(curved)
    }
}

impl Relaxation for ActiveSet {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        let metric = if ActiveSet::suits(program) { Metric::new(program) } else { None };
        let Some(metric) = metric else { return RelaxationResult::nothing(program) };
        let set = WorkingSet::new(metric.len());
        let mut run = ActiveSetRun { metric, set, steps: 0, x: Vec::new(), ray: None };
        run.start(effort.warm.and_then(WarmState::get));
        let claim = run.finish(effort);
        run.answer(claim)
    }
}

/// One solve.
struct ActiveSetRun<'a> {
    metric: Metric<'a>,
    set: WorkingSet,
    steps: u32,
    x: Vec<f64>,
    /// A direction of multipliers that proves infeasibility, by row.
    ray: Option<Vec<f64>>,
}

impl ActiveSetRun<'_> {
    /// Fills the working set: equalities, and what held at the parent.
    fn start(&mut self, parent: Option<&ActiveLimits>) {
        let program = self.metric.program;
        let m = program.rows.len();
        let mut wanted: Vec<(usize, f64)> = Vec::new();
        if let Some(ActiveLimits(parent)) = parent {
            let mut at = [vec![usize::MAX; 0], vec![usize::MAX; 0]];
            for (is_row, names) in [(0, &program.columns), (1, &program.origin)] {
                for (k, &name) in names.iter().enumerate().filter(|(_, name)| **name != usize::MAX)
                {
                    let len = at[is_row].len().max(name + 1);
                    at[is_row].resize(len, usize::MAX);
                    at[is_row][name] = k;
                }
            }
            for held in parent {
                let k = at[usize::from(held.is_row)].get(held.of).copied().unwrap_or(usize::MAX);
                if k != usize::MAX {
                    wanted.push((if held.is_row { k } else { m + k }, held.multiplier));
                }
            }
        }
        let equalities = (0..m).filter(|&i| program.row_lower[i] == program.row_upper[i]);
        let equalities: Vec<(usize, f64)> = equalities.map(|i| (i, 0.0)).collect();
        for (of, multiplier) in wanted.into_iter().chain(equalities) {
            if self.set.holds[of] {
                continue;
            }
            let [lower, upper] = self.metric.limits(of);
            let side = match multiplier {
                _ if lower == upper => LimitSide::Both,
                y if y > 0.0 && upper.is_finite() => LimitSide::Upper,
                y if y < 0.0 && lower.is_finite() => LimitSide::Lower,
                _ => continue,
            };
            let candidate = self.set.candidate(&mut self.metric, of, side);
            if !candidate.is_dependent() {
                let size = self.metric.unit(of).1;
                self.set.add(&mut self.metric, &candidate, multiplier * size);
            }
        }
    }

    fn finish(&mut self, effort: &Effort<'_>) -> RelaxationClaim {
        let enough = effort.sufficient_bound();
        let mut refined = false;
        while self.steps < effort.iterations && !effort.token.is_over() {
            self.steps += 1;
            if !self.set.advance() {
                continue;
            }
            let mut u = self.set.position(&self.metric);
            self.x = self.metric.point(&u);
            if self.metric.objective(&u) > enough {
                return RelaxationClaim::Beyond;
            }
            let mut violated = self.metric.most_violated(&self.x, &self.set.holds);
            if violated.is_none() && !refined {
                refined = true;
                self.set.refine(&mut self.metric, &self.x);
                u = self.set.position(&self.metric);
                self.x = self.metric.point(&u);
                violated = self.metric.most_violated(&self.x, &self.set.holds);
            }
            let Some((of, side)) = violated else { return RelaxationClaim::Solved };
            let candidate = self.set.candidate(&mut self.metric, of, side);
            if !candidate.is_dependent() {
                self.set.add(&mut self.metric, &candidate, 0.0);
                continue;
            }
            let [_, upper] = self.metric.limits(of);
            let up = self.metric.value(of, &self.x) > upper;
            if let Err(direction) = self.set.exchange(&mut self.metric, candidate, up) {
                self.ray = Some(self.certificate(&direction, of, up));
                return RelaxationClaim::Infeasible;
            }
        }
        RelaxationClaim::Unknown
    }

    /// Multipliers of rows, from those of the working set and of one more limit.
    fn certificate(&mut self, direction: &[f64], of: usize, up: bool) -> Vec<f64> {
        let mut y = vec![0.0; self.metric.program.rows.len()];
        let own = std::iter::once((of, if up { 1.0 } else { -1.0 }));
        let members = self.set.members.iter().map(|m| m.of).zip(direction.iter().copied());
        for (of, multiplier) in members.chain(own) {
            if let Some(y) = y.get_mut(of) {
                *y = multiplier / self.metric.unit(of).1;
            }
        }
        y
    }

    fn answer(mut self, claim: RelaxationClaim) -> RelaxationResult {
        let program = self.metric.program;
        let (n, m) = (program.columns.len(), program.rows.len());
        let mut y = vec![0.0; m];
        let mut held = Vec::new();
        for member in &self.set.members {
            let multiplier = member.multiplier / self.metric.unit(member.of).1;
            if multiplier == 0.0 {
                continue;
            }
            if let Some(y) = y.get_mut(member.of) {
                *y = multiplier;
            }
            let is_row = member.of < m;
            let name = if is_row {
                program.origin.get(member.of)
            } else {
                program.columns.get(member.of - m)
            };
            held.extend(name.map(|&of| HeldLimit { is_row, of, multiplier }));
        }
        if self.x.is_empty() {
            self.x = vec![f64::NAN; n];
        }
        let y = self.ray.unwrap_or(y);
        let warm = Some(WarmState::new(ActiveLimits(held)));
        RelaxationResult { claim, x: self.x, y, iterations: u64::from(self.steps), warm }
    }
}
