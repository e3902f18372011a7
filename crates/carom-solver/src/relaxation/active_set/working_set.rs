//! The working set: limits that hold with equality, their multipliers, and the factor of their
//! products.

use super::metric::{LimitSide, Metric};
use super::parameters::{MIN_SQUARED_SINE, MULTIPLIER_ROUNDING};
use super::triangle::{LowerTriangle, add_multiple, dot};
use crate::tolerance::largest_magnitude;

/// A limit that is held.
#[derive(Debug, Clone, Copy)]
pub(super) struct WorkingLimit {
    /// A row or a column.
    pub(super) of: usize,
    pub(super) side: LimitSide,
    /// The value that its unit vector takes.
    level: f64,
    pub(super) multiplier: f64,
}

/// A limit that may enter the working set, with its dependence on the members.
#[derive(Debug)]
pub(super) struct EnteringLimit {
    of: usize,
    side: LimitSide,
    /// Its row of the factor, and the diagonal entry.
    row: Vec<f64>,
    diagonal: f64,
    /// The members' multiples that come closest to it.
    multiples: Vec<f64>,
}

impl EnteringLimit {
    pub(super) fn is_dependent(&self) -> bool {
        self.diagonal * self.diagonal <= MIN_SQUARED_SINE
    }
}

#[derive(Debug, Default)]
pub(super) struct WorkingSet {
    pub(super) members: Vec<WorkingLimit>,
    /// `C` with `C C'` the products of the members' unit vectors.
    factor: LowerTriangle,
    /// By row and column: whether it is a member.
    pub(super) holds: Vec<bool>,
}

impl WorkingSet {
    pub(super) fn new(len: usize) -> Self {
        WorkingSet { holds: vec![false; len], ..WorkingSet::default() }
    }

    /// A limit with its dependence on the members.
    pub(super) fn candidate(
        &self,
        metric: &mut Metric<'_>,
        of: usize,
        side: LimitSide,
    ) -> EnteringLimit {
        let unit = metric.unit(of).0.to_vec();
        let product = |m: &WorkingLimit| dot(metric.known(m.of), &unit);
        let mut row: Vec<f64> = self.members.iter().map(product).collect();
        self.factor.solve(&mut row, 0);
        let mut multiples = row.clone();
        self.factor.solve_transposed(&mut multiples);
        // The vector of an empty row is 0.
        let length = if unit.iter().any(|&v| v != 0.0) { 1.0 } else { 0.0 };
        let mut square = length - dot(&row, &row);
        if square < 1e-3 {
            // The difference has lost digits; the vector that is left has them.
            let mut left = unit;
            for (member, &multiple) in self.members.iter().zip(&multiples) {
                add_multiple(&mut left, -multiple, metric.known(member.of));
            }
            square = dot(&left, &left);
        }
        EnteringLimit { of, side, row, diagonal: square.max(0.0).sqrt(), multiples }
    }

    /// Holds a limit that does not depend on the members.
    pub(super) fn add(
        &mut self,
        metric: &mut Metric<'_>,
        candidate: &EnteringLimit,
        multiplier: f64,
    ) {
        let &EnteringLimit { of, side, diagonal, .. } = candidate;
        self.factor.push(&candidate.row, diagonal);
        self.holds[of] = true;
        self.members.push(WorkingLimit { of, side, level: metric.level(of, side), multiplier });
    }

    /// Takes the levels of the members from a metric whose centre has moved.
    pub(super) fn update_levels(&mut self, metric: &mut Metric<'_>) {
        for member in &mut self.members {
            member.level = metric.level(member.of, member.side);
        }
    }

    fn remove(&mut self, at: usize) {
        self.factor.remove(at);
        let member = self.members.remove(at);
        self.holds[member.of] = false;
    }

    /// The multipliers at which all members hold with equality and all others are zero.
    fn target(&self) -> Vec<f64> {
        let mut target: Vec<f64> = self.members.iter().map(|m| -m.level).collect();
        self.factor.solve(&mut target, 0);
        self.factor.solve_transposed(&mut target);
        target
    }

