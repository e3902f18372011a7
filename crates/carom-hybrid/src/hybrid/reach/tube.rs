//! The tube of one horizon: what a plan with exactly that many steps can do at each of them.

use std::sync::Arc;

use super::compiled::Compiled;
use super::graph::Graph;
use super::set::{Layers, ReachSet};
use super::sets::{ReachSets, Shared, add, of_node};
use super::step::{arrive, predecessors, predict, prediction_boxes};
use super::words::Words;
use crate::error::Error;
use crate::hybrid::horizon::check_steps;
use crate::interval::Interval;
use crate::solver::{StopToken, uninterrupted};

/// The largest number of sweeps over the horizon, forward and backward alternately.
const MOST_SWEEPS: usize = 4;

/// Number of steps after which a sweep checks the stop token.
const STOP_EVERY: usize = 64;

/// The states and transitions that reach sets leave possible for plans over exactly τ steps.
///
/// A tube combines forward and backward sets: a transition is possible in a step if it leads from a
/// state that can be reached to one from which the goal can be reached in the remaining steps. What
/// a tube excludes is in no plan; this is a proof.
///
/// ```
/// use carom::hybrid::reach::{ReachSets, SetOptions};
/// use carom::prelude::*;
///
/// // From 10 m to 0.3 m, rest to rest, over a plastic wall at 0 m.
/// let mut vehicle = HybridSystem::new(0.05); // s
/// let x = vehicle.state("x", 0.0, 50.0)?; // m
/// let v = vehicle.state("v", -15.0, 15.0)?; // m/s
/// let a = vehicle.input("a", -6.0, 6.0)?; // m/s²
/// vehicle.rates([x.is(v), v.is(a)])?;
/// vehicle.mode("flight")?.guard(x.predicted().ge(0.0))?;
/// vehicle
///     .event("impact")?
///     .guard(x.predicted().le(0.0))?
///     .guard(v.predicted().le(0.0))?
///     .reset([x.is(0.0), v.is(0.0)])?;
/// let at_rest = |at: f64| [x.equals(at), v.equals(0.0)];
/// let mut sets = ReachSets::new(&vehicle, at_rest(10.0), at_rest(0.3), SetOptions::default())?;
///
/// assert!(sets.tube(45)?.is_empty()); // no plan has 45 steps
/// let tube = sets.tube(46)?;
/// let steps: Vec<usize> = (0..46).filter(|&t| tube.is_possible(t, 1)).collect();
/// assert_eq!(steps, [36]); // the only step in which it may hit the wall
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tube {
    pub(super) system: Arc<Compiled>,
    pub(super) graph: Arc<Graph>,
    pub(super) words: Arc<Words>,
    steps: usize,
    /// Sets of the samples, by modes and by events so far.
    pub(super) forward: Vec<Shared>,
    /// Sets by remaining steps and by modes and events to come, as far as they were computed before
    /// the tube became empty.
    pub(super) backward: Vec<Shared>,
    /// Per step and transition, whether it is possible.
    possible: Vec<Vec<bool>>,
    /// Per sample and node, whether it is possible.
    nodes: Vec<Vec<bool>>,
    /// Per step and transition, the box around its predictions, if it is possible.
    predictions: Vec<Vec<Option<Vec<Interval>>>>,
    /// Per sample, the box around the states.
    boxes: Vec<Vec<Interval>>,
    /// Both in the user's units, if the sets are in others.
    stated_predictions: Option<Vec<Vec<Option<Vec<Interval>>>>>,
    stated_boxes: Option<Vec<Vec<Interval>>>,
    /// The first sample that no plan reaches.
    died: Option<usize>,
}

/// The remaining edges of the graph of (step, events so far, edge), and of the same graph by events
/// to come.
#[derive(Clone)]
struct Edges {
    edges: usize,
    layers: usize,
    alive: Vec<bool>,
}

impl Edges {
    fn all(steps: usize, graph: &Graph) -> Self {
        let (edges, layers) = (graph.edges.len(), graph.events + 1);
        Edges { edges, layers, alive: vec![true; steps * layers * edges] }
    }

