//! The workers as rank 0 sees them.

use std::time::{Duration, Instant};

use carom::prelude::Statistics;

use crate::message::Status;

/// The least time between two looks of a searching rank for messages: nodes may take microseconds.
pub(crate) const BETWEEN_LOOKS: Duration = Duration::from_millis(1);

/// The work of one rank.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RankCounts {
    /// The rank.
    pub rank: usize,
    /// Nodes processed.
    pub nodes: u64,
    /// Nodes that rank 0 handed to it.
    pub handed: u64,
    /// Nodes that it gave back.
    pub given: u64,
    /// Time with a node at hand, in s.
    pub busy: f64,
}

/// A worker as rank 0 sees it.
pub(crate) struct Peer {
    /// Whether its last status has no orders yet.
    pub(crate) is_waiting: bool,
    /// Whether it takes nodes.
    pub(crate) takes: bool,
    /// Whether it was told that the tree is over, or the run.
    pub(crate) told_end: bool,
    pub(crate) told_stop: bool,
    /// Whether it has said its last word about the tree.
    pub(crate) has_ended: bool,
    /// A status that is about the tree after the present one.
    pub(crate) early: Option<Status>,
    pub(crate) open: usize,
    /// At most the smallest bound of its open nodes.
    pub(crate) floor: f64,
    pub(crate) nodes: u64,
    /// Nodes of earlier trees.
    pub(crate) nodes_before: u64,
    /// The version of the best point that it knows.
    pub(crate) version: u64,
    /// Nodes it is asked to give back.
    pub(crate) asked: usize,
    /// Whether a checkpoint waits for its list.
    pub(crate) lists: bool,
    /// Whether it was told to list its nodes.
    pub(crate) told_to_list: bool,
    pub(crate) counts: Option<Statistics>,
    pub(crate) busy: f64,
    pub(crate) handed: u64,
    pub(crate) given: u64,
    pub(crate) batch: Batch,
}

/// Most nodes that are handed to a worker at once.
const MOST_AT_ONCE: usize = 256;

/// The time that a worker should need for what it is handed: twice as many nodes if it needed less,
/// half as many if it needed ten times as long.
const HELD: Duration = Duration::from_millis(10);

/// The number of nodes that a rank gets at once.
pub(crate) struct Batch {
    pub(crate) size: usize,
    /// When it last got nodes.
    pub(crate) since: Instant,
}

impl Batch {
    pub(crate) fn new() -> Self {
        Batch { size: 1, since: Instant::now() }
    }

    /// Fits the number to the time that the last nodes took, once they are used up.
    pub(crate) fn adapt(&mut self) {
        let held = self.since.elapsed();
        if held < HELD {
            self.size = (2 * self.size).min(MOST_AT_ONCE);
        } else if held > 10 * HELD {
            self.size = (self.size / 2).max(1);
        }
    }
}

impl Peer {
    /// Whether it waits and has nothing to search.
    pub(crate) fn is_hungry(&self) -> bool {
        self.takes && self.is_waiting && self.open == 0
    }

    /// A worker that has said nothing yet.
    pub(crate) fn new() -> Self {
        Peer {
            is_waiting: false,
            takes: false,
            told_end: false,
            told_stop: false,
            has_ended: false,
            early: None,
            open: 0,
            floor: f64::INFINITY,
            nodes: 0,
            nodes_before: 0,
            version: 0,
            asked: 0,
            lists: false,
            told_to_list: false,
            counts: None,
            busy: 0.0,
            handed: 0,
            given: 0,
            batch: Batch::new(),
        }
    }

    /// A tree begins, of which the worker has said nothing yet.
    pub(crate) fn begin(&mut self) {
        (self.takes, self.told_end, self.has_ended) = (false, false, false);
        (self.open, self.floor, self.version, self.asked) = (0, f64::INFINITY, 0, 0);
        (self.lists, self.told_to_list, self.counts) = (false, false, None);
        (self.nodes_before, self.nodes) = (self.nodes_before + self.nodes, 0);
    }
}
