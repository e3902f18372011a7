//! A tree that several processes search together: this process's part of it.

use std::sync::atomic::Ordering;

use super::node::{Decision, Node, Path};
use super::reporter::Reporter;
use super::tree::{Tree, TreeState};
use super::tree_view::TreeView;
use crate::program::Program;
use crate::solution::{Heuristic, Statistics, Termination};
use crate::solver::{Elsewhere, OpenNode, PartState, TreeExchange, TreePart};

/// This process's part of a tree, with the node that comes next.
struct OwnPart<'t, 'a> {
    tree: &'t Tree<'a>,
    plunge: &'t mut Option<Node>,
}

/// Tells an exchange that a search begins; whether the nodes below the root are another process's.
/// The root itself is searched by all of them, because nodes from elsewhere start from the state
/// that it leaves.
pub(super) fn begin(tree: &Tree<'_>, exchange: &mut dyn TreeExchange) -> bool {
    !exchange.begin(fingerprint(tree.task.exact.unwrap_or(tree.task.program)), true)
}

/// Lets an exchange act after a node.
pub(super) fn meet(
    tree: &Tree<'_>,
    reporter: &mut Reporter<'_, '_>,
    view: &TreeView<'_>,
    plunge: &mut Option<Node>,
) {
    let drops_nodes = std::mem::take(&mut reporter.drops_nodes);
    let Some(exchange) = reporter.exchange.as_deref_mut() else { return };
    let mut part = OwnPart { tree, plunge };
    if drops_nodes {
        part.take_all();
    }
    exchange.meet(&mut part, false);
    tree.lock().floors[view.id] = plunge.as_ref().map(|node| node.bound);
}

/// Waits for a node from other processes; `None` at the end of the search.
pub(super) fn wait<'a>(
    tree: &Tree<'a>,
    reporter: &mut Reporter<'_, '_>,
    view: &TreeView<'a>,
    next: impl Fn(&Tree<'a>, &TreeView<'a>) -> Option<Node>,
) -> Option<Node> {
    loop {
        if let Some(reason) = tree.task.token.ended() {
            tree.stop(reason);
        }
        let drops_nodes = std::mem::take(&mut reporter.drops_nodes);
        let exchange = reporter.exchange.as_deref_mut()?;
        let mut part = OwnPart { tree, plunge: &mut None };
        if drops_nodes {
            part.take_all();
        }
        if !exchange.meet(&mut part, true) {
            return None;
        }
        reporter.report(tree);
        if let Some(node) = next(tree, view) {
            return Some(node);
        }
    }
}

impl OwnPart<'_, '_> {
    fn open_node(node: &Node) -> OpenNode {
        let mut decisions: Vec<_> =
            node.path.backwards().map(|d| (d.column as u32, d.is_upper, d.value)).collect();
        decisions.reverse();
        OpenNode { bound: node.bound, decisions }
    }

    /// Whether a node speaks of integral columns of the program and of whole numbers.
    fn fits(&self, node: &OpenNode) -> bool {
        let integral = &self.tree.task.program.integral;
        let fits = |&(column, _, value): &(u32, bool, f64)| {
            integral.get(column as usize) == Some(&true) && value == value.round()
        };
        !node.bound.is_nan() && node.decisions.iter().all(fits)
    }

    fn floor(&self, state: &TreeState) -> f64 {
        let next = self.plunge.as_ref().map_or(f64::INFINITY, |node| node.bound);
        state.queue.best_bound().min(next)
    }
}

impl TreePart for OwnPart<'_, '_> {
    fn state(&self) -> PartState {
        let state = self.tree.lock();
        PartState {
            open: state.queue.len() + usize::from(self.plunge.is_some()),
            floor: self.floor(&state),
            closed: state.closed,
            stalled: state.stalled,
            nodes: state.nodes(),
            cutoff: self.tree.cutoff(),
            is_doubtful: state.is_doubtful(),
            ended: state.stop,
        }
    }

    fn open_nodes(&self) -> Vec<OpenNode> {
        let state = self.tree.lock();
        state.queue.iter().chain(self.plunge.iter()).map(Self::open_node).collect()
    }

