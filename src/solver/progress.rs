//! What a solve reports while it runs.

use web_time::Duration;

/// A progress event of a solve. Objective values are in the model's own sense.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The root node is done.
    Root(Progress),
    /// A better point was found and verified.
    Incumbent(Progress),
    /// A regular sign of life, a few times a second.
    Progress(Progress),
}

impl Event {
    /// The figures of any event.
    pub fn progress(&self) -> &Progress {
        match self {
            Event::Root(p) | Event::Incumbent(p) | Event::Progress(p) => p,
        }
    }
}

/// The figures of a search at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Nodes processed.
    pub nodes: u64,
    /// Nodes waiting.
    pub open: usize,
    /// Relaxations solved.
    pub relaxations: u64,
    /// Objective of the best point so far.
    pub incumbent: Option<f64>,
    /// Proved bound.
    pub bound: f64,
    /// Time since the solve began.
    pub elapsed: Duration,
}

impl Progress {
    /// A snapshot, for backends that report their own progress.
    pub fn new(
        nodes: u64,
        open: usize,
        relaxations: u64,
        incumbent: Option<f64>,
        bound: f64,
        elapsed: Duration,
    ) -> Self {
        Progress { nodes, open, relaxations, incumbent, bound, elapsed }
    }
}
