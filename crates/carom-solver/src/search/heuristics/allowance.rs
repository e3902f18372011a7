//! The budget of a heuristic: a share of the cost of the search, which grows with its success.

use super::parameters::HEURISTICS;

/// The account of one heuristic at one worker.
#[derive(Debug, Default)]
pub struct Allowance {
    calls: u64,
    successes: u64,
    spent: u64,
}

impl Allowance {
    /// Iterations that may be spent now, when the worker has taken `total` in all, with a free
    /// start or without. Calls without success lower the share in proportion.
    pub fn left(&self, total: u64, free_start: bool) -> u64 {
        let favour = (1 + self.successes) as f64 / (1 + self.calls) as f64;
        let start = if free_start { HEURISTICS.free_iterations } else { 0 };
        let allowed = start + (HEURISTICS.iteration_share * favour * total as f64) as u64;
        allowed.saturating_sub(self.spent)
    }

    /// Books a call: what it took, and whether it found a better point.
    pub fn book(&mut self, iterations: u64, success: bool) {
        self.calls += 1;
        self.successes += u64::from(success);
        self.spent += iterations;
    }

    /// Calls so far.
    pub(super) fn calls(&self) -> u64 {
        self.calls
    }
}
