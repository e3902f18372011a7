//! Layered reach sets, forward from the starts and backward from the goals.

use std::sync::Arc;

use super::compiled::{Compiled, Source};
use super::graph::Graph;
use super::joint_transitions::JointTransitions;
use super::margins::Margins;
use super::options::SetOptions;
use super::set::{Emptied, Layers, ReachSet, closed};
use super::step::{predecessors, successors};
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::horizon::check_steps;
use crate::hybrid::system::{
    Approximation, Coordinates, HybridSystem, IntoRegion, NormLimit, Region, Restated, check_ends,
};
use crate::interval::Interval;
#[cfg(doc)]
use crate::tolerance;

pub(super) type Shared = Arc<Layers>;

/// Reach sets of a hybrid system: forward from a set of starts, by the number of steps done, and
/// backward from a set of goals, by the number of steps to go.
///
/// Forward sets do not depend on the horizon and backward sets only on the time to go, so one
/// object serves every horizon. Sets are computed on first use.
///
/// ```
/// use carom::hybrid::reach::{ReachSets, SetOptions};
/// use carom::prelude::*;
///
/// // One metre from rest to rest with at most 1 m/s², in steps of 0.1 s.
/// let mut push = HybridSystem::new(0.1); // s
/// let x = push.state("x", -9.0, 9.0)?; // m
/// let v = push.state("v", -9.0, 9.0)?; // m/s
/// let a = push.input("a", -1.0, 1.0)?; // m/s²
/// push.mode("flight")?.rates([x.is(v), v.is(a)])?;
/// let at_rest = |at: f64| [x.equals(at), v.equals(0.0)];
/// let mut sets = ReachSets::new(&push, at_rest(0.0), at_rest(1.0), SetOptions::default())?;
///
/// assert!(!sets.may_finish(19)?); // proved: 19 steps are too few
/// assert!(sets.may_finish(20)?);
/// let halfway = sets.forward(10)?.remove(0).expect("there is always a state without an event");
/// assert!((halfway.support(&[1.0, 0.0])? - 0.5).abs() < 1e-4);
/// assert!(!halfway.contains(&[0.6, 0.0])?);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ReachSets {
    /// The system at each step, up to the one from which on nothing changes.
    compiled: Vec<Arc<Compiled>>,
    /// The first step with its own inputs, if these are given.
    first: Option<Arc<Compiled>>,
    joint_transitions: JointTransitions,
    pub(super) graph: Arc<Graph>,
    source: HybridSystem,
    /// The system with norms, in its own coordinates.
    pub(super) computed: HybridSystem,
    /// The system as it is stated, if that is not the same.
    stated: Option<Arc<HybridSystem>>,
    pub(super) coordinates: Arc<Coordinates>,
    /// Magnitudes of the states at the start and the goal.
    pub(super) sizes: Vec<f64>,
    ends: (Region, Region),
    first_inputs: Option<Vec<Interval>>,
    pub(super) options: SetOptions,
    margins: Margins,
    norm_excess: f64,
    forward: Vec<Shared>,
    backward: Vec<Shared>,
    /// From this step on, the forward sets no longer grow.
    settled: Option<usize>,
    /// The step after which all forward sets are empty, and what emptied them.
    pub(super) emptied: Option<(usize, Vec<Emptied>)>,
}

impl ReachSets {
    /// Prepares the sets of a system.
    ///
    /// # Arguments
    ///
    /// * `start`, `goal`: rows of states and modes, or a [`Region`].
    ///
    /// # Errors
    ///
    /// [`HybridSystem::check`]; [`ErrorKind::Length`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::CrossedBounds`], [`ErrorKind::UnknownName`] for a bad start or goal;
    /// [`ErrorKind::OutOfRange`] for bad options and for numbers of 1e20 and more in magnitude.
    pub fn new(
        system: &HybridSystem,
        start: impl IntoRegion,
        goal: impl IntoRegion,
        options: SetOptions,
    ) -> Result<Self, Error> {
        let (start, goal) = (start.stated().of(system)?, goal.stated().of(system)?);
        system.check()?;
        options.check(system.states.len())?;
        ReachSets::in_coordinates(system, Coordinates::of(system), [&start, &goal], options)
    }

    /// The sets of a checked system, computed in some coordinates.
    pub(crate) fn in_coordinates(
        system: &HybridSystem,
        coordinates: Coordinates,
        [start, goal]: [&Region; 2],
        options: SetOptions,
    ) -> Result<Self, Error> {
        start.check(system, "the start")?;
        goal.check(system, "the goal")?;
        let (start, goal) = (coordinates.region(start), coordinates.region(goal));
        let stated = (!coordinates.is_plain()).then(|| Arc::new(system.clone()));
        let own = Restated { system: coordinates.system(system)?, coordinates };
        Ok(ReachSets::restated(stated, own, start, goal, options))
    }

