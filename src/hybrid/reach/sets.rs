//! Layered reach sets, forward from the starts and backward from the goals.

use std::sync::Arc;

use super::compiled::Compiled;
use super::set::{Emptied, ReachSet};
use super::step::{predecessors, successors};
use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::hybrid::horizon::check_steps;
use crate::hybrid::system::{HybridSystem, check_ends};
use crate::interval::Interval;
use crate::setters::setters;
use crate::tolerance;

/// Options of reach sets.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SetOptions {
    /// Number of layers: states with different numbers of events so far (or to come) are in
    /// different layers, and states with this many or more events share the last layer; `0..=64`,
    /// default 3.
    pub events: usize,
    /// Number of vertices of a polygon beyond which short edges are merged outward; at least 8,
    /// default 512.
    pub vertices: usize,
    /// How much a plan may miss its start, its goal, and every limit, guard and input range, and
    /// still lie in the sets, in SI units; for numbers above 1000, times a thousandth of them;
    /// default [`tolerance::REACH`], from 0 to 1.
    pub margin: f64,
    /// Template directions of sets with other than two states, in addition to the axes, the
    /// diagonals of small blocks and the normals of the limits; one coefficient per state.
    pub directions: Vec<Vec<f64>>,
}

impl Default for SetOptions {
    fn default() -> Self {
        SetOptions { events: 3, vertices: 512, margin: tolerance::REACH, directions: Vec::new() }
    }
}

impl SetOptions {
    setters! {
        /// Sets the number of events that are distinguished.
        with_events(events: usize) => events = events;
        /// Sets the number of vertices beyond which polygons are simplified.
        with_vertices(vertices: usize) => vertices = vertices;
        /// Sets the margin.
        with_margin(margin: f64) => margin = margin;
    }

    /// Adds a template direction.
    #[must_use]
    pub fn with_direction(mut self, direction: impl Into<Vec<f64>>) -> Self {
        self.directions.push(direction.into());
        self
    }

    fn check(&self, states: usize) -> Result<(), Error> {
        let (events, vertices) = (self.events as f64, self.vertices as f64);
        let ranges = [
            ("number of events", events, events <= 64.0, "within [0, 64]"),
            ("number of vertices", vertices, vertices >= 8.0, "at least 8"),
            ("margin", self.margin, (0.0..=1.0).contains(&self.margin), "within [0, 1]"),
        ];
        if let Some((what, value, _, range)) = ranges.into_iter().find(|r| !r.2) {
            return Err(Error::out_of_range(format!("the {what} of reach sets"), value, range));
        }
        for direction in &self.directions {
            check_length("a template direction", direction.len(), states)?;
            check_finite("a template direction", "an entry", direction.iter().copied())?;
        }
        Ok(())
    }
}

/// The sets of one sample, by the number of events; the last layer is "this many or more".
pub(super) type Layers = Vec<Option<ReachSet>>;

pub(super) type Shared = Arc<Layers>;

/// Reach sets of a hybrid system: forward from a set of starts, by the number of steps done, and
/// backward from a set of goals, by the number of steps to go.
///
/// Forward sets do not depend on the horizon and backward sets only on the time to go, so one
/// object serves every horizon. Sets are computed on first use.
///
/// ```
/// use carom::hybrid::reach::{ReachSets, SetOptions};
/// use carom::hybrid::{HybridSystem, LinearSystem, Transition};
/// use carom::interval::Interval;
///
/// // One metre from rest to rest with at most 1 m/s², in steps of 0.1 s.
/// let push = HybridSystem::new()
///     .with_state("x", Interval::new(-9.0, 9.0))
///     .with_state("v", Interval::new(-9.0, 9.0))
///     .with_input("a", Interval::new(-1.0, 1.0))
///     .with_transition(Transition::new("flight", LinearSystem::double_integrator(0.1)?));
/// let at_rest = |x| [Interval::point(x), Interval::point(0.0)];
/// let mut sets = ReachSets::new(&push, &at_rest(0.0), &at_rest(1.0), SetOptions::default())?;
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
    pub(super) system: Arc<Compiled>,
    /// The same with the inputs of the first step, if these differ.
    first: Option<Arc<Compiled>>,
    source: HybridSystem,
    /// Magnitudes of the states at the start and the goal.
    sizes: Vec<f64>,
    ends: (Vec<Interval>, Vec<Interval>),
    first_inputs: Option<Vec<Interval>>,
    pub(super) options: SetOptions,
    forward: Vec<Shared>,
    backward: Vec<Shared>,
    /// From this step on, the forward sets no longer grow.
    settled: Option<usize>,
    /// The step after which all forward sets are empty, and what emptied one of them.
    pub(super) emptied: Option<(usize, Emptied)>,
}

