//! Nodes of a step: the modes of the choices with memory, and how long they have lasted.
//!
//! States in different nodes are in different sets. A joint transition leads from a node to
//! at most one node. If there are too many sets, some are merged, by which sets only grow: first
//! those that differ in dwell times, the longest ones first, then those that differ in numbers of
//! events, then those of different modes.

use std::sync::Arc;

use super::joint_transitions::JointTransitions;
use super::set::{Label, Layers};
use crate::hybrid::system::{Choice, HybridSystem, Region};

/// How far a choice with memory has got.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Memory {
    /// Number of the choice.
    choice: usize,
    /// Its modes with the limits of their dwell times: least and most, and the number of ages that
    /// are told apart.
    modes: Vec<Dwelling>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Dwelling {
    name: String,
    least: usize,
    most: Option<usize>,
    ages: usize,
}

/// A mode and the number of samples for which it has lasted, per choice with memory.
type Place = Vec<(usize, usize)>;

/// Choices with memory and their modes by name, if there are any.
type Names = Option<Arc<Vec<(String, String)>>>;

/// A joint transition from a node to a node.
#[derive(Debug, Clone)]
pub(super) struct Edge {
    pub(super) from: usize,
    pub(super) to: usize,
    /// Number of the joint transition.
    pub(super) taken: usize,
}

/// Nodes and edges of a system's steps.
#[derive(Debug, Clone)]
pub(super) struct Graph {
    memories: Vec<Memory>,
    nodes: Vec<Place>,
    /// The modes of each node by name, if there are any.
    names: Vec<Names>,
    /// All choices with memory and their modes, followed or not.
    all_modes: Vec<(String, String)>,
    pub(super) edges: Vec<Edge>,
    /// Numbers of the edges that leave a node, and that enter it.
    pub(super) leaving: Vec<Vec<usize>>,
    pub(super) entering: Vec<Vec<usize>>,
    /// Number of events that are told apart; that many and more share a layer.
    pub(super) events: usize,
    /// Whether no run has more events than that.
    pub(super) is_limited: bool,
}

impl Graph {
    /// The graph for at most `layers` sets, of which those by events are `events + 1`.
    pub(super) fn new(
        system: &HybridSystem,
        joint: &JointTransitions,
        events: usize,
        layers: usize,
    ) -> Self {
        let limit = system.most_events.filter(|&most| most <= MOST_EVENTS);
        let mut events = limit.unwrap_or(events);
        let unseen = |m: &usize| system.transitions().nth(*m).is_some_and(|t| t.is_event);
        if joint.relaxed.iter().any(unseen) {
            // Events of choices that are not followed are not counted.
            events = 0;
        }
        let with_memory = system.choices.iter().enumerate().take(joint.followed);
        let with_memory = with_memory.filter(|(_, choice)| !choice.modes().is_empty());
        let mut memories: Vec<Memory> =
            with_memory.map(|(c, choice)| Memory::new(c, choice)).collect();
        while count(&memories).saturating_mul(events + 1) > layers && merge_ages(&mut memories) {}
        while count(&memories) > layers && merge_modes(&mut memories) {}
        events = events.min((layers / count(&memories)).max(1) - 1);
        let is_limited = system.most_events == Some(events) && !joint.relaxed.iter().any(unseen);
        let mut graph = Graph {
            nodes: places(&memories),
            names: Vec::new(),
            all_modes: all_modes(system),
            memories,
            edges: Vec::new(),
            leaving: Vec::new(),
            entering: Vec::new(),
            events,
            is_limited,
        };
        graph.name(system);
        graph.connect(system, joint);
        graph
    }

    fn connect(&mut self, system: &HybridSystem, joint: &JointTransitions) {
        self.leaving = vec![Vec::new(); self.nodes.len()];
        self.entering = vec![Vec::new(); self.nodes.len()];
        for (from, place) in self.nodes.iter().enumerate() {
            for (number, taken) in joint.list.iter().enumerate() {
                let next = self.memories.iter().zip(place).map(|(memory, &at)| {
                    let first = system.first_transition(memory.choice);
                    let choice = &system.choices[memory.choice];
                    let transition = taken.members[memory.choice].checked_sub(first);
                    let transition = transition.and_then(|k| choice.transitions.get(k))?;
                    memory.next(at, transition.modes.as_ref()?)
                });
                let Some(next) = next.collect::<Option<Place>>() else { continue };
                let Some(to) = self.nodes.iter().position(|node| *node == next) else { continue };
                self.leaving[from].push(self.edges.len());
                self.entering[to].push(self.edges.len());
                self.edges.push(Edge { from, to, taken: number });
            }
        }
    }

    pub(super) fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of sets of a sample.
    pub(super) fn layers(&self) -> usize {
        self.nodes.len() * (self.events + 1)
    }

    /// The layer of a node and a number of events.
    pub(super) fn layer(&self, node: usize, events: usize) -> usize {
        node * (self.events + 1) + events
    }

    /// The node and the number of events of a layer.
    pub(super) fn node_and_events(&self, layer: usize) -> (usize, usize) {
        (layer / (self.events + 1), layer % (self.events + 1))
    }