    /// The sets of a system in coordinates, with a start, a goal and options in them.
    pub(crate) fn restated(
        stated: Option<Arc<HybridSystem>>,
        restated: Restated,
        start: Region,
        goal: Region,
        options: SetOptions,
    ) -> Self {
        let Restated { system, coordinates } = restated;
        let (system, coordinates) = (&system, Arc::new(coordinates));
        // Sets have polygons for norms.
        let around = system.polyhedral(Approximation::Outer);
        let norms = system.all_norms().chain(&start.norms).chain(&goal.norms);
        let norm_excess = norms.map(NormLimit::excess).fold(0.0, f64::max);
        let computed = system.clone();
        let (system, start, goal) = (&around, start.polyhedral(), goal.polyhedral());
        let (from, to) = (closed(&system.states, &start), closed(&system.states, &goal));
        let sizes = from.iter().zip(&to).map(|(a, b)| a.magnitude().max(b.magnitude()));
        let joint_transitions = JointTransitions::new(system, &options.exclusive);
        let graph = Graph::new(system, &joint_transitions, options.events, options.layers);
        let mut sets = ReachSets {
            compiled: Vec::new(),
            first: None,
            joint_transitions,
            graph: Arc::new(graph),
            source: system.clone(),
            computed,
            stated,
            coordinates,
            norm_excess,
            sizes: sizes.collect(),
            ends: (start, goal),
            first_inputs: None,
            margins: Margins::new(system, options.margin),
            options,
            forward: Vec::new(),
            backward: Vec::new(),
            settled: None,
            emptied: None,
        };
        sets.compile();
        sets.forward.push(sets.end_layers(0, &sets.ends.0, true));
        sets.backward.push(sets.end_layers(system.settles(), &sets.ends.1, false));
        sets
    }

    /// How far the polygons that stand for norms reach beyond them, at most, relative to the
    /// bounds; 0 without norms. A polygon around a disc has 16 sides and reaches `1/cos(π/16) - 1`,
    /// 2 %, beyond it.
    pub fn norm_excess(&self) -> f64 {
        self.norm_excess
    }

    /// Compiles the system for every step up to the one from which on nothing changes.
    fn compile(&mut self) {
        let mut last: Option<Vec<f64>> = None;
        for step in 0..=self.source.settles() {
            let values = self.source.values_at(step);
            let same = self.compiled.last().filter(|_| last.as_ref() == Some(&values));
            let compiled = match same {
                Some(same) => Arc::clone(same),
                None => Arc::new(self.compiled_at(step, None)),
            };
            self.compiled.push(compiled);
            last = Some(values);
        }
    }

    fn compiled_at(&self, step: usize, given: Option<&[Interval]>) -> Compiled {
        let source = Source {
            system: &self.source,
            coordinates: &self.coordinates,
            joint_transitions: &self.joint_transitions,
            step,
            given,
            options: &self.options,
            ends: [&self.ends.0, &self.ends.1],
            sizes: &self.sizes,
            margins: &self.margins,
        };
        Compiled::new(&source, self.compiled.first().map(Arc::as_ref))
    }

    /// Sets the ranges of the inputs in the first step, in the inputs' units, for a start with a
    /// given input.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`], [`ErrorKind::NotFinite`], [`ErrorKind::CrossedBounds`];
    /// [`ErrorKind::OutOfRange`] for limits of 1e20 and more in magnitude.
    pub fn with_first_inputs(mut self, inputs: &[Interval]) -> Result<Self, Error> {
        check_length("the first step's inputs", inputs.len(), self.source.inputs.len())?;
        for ((name, _), range) in self.source.inputs.iter().zip(inputs) {
            check_ends(name, *range)?;
        }
        let own = inputs.iter().enumerate();
        let own = own.map(|(u, range)| self.coordinates.input(u).inward_range(*range)).collect();
        self.begin_with(own);
        Ok(self)
    }

    /// Sets the ranges of the inputs in the first step, in the coordinates of the sets.
    pub(crate) fn begin_with(&mut self, inputs: Vec<Interval>) {
        self.first = Some(Arc::new(self.compiled_at(0, Some(&inputs))));
        self.first_inputs = Some(inputs);
        self.forward.truncate(1);
        (self.settled, self.emptied) = (None, None);
    }

    /// The system of the sets.
    pub fn system(&self) -> &HybridSystem {
        self.stated.as_deref().unwrap_or(&self.computed)
    }

    /// The options in force.
    pub fn options(&self) -> &SetOptions {
        &self.options
    }

    /// The states that can be reached in exactly `steps` steps, by the number of events on the way;
    /// the last layer has those with that many or more. `None` is the empty set. States in
    /// different modes share sets.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for more than [`tolerance::MAX_STEPS`] steps.
    pub fn forward(&mut self, steps: usize) -> Result<Vec<Option<ReachSet>>, Error> {
        let graph = Arc::clone(&self.graph);
        Ok(by_events(&graph, self.forward_layers(steps)?))
    }