impl ReachSets {
    /// Prepares the sets of a system.
    ///
    /// # Arguments
    ///
    /// * `start`, `goal`: one interval per state, in the state's unit.
    ///
    /// # Errors
    ///
    /// [`HybridSystem::check`]; [`ErrorKind::Length`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::CrossedBounds`] for a bad start or goal; [`ErrorKind::OutOfRange`] for bad
    /// options and for numbers of 1e20 and more in magnitude; [`ErrorKind::Unsupported`] for
    /// systems with several choices, modes with memory, guards or ranges that depend on inputs,
    /// values by step, or a largest number of events.
    pub fn new(
        system: &HybridSystem,
        start: &[Interval],
        goal: &[Interval],
        options: SetOptions,
    ) -> Result<Self, Error> {
        system.check()?;
        check_supported(system)?;
        let states = system.states.len();
        options.check(states)?;
        for (what, ends) in [("the start", start), ("the goal", goal)] {
            check_length(what, ends.len(), states)?;
        }
        let inputs: Vec<Interval> =
            system.inputs.iter().filter_map(|(_, range)| range.get(0).copied()).collect();
        let sizes = start.iter().zip(goal).map(|(a, b)| a.magnitude().max(b.magnitude()));
        let sizes: Vec<f64> = sizes.collect();
        let (margin, further) = (options.margin, &options.directions);
        let compiled = Arc::new(Compiled::new(system, &inputs, margin, &sizes, further));
        let end = |ends| -> Result<Layers, Error> {
            let set = ReachSet::from_box(&compiled, ends, options.margin)?;
            let mut layers = vec![None; options.events + 1];
            layers[0] = set.ok();
            Ok(layers)
        };
        let (forward, backward) = (vec![Arc::new(end(start)?)], vec![Arc::new(end(goal)?)]);
        Ok(ReachSets {
            system: compiled,
            first: None,
            source: system.clone(),
            sizes,
            ends: (start.to_vec(), goal.to_vec()),
            first_inputs: None,
            options,
            forward,
            backward,
            settled: None,
            emptied: None,
        })
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
        let (margin, further) = (self.options.margin, &self.options.directions);
        let compiled = Compiled::new(&self.source, inputs, margin, &self.sizes, further);
        self.first = Some(Arc::new(compiled));
        self.first_inputs = Some(inputs.to_vec());
        self.forward.truncate(1);
        (self.settled, self.emptied) = (None, None);
        Ok(self)
    }

    /// The system of the sets.
    pub fn system(&self) -> &HybridSystem {
        &self.source
    }

    /// The options in force.
    pub fn options(&self) -> &SetOptions {
        &self.options
    }

    /// The states that can be reached in exactly `steps` steps, by the number of events on the way;
    /// the last layer has those with [`SetOptions::events`] or more. `None` is the empty set.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for more than [`tolerance::MAX_STEPS`] steps.
    pub fn forward(&mut self, steps: usize) -> Result<Vec<Option<ReachSet>>, Error> {
        Ok(self.forward_layers(steps)?.clone())
    }

    /// The states from which the goal can be reached in exactly `steps` steps, by the number of
    /// events on the way.
    ///
    /// # Errors
    ///
    /// As for [`forward`](ReachSets::forward).
    pub fn backward(&mut self, steps: usize) -> Result<Vec<Option<ReachSet>>, Error> {
        Ok(self.backward_layers(steps)?.clone())
    }