    fn at(&self, step: usize, layer: usize, edge: usize) -> usize {
        (step * self.layers + layer) * self.edges + edge
    }

    fn row(&self, step: usize) -> &[bool] {
        let width = self.layers * self.edges;
        &self.alive[step * width..(step + 1) * width]
    }

    /// Whether an edge remains in a step, in any layer.
    fn any(&self, step: usize, edge: usize) -> bool {
        (0..self.layers).any(|layer| self.alive[self.at(step, layer, edge)])
    }

    /// Ends all sets from a step on.
    fn end(&mut self, step: usize) {
        let first = self.at(step, 0, 0).min(self.alive.len());
        self.alive[first..].fill(false);
    }
}

impl ReachSets {
    /// The tube of plans over exactly `steps` steps.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for no steps or more than
    /// [`tolerance::MAX_STEPS`](crate::tolerance::MAX_STEPS).
    pub fn tube(&mut self, steps: usize) -> Result<Tube, Error> {
        uninterrupted(|token| self.tube_until(steps, token))
    }

    /// Same as [`tube`](ReachSets::tube), but `None` if the token is over before the end.
    pub(crate) fn tube_until(
        &mut self,
        steps: usize,
        token: &StopToken,
    ) -> Result<Option<Tube>, Error> {
        check_steps("the number of steps of a tube", steps)?;
        for reached in (0..=steps).step_by(STOP_EVERY) {
            if token.is_over() {
                return Ok(None);
            }
            self.forward_layers(reached)?;
        }
        let graph = Arc::clone(&self.graph);
        let system = Arc::clone(self.sample(usize::MAX));
        let mut tube = Tube {
            steps,
            forward: self.forward_sets(steps)?,
            backward: vec![self.goal_layers(steps)],
            possible: Vec::new(),
            nodes: Vec::new(),
            predictions: vec![vec![None; system.transitions.len()]; steps],
            boxes: Vec::new(),
            stated_predictions: None,
            stated_boxes: None,
            died: None,
            system,
            graph,
            words: Arc::clone(&self.options.words),
        };
        let mut ahead = Edges::all(steps, &tube.graph);
        let mut back = Edges::all(steps, &tube.graph);
        if !self.may_finish(steps)? {
            tube.died = Some(steps);
            return Ok(Some(tube));
        }
        // A sweep begins at the first step that the sweep in the other direction changed.
        let mut to = steps;
        for sweep in 1..=MOST_SWEEPS {
            let before = back.clone();
            match self.sweep_backward(&mut tube, &mut back, &ahead, to, token) {
                Some(true) => {}
                Some(false) => break,
                None => return Ok(None),
            }
            let from = match sweep {
                1 => 0,
                _ => match (0..steps).find(|&t| before.row(t) != back.row(t)) {
                    Some(first) => first,
                    None => break,
                },
            };
            let before = ahead.clone();
            match self.sweep_forward(&mut tube, &mut ahead, &back, from, token) {
                // With at most one open event, another sweep gains nothing.
                Some(true) if self.gains(&ahead, steps) => {}
                Some(_) => break,
                None => return Ok(None),
            }
            match (0..steps).rfind(|&t| before.row(t) != ahead.row(t)) {
                Some(last) => to = last + 1,
                None => break,
            }
        }
        tube.finish(&ahead);
        Ok(Some(tube))
    }

    /// Whether another sweep may gain something: if there are modes, or an event is possible in
    /// more than one step.
    fn gains(&self, edges: &Edges, steps: usize) -> bool {
        let is_event = |edge: usize| {
            let taken = self.graph.edges[edge].taken;
            self.sample(usize::MAX).joint_transitions[taken].events > 0
        };
        let open = |t: &usize| (0..edges.edges).any(|k| is_event(k) && edges.any(*t, k));
        self.graph.nodes() > 1 || (0..steps).filter(open).count() > 1
    }