    /// The states that can be reached in exactly `steps` steps, one set for each combination of
    /// [modes](ReachSet::modes), dwell times and [number of events](ReachSet::events) that is told
    /// apart and can be reached.
    ///
    /// # Errors
    ///
    /// As for [`forward`](ReachSets::forward).
    pub fn forward_by_mode(&mut self, steps: usize) -> Result<Vec<ReachSet>, Error> {
        Ok(self.forward_layers(steps)?.iter().flatten().cloned().collect())
    }

    /// The states from which the goal can be reached in exactly `steps` steps, by the number of
    /// events on the way.
    ///
    /// # Errors
    ///
    /// As for [`forward`](ReachSets::forward); [`ErrorKind::Unsupported`] if the system depends on
    /// the step, because then the horizon must be known: use [`Tube::to_go`](super::Tube::to_go).
    pub fn backward(&mut self, steps: usize) -> Result<Vec<Option<ReachSet>>, Error> {
        let graph = Arc::clone(&self.graph);
        Ok(by_events(&graph, self.backward_layers(steps)?))
    }

    /// The states from which the goal can be reached in exactly `steps` steps, by modes, dwell
    /// times and number of events to come, as [`forward_by_mode`](ReachSets::forward_by_mode).
    ///
    /// # Errors
    ///
    /// As for [`backward`](ReachSets::backward).
    pub fn backward_by_mode(&mut self, steps: usize) -> Result<Vec<ReachSet>, Error> {
        Ok(self.backward_layers(steps)?.iter().flatten().cloned().collect())
    }

    /// Whether the goal may be reached in exactly `steps` steps, according to the forward sets;
    /// `false` is a proof that it cannot.
    ///
    /// # Errors
    ///
    /// As for [`forward`](ReachSets::forward).
    pub fn may_finish(&mut self, steps: usize) -> Result<bool, Error> {
        self.forward_layers(steps)?;
        let goal = self.goal_layers(steps);
        let reached = &self.forward[steps.min(self.forward.len() - 1)];
        let graph = &self.graph;
        Ok((0..graph.nodes()).any(|node| {
            let goal = goal.get(graph.layer(node, 0)).and_then(Option::as_ref);
            goal.is_some_and(|goal| of_node(graph, reached, node).any(|(_, set)| set.meets(goal)))
        }))
    }

    /// The number of steps from which the forward sets are known not to grow: a state that cannot
    /// be reached in that many steps can never be reached.
    pub fn settled(&self) -> Option<usize> {
        self.settled
    }

    pub(super) fn forward_layers(&mut self, steps: usize) -> Result<&Layers, Error> {
        check_steps("the number of steps of reach sets", steps.max(1))?;
        while self.forward.len() <= steps && self.settled.is_none() {
            self.extend_forward();
        }
        let at = steps.min(self.forward.len() - 1);
        Ok(&self.forward[at])
    }

    pub(super) fn backward_layers(&mut self, steps: usize) -> Result<&Layers, Error> {
        check_steps("the number of steps of reach sets", steps.max(1))?;
        if self.source.settles() > 0 {
            return Err(ErrorKind::Unsupported {
                solver: "`ReachSets::backward`".into(),
                what: "systems that depend on the step".into(),
                help: "give the horizon and use `ReachSets::tube` and `Tube::to_go`".into(),
            }
            .into());
        }
        while self.backward.len() <= steps {
            self.extend_backward();
        }
        Ok(&self.backward[steps])
    }

    /// The forward sets of the samples 0, ..., `steps`.
    pub(super) fn forward_sets(&mut self, steps: usize) -> Result<Vec<Shared>, Error> {
        self.forward_layers(steps)?;
        let last = self.forward.len() - 1;
        Ok((0..=steps).map(|t| Arc::clone(&self.forward[t.min(last)])).collect())
    }

    /// The start and the goal as given.
    pub(super) fn ends(&self) -> (&Region, &Region) {
        (&self.ends.0, &self.ends.1)
    }

    /// The same task for another system in the same coordinates.
    pub(super) fn of_system(&self, system: &HybridSystem) -> ReachSets {
        let ((start, goal), options) = (self.ends(), self.options.clone());
        let coordinates = Coordinates::clone(&self.coordinates);
        let restated = Restated { system: system.clone(), coordinates };
        let stated = self.stated.clone();
        let mut sets = ReachSets::restated(stated, restated, start.clone(), goal.clone(), options);
        if let Some(inputs) = &self.first_inputs {
            sets.begin_with(inputs.clone());
        }
        sets
    }

