//! The messages of ranks to each other.
//!
//! A worker speaks first: every [`Status`] is answered by [`Orders`], and a worker sends no second
//! status before it has its orders. So a rank never sends to one that is sending to it, and sends
//! may block.

use carom::solver::OpenNode;

use crate::bytes::{Reader, Writer};

/// A worker's word to rank 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Status {
    /// The number of the presolved program; `None` if the rank takes no nodes.
    pub(crate) program: Option<u64>,
    pub(crate) open: u64,
    pub(crate) floor: f64,
    pub(crate) closed: f64,
    pub(crate) stalled: f64,
    pub(crate) nodes: u64,
    pub(crate) is_doubtful: bool,
    /// A new best point.
    pub(crate) point: Option<Vec<f64>>,
    /// Nodes that the worker has no longer.
    pub(crate) given: Vec<OpenNode>,
    /// All nodes that it has, if it was asked to list them.
    pub(crate) listing: Option<Vec<OpenNode>>,
    /// The last word about a tree, with its counts, as JSON, and the time in nodes so far, in s. No
    /// orders follow.
    pub(crate) last: Option<(String, f64)>,
}

/// The answer of rank 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Orders {
    /// Nodes to search.
    pub(crate) nodes: Vec<OpenNode>,
    /// A better point than the worker's.
    pub(crate) point: Option<Vec<f64>>,
    /// So many nodes to give back.
    pub(crate) give: u64,
    /// Whether to list all nodes.
    pub(crate) list: bool,
    /// Whether the search of this tree is over.
    pub(crate) ends: bool,
    /// Whether no other tree follows.
    pub(crate) stop: bool,
}

impl Status {
    /// The word of a rank that has nothing.
    pub(crate) fn empty() -> Self {
        Status {
            program: None,
            open: 0,
            floor: f64::INFINITY,
            closed: f64::INFINITY,
            stalled: f64::INFINITY,
            nodes: 0,
            is_doubtful: false,
            point: None,
            given: Vec::new(),
            listing: None,
            last: None,
        }
    }

    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::default();
        out.maybe(self.program.as_ref(), |out, &program| out.whole(program));
        out.whole(self.open);
        [self.floor, self.closed, self.stalled].into_iter().for_each(|value| out.number(value));
        out.whole(self.nodes);
        out.flag(self.is_doubtful);
        out.maybe(self.point.as_ref(), |out, point| out.numbers(point));
        out.nodes(&self.given);
        out.maybe(self.listing.as_ref(), |out, nodes| out.nodes(nodes));
        out.maybe(self.last.as_ref(), |out, (counts, seconds)| {
            out.text(counts);
            out.number(*seconds);
        });
        out.bytes
    }

    pub(crate) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut from = Reader::new(bytes);
        let status = Status {
            program: from.maybe(Reader::whole)?,
            open: from.whole()?,
            floor: from.number()?,
            closed: from.number()?,
            stalled: from.number()?,
            nodes: from.whole()?,
            is_doubtful: from.flag()?,
            point: from.maybe(Reader::numbers)?,
            given: from.nodes()?,
            listing: from.maybe(Reader::nodes)?,
            last: from.maybe(|from| Some((from.text()?, from.number()?)))?,
        };
        from.end()?;
        Some(status)
    }
}

impl Orders {
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::default();
        out.nodes(&self.nodes);
        out.maybe(self.point.as_ref(), |out, point| out.numbers(point));
        out.whole(self.give);
        out.flag(self.list);
        out.flag(self.ends);
        out.flag(self.stop);
        out.bytes
    }

    pub(crate) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut from = Reader::new(bytes);
        let orders = Orders {
            nodes: from.nodes()?,
            point: from.maybe(Reader::numbers)?,
            give: from.whole()?,
            list: from.flag()?,
            ends: from.flag()?,
            stop: from.flag()?,
        };
        from.end()?;
        Some(orders)
    }
}
