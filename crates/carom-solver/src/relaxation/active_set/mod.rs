//! A dual active-set method for dense programs with curvature.
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
use parameters::{
    LARGEST_PULL, MAX_CENTRES, MAX_DENSE_COLUMNS, MAX_IDLE_STEPS, PROXIMAL_PIVOT,
    WEAK_PROXIMAL_PIVOT,
};
use working_set::WorkingSet;

/// The active-set method for small dense programs.
#[derive(Debug, Clone, Default)]
pub struct ActiveSet {}

/// Names beyond this one are those of rows that programs have beside their own; they are few.
pub(super) const LAST_PLACED_NAME: usize = usize::MAX / 2;

/// The limits that are active at an optimum, and the values of the columns without curvature of
/// their own, by their names.
#[derive(Debug)]
struct ActiveLimits {
    held: Vec<HeldLimit>,
    flat: Vec<(usize, f64)>,
}

/// A limit of the parent, by its row or column of the program, with its multiplier.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeldLimit {
    is_row: bool,
    of: usize,
    side: LimitSide,
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
        let dense = 8 * program.quadratic.index.len() >= n * n;
        let curved = |j: &usize| program.quadratic.vector(*j).0.contains(j);
        let enough = |n: usize| 10 * (0..n).filter(curved).count() >= 9 * n;
        n <= MAX_DENSE_COLUMNS && dense && enough(n)
    }
}

impl Relaxation for ActiveSet {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        let metric =
            if ActiveSet::suits(program) { Metric::new(program, PROXIMAL_PIVOT) } else { None };
        let Some(metric) = metric else { return RelaxationResult::nothing(program) };
        let set = WorkingSet::new(metric.len());
        let mut run = ActiveSetRun { metric, set, steps: 0, x: Vec::new(), ray: None };
        run.start(effort.warm.and_then(WarmState::get));
        let claim = run.finish(effort);
        run.answer(claim)
    }
}

/// The optimum of a program whose columns without curvature are pulled towards a centre.
pub(super) struct CentredAnswer {
    pub(super) claim: RelaxationClaim,
    pub(super) x: Vec<f64>,
    /// By row.
    pub(super) y: Vec<f64>,
    pub(super) held: Vec<HeldLimit>,
    /// The most that the pull may cost near the point, in the unit of the objective.
    pub(super) pull: f64,
    pub(super) iterations: u64,
}

