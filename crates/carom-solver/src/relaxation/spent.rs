//! The work of a cascade so far, for the statistics of a solve.

use web_time::Duration;

use crate::solution::{RelaxationCounts, Statistics};

/// The attempts, iterations and time of a cascade since they were last taken.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spent {
    /// Attempts by method.
    pub counts: RelaxationCounts,
    /// Iterations of all attempts.
    pub iterations: u64,
    /// Time inside the methods.
    pub time: Duration,
}

impl Spent {
    /// Adds it to the counts of a solve.
    pub fn count(&self, statistics: &mut Statistics) {
        statistics.relaxations += self.counts.total();
        statistics.relaxation_counts.add(&self.counts);
        statistics.iterations += self.iterations;
    }
}
