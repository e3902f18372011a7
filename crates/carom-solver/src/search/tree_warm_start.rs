//! The root divided as the tree of an earlier solve was.
//!
//! The splits of the earlier tree are gone through again, and its inner nodes are not relaxed: each
//! decision is propagated. Where the earlier tree closed a node or a side, the multipliers that
//! closed it are tried again. Of a subtree with more than one open end only the top is kept, to be
//! split afresh. In what is kept, sides that are not closed any more are relaxed if they cut off
//! the relaxed point of the root: most are closed again, and what they leave is smaller. What is
//! kept of a large tree is found out by a run without relaxations.
//!
//! The parts cover the root whatever the earlier tree was, since a split always leaves a part for
//! what none of its children has.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::clock::Activity;
use super::close_node::{closed_bound, opposite};
use super::context::Context;
use super::local_bounds::propagate_since;
use super::node::{Decision, Node};
use super::node_relaxation::{project_reduced, reduce_node, relax_and_keep};
use super::saved_tree::{
    End, EndKey, ProofMultipliers, ProofTrial, SavedDuals, SavedSplit, SavedTree,
};
use crate::relaxation::{Purpose, RelaxationVerdict};

/// Most decisions on a way down.
const MOST_DECISIONS: usize = 400;

/// Divides the root along the earlier tree, if there is one and a point to beat. Returns the open
/// parts, the most promising one first; `None` if the root is as it was.
///
/// # Arguments
///
/// * `x`: the relaxed point of the root.
pub(super) fn warm_start_tree(
    ctx: &mut Context<'_>,
    root: &Node,
    bound: f64,
    x: &[f64],
) -> Option<Vec<Node>> {
    let saved_tree = ctx.tree.saved_tree().filter(|saved_tree| saved_tree.has_splits())?;
    let cutoff = ctx.tree.cutoff();
    if root.id != 0 || cutoff == f64::INFINITY {
        return None;
    }
    ctx.node.cutoff = ctx.propagator.set_cutoff(ctx.program(), cutoff);
    let whole = |v: &f64| (v - v.round()).abs() <= ctx.options().integrality;
    let fractional = x.iter().map(|v| !whole(v)).collect();
    let relaxes = !saved_tree.is_large();
    let mut warm_start = TreeWarmStart { fractional, relaxes, ..TreeWarmStart::default() };
    warm_start.run(ctx, &saved_tree, bound);
    if warm_start.has_more_to_relax() {
        let TreeWarmStart { fractional, known, crowded, .. } = warm_start;
        warm_start =
            TreeWarmStart { fractional, known, crowded, relaxes: true, ..TreeWarmStart::default() };
        warm_start.run(ctx, &saved_tree, bound);
    }
    let TreeWarmStart { mut parts, splits, duals, closed, proved, .. } = warm_start;
    if parts.iter().any(|part| part.path.is_empty()) {
        return None;
    }
    ctx.tree.count(|s| {
        s.split += 1;
        s.closed_by_proofs += proved;
    });
    splits.into_iter().for_each(|split| ctx.tree.keep_split(|| split));
    duals.into_iter().for_each(|duals| ctx.tree.keep_duals(|| duals));
    if closed && closed_bound(ctx) < f64::INFINITY {
        ctx.tree.close(closed_bound(ctx));
    }
    parts.sort_by(|a, b| a.bound.total_cmp(&b.bound));
    let facts = ctx.node.path.get(root.path.len()..).unwrap_or_default();
    let base = ctx.tree.path_with(&root.path, facts);
    let node_of = |OpenPart { path, bound, id, multipliers }: OpenPart| {
        let path = ctx.tree.path_with(&base, &path);
        Node { path, bound, id, multipliers, warm: ctx.node.warm.clone(), ..Node::root() }
    };
    Some(parts.into_iter().map(node_of).collect())
}

/// The state of a warm start: the parts of the root so far.
#[derive(Default)]
struct TreeWarmStart {
    /// The decisions that lead to the part in hand, from the root on.
    path: Vec<Decision>,
    /// Open parts.
    parts: Vec<OpenPart>,
    /// The tree as it is now, and the multipliers that closed its ends.
    splits: Vec<SavedSplit>,
    duals: Vec<SavedDuals>,
    /// Whether anything was closed.
    closed: bool,
    /// By column: whether it is fractional at the root.
    fractional: Vec<bool>,
    /// Memory for the multipliers of a node.
    picked: ProofMultipliers,
    /// Whether sides are relaxed where no node above is crowded.
    relaxes: bool,
    /// Sides that relaxing might close.
    left: bool,
    /// Ends that saved multipliers have closed, here or in a run without relaxations.
    proved: u64,
    known: BTreeSet<EndKey>,
    /// Nodes of the earlier tree that have several open ends without relaxations.
    crowded: BTreeSet<u32>,
}

/// An open part.
struct OpenPart {
    path: Vec<Decision>,
    bound: f64,
    id: u32,
    multipliers: Option<Arc<ProofMultipliers>>,
}