    /// Whether the goal may be reached in exactly `steps` steps, according to the forward sets;
    /// `false` is a proof that it cannot.
    ///
    /// # Errors
    ///
    /// As for [`forward`](ReachSets::forward).
    pub fn may_finish(&mut self, steps: usize) -> Result<bool, Error> {
        let goal = self.backward[0][0].clone();
        let Some(goal) = goal else { return Ok(false) };
        let layers = self.forward_layers(steps)?;
        Ok(layers.iter().flatten().any(|set| set.meets(&goal)))
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
    pub(super) fn ends(&self) -> (&[Interval], &[Interval]) {
        (&self.ends.0, &self.ends.1)
    }

    /// The same task for another system.
    pub(super) fn of_system(&self, system: &HybridSystem) -> Result<ReachSets, Error> {
        let (start, goal) = self.ends();
        let sets = ReachSets::new(system, start, goal, self.options.clone())?;
        match &self.first_inputs {
            Some(inputs) => sets.with_first_inputs(inputs),
            None => Ok(sets),
        }
    }

    pub(super) fn goal_layers(&self) -> Shared {
        Arc::clone(&self.backward[0])
    }

    /// The system of a step; the first step may have different inputs.
    pub(super) fn system_at(&self, step: usize) -> &Arc<Compiled> {
        match &self.first {
            Some(first) if step == 0 => first,
            _ => &self.system,
        }
    }

    fn extend_forward(&mut self) {
        let step = self.forward.len() - 1;
        let system = Arc::clone(self.system_at(step));
        let most = self.options.vertices;
        let now = &self.forward[step];
        let mut next: Layers = vec![None; now.len()];
        let mut emptied = None;
        for (events, set) in now.iter().enumerate() {
            let Some(set) = set else { continue };
            for (transition, (_, is_event)) in system.transitions.iter().enumerate() {
                let target = (events + usize::from(*is_event)).min(self.options.events);
                match successors(&system, transition, set) {
                    Ok(image) => add(&mut next[target], image),
                    Err(reason) => emptied = emptied.or(Some((step, reason))),
                }
            }
        }
        next.iter_mut().flatten().for_each(|set| set.simplify(most));
        let stands = next.iter().zip(now.iter()).all(|(next, now)| match (next, now) {
            (None, _) => true,
            (Some(next), Some(now)) => next.lies_in(now),
            (Some(_), None) => false,
        });
        if step > 0 && stands {
            // No growth, so by monotonicity the sets never grow again.
            self.settled = Some(step);
        }
        if next.iter().all(Option::is_none) && self.emptied.is_none() {
            self.emptied = emptied;
        }
        self.forward.push(Arc::new(next));
    }

    fn extend_backward(&mut self) {
        let system = Arc::clone(&self.system);
        let now = &self.backward[self.backward.len() - 1];
        let mut next: Layers = vec![None; now.len()];
        for (events, set) in now.iter().enumerate() {
            let Some(set) = set else { continue };
            for (transition, (_, is_event)) in system.transitions.iter().enumerate() {
                let target = (events + usize::from(*is_event)).min(self.options.events);
                if let Ok(before) = predecessors(&system, transition, set) {
                    add(&mut next[target], before);
                }
            }
        }
        let most = self.options.vertices;
        next.iter_mut().flatten().for_each(|set| set.simplify(most));
        self.backward.push(Arc::new(next));
    }
}

pub(super) fn add(layer: &mut Option<ReachSet>, set: ReachSet) {
    *layer = Some(match layer.take() {
        Some(present) => present.join(&set),
        None => set,
    });
}

/// Refuses what the sets do not follow yet.
fn check_supported(system: &HybridSystem) -> Result<(), Error> {
    let n = system.states.len();
    let mut guards = system.transitions().flat_map(|t| &t.guards);
    let unsupported = [
        (system.choices.len() > 1, "several choices"),
        (system.transitions().any(|t| t.modes.is_some()), "modes with memory"),
        (system.limits.iter().any(|h| h.is_joint(n)), "limits on inputs"),
        (guards.any(|h| h.is_joint(n)), "guards on inputs"),
        (system.transitions().any(|t| !t.inputs.is_empty()), "input ranges of transitions"),
        (system.settles() > 0, "values by step"),
        (system.most_events.is_some(), "a largest number of events"),
    ];
    match unsupported.iter().find(|(found, _)| *found) {
        Some((_, what)) => Err(ErrorKind::Unsupported {
            solver: "a reach set".into(),
            what: (*what).into(),
            help: "solve the program without reach sets".into(),
        }
        .into()),
        None => Ok(()),
    }
}
