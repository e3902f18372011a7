//! The tube of one horizon: what a plan with exactly that many steps can do at each of them.

use std::sync::Arc;

use super::compiled::Compiled;
use super::set::{ReachSet, bounding_box};
use super::sets::{Layers, ReachSets, Shared, add};
use super::shape::Shape;
use super::step::{arrive, predecessors, predict};
use crate::error::Error;
use crate::hybrid::horizon::check_steps;
use crate::interval::Interval;
use crate::solver::StopToken;

/// The largest number of sweeps over the horizon, forward and backward alternately.
const MOST_SWEEPS: usize = 4;

/// Number of steps after which a sweep checks the stop token.
const STOP_EVERY: usize = 64;

/// What a plan over exactly τ steps can do, according to reach sets.
///
/// A tube combines forward and backward sets: a transition is possible in a step if it leads from a
/// state that can be reached to one from which the goal can be reached in the remaining steps. What
/// a tube excludes is in no plan; this is a proof.
///
/// ```
/// use carom::hybrid::reach::{ReachSets, SetOptions};
/// use carom::hybrid::{Contact, HybridSystem, Restitution, Wall};
/// use carom::interval::Interval;
///
/// // From 10 m to 0.3 m, rest to rest, in steps of 0.05 s, over a plastic wall at 0 m.
/// let wall = Contact::new(Wall::above(0.0)?, Restitution::PLASTIC);
/// let [flight, impact] = wall.transitions(0.05, None)?;
/// let vehicle = HybridSystem::new()
///     .with_state("x", Interval::new(0.0, 50.0))
///     .with_state("v", Interval::new(-15.0, 15.0))
///     .with_input("a", Interval::new(-6.0, 6.0))
///     .with_transition(flight)
///     .with_transition(impact);
/// let at_rest = |x| [Interval::point(x), Interval::point(0.0)];
/// let mut sets = ReachSets::new(&vehicle, &at_rest(10.0), &at_rest(0.3), SetOptions::default())?;
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
    steps: usize,
    /// Sets of the samples, by events so far.
    pub(super) forward: Vec<Shared>,
    /// Sets by remaining steps and by events to come, as far as they were computed before the tube
    /// became empty.
    pub(super) backward: Vec<Shared>,
    /// Per step and transition, whether it is possible.
    possible: Vec<Vec<bool>>,
    /// Per step and transition, the box around its predictions, if it is possible.
    predictions: Vec<Vec<Option<Vec<Interval>>>>,
    /// Per sample, the box around the states.
    boxes: Vec<Vec<Interval>>,
    /// The first sample that no plan reaches.
    died: Option<usize>,
}

/// The remaining edges of the graph of (step, events so far, transition), and of the same graph by
/// events to come.
#[derive(Clone)]
struct Edges {
    transitions: usize,
    layers: usize,
    alive: Vec<bool>,
}

impl Edges {
    fn all(steps: usize, layers: usize, transitions: usize) -> Self {
        Edges { transitions, layers, alive: vec![true; steps * layers * transitions] }
    }

    fn at(&self, step: usize, layer: usize, transition: usize) -> usize {
        (step * self.layers + layer) * self.transitions + transition
    }

    fn row(&self, step: usize) -> &[bool] {
        let width = self.layers * self.transitions;
        &self.alive[step * width..(step + 1) * width]
    }

    /// Whether a transition remains in a step, in any layer.
    fn any(&self, step: usize, transition: usize) -> bool {
        (0..self.layers).any(|layer| self.alive[self.at(step, layer, transition)])
    }
}

