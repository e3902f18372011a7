//! Explanations of why there is no plan, in words.

use std::sync::Arc;

use web_time::Duration;

use super::set::{Emptied, Place, ReachSet};
use super::sets::ReachSets;
use super::step::predecessors;
use super::tube::Tube;
use super::words::{Words, number};
use crate::error::Error;
use crate::hybrid::step::{ConditionSet, StepCondition};
use crate::hybrid::system::{HybridSystem, Measure};
use crate::interval::Interval;
use crate::solver::{Interrupt, StopToken};
use crate::tolerance::largest_magnitude;

/// The number of widths by which a domain is enlarged to find out whether it is to blame.
const LIFTED_WIDTHS: f64 = 1e3;

/// Why there is no plan over a horizon, according to the reach sets.
///
/// ```
/// use carom::collision_tolerant::Scenario;
///
/// let slow = Scenario::paper().with_time_step(0.1).with_max_speed(2.0).collision_free();
/// let reason = slow.reach_sets()?.explain(40)?.expect("4 s are not enough at 2 m/s");
/// let text = reason.to_string();
/// assert!(text.starts_with("no plan has 40 steps (4 s): at the end, "), "{text}");
/// assert!(text.contains("without the lower limit of the velocity"), "{text}");
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ReachExplanation {
    /// The horizon, in steps.
    pub steps: usize,
    /// The sample at which no state is left.
    pub sample: usize,
    /// The reason for each number of events with which a plan can get that far.
    pub findings: Vec<Finding>,
    /// Single changes that might make a plan possible, in words.
    pub remedies: Vec<String>,
    /// Δt, in s.
    pub(super) time_step: f64,
    pub(super) words: Arc<Words>,
}

/// The reason why plans with a certain number of events are excluded.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Finding {
    /// Events up to the sample, or `None` if the number does not matter.
    pub events: Option<usize>,
    /// Whether this includes more events than these.
    pub or_more: bool,
    /// Modes of the choices with memory, each with its choice's name; empty if they do not matter.
    pub modes: Vec<(String, String)>,
    /// The reason.
    pub reason: EmptinessReason,
}

/// The reason why a set is empty.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum EmptinessReason {
    /// A limit that no state satisfies.
    Limit {
        /// Its name.
        name: String,
        /// The transition, if the limit is a guard and not a rule of the user's.
        transition: Option<String>,
        /// The limit.
        limit: f64,
        /// The smallest value that can be reached.
        nearest: f64,
    },
    /// The values that a state can have do not include those that are needed.
    Range {
        /// The state's name.
        state: String,
        /// The range that can be reached, in the state's unit.
        reached: Interval,
        /// The range that is needed, in the state's unit.
        needed: Interval,
        /// Other states that already have the needed values.
        given: Vec<(String, Interval)>,
    },
    /// A combination of states is out of range, but none of them alone.
    Combination {
        /// Names and coefficients of the states.
        factors: Vec<(String, f64)>,
        /// The largest value that can be reached.
        reached: f64,
        /// The smallest value that is needed.
        needed: f64,
    },
}

/// The reasons that tell why no transition is left: the first one, and rules of the user's.
fn reported(reasons: impl Iterator<Item = EmptinessReason>) -> Vec<EmptinessReason> {
    let mut told: Vec<EmptinessReason> = Vec::new();
    let name_of = |reason: &EmptinessReason| match reason {
        EmptinessReason::Limit { name, transition: None, .. } => Some(name.clone()),
        _ => None,
    };
    for reason in reasons {
        let name = name_of(&reason);
        if told.is_empty() || name.is_some() && !told.iter().any(|known| name_of(known) == name) {
            told.push(reason);
        }
    }
    told
}

impl ReachSets {
    /// Why no plan has exactly `steps` steps, or `None` if the sets do not exclude one.
    ///
    /// # Errors
    ///
    /// As for [`tube`](ReachSets::tube).
    pub fn explain(&mut self, steps: usize) -> Result<Option<ReachExplanation>, Error> {
        self.explain_until(steps, &StopToken::default())
    }

