//! Relaxation-induced neighbourhood search.
//!
//! Where an incumbent and a relaxed point agree on an integer, both a plan that works and a bound
//! that is hard to beat say so. These integers are fixed, and what is left is searched as a small
//! program of its own, for a point that is better by a part of the gap (Danna, Rothberg and Le Pape
//! 2005).

use super::worker::Worker;
use super::{Found, Task, search};
use crate::solver::Control;

/// Nodes of the small search.
const NODES: u64 = 60;

/// Share of all relaxations that may go into small searches, and how many are always allowed.
const SHARE: f64 = 0.3;
const ALLOWED: u64 = 50;

/// Least share of the open integers that must be fixed.
const LEAST_FIXED: f64 = 0.4;

/// Share of the gap by which a new point must be better.
const GAIN: f64 = 0.02;

/// Nodes between two searches: at first, and at most.
const PAUSE: u64 = 10;
const LONGEST_PAUSE: u64 = 640;

/// When to search next.
pub(super) struct Schedule {
    /// Nodes since the last search.
    since: u64,
    pause: u64,
    /// Relaxations in small searches so far.
    spent: u64,
    /// The incumbent's value at the last search.
    seen: f64,
}

impl Schedule {
    pub(super) fn new() -> Self {
        Schedule { since: 0, pause: PAUSE, spent: 0, seen: f64::INFINITY }
    }
}

impl Worker<'_> {
    /// Searches around the incumbent, when it is time to; `point` is the node's relaxed point.
    pub(super) fn explore_neighbourhood(&mut self, point: &[f64], bound: f64) {
        self.neighbourhoods.since += 1;
        let due = self.neighbourhoods.since >= self.neighbourhoods.pause;
        if self.task.nested || self.program().is_feasibility_problem() || !due {
            return;
        }
        let allowed = SHARE * self.tree.relaxations() as f64;
        if self.neighbourhoods.spent.saturating_sub(ALLOWED) as f64 > allowed {
            return;
        }
        let Some((value, incumbent)) = self.tree.incumbent() else { return };
        let schedule = &mut self.neighbourhoods;
        schedule.since = 0;
        if value < schedule.seen {
            (schedule.seen, schedule.pause) = (value, PAUSE);
        }
        // Doubled now, and set back when this search or the tree finds something.
        schedule.pause = (2 * schedule.pause).min(LONGEST_PAUSE);

        let mut program = self.program().clone();
        let (mut open, mut fixed) = (0usize, 0usize);
        for &j in &self.program().integers {
            if self.root_width(j) == 0.0 {
                continue;
            }
            open += 1;
            if (point[j] - incumbent[j]).abs() <= self.task.options.integrality {
                (program.lower[j], program.upper[j]) = (incumbent[j], incumbent[j]);
                fixed += 1;
            }
        }
        if (fixed as f64) < LEAST_FIXED * open as f64 {
            return;
        }
        let gain = GAIN * (value - bound).max(0.0);
        let cutoff = self.tree.cutoff().min(if gain.is_finite() { value - gain } else { value });
        let options = self.task.options.clone().with_threads(1).with_node_limit(NODES);
        let task = Task { program: &program, options: &options, nested: true, cutoff, ..self.task };
        let mut control = Control::default().with_interrupt(self.tree.interrupt());
        let Found { incumbent, statistics, .. } = search(task, &mut control);
        self.neighbourhoods.spent += statistics.relaxations;
        self.tree.count(|s| {
            s.relaxations += statistics.relaxations;
            s.iterations += statistics.iterations;
        });
        if let Some(found) = incumbent {
            let value = self.program().objective(&found);
            self.tree.offer(value, found);
        }
    }
}