    /// A start or goal at a sample, in its modes.
    fn end_layers(&self, sample: usize, region: &Region, is_start: bool) -> Shared {
        let system = self.sample(sample);
        let set = ReachSet::from_region(system, region, &self.sizes, is_start).ok();
        let mut layers = vec![None; self.graph.layers()];
        for node in self.graph.nodes_in(region) {
            layers[self.graph.layer(node, 0)] = set.clone();
        }
        self.graph.label(&mut layers);
        Arc::new(layers)
    }

    /// The goal at a sample.
    pub(super) fn goal_layers(&self, sample: usize) -> Shared {
        match sample >= self.source.settles() {
            true => Arc::clone(&self.backward[0]),
            false => self.end_layers(sample, &self.ends.1, false),
        }
    }

    /// The system at a sample, for its limits.
    pub(super) fn sample(&self, sample: usize) -> &Arc<Compiled> {
        &self.compiled[sample.min(self.compiled.len() - 1)]
    }

    /// The system of a step; the first step may have different inputs.
    pub(super) fn system_at(&self, step: usize) -> &Arc<Compiled> {
        match &self.first {
            Some(first) if step == 0 => first,
            _ => self.sample(step),
        }
    }

    fn extend_forward(&mut self) {
        let step = self.forward.len() - 1;
        let system = Arc::clone(self.system_at(step));
        let after = Arc::clone(self.sample(step + 1));
        let graph = Arc::clone(&self.graph);
        let now = &self.forward[step];
        let mut next: Layers = vec![None; now.len()];
        let mut emptied = Vec::new();
        for (layer, set) in now.iter().enumerate() {
            let Some(set) = set else { continue };
            let (node, events) = graph.node_and_events(layer);
            for &edge in &graph.leaving[node] {
                let edge = &graph.edges[edge];
                let Some(events) = graph.sum(events, system.joint_transitions[edge.taken].events)
                else {
                    continue;
                };
                match successors(&system, &after, edge.taken, set) {
                    Ok(image) => add(&mut next[graph.layer(edge.to, events)], image),
                    Err(reason) => emptied.push(reason),
                }
            }
        }
        self.finish(&mut next);
        let stands = next.iter().zip(now.iter()).all(|(next, now)| match (next, now) {
            (None, _) => true,
            (Some(next), Some(now)) => next.lies_in(now),
            (Some(_), None) => false,
        });
        if step > 0 && step >= self.source.settles() && stands {
            // No growth, so by monotonicity the sets never grow again.
            self.settled = Some(step);
        }
        if next.iter().all(Option::is_none) && self.emptied.is_none() {
            self.emptied = Some((step, emptied));
        }
        self.forward.push(Arc::new(next));
    }

    fn extend_backward(&mut self) {
        let system = Arc::clone(self.sample(usize::MAX));
        let graph = Arc::clone(&self.graph);
        let now = &self.backward[self.backward.len() - 1];
        let mut next: Layers = vec![None; now.len()];
        for (layer, set) in now.iter().enumerate() {
            let Some(set) = set else { continue };
            let (node, events) = graph.node_and_events(layer);
            for &edge in &graph.entering[node] {
                let edge = &graph.edges[edge];
                let events = graph.sum(events, system.joint_transitions[edge.taken].events);
                if let Some(events) = events
                    && let Ok(before) = predecessors(&system, edge.taken, set)
                {
                    add(&mut next[graph.layer(edge.from, events)], before);
                }
            }
        }
        self.finish(&mut next);
        self.backward.push(Arc::new(next));
    }

    /// Simplifies the sets of a sample and labels them.
    pub(super) fn finish(&self, layers: &mut Layers) {
        let most = self.options.vertices;
        layers.iter_mut().flatten().for_each(|set| set.simplify(most));
        self.graph.label(layers);
    }
}

/// The sets of a node, by events.
pub(super) fn of_node<'a>(
    graph: &Graph,
    layers: &'a Layers,
    node: usize,
) -> impl Iterator<Item = (usize, &'a ReachSet)> {
    let first = graph.layer(node, 0);
    let sets = layers[first..=first + graph.events].iter().enumerate();
    sets.filter_map(|(events, set)| Some((events, set.as_ref()?)))
}

/// The hulls of the sets with the same number of events.
fn by_events(graph: &Graph, layers: &Layers) -> Vec<Option<ReachSet>> {
    let mut hulls = vec![None; graph.events + 1];
    for (layer, set) in layers.iter().enumerate() {
        let (_, events) = graph.node_and_events(layer);
        if let Some(set) = set {
            let mut set = set.clone();
            if graph.nodes() > 1 {
                set.label.modes = None;
            }
            add(&mut hulls[events], set);
        }
    }
    hulls
}

pub(super) fn add(layer: &mut Option<ReachSet>, set: ReachSet) {
    *layer = Some(match layer.take() {
        Some(present) => present.join(&set),
        None => set,
    });
}