    /// The same in a limited time: the reason is found first, and then as many of the remedies as
    /// there is time for. `None` also if there is no time for the reason.
    ///
    /// # Errors
    ///
    /// As for [`tube`](ReachSets::tube).
    pub fn explain_within(
        &mut self,
        steps: usize,
        limit: Duration,
    ) -> Result<Option<ReachExplanation>, Error> {
        self.explain_until(steps, &StopToken::new(Some(limit), &Interrupt::new()))
    }

    fn explain_until(
        &mut self,
        steps: usize,
        token: &StopToken,
    ) -> Result<Option<ReachExplanation>, Error> {
        let Some(tube) = self.tube_until(steps, token)? else { return Ok(None) };
        let Some(sample) = tube.died() else { return Ok(None) };
        let (sample, findings) = match self.missing_end(steps) {
            Some((at_start, reason)) => {
                let finding = Finding::of_all(reason);
                (if at_start { 0 } else { steps }, vec![finding])
            }
            None => self.findings(&tube, sample),
        };
        let remedies = self.remedies(steps, token)?;
        let (time_step, words) = (self.system().time_step, Arc::clone(&self.options.words));
        Ok(Some(ReachExplanation { steps, sample, findings, remedies, time_step, words }))
    }

    /// The limit that excludes the start or the goal itself.
    fn missing_end(&self, steps: usize) -> Option<(bool, EmptinessReason)> {
        let (start, goal) = self.ends();
        let ends = [(true, start), (false, goal)];
        ends.into_iter().find_map(|(at_start, end)| {
            let sample = if at_start { 0 } else { steps };
            let system = self.sample(sample);
            let set = ReachSet::from_region(system, end, &self.sizes, at_start);
            let emptied = set.err()?;
            if let Place::End(k) = emptied.place {
                let halfspace = &end.halfspaces[k];
                let measure = self.measure_of(&halfspace.name);
                let name = halfspace.name.clone();
                let limit = measure.outward(halfspace.limit_at(0));
                let nearest = measure.outward(emptied.nearest);
                return Some((
                    at_start,
                    EmptinessReason::Limit { name, transition: None, limit, nearest },
                ));
            }
            Some((at_start, self.reason(sample, &emptied)?))
        })
    }

    /// The reason that emptied a set of a sample, or a set on the way there from the sample
    /// before.
    fn reason(&self, sample: usize, emptied: &Emptied) -> Option<EmptinessReason> {
        let system = self.system_at(sample.saturating_sub(1));
        let block = &system.blocks[emptied.block];
        let (name, limit, taken) = match emptied.place {
            Place::Limit(k) => {
                let cut = self.sample(sample).blocks[emptied.block].limits.get(k)?;
                (&cut.name, cut.given, None)
            }
            Place::Guard(m, k) => {
                let cut = block.steps.get(m)?.before.get(k)?;
                (&cut.name, cut.given, Some(m))
            }
            Place::Prediction(m, k) => {
                let cut = block.steps.get(m)?.after.get(k)?;
                (&cut.name, cut.given, Some(m))
            }
            Place::Joint(m, k) => {
                let guard = system.joint_transitions.get(m)?.joint.get(k)?;
                (&guard.name, guard.given, Some(m))
            }
            Place::End(_) | Place::Shape => return None,
        };
        let measure = self.measure_of(name);
        let (limit, nearest) = (measure.outward(limit), measure.outward(emptied.nearest));
        if taken.is_some_and(|m| {
            system.joint_transitions[m].members.iter().any(|t| self.is_rule(*t, name))
        }) {
            let name = format!("{name} ({})", number(limit));
            return Some(EmptinessReason::Limit { name, transition: None, limit, nearest });
        }
        // Of the transitions that a step combines, the one that has the guard.
        let owner = |m: usize| {
            let members = &system.joint_transitions[m].members;
            let has = |&&t: &&usize| self.has_guard(t, name);
            match members.iter().find(has) {
                Some(&own) => system.transition_name(own),
                None => system.name(m),
            }
        };
        Some(EmptinessReason::Limit {
            name: name.clone(),
            transition: taken.map(owner),
            limit,
            nearest,
        })
    }