    /// Propagates the start forward along the remaining edges and keeps those that meet the
    /// backward sets. Begins at the first changed step. Returns whether the goal is reached, or
    /// `None` if the token is over.
    fn sweep_forward(
        &self,
        tube: &mut Tube,
        ahead: &mut Edges,
        back: &Edges,
        from: usize,
        token: &StopToken,
    ) -> Option<bool> {
        let graph = Arc::clone(&self.graph);
        let mut forward = std::mem::take(&mut tube.forward);
        forward.truncate(from + 1);
        for t in from..tube.steps {
            if t.is_multiple_of(STOP_EVERY) && token.is_over() {
                return None;
            }
            tube.predictions[t].fill(None);
            let (system, after) = (Arc::clone(self.system_at(t)), self.sample(t + 1));
            let to_go = Arc::clone(&tube.backward[tube.steps - t - 1]);
            let mut next: Layers = vec![None; graph.layers()];
            for (layer, set) in forward[t].iter().enumerate() {
                let (node, events) = graph.node_and_events(layer);
                for &k in &graph.leaving[node] {
                    let edge = &graph.edges[k];
                    let at = ahead.at(t, events, k);
                    let alive = ahead.alive[at] && back.any(t, k);
                    let total = graph.sum(events, system.joint_transitions[edge.taken].events);
                    let set = set.as_ref().filter(|_| alive);
                    let image = set.zip(total).and_then(|(set, total)| {
                        let predicted = predict(&system, edge.taken, set).ok()?;
                        let image = arrive(&system, after, edge.taken, &predicted).ok()?;
                        let goals = of_node(&graph, &to_go, edge.to);
                        let mut goals = goals.filter(|(to_come, _)| graph.fits(total, *to_come));
                        let target = graph.layer(edge.to, total);
                        goals
                            .any(|(_, goal)| image.meets(goal))
                            .then_some((set, predicted, image, target))
                    });
                    ahead.alive[at] = image.is_some();
                    if let Some((set, predicted, image, target)) = image {
                        for (m, found) in prediction_boxes(&system, edge.taken, set, &predicted) {
                            widen(&mut tube.predictions[t][m], found);
                        }
                        add(&mut next[target], image);
                    }
                }
            }
            self.finish(&mut next);
            if next.iter().all(Option::is_none) {
                tube.died = Some(t + 1);
                ahead.end(t + 1);
                tube.forward = forward;
                return Some(false);
            }
            forward.push(Arc::new(next));
        }
        tube.forward = forward;
        Some(true)
    }

    /// Propagates the goal backward along the edges that remain in both directions. Begins at the
    /// last changed step. Returns whether the start is reached, or `None` if the token is over.
    fn sweep_backward(
        &self,
        tube: &mut Tube,
        back: &mut Edges,
        ahead: &Edges,
        to: usize,
        token: &StopToken,
    ) -> Option<bool> {
        let graph = Arc::clone(&self.graph);
        let mut backward = std::mem::take(&mut tube.backward);
        backward.truncate(tube.steps - to + 1);
        for to_go in tube.steps - to + 1..=tube.steps {
            let t = tube.steps - to_go;
            if t.is_multiple_of(STOP_EVERY) && token.is_over() {
                return None;
            }
            let system = Arc::clone(self.system_at(t));
            let mut next: Layers = vec![None; graph.layers()];
            for (layer, set) in backward[to_go - 1].iter().enumerate() {
                let (node, events) = graph.node_and_events(layer);
                // Several edges may take the same joint transition to this node.
                let mut known: Vec<Option<Option<ReachSet>>> =
                    vec![None; system.joint_transitions.len()];
                for &k in &graph.entering[node] {
                    let edge = &graph.edges[k];
                    let at = back.at(t, events, k);
                    let alive = back.alive[at] && ahead.any(t, k);
                    let total = graph.sum(events, system.joint_transitions[edge.taken].events);
                    let set = set.as_ref().filter(|_| alive);
                    let before = set.zip(total).and_then(|(set, total)| {
                        let before = known[edge.taken]
                            .get_or_insert_with(|| predecessors(&system, edge.taken, set).ok());
                        let before = before.as_ref()?;
                        let mut reached = of_node(&graph, &tube.forward[t], edge.from)
                            .filter(|(so_far, _)| graph.fits(*so_far, total));
                        let target = graph.layer(edge.from, total);
                        let meets = reached.any(|(_, start)| before.meets(start));
                        meets.then(|| (before.clone(), target))
                    });
                    back.alive[at] = before.is_some();
                    if let Some((before, target)) = before {
                        add(&mut next[target], before);
                    }
                }
            }
            self.finish(&mut next);
            if next.iter().all(Option::is_none) {
                tube.died = Some(t);
                tube.backward = backward;
                return Some(false);
            }
            backward.push(Arc::new(next));
        }
        tube.backward = backward;
        Some(true)
    }
}

