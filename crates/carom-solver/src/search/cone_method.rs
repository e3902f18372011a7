//! The choice between the two ways of relaxing a node of a program whose cones are cut off: rounds
//! of cuts, each a linear program that begins with the basis of the last one, or one conic program.
//!
//! Both give the same bound, so the quicker one is used. Which one that is depends on the program,
//! and changes with the cuts that are known. So the favourite is used for long. The other one is
//! tried for a few nodes in a row, because a basis helps only the node that follows. Conic programs
//! come first, because they take about the same time at all nodes.

use web_time::Duration;

/// Nodes of a trial, and of the turn of a new favourite between two trials; a turn that follows a
/// trial that changed nothing is twice as long as the last one.
const TRIAL_NODES: u32 = 12;
const FIRST_TURN: u32 = 100;
const LONGEST_TURN: u32 = 10_000;

/// A trial ends early if it has taken this many times as long as the favourite would for all its
/// nodes.
const FAR_SLOWER: f64 = 4.0;

/// The share of the last node in the average time of a way.
const SHARE_OF_LAST: f64 = 0.1;

/// A way of relaxing a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConeMethod {
    Cuts,
    Conic,
}

impl ConeMethod {
    fn other(self) -> Self {
        match self {
            ConeMethod::Cuts => ConeMethod::Conic,
            ConeMethod::Conic => ConeMethod::Cuts,
        }
    }
}

/// The turns of the two ways at the nodes of a worker, and the time that they take.
#[derive(Debug)]
pub(super) struct ConeRecord {
    favourite: ConeMethod,
    /// Whether the other way is on trial, and the nodes left of the turn.
    on_trial: bool,
    left: u32,
    /// The time that the trial has taken (s).
    trial: f64,
    /// The length of the favourite's next turn.
    turn: u32,
    /// By way, the nodes since its last trial began, and their average time (s).
    nodes: [u32; 2],
    average: [f64; 2],
}

impl Default for ConeRecord {
    fn default() -> Self {
        ConeRecord {
            favourite: ConeMethod::Conic,
            on_trial: false,
            left: TRIAL_NODES,
            trial: 0.0,
            turn: FIRST_TURN,
            nodes: [0; 2],
            average: [0.0; 2],
        }
    }
}

impl ConeRecord {
    /// The way for the next node, which is counted.
    pub(super) fn next(&mut self) -> ConeMethod {
        match (self.left, self.on_trial) {
            (0, true) => self.end_trial(),
            (0, false) => {
                (self.on_trial, self.left, self.trial) = (true, TRIAL_NODES, 0.0);
                self.nodes[self.favourite.other() as usize] = 0;
            }
            _ => {}
        }
        self.left -= 1;
        self.current()
    }

    /// The way of the turn.
    pub(super) fn current(&self) -> ConeMethod {
        if self.on_trial { self.favourite.other() } else { self.favourite }
    }

    fn end_trial(&mut self) {
        let (old, new) = (self.favourite as usize, self.favourite.other() as usize);
        let is_quicker = self.nodes[old] == 0 || self.average[new] < self.average[old];
        if self.nodes[new] > 0 && is_quicker && !self.is_far_slower() {
            (self.favourite, self.turn) = (self.favourite.other(), FIRST_TURN);
        }
        (self.on_trial, self.left) = (false, self.turn);
        self.turn = (2 * self.turn).min(LONGEST_TURN);
    }

    /// Whether the trial has taken far too long.
    fn is_far_slower(&self) -> bool {
        let favourite = self.average[self.favourite as usize];
        self.trial > FAR_SLOWER * f64::from(TRIAL_NODES) * favourite
    }

    /// Takes note of the time of a node; without a basis to begin with, it does not tell what
    /// others take.
    pub(super) fn note(&mut self, method: ConeMethod, time: Duration, is_warm: bool) {
        if self.on_trial && method != self.favourite {
            self.trial += time.as_secs_f64();
            if self.is_far_slower() {
                self.left = 0;
            }
        }
        if method == ConeMethod::Cuts && !is_warm {
            return;
        }
        let way = method as usize;
        let share = SHARE_OF_LAST.max(1.0 / f64::from(self.nodes[way] + 1));
        self.average[way] += share * (time.as_secs_f64() - self.average[way]);
        self.nodes[way] = self.nodes[way].saturating_add(1);
    }
}