impl TreeWarmStart {
    /// Goes through the earlier tree from its root. The domain is left as it was.
    fn run(&mut self, ctx: &mut Context<'_>, saved_tree: &SavedTree, bound: f64) {
        let mark = ctx.node.domain.mark();
        self.visit(ctx, saved_tree, Some(0), (0, bound));
        ctx.propagator.touch(ctx.node.domain.changed_since(mark));
        ctx.node.domain.undo_to(mark);
    }

    /// Whether relaxing sides might make open parts smaller.
    fn has_more_to_relax(&self) -> bool {
        self.left && !self.parts.is_empty()
    }

    /// Goes through the subtree below a node of the earlier tree, within the present domain.
    ///
    /// # Arguments
    ///
    /// * `earlier`: the node's name in the earlier tree, if it was there; `id`: its name now.
    fn visit(
        &mut self,
        ctx: &mut Context<'_>,
        saved_tree: &SavedTree,
        earlier: Option<u32>,
        (id, bound): (u32, f64),
    ) {
        let (length, open) = (self.path.len(), self.parts.len());
        let mut split = SavedSplit { id, ..SavedSplit::default() };
        let relaxes = self.relaxes;
        let top = self.go_down(ctx, saved_tree, earlier, bound, &mut split);
        self.relaxes = relaxes;
        let Some(top) = top else {
            self.closed = true;
            self.path.truncate(length);
            self.splits.push(split);
            return;
        };
        if self.parts.len() > open + 1 {
            self.crowded.extend(earlier);
            self.parts.truncate(open);
            (split.chain, split.rest) = (Vec::new(), None);
            let (path, multipliers) = (self.path[..top].to_vec(), ctx.node.multipliers.clone());
            self.parts.push(OpenPart { path, bound, id, multipliers });
        }
        self.path.truncate(length);
        self.splits.push(split);
    }

    /// Goes down to the ends below a node of the earlier tree. Returns the length of the path to
    /// the node, with the decisions from closed sides; `None` if nothing is left of the node.
    fn go_down(
        &mut self,
        ctx: &mut Context<'_>,
        saved_tree: &SavedTree,
        mut earlier: Option<u32>,
        bound: f64,
        split: &mut SavedSplit,
    ) -> Option<usize> {
        let own = earlier;
        loop {
            let earlier_split = earlier.and_then(|node| Some((node, saved_tree.split(node)?)));
            let Some((node, earlier_split)) =
                earlier_split.filter(|_| self.path.len() < MOST_DECISIONS && !ctx.token.is_over())
            else {
                return self.end(ctx, saved_tree, earlier, (split.id, bound));
            };
            self.close_sides(ctx, saved_tree, (node, &earlier_split.closed), split)?;
            let (top, mut next) = (self.path.len(), earlier_split.rest);
            let relaxes = self.relaxes;
            // What is below a crowded node is not kept.
            self.relaxes &= own.is_none_or(|own| !self.crowded.contains(&own));
            for &(decision, child) in &earlier_split.chain {
                match Relation::of(ctx, &decision) {
                    Relation::Holds => {
                        next = Some(child);
                        break;
                    }
                    Relation::Fails => {}
                    Relation::Open => {
                        let id = ctx.tree.new_id();
                        split.chain.push((decision, id));
                        let (mark, length) = (ctx.node.domain.mark(), self.path.len());
                        if self.add(ctx, decision) {
                            self.visit(ctx, saved_tree, Some(child), (id, bound));
                        } else {
                            self.closed = true;
                        }
                        self.path.truncate(length);
                        ctx.node.domain.undo_to(mark);
                        if !self.add(ctx, opposite(decision)) {
                            self.closed = true;
                            return Some(top);
                        }
                    }
                }
            }
            if !split.chain.is_empty() {
                let id = ctx.tree.new_id();
                split.rest = Some(id);
                self.visit(ctx, saved_tree, next, (id, bound));
                return Some(top);
            }
            self.relaxes = relaxes;
            if next.is_none() {
                return self.end(ctx, saved_tree, None, (split.id, bound));
            }
            earlier = next;
        }
    }

    /// Tries to close an end of the earlier tree again. Returns the length of the path to it if it
    /// stays open, `None` if it is closed.
    fn end(
        &mut self,
        ctx: &mut Context<'_>,
        saved_tree: &SavedTree,
        earlier: Option<u32>,
        (id, mut bound): (u32, f64),
    ) -> Option<usize> {
        let mut multipliers = ctx.node.multipliers.clone();
        let before = earlier.map(End::Node);
        let saved = before.and_then(|end| saved_tree.of(end));
        match self.retry(ctx, saved_tree, (before, End::Node(id))) {
            ProofTrial::Closed => return None,
            ProofTrial::Bound(proved) if proved > bound => {
                (bound, multipliers) = (proved, saved.cloned());
            }
            _ => {}
        }
        self.parts.push(OpenPart { path: self.path.clone(), bound, id, multipliers });
        Some(self.path.len())
    }