/// Enlarges a box to contain some predictions.
fn widen(around: &mut Option<Vec<Interval>>, found: Vec<Interval>) {
    *around = Some(match around.take() {
        Some(present) => hull(&present, &found),
        None => found,
    });
}

fn hull(a: &[Interval], b: &[Interval]) -> Vec<Interval> {
    a.iter().zip(b).map(|(a, b)| a.hull(*b)).collect()
}

impl Tube {
    fn finish(&mut self, edges: &Edges) {
        let (count, graph) = (self.system.transitions.len(), Arc::clone(&self.graph));
        self.nodes = vec![vec![false; graph.nodes()]; self.steps + 1];
        for t in 0..self.steps {
            let mut possible = vec![false; count];
            for (k, edge) in graph.edges.iter().enumerate() {
                if edges.any(t, k) {
                    let members = &self.system.joint_transitions[edge.taken].members;
                    members.iter().chain(&self.system.relaxed).for_each(|&m| possible[m] = true);
                    self.nodes[t][edge.from] = true;
                    self.nodes[t + 1][edge.to] = true;
                }
            }
            self.possible.push(possible);
        }
        if self.died.is_some() {
            return;
        }
        let around = |layers: &Layers, node: usize| -> Option<Vec<Interval>> {
            let boxes = of_node(&graph, layers, node).map(|(_, set)| set.own_box());
            boxes.reduce(|a, b| hull(&a, &b))
        };
        for t in 0..=self.steps {
            let one = |node: usize| -> Option<Vec<Interval>> {
                let ahead = around(&self.forward[t], node)?;
                let back = around(&self.backward[self.steps - t], node)?;
                Some(ahead.iter().zip(&back).map(|(a, b)| a.intersection(*b)).collect())
            };
            let is_met = |ranges: &Vec<Interval>| {
                graph.nodes() == 1 || ranges.iter().all(|range| range.lower <= range.upper)
            };
            let boxes = (0..graph.nodes()).filter_map(one).filter(is_met);
            let Some(found) = boxes.reduce(|a, b| hull(&a, &b)) else {
                self.died = Some(t);
                return;
            };
            self.boxes.push(self.system.margins.widened(&found));
        }
        if !self.system.coordinates.is_plain() {
            let stated = |own: &Vec<Interval>| self.system.stated_ranges(own);
            self.stated_boxes = Some(self.boxes.iter().map(stated).collect());
            let row = |row: &Vec<Option<Vec<Interval>>>| {
                row.iter().map(|own| own.as_ref().map(stated)).collect()
            };
            self.stated_predictions = Some(self.predictions.iter().map(row).collect());
        }
    }

    /// Whether a plan may be in a mode of a choice with memory at a sample; `false` is a proof that
    /// none is. `false` for names that do not exist.
    pub fn is_mode_possible(&self, sample: usize, choice: &str, mode: &str) -> bool {
        let Some(nodes) = self.nodes.get(sample).filter(|_| !self.is_empty()) else {
            return false;
        };
        let has = |node: usize| {
            self.graph.modes(node).iter().any(|(own, at)| own == choice && at == mode)
        };
        let is_followed =
            (0..nodes.len()).any(|n| self.graph.modes(n).iter().any(|m| m.0 == choice));
        match is_followed {
            true => nodes.iter().enumerate().any(|(node, &alive)| alive && has(node)),
            // All modes of the choice share sets.
            false => self.graph.modes_of(choice).any(|at| at == mode),
        }
    }