    /// How the values of a condition of the system are computed, by its name.
    fn measure_of(&self, name: &str) -> Measure {
        let (coordinates, system) = (&self.coordinates, self.system());
        for (i, (state, _)) in system.states.iter().enumerate() {
            let own = coordinates.state(i);
            if *name == format!("the upper limit of {state}") {
                return own;
            }
            if *name == format!("the lower limit of {state}") {
                return Measure { origin: 0.0 - own.origin, scale: own.scale };
            }
        }
        let all = || system.all_conditions().map(|own| own.set).filter(|own| own.name() == name);
        let is_norm = |own: &ConditionSet| matches!(own, ConditionSet::Norm(_));
        let Some(own) = all().find(|own| !is_norm(own)).or_else(|| all().next()) else {
            return Measure::PLAIN;
        };
        let scale = 1.0 / coordinates.weight(own.factors());
        match own {
            ConditionSet::HalfSpace(own) => {
                Measure { origin: coordinates.shifted(&own.normal, 0.0), scale }
            }
            ConditionSet::Norm(_) => Measure::unit(scale),
        }
    }

    /// Whether a transition has a guard of a name that is a limit which the user has set.
    fn is_rule(&self, number: usize, name: &str) -> bool {
        let transition = self.system().transitions().nth(number);
        transition.is_some_and(|transition| {
            let mut own = transition.conditions().filter(|own| own.name() == name);
            own.any(|own| own.is_limit())
        })
    }

    /// Whether a transition has a guard of a name.
    fn has_guard(&self, number: usize, name: &str) -> bool {
        let transition = self.system().transitions().nth(number);
        transition.is_some_and(|own| own.conditions().any(|own| own.name() == name))
    }

    fn findings(&self, tube: &Tube, sample: usize) -> (usize, Vec<Finding>) {
        if tube.reached(sample).next().is_none() {
            // The forward sets became empty by themselves.
            let Some((step, emptied)) = &self.emptied else { return (sample, Vec::new()) };
            let reasons = emptied.iter().filter_map(|emptied| self.reason(step + 1, emptied));
            return (step + 1, reported(reasons).into_iter().map(Finding::of_all).collect());
        }
        let needed = self.needed(tube, sample);
        let has_events = self.system().transitions().any(|transition| transition.is_event);
        let graph = &self.graph;
        let mut findings: Vec<Finding> = Vec::new();
        for (layer, set) in tube.forward[sample].iter().enumerate() {
            let (node, events) = graph.node_and_events(layer);
            let Some(set) = set else { continue };
            let mut same = needed.iter().filter(|(at, _)| *at == node);
            let same = same.find_map(|(_, goal)| between(set, goal));
            let any = || needed.iter().find_map(|(_, goal)| between(set, goal));
            let reason = same.or_else(any);
            let modes = graph.modes(node).to_vec();
            // Different dwell times of the same modes are one finding.
            let told = has_events.then_some(events);
            let known = |f: &Finding| f.events == told && f.modes == modes;
            if let Some(reason) = reason.filter(|_| !findings.iter().any(known)) {
                let or_more = events == graph.events && !graph.is_limited;
                findings.push(Finding { events: told, or_more, modes, reason });
            }
        }
        (sample, findings)
    }

    /// The sets from which the goal can be reached, at a sample that no plan passes, with their
    /// nodes.
    fn needed(&self, tube: &Tube, sample: usize) -> Vec<(usize, ReachSet)> {
        let to_go = tube.steps() - sample;
        let graph = &self.graph;
        let sets = |to_go: usize| {
            let layers = tube.backward.get(to_go).into_iter().flat_map(|layers| layers.iter());
            let sets = layers.enumerate().filter_map(|(layer, set)| Some((layer, set.as_ref()?)));
            sets.map(|(layer, set)| (graph.node_and_events(layer).0, set)).collect::<Vec<_>>()
        };
        if to_go == 0 {
            return sets(0).into_iter().map(|(node, set)| (node, set.clone())).collect();
        }
        let system = self.system_at(sample);
        let before = sets(to_go - 1).into_iter().flat_map(|(node, set)| {
            graph.entering[node].iter().filter_map(|&k| {
                let edge = &graph.edges[k];
                Some((edge.from, predecessors(system, edge.taken, set).ok()?))
            })
        });
        before.collect()
    }