impl ActiveSet {
    /// Solves a convex program once around a centre; `None` if it has no curvature at all.
    pub(super) fn solve_centred(
        &self,
        program: &Reduced,
        centre: &[f64],
        held: &[HeldLimit],
        effort: &Effort<'_>,
    ) -> Option<CentredAnswer> {
        let mut metric = Metric::new(program, WEAK_PROXIMAL_PIVOT)?;
        metric.begin_at(centre.iter().copied().enumerate());
        let set = WorkingSet::new(metric.len());
        let mut run = ActiveSetRun { metric, set, steps: 0, x: Vec::new(), ray: None };
        run.hold(held);
        let claim = run.descend(effort, f64::INFINITY);
        let pull = if run.x.is_empty() { 0.0 } else { run.metric.pull(&run.x)[1] };
        let (RelaxationResult { claim, x, y, iterations, .. }, held, _) = run.result(claim);
        Some(CentredAnswer { claim, x, y, held, pull, iterations })
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
    /// Begins where the parent ended.
    fn start(&mut self, parent: Option<&ActiveLimits>) {
        let Some(ActiveLimits { held, flat }) = parent else { return self.hold(&[]) };
        let at = places(&self.metric.program.columns);
        let place = |name: usize| at.get(name).copied().filter(|k| *k != usize::MAX);
        let values = flat.iter().filter_map(|&(name, value)| Some((place(name)?, value)));
        self.metric.begin_at(values);
        self.hold(held);
    }

    /// Fills the working set: some limits, and equalities.
    fn hold(&mut self, held: &[HeldLimit]) {
        let program = self.metric.program;
        let m = program.rows.len();
        let mut wanted: Vec<(usize, LimitSide, f64)> = Vec::new();
        if !held.is_empty() {
            let at = [places(&program.columns), places(&program.origin)];
            for limit in held {
                let k = match limit.of > LAST_PLACED_NAME {
                    true => program.origin.iter().position(|name| *name == limit.of),
                    false => at[usize::from(limit.is_row)].get(limit.of).copied(),
                };
                if let Some(k) = k.filter(|k| *k != usize::MAX) {
                    let of = if limit.is_row { k } else { m + k };
                    wanted.push((of, limit.side, limit.multiplier));
                }
            }
        }
        let equalities = (0..m).filter(|&i| program.row_lower[i] == program.row_upper[i]);
        wanted.extend(equalities.map(|i| (i, LimitSide::Both, 0.0)));
        for (of, side, multiplier) in wanted {
            if self.set.holds[of] {
                continue;
            }
            let [lower, upper] = self.metric.limits(of);
            let (side, multiplier) = match side {
                _ if lower == upper => (LimitSide::Both, multiplier),
                LimitSide::Upper if upper.is_finite() => (side, multiplier.max(0.0)),
                LimitSide::Lower if lower.is_finite() => (side, multiplier.min(0.0)),
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
        if self.metric.flat().next().is_none() {
            return self.descend(effort, effort.sufficient_bound());
        }
        for _ in 0..MAX_CENTRES {
            // The bound of a program with a pull is none of the program without it.
            let claim = self.descend(effort, f64::INFINITY);
            if claim != RelaxationClaim::Solved {
                return claim;
            }
            let ([pull, near], value) =
                (self.metric.pull(&self.x), self.metric.program.objective(&self.x));
            if value - pull > effort.sufficient_bound() {
                return RelaxationClaim::Beyond;
            }
            if near <= LARGEST_PULL * value.abs().max(1.0) {
                return RelaxationClaim::Solved;
            }
            self.metric.move_centre(&self.x);
            self.set.update_levels(&mut self.metric);
        }
        RelaxationClaim::Unknown
    }

    /// Raises the dual objective to the optimum, or to a bound that is enough. Gives up where
    /// rounding keeps it from rising: the method would go round in a circle.
    fn descend(&mut self, effort: &Effort<'_>, enough: f64) -> RelaxationClaim {
        let mut refined = false;
        let (mut highest, mut idle) = (f64::NEG_INFINITY, 0);
        let most_idle = MAX_IDLE_STEPS + 2 * self.metric.len();
        while self.steps < effort.iterations && !effort.token.is_over() {
            self.steps += 1;
            if !self.set.advance() {
                continue;
            }
            let u = self.set.position(&self.metric);
            self.x = self.metric.point(&u);
            let objective = self.metric.objective(&u);
            if objective > enough {
                return RelaxationClaim::Beyond;
            }
            idle = if objective > highest { 0 } else { idle + 1 };
            if idle > most_idle {
                return RelaxationClaim::Unknown;
            }
            highest = highest.max(objective);
            let mut violated = self.metric.most_violated(&self.x, &self.set.holds);
            if violated.is_none() && !refined {
                refined = true;
                violated = self.refine();
            }
            let Some((mut of, side)) = violated else { return RelaxationClaim::Solved };
            let mut candidate = self.set.candidate(&mut self.metric, of, side);
            if candidate.is_dependent() {
                // The digits that the point lacks may be all that is violated.
                let Some((worst, side)) = self.refine() else { return RelaxationClaim::Solved };
                of = worst;
                candidate = self.set.candidate(&mut self.metric, of, side);
            }
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

    /// Corrects the point and the multipliers, and returns what is violated most then.
    fn refine(&mut self) -> Option<(usize, LimitSide)> {
        self.set.refine(&mut self.metric, &self.x);
        let u = self.set.position(&self.metric);
        self.x = self.metric.point(&u);
        self.metric.most_violated(&self.x, &self.set.holds)
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

    fn answer(self, claim: RelaxationClaim) -> RelaxationResult {
        let (result, held, flat) = self.result(claim);
        RelaxationResult { warm: Some(WarmState::new(ActiveLimits { held, flat })), ..result }
    }

    /// The result without a state, the limits that are held, and the values of flat columns.
    fn result(
        mut self,
        claim: RelaxationClaim,
    ) -> (RelaxationResult, Vec<HeldLimit>, Vec<(usize, f64)>) {
        let program = self.metric.program;
        let (n, m) = (program.columns.len(), program.rows.len());
        let mut y = vec![0.0; m];
        let mut held = Vec::new();
        for member in &self.set.members {
            let multiplier = member.multiplier / self.metric.unit(member.of).1;
            if let Some(y) = y.get_mut(member.of) {
                *y = multiplier;
            }
            let is_row = member.of < m;
            let name = if is_row {
                program.origin.get(member.of)
            } else {
                program.columns.get(member.of - m)
            };
            let side = member.side;
            held.extend(name.map(|&of| HeldLimit { is_row, of, side, multiplier }));
        }
        if self.x.is_empty() {
            self.x = vec![f64::NAN; n];
        }
        let y = self.ray.unwrap_or(y);
        let flat = self.metric.flat().map(|k| (program.columns[k], self.x[k]));
        let flat = flat.filter(|(_, value)| value.is_finite()).collect();
        let iterations = u64::from(self.steps);
        (RelaxationResult { claim, x: self.x, y, iterations, warm: None }, held, flat)
    }
}

/// The place of each name, as far as there is one.
fn places(names: &[usize]) -> Vec<usize> {
    let mut at = Vec::new();
    for (k, &name) in names.iter().enumerate().filter(|(_, name)| **name <= LAST_PLACED_NAME) {
        at.resize(at.len().max(name + 1), usize::MAX);
        at[name] = k;
    }
    at
}