    fn take(&mut self, count: usize) -> Vec<OpenNode> {
        let mut state = self.tree.lock();
        let (mut taken, mut kept) = (Vec::new(), Vec::new());
        while taken.len() < count
            && let Some(node) = state.queue.pop()
        {
            if node.bound < self.tree.cutoff() && kept.len() >= taken.len() {
                self.tree.open.fetch_sub(1, Ordering::Relaxed);
                taken.push(Self::open_node(&node));
            } else {
                kept.push(node);
            }
        }
        kept.into_iter().for_each(|node| state.queue.push(node));
        taken
    }

    fn take_all(&mut self) -> Vec<OpenNode> {
        let mut state = self.tree.lock();
        let next = self.plunge.take();
        let mut taken: Vec<OpenNode> = next.iter().map(Self::open_node).collect();
        while let Some(node) = state.queue.pop() {
            self.tree.open.fetch_sub(1, Ordering::Relaxed);
            taken.push(Self::open_node(&node));
        }
        taken
    }

    fn put(&mut self, nodes: Vec<OpenNode>) -> bool {
        if !nodes.iter().all(|node| self.fits(node)) {
            return false;
        }
        let mut state = self.tree.lock();
        for node in nodes {
            let step = |path: Path, &(column, is_upper, value): &(u32, bool, f64)| {
                path.then(&Decision { column: column as usize, is_upper, value }, &self.tree.steps)
            };
            let path = node.decisions.iter().fold(Path::default(), step);
            let id = self.tree.ids.fetch_add(1, Ordering::Relaxed);
            self.tree.push(&mut state, Node { path, bound: node.bound, id, ..Node::root() });
        }
        true
    }

    fn incumbent(&self) -> Option<(f64, Vec<f64>)> {
        self.tree.incumbent()
    }

    fn offer(&mut self, point: Vec<f64>) -> bool {
        let task = &self.tree.task;
        let fits = point.len() == task.program.column_count();
        if !fits || !point.iter().all(|x| x.is_finite()) || !task.judge.accepts(&point) {
            return false;
        }
        let accepted = self.tree.accepted(task.value(&point), point, Heuristic::Leaf);
        self.tree.accept(&mut self.tree.lock(), accepted)
    }

    fn note_elsewhere(&mut self, elsewhere: Elsewhere) {
        self.tree.lock().elsewhere = elsewhere;
    }

    fn note_closed(&mut self, closed: f64, stalled: f64) {
        let mut state = self.tree.lock();
        (state.closed, state.stalled) = (state.closed.min(closed), state.stalled.min(stalled));
    }

    fn note_doubt(&mut self) {
        {
            let mut state = self.tree.lock();
            (state.is_widened, state.stalled) = (true, f64::NEG_INFINITY);
        }
        self.tree.stop(Termination::Stalled);
    }

    fn statistics(&self) -> Statistics {
        self.tree.lock().statistics()
    }

    fn add_statistics(&mut self, counts: &Statistics) {
        let mut counts = *counts;
        counts.forget_incumbents();
        self.tree.lock().add_statistics(&counts);
    }

    fn stop(&mut self, reason: Termination) {
        self.tree.stop(reason);
    }
}

/// A number for a program: programs with the same number have, but for chance, the same columns and
/// rows.
fn fingerprint(program: &Program) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bits: u64| {
        for byte in bits.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    add(program.column_count() as u64);
    add(program.row_count() as u64);
    let numbers = [&program.linear, &program.lower, &program.upper];
    numbers.into_iter().flatten().for_each(|value| add(value.to_bits()));
    add(program.offset.to_bits());
    add(program.sign.to_bits());
    program.integers.iter().for_each(|&j| add(j as u64));
    for row in 0..program.row_count() {
        let (columns, values) = program.row(row);
        columns.iter().for_each(|&j| add(j as u64));
        values.iter().for_each(|value| add(value.to_bits()));
        add(program.row_lower[row].to_bits());
        add(program.row_upper[row].to_bits());
    }
    for (row, column, value) in program.quadratic_entries() {
        add(row as u64);
        add(column as u64);
        add(value.to_bits());
    }
    format!("{:?}", program.cones).bytes().for_each(|byte| add(u64::from(byte)));
    hash
}