impl ReachSets {
    /// The tube of plans over exactly `steps` steps.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`](crate::ErrorKind::OutOfRange) for no steps or more than
    /// [`tolerance::MAX_STEPS`](crate::tolerance::MAX_STEPS).
    pub fn tube(&mut self, steps: usize) -> Result<Tube, Error> {
        loop {
            // The token is never over, so there is a tube.
            if let Some(tube) = self.tube_until(steps, &StopToken::default())? {
                return Ok(tube);
            }
        }
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
        let transitions = self.system.transitions.len();
        let layers = self.options.events + 1;
        let mut tube = Tube {
            system: Arc::clone(&self.system),
            steps,
            forward: self.forward_sets(steps)?,
            backward: vec![self.goal_layers()],
            possible: Vec::new(),
            predictions: vec![vec![None; transitions]; steps],
            boxes: Vec::new(),
            died: None,
        };
        let mut ahead = Edges::all(steps, layers, transitions);
        let mut back = Edges::all(steps, layers, transitions);
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
                Some(true) if self.open_events(&ahead, steps) > 1 => {}
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

    /// Steps in which an event is possible.
    fn open_events(&self, edges: &Edges, steps: usize) -> usize {
        let is_event = |m: usize| self.system.transitions[m].1;
        let open = |t: &usize| (0..edges.transitions).any(|m| is_event(m) && edges.any(*t, m));
        (0..steps).filter(open).count()
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
        let most = self.options.vertices;
        let last_layer = self.options.events;
        let mut forward = std::mem::take(&mut tube.forward);
        forward.truncate(from + 1);
        for t in from..tube.steps {
            if t.is_multiple_of(STOP_EVERY) && token.is_over() {
                return None;
            }
            tube.predictions[t].fill(None);
            let system = Arc::clone(self.system_at(t));
            let mut next: Layers = vec![None; last_layer + 1];
            for (layer, set) in forward[t].iter().enumerate() {
                for (m, &(_, is_event)) in system.transitions.iter().enumerate() {
                    let edge = ahead.at(t, layer, m);
                    let alive = ahead.alive[edge] && back.any(t, m);
                    let image = set.as_ref().filter(|_| alive).and_then(|set| {
                        let predicted = predict(&system, m, set).ok()?;
                        let image = arrive(&system, m, &predicted).ok()?;
                        let to_go = tube.backward[tube.steps - t - 1].iter().flatten();
                        to_go
                            .into_iter()
                            .any(|goal| image.meets(goal))
                            .then_some((predicted, image))
                    });
                    ahead.alive[edge] = image.is_some();
                    if let Some((predicted, image)) = image {
                        widen(&mut tube.predictions[t][m], &system, &predicted);
                        add(&mut next[(layer + usize::from(is_event)).min(last_layer)], image);
                    }
                }
            }
            next.iter_mut().flatten().for_each(|set| set.simplify(most));
            if next.iter().all(Option::is_none) {
                tube.died = Some(t + 1);
                ahead.alive[(t + 1) * ahead.layers * ahead.transitions..].fill(false);
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
        let most = self.options.vertices;
        let last_layer = self.options.events;
        let mut backward = std::mem::take(&mut tube.backward);
        backward.truncate(tube.steps - to + 1);
        for to_go in tube.steps - to + 1..=tube.steps {
            let t = tube.steps - to_go;
            if t.is_multiple_of(STOP_EVERY) && token.is_over() {
                return None;
            }
            let system = Arc::clone(self.system_at(t));
            let mut next: Layers = vec![None; last_layer + 1];
            for (layer, set) in backward[to_go - 1].iter().enumerate() {
                for (m, &(_, is_event)) in system.transitions.iter().enumerate() {
                    let edge = back.at(t, layer, m);
                    let alive = back.alive[edge] && ahead.any(t, m);
                    let before = set.as_ref().filter(|_| alive).and_then(|set| {
                        let before = predecessors(&system, m, set).ok()?;
                        let mut reached = tube.forward[t].iter().flatten();
                        reached.any(|start| before.meets(start)).then_some(before)
                    });
                    back.alive[edge] = before.is_some();
                    if let Some(before) = before {
                        add(&mut next[(layer + usize::from(is_event)).min(last_layer)], before);
                    }
                }
            }
            next.iter_mut().flatten().for_each(|set| set.simplify(most));
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
fn widen(around: &mut Option<Vec<Interval>>, system: &Compiled, predicted: &[Shape]) {
    let found = bounding_box(system, predicted);
    *around = Some(match around.take() {
        Some(present) => present.iter().zip(&found).map(|(a, b)| a.hull(*b)).collect(),
        None => found,
    });
}

impl Tube {
    fn finish(&mut self, edges: &Edges) {
        let transitions = 0..edges.transitions;
        let row = |t: usize| transitions.clone().map(|m| edges.any(t, m)).collect();
        self.possible = (0..self.steps).map(row).collect();
        if self.died.is_some() {
            return;
        }
        let around = |layers: &Layers| -> Option<Vec<Interval>> {
            let boxes = layers.iter().flatten().map(ReachSet::bounding_box);
            boxes.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a.hull(*b)).collect())
        };
        for t in 0..=self.steps {
            let (ahead, back) = (around(&self.forward[t]), around(&self.backward[self.steps - t]));
            let Some((ahead, back)) = ahead.zip(back) else {
                self.died = Some(t);
                return;
            };
            self.boxes.push(ahead.iter().zip(&back).map(|(a, b)| a.intersection(*b)).collect());
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
        self.boxes.get(sample).filter(|_| !self.is_empty()).map(Vec::as_slice)
    }

    /// The box around the predictions of a transition in a step, before its reset, in the states'
    /// units. `None` if the transition is not possible.
    pub fn predictions(&self, step: usize, transition: usize) -> Option<&[Interval]> {
        let row = self.predictions.get(step).filter(|_| !self.is_empty())?;
        row.get(transition)?.as_deref()
    }

    /// The states that can be reached from the start by transitions that may lead to the goal, by
    /// events so far, for drawing. They are not intersected with the backward sets.
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
        last.iter().position(Option::is_some)
    }

    /// Proved upper bound of the number of events of a plan. `None` if it is not known or the tube
    /// is empty.
    pub fn most_events(&self) -> Option<usize> {
        let last = self.forward.get(self.steps).filter(|_| !self.is_empty())?;
        let most = last.iter().rposition(Option::is_some)?;
        (most + 1 < last.len()).then_some(most)
    }
}
