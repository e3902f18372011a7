//! The choice between the two ways of relaxing a node of a program whose cones are cut off: rounds of cuts,
//! each a linear program that begins with the basis of the last one, or one conic program.
//!
//! Both give the same bound, so the quicker one is used. Which one that is depends on the program, and both
//! are tried.

use web_time::Duration;

/// Nodes that each way is tried at, at the beginning, and nodes after which the slower one is tried again.
const TRIED_FIRST: u32 = 4;
const RETRY_INTERVAL: u32 = 64;

/// The slower way is not tried again if it takes this many times as long.
const FAR_SLOWER: f64 = 6.0;

/// The share of the last node in the average time of a way.
const SHARE_OF_LAST: f64 = 0.1;

/// A way of relaxing a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConeMethod {
    Cuts,
    Conic,
}

/// What the two ways have taken at the nodes of a worker.
#[derive(Debug, Default)]
pub(super) struct ConeRecord {
    /// By way, the nodes and the average time (s).
    nodes: [u32; 2],
    average: [f64; 2],
}

impl ConeRecord {
    /// The way for the next node.
    pub(super) fn next(&self) -> ConeMethod {
        let quicker = self.quicker();
        let (best, other) = (quicker as usize, 1 - quicker as usize);
        let is_tried = self.nodes[best] >= TRIED_FIRST && self.nodes[other] >= TRIED_FIRST;
        let retries = self.nodes[best].is_multiple_of(RETRY_INTERVAL)
            && self.average[other] < FAR_SLOWER * self.average[best];
        match (is_tried, quicker) {
            (false, _) if self.nodes[0] <= self.nodes[1] => ConeMethod::Cuts,
            (false, _) => ConeMethod::Conic,
            (true, ConeMethod::Cuts) if retries => ConeMethod::Conic,
            (true, ConeMethod::Conic) if retries => ConeMethod::Cuts,
            (true, quicker) => quicker,
        }
    }

    /// The way that has taken less time.
    pub(super) fn quicker(&self) -> ConeMethod {
        if self.average[1] < self.average[0] { ConeMethod::Conic } else { ConeMethod::Cuts }
    }

    /// Takes note of the time of a node.
    pub(super) fn note(&mut self, method: ConeMethod, time: Duration) {
        let (average, nodes) =
            (&mut self.average[method as usize], &mut self.nodes[method as usize]);
        let share = SHARE_OF_LAST.max(1.0 / f64::from(*nodes + 1));
        *average += share * (time.as_secs_f64() - *average);
        *nodes = nodes.saturating_add(1);
    }
}