    /// Closes the sides that were closed in the earlier tree, by their old multipliers or by
    /// relaxations. Returns `None` if that leaves nothing of the node.
    fn close_sides(
        &mut self,
        ctx: &mut Context<'_>,
        saved_tree: &SavedTree,
        (node, sides): (u32, &[Decision]),
        split: &mut SavedSplit,
    ) -> Option<()> {
        let mut left: Vec<Decision> = sides.to_vec();
        for relaxes in [false, true] {
            if relaxes && !self.relaxes {
                self.left |= left.iter().any(|side| self.fractional[side.column]);
                break;
            }
            let mut kept = 0;
            for k in 0..left.len() {
                let side = left[k];
                if !matches!(Relation::of(ctx, &side), Relation::Open) || ctx.token.is_over() {
                    continue;
                }
                let mark = ctx.node.domain.mark();
                ctx.node.domain.apply(side.column, side.is_upper, side.value);
                let closes = propagate_since(ctx, mark).is_err() || {
                    let (before, now) = (End::Side(node, side), End::Side(split.id, side));
                    let tried = self.retry(ctx, saved_tree, (Some(before), now));
                    matches!(tried, ProofTrial::Closed)
                        || (relaxes && self.fractional[side.column] && self.relax(ctx, now))
                };
                ctx.node.domain.undo_to(mark);
                if !closes {
                    left[kept] = side;
                    kept += 1;
                    continue;
                }
                self.closed = true;
                split.closed.push(side);
                if !self.add(ctx, opposite(side)) {
                    return None;
                }
            }
            left.truncate(kept);
        }
        Some(())
    }

    /// Tries the multipliers of an earlier end on the domain, and keeps them for the end `now` if
    /// they hold.
    fn retry(
        &mut self,
        ctx: &mut Context<'_>,
        saved_tree: &SavedTree,
        (before, now): (Option<End>, End),
    ) -> ProofTrial {
        let saved = before.and_then(|end| Some((end, saved_tree.of(end)?)));
        let Some((before, multipliers)) = saved.filter(|_| !ctx.token.is_over()) else {
            return ProofTrial::Nothing;
        };
        if self.known.contains(&before.key()) {
            self.keep((before, now), multipliers);
            return ProofTrial::Closed;
        }
        let Some(reduced) = reduce_node(ctx) else { return ProofTrial::Closed };
        let activity = ctx.clock.switch(Activity::Proof);
        let cutoff = ctx.tree.cutoff();
        let tried = multipliers.prove(&reduced, cutoff, ctx.cascade.prover(), &mut self.picked);
        ctx.clock.switch(activity);
        ctx.cascade.reducer().reuse(reduced);
        if let ProofTrial::Closed = tried {
            self.keep((before, now), multipliers);
        }
        tried
    }

    /// Keeps multipliers that have closed an end again.
    fn keep(&mut self, (before, now): (End, End), multipliers: &Arc<ProofMultipliers>) {
        self.proved += 1;
        self.known.insert(before.key());
        self.duals.push(SavedDuals::new(now, multipliers.clone()));
    }

    /// Whether the relaxation of the domain closes an end; keeps its multipliers if it does.
    fn relax(&mut self, ctx: &mut Context<'_>, end: End) -> bool {
        let Some(reduced) = reduce_node(ctx) else { return true };
        let mut projection = project_reduced(ctx, reduced);
        let (verdict, multipliers) = relax_and_keep(ctx, &mut projection, Purpose::Trial);
        ctx.cascade.reducer().reuse_projection(projection);
        let closes = match verdict {
            RelaxationVerdict::Refuted(_) => true,
            RelaxationVerdict::Relaxed { bound, .. } => {
                ctx.tree.strengthen(bound) >= ctx.tree.cutoff()
            }
            RelaxationVerdict::Stopped | RelaxationVerdict::Descent => false,
        };
        ctx.cascade.reuse(verdict);
        if closes {
            ctx.tree.count(|s| s.closed_by_trials += 1);
            self.duals.extend(multipliers.map(|multipliers| SavedDuals::new(end, multipliers)));
        }
        closes
    }

    /// Adds a decision to the path and the domain; `false` if that is a contradiction.
    fn add(&mut self, ctx: &mut Context<'_>, decision: Decision) -> bool {
        let mark = ctx.node.domain.mark();
        if ctx.node.apply_if_news(&decision) {
            self.path.push(decision);
        }
        propagate_since(ctx, mark).is_ok()
    }
}

/// The relation of a decision to the domain.
enum Relation {
    Holds,
    Fails,
    Open,
}

impl Relation {
    fn of(ctx: &Context<'_>, decision: &Decision) -> Self {
        let [lower, upper] = ctx.node.domain.bounds(decision.column);
        let (holds, fails) = match decision.is_upper {
            true => (upper <= decision.value, lower > decision.value),
            false => (lower >= decision.value, upper < decision.value),
        };
        match (holds, fails) {
            (true, _) => Relation::Holds,
            (_, true) => Relation::Fails,
            _ => Relation::Open,
        }
    }
}