    /// The horizon, in steps.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Whether it is proved that there is no plan.
    pub fn is_empty(&self) -> bool {
        self.died.is_some()
    }

    /// The first sample that no plan reaches, if the tube is empty.
    pub fn died(&self) -> Option<usize> {
        self.died
    }

    /// Whether a plan may take a transition (by its number in the system) in a step; `false` is a
    /// proof that none does. `false` for numbers that do not exist.
    pub fn is_possible(&self, step: usize, transition: usize) -> bool {
        let row = self.possible.get(step).filter(|_| !self.is_empty());
        row.and_then(|row| row.get(transition)).copied().unwrap_or(false)
    }

    /// The box around the states that plans can have at a sample, one interval per state, in the
    /// states' units. `None` if the tube is empty or has no such sample.
    pub fn bounds(&self, sample: usize) -> Option<&[Interval]> {
        let boxes = self.stated_boxes.as_ref().unwrap_or(&self.boxes);
        boxes.get(sample).filter(|_| !self.is_empty()).map(Vec::as_slice)
    }

    /// The same in the coordinates of the sets.
    pub(super) fn own_bounds(&self, sample: usize) -> Option<&[Interval]> {
        self.boxes.get(sample).filter(|_| !self.is_empty()).map(Vec::as_slice)
    }

    /// The box around the predictions of a transition in a step, before its reset, in the states'
    /// units. `None` if the transition is not possible.
    pub fn predictions(&self, step: usize, transition: usize) -> Option<&[Interval]> {
        let boxes = self.stated_predictions.as_ref().unwrap_or(&self.predictions);
        boxes.get(step).filter(|_| !self.is_empty())?.get(transition)?.as_deref()
    }

    /// The same in the coordinates of the sets.
    pub(super) fn own_predictions(&self, step: usize, transition: usize) -> Option<&[Interval]> {
        let row = self.predictions.get(step).filter(|_| !self.is_empty())?;
        row.get(transition)?.as_deref()
    }

    /// For drawing: the states that can be reached by transitions that may lead to the goal, one
    /// set for each number of events so far. They are not intersected with the backward sets.
    pub fn reached(&self, sample: usize) -> impl Iterator<Item = &ReachSet> {
        self.forward.get(sample).into_iter().flat_map(|layers| layers.iter().flatten())
    }

    /// The states at a sample from which the goal can be reached in the remaining steps.
    pub fn to_go(&self, sample: usize) -> impl Iterator<Item = &ReachSet> {
        let to_go = self.steps.checked_sub(sample).and_then(|s| self.backward.get(s));
        to_go.into_iter().flat_map(|layers| layers.iter().flatten())
    }

    /// Proved lower bound of the number of events of a plan. `None` if the tube is empty.
    pub fn fewest_events(&self) -> Option<usize> {
        let last = self.forward.get(self.steps).filter(|_| !self.is_empty())?;
        let events = |layer: usize| self.graph.node_and_events(layer).1;
        last.iter().enumerate().filter(|(_, set)| set.is_some()).map(|(k, _)| events(k)).min()
    }

    /// Proved upper bound of the number of events of a plan. `None` if it is not known or the tube
    /// is empty.
    pub fn most_events(&self) -> Option<usize> {
        let last = self.forward.get(self.steps).filter(|_| !self.is_empty())?;
        let events = |layer: usize| self.graph.node_and_events(layer).1;
        let reached = last.iter().enumerate().filter(|(_, set)| set.is_some());
        let most = reached.map(|(layer, _)| events(layer)).max()?;
        (most < self.graph.events || self.graph.is_limited).then_some(most)
    }
}