    /// Changes of the system each of which alone lets the sets reach the goal.
    fn remedies(&self, steps: usize, token: &StopToken) -> Result<Vec<String>, Error> {
        let (system, words, stated) = (&self.computed, &self.options.words, self.system());
        let mut changes: Vec<(String, HybridSystem)> = Vec::new();
        for (j, (name, range)) in system.inputs.iter().enumerate() {
            let mut changed = system.clone();
            changed.inputs[j].1 = range.map(|range| range.hull(*range * 2.0));
            changes.push((format!("with twice the range of {}", words.name(name)), changed));
        }
        for (i, (name, domain)) in system.states.iter().enumerate() {
            let far = LIFTED_WIDTHS * domain.width().max(1.0);
            for (word, is_upper) in [("upper", true), ("lower", false)] {
                let mut changed = system.clone();
                let range = &mut changed.states[i].1;
                if is_upper {
                    range.upper += far
                } else {
                    range.lower -= far
                }
                let domain = &stated.states[i].1;
                let limit = if is_upper { domain.upper } else { domain.lower };
                let (own, unit) = (words.name(name), words.unit(name));
                let text = format!("without the {word} limit of {own} ({}{unit})", number(limit));
                changes.push((text, changed));
            }
        }
        let text = |own: StepCondition<'_>| match own.set {
            ConditionSet::HalfSpace(own) => {
                format!("without {} ({})", own.name, number(own.limit_at(0)))
            }
            ConditionSet::Norm(own) => format!("without {}", own.name),
        };
        for own in stated.conditions().filter(|own| own.is_limit()) {
            let mut changed = system.clone();
            changed.remove_condition(own.number);
            changes.push((text(own), changed));
        }
        for (c, choice) in stated.choices.iter().enumerate() {
            for (m, transition) in choice.transitions.iter().enumerate() {
                for own in transition.conditions().filter(|own| own.is_limit()) {
                    let mut changed = system.clone();
                    changed.choices[c].transitions[m].remove_condition(own.number);
                    changes.push((text(own), changed));
                }
            }
        }
        let mut remedies = Vec::new();
        for (text, changed) in changes {
            if token.is_over() {
                break;
            }
            let tube = self.of_system(&changed).tube_until(steps, token)?;
            if tube.is_some_and(|tube| !tube.is_empty()) {
                remedies.push(text);
            }
        }
        Ok(remedies)
    }
}

impl Finding {
    /// For any number of events, in any mode.
    fn of_all(reason: EmptinessReason) -> Self {
        Finding { events: None, or_more: false, modes: Vec::new(), reason }
    }
}

/// The range or combination of states that separates two sets of one system; `None` if none is
/// found.
fn between(reached: &ReachSet, needed: &ReachSet) -> Option<EmptinessReason> {
    let system = Arc::clone(&reached.system);
    let mut rest = reached.clone();
    let goal = needed.own_box();
    let stated = |i: usize, own: Interval| system.coordinates.state(i).outward_range(own);
    let mut given = Vec::new();
    for (i, (name, _)) in system.states.iter().enumerate() {
        let range = rest.own_box()[i];
        if range.lower > goal[i].upper || range.upper < goal[i].lower {
            let (state, needed) = (name.clone(), stated(i, goal[i]));
            return Some(EmptinessReason::Range {
                state,
                reached: stated(i, range),
                needed,
                given,
            });
        }
        if !rest.keep(i, goal[i]) {
            break;
        }
        given.push((name.clone(), stated(i, goal[i])));
    }
    let blocks = reached.shapes.iter().zip(&needed.shapes).zip(&system.blocks);
    blocks.into_iter().find_map(|((a, b), block)| {
        let (normal, first, second) = a.separation(b)?;
        // n . own = (n / scale) . x - shift.
        let measures: Vec<Measure> =
            block.states.iter().map(|&i| system.coordinates.state(i)).collect();
        let normal: Vec<f64> = normal.iter().zip(&measures).map(|(n, m)| n / m.scale).collect();
        let size = largest_magnitude(&normal);
        let shift: f64 = normal.iter().zip(&measures).map(|(n, m)| n * m.origin).sum();
        let named = block.states.iter().zip(&normal).filter(|(_, n)| **n != 0.0);
        let factors = named.map(|(&i, n)| (system.states[i].0.clone(), n / size)).collect();
        let [reached, needed] = [first, second].map(|value| (value + shift) / size);
        Some(EmptinessReason::Combination { factors, reached, needed })
    })
}