    /// Moves the multipliers towards those at which all members hold, up to the first one that
    /// becomes zero; its limit is let go. Returns whether all members hold.
    pub(super) fn advance(&mut self) -> bool {
        let target = self.target();
        let size = largest_magnitude(&target);
        let mut step = 1.0;
        let mut blocking = None;
        for (k, (member, &to)) in self.members.iter().zip(&target).enumerate() {
            if member.side.refuses(to) && to.abs() > MULTIPLIER_ROUNDING * size {
                let reach = (member.multiplier / (member.multiplier - to)).clamp(0.0, 1.0);
                if reach < step || blocking.is_none() {
                    (step, blocking) = (reach, Some(k));
                }
            }
        }
        for (member, to) in self.members.iter_mut().zip(target) {
            let moved = member.multiplier + step * (to - member.multiplier);
            let moved = if step == 1.0 { to } else { moved };
            member.multiplier = if member.side.refuses(moved) { 0.0 } else { moved };
        }
        if let Some(k) = blocking {
            self.remove(k);
        }
        blocking.is_none()
    }

    /// Adds a limit that depends on the members: moves the multipliers along the direction that
    /// keeps the point, up to the first multiplier that becomes zero. A member without which the
    /// limit depends on the others all the same is passed over, because exchanging the two would
    /// let go of a member for nothing: the objective would fall, and the method could go round in
    /// a circle.
    ///
    /// # Errors
    ///
    /// The direction, if no multiplier becomes zero: these multipliers of the members, and 1 (-1
    /// for a lower limit) for the limit itself, prove that the limits contradict each other.
    pub(super) fn exchange(
        &mut self,
        metric: &mut Metric<'_>,
        mut candidate: EnteringLimit,
        up: bool,
    ) -> Result<(), Vec<f64>> {
        let sign = if up { 1.0 } else { -1.0 };
        let mut passed_over = Vec::new();
        loop {
            let mut direction: Vec<f64> = candidate.multiples.iter().map(|t| -sign * t).collect();
            let (mut step, mut blocking) = (f64::INFINITY, None);
            for (k, (member, &along)) in self.members.iter().zip(&direction).enumerate() {
                if member.side.refuses(along)
                    && along.abs() > MULTIPLIER_ROUNDING
                    && !passed_over.contains(&member.of)
                {
                    let reach = (member.multiplier / -along).max(0.0);
                    if reach < step {
                        (step, blocking) = (reach, Some(k));
                    }
                }
            }
            let Some(k) = blocking else { return Err(direction) };
            let leaving = self.members[k];
            self.remove(k);
            let entering = self.candidate(metric, candidate.of, candidate.side);
            if entering.is_dependent() {
                let back = self.candidate(metric, leaving.of, leaving.side);
                if back.is_dependent() {
                    return Ok(());
                }
                self.add(metric, &back, leaving.multiplier);
                passed_over.push(leaving.of);
                candidate = self.candidate(metric, candidate.of, candidate.side);
                continue;
            }
            direction.remove(k);
            for (member, along) in self.members.iter_mut().zip(direction) {
                let moved = member.multiplier + step * along;
                member.multiplier = if member.side.refuses(moved) { 0.0 } else { moved };
            }
            self.add(metric, &entering, sign * step);
            return Ok(());
        }
    }

    /// `u` of the multipliers.
    pub(super) fn position(&self, metric: &Metric<'_>) -> Vec<f64> {
        let mut u = vec![0.0; metric.program.columns.len()];
        for member in &self.members {
            add_multiple(&mut u, -member.multiplier, metric.known(member.of));
        }
        u
    }

    /// Corrects the multipliers by the distances of the members to their limits at a point.
    pub(super) fn refine(&mut self, metric: &mut Metric<'_>, x: &[f64]) {
        let mut miss = Vec::with_capacity(self.members.len());
        for member in &self.members {
            let size = metric.unit(member.of).1;
            let value = metric.value(member.of, x);
            miss.push((value - metric.limit(member.of, member.side)) / size);
        }
        self.factor.solve(&mut miss, 0);
        self.factor.solve_transposed(&mut miss);
        for (member, by) in self.members.iter_mut().zip(miss) {
            let moved = member.multiplier + by;
            member.multiplier = if member.side.refuses(moved) { 0.0 } else { moved };
        }
    }
}