    /// The number of events after some more, or `None` if no run has as many.
    pub(super) fn sum(&self, events: usize, more: usize) -> Option<usize> {
        match events + more {
            sum if sum <= self.events => Some(sum),
            _ if self.is_limited => None,
            _ => Some(self.events),
        }
    }

    /// Whether runs may have so many events before a sample and so many after it.
    pub(super) fn fits(&self, before: usize, after: usize) -> bool {
        !self.is_limited || before + after <= self.events
    }

    fn name(&mut self, system: &HybridSystem) {
        let name = |place: &Place| {
            let named = self.memories.iter().zip(place).map(|(memory, (mode, _))| {
                (system.choices[memory.choice].name.clone(), memory.modes[*mode].name.clone())
            });
            let named: Vec<(String, String)> = named.collect();
            (!named.is_empty()).then(|| Arc::new(named))
        };
        self.names = self.nodes.iter().map(name).collect();
    }

    /// Names of the choices with memory and of a node's modes.
    pub(super) fn modes(&self, node: usize) -> &[(String, String)] {
        self.names[node].as_deref().map_or(&[], Vec::as_slice)
    }

    /// The modes of a choice, followed or not; none without memory.
    pub(super) fn modes_of<'a>(&'a self, choice: &'a str) -> impl Iterator<Item = &'a str> {
        self.all_modes.iter().filter(move |(own, _)| own == choice).map(|(_, mode)| mode.as_str())
    }

    /// Labels the sets of a sample.
    pub(super) fn label(&self, layers: &mut Layers) {
        for (layer, set) in layers.iter_mut().enumerate() {
            if let Some(set) = set {
                let (node, events) = self.node_and_events(layer);
                set.label = Label { events, modes: self.names[node].clone() };
            }
        }
    }

    /// Nodes in the modes of a region.
    pub(super) fn nodes_in(&self, region: &Region) -> Vec<usize> {
        let inside = |node: &usize| {
            self.modes(*node).iter().all(|(choice, mode)| region.allows(choice, mode))
        };
        (0..self.nodes.len()).filter(inside).collect()
    }
}

/// The largest limit on the number of events that is followed.
const MOST_EVENTS: usize = 64;

impl Memory {
    fn new(number: usize, choice: &Choice) -> Self {
        let modes = choice.modes().into_iter().map(|mode| {
            let dwells = || choice.dwells.iter().filter(|dwell| dwell.mode == mode);
            let least = dwells().map(|dwell| dwell.least).max().unwrap_or(1);
            let most = dwells().filter_map(|dwell| dwell.most).min();
            let ages = least.max(most.unwrap_or(1));
            Dwelling { name: mode.to_owned(), least, most, ages }
        });
        Memory { choice: number, modes: modes.collect() }
    }

    /// The mode and its age after a transition between two modes, or `None` if it is not possible.
    fn next(
        &self,
        (mode, age): (usize, usize),
        (from, to): &(String, String),
    ) -> Option<(usize, usize)> {
        let at = &self.modes[mode];
        if at.name != *from {
            return None;
        }
        let is_merged = at.ages < at.least.max(at.most.unwrap_or(1));
        if from == to {
            let lasts = is_merged || at.most.is_none_or(|most| age < most);
            return lasts.then_some((mode, (age + 1).min(at.ages)));
        }
        let may_leave = is_merged || age >= at.least;
        let target = self.modes.iter().position(|mode| mode.name == *to)?;
        may_leave.then_some((target, 1))
    }
}

fn all_modes(system: &HybridSystem) -> Vec<(String, String)> {
    let named = system.choices.iter().flat_map(|choice| {
        choice.modes().into_iter().map(|mode| (choice.name.clone(), mode.to_owned()))
    });
    named.collect()
}

fn count(memories: &[Memory]) -> usize {
    let counts = memories.iter().map(|memory| memory.modes.iter().map(|m| m.ages).sum::<usize>());
    counts.fold(1, usize::saturating_mul)
}

/// Merges the ages of the mode that has the most of them.
fn merge_ages(memories: &mut [Memory]) -> bool {
    let modes = memories.iter_mut().flat_map(|memory| &mut memory.modes);
    match modes.max_by_key(|mode| mode.ages).filter(|mode| mode.ages > 1) {
        Some(mode) => {
            mode.ages = 1;
            true
        }
        None => false,
    }
}

/// Forgets the modes of the choice that has the most of them.
fn merge_modes(memories: &mut Vec<Memory>) -> bool {
    let most = (0..memories.len()).max_by_key(|&k| memories[k].modes.len());
    most.map(|k| memories.remove(k)).is_some()
}

fn places(memories: &[Memory]) -> Vec<Place> {
    let mut places = vec![Vec::new()];
    for memory in memories {
        let modes = memory.modes.iter().enumerate();
        let own: Vec<(usize, usize)> =
            modes.flat_map(|(k, mode)| (1..=mode.ages).map(move |age| (k, age))).collect();
        let extend = |place: &Place| -> Vec<Place> {
            own.iter().map(|at| place.iter().copied().chain([*at]).collect()).collect()
        };
        places = places.iter().flat_map(extend).collect();
    }
    places
}
