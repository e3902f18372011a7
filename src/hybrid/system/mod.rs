//! A hybrid system, stated once.
//!
//! | part | file |
//! | --- | --- |
//! | states, inputs, limits, common flow | `system/mod.rs` |
//! | a choice among transitions, modes, dwell times | `system/choice.rs` |
//! | a transition: flow, guards, reset, outputs | `system/transition.rs` |
//! | a half-space | `system/halfspace.rs` |
//! | values by step | `system/schedule.rs` |
//! | ranges of inputs under several choices | `system/input_range.rs` |
//! | starts and goals | `system/region.rs` |
//! | piecewise-affine systems, a ball, a thermostat | `system/piecewise_affine.rs`, `system/named.rs` |
//! | mixed logical dynamical systems | `system/mixed_logical_dynamical.rs`, `system/mixed_logical_rows.rs` |
//! | the text form; `serde` | `system/text.rs`, `system/serialized.rs` |
//! | what is refused | `system/check.rs` |

mod by_step;
mod check;
mod choice;
mod halfspace;
mod input_range;
mod mixed_logical_dynamical;
mod mixed_logical_rows;
mod named;
mod piecewise_affine;
mod region;
mod schedule;
#[cfg(feature = "serde")]
mod serialized;
mod text;
mod transition;

pub use choice::Choice;

pub use halfspace::Halfspace;
pub use mixed_logical_dynamical::MixedLogicalDynamical;
pub use region::Region;
pub(crate) use region::check_cut;
pub use schedule::Schedule;
pub use transition::Transition;

pub(crate) use check::{check_ends, check_halfspace};

#[cfg(feature = "serde")]
use serialized::StoredSystem;

use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;

/// The name of the choice to which [`HybridSystem::with_transition`] adds.
pub(crate) const MODE: &str = "mode";

/// A discrete-time hybrid system with bounded states and inputs.
///
/// The state at every sample lies in its domain and satisfies the limits. Each step takes one
/// transition of every [`Choice`], with every input within its range.
///
/// With one choice, the next state is the one to which its transition leads. With several, each
/// transition adds what it changes: if `y` is the common flow's result and `x⁺_c` the state to which
/// the transition of choice c leads, the next state is `y + Σ_c (x⁺_c - y)`.
///
/// ```
/// use carom::hybrid::{HybridSystem, LinearSystem, Transition};
/// use carom::interval::Interval;
///
/// let push = HybridSystem::new()
///     .with_state("x", Interval::new(-9.0, 9.0))
///     .with_state("v", Interval::new(-9.0, 9.0))
///     .with_input("a", Interval::new(-1.0, 1.0))
///     .with_transition(Transition::new("flight", LinearSystem::double_integrator(0.1)?));
/// push.check()?;
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredSystem", into = "StoredSystem"))]
pub struct HybridSystem {
    /// Names and domains (finite) of the states.
    pub states: Vec<(String, Interval)>,
    /// Names and ranges (finite) of the inputs, by step.
    pub inputs: Vec<(String, Schedule<Interval>)>,
    /// Limits in addition to the domains: at every sample, or, if they depend on the inputs, at the
    /// start of every step.
    pub limits: Vec<Halfspace>,
    /// The common flow, to which the choices add; needed with two choices or more.
    pub flow: Option<LinearSystem>,
    /// The choices of a step, at least one.
    pub choices: Vec<Choice>,
    /// The most events of a run, if they are limited.
    pub most_events: Option<usize>,
    /// The range of the disturbance added to each next state; empty if there is none. Only simulations and
    /// robust sets see it.
    pub disturbance: Vec<Interval>,
}

impl HybridSystem {
    /// A system without states, inputs and choices.
    pub fn new() -> Self {
        HybridSystem::default()
    }

    /// Adds a state with its domain, in the state's unit.
    #[must_use]
    pub fn with_state(mut self, name: impl Into<String>, domain: Interval) -> Self {
        self.states.push((name.into(), domain));
        self
    }

    /// Adds an input with its range, in the input's unit.
    #[must_use]
    pub fn with_input(
        mut self,
        name: impl Into<String>,
        range: impl Into<Schedule<Interval>>,
    ) -> Self {
        self.inputs.push((name.into(), range.into()));
        self
    }

    /// Adds a limit on the states at every sample, or on states and inputs at every step.
    #[must_use]
    pub fn with_limit(mut self, limit: Halfspace) -> Self {
        self.limits.push(limit);
        self
    }

    /// Sets the common flow, whose result the choices change.
    #[must_use]
    pub fn with_flow(mut self, flow: LinearSystem) -> Self {
        self.flow = Some(flow);
        self
    }

    /// Adds a transition to the choice named `mode`, which is made if there is none.
    #[must_use]
    pub fn with_transition(mut self, transition: Transition) -> Self {
        let k = self.choices.iter().position(|choice| choice.name == MODE).unwrap_or_else(|| {
            self.choices.push(Choice::new(MODE));
            self.choices.len() - 1
        });
        self.choices[k].transitions.push(transition);
        self
    }

    /// Adds a choice, independent of the others.
    #[must_use]
    pub fn with_choice(mut self, choice: Choice) -> Self {
        self.choices.push(choice);
        self
    }

    /// Limits the number of events of a run, over all choices.
    #[must_use]
    pub fn with_most_events(mut self, most: usize) -> Self {
        self.most_events = Some(most);
        self
    }

    /// Sets what a disturbance may add to each next state, in the states' units. Rows, refutations
    /// and certificates do not see it.
    #[must_use]
    pub fn with_disturbance(mut self, ranges: impl Into<Vec<Interval>>) -> Self {
        self.disturbance = ranges.into();
        self
    }

    /// All transitions, in the order of the choices. Their positions are their numbers.
    pub fn transitions(&self) -> impl Iterator<Item = &Transition> {
        self.choices.iter().flat_map(|choice| &choice.transitions)
    }

    /// The number of a choice's first transition.
    pub(crate) fn first_transition(&self, choice: usize) -> usize {
        self.choices[..choice].iter().map(|choice| choice.transitions.len()).sum()
    }

    /// Everything that depends on the step, at one step, in a fixed order.
    pub(crate) fn values_at(&self, step: usize) -> Vec<f64> {
        let ranges = self.inputs.iter().chain(self.transitions().flat_map(|t| &t.inputs));
        let ranges = ranges.filter_map(|(_, range)| range.get(step));
        let mut values: Vec<f64> = ranges.flat_map(|r| [r.lower, r.upper]).collect();
        let guards = self.transitions().flat_map(|t| t.guards.iter().chain(&t.prediction_guards));
        values.extend(self.limits.iter().chain(guards).map(|h| h.limit_at(step)));
        let resets = self.transitions().filter_map(|t| t.reset.as_ref());
        values.extend(resets.filter_map(|r| r.offset.get(step)).flatten());
        let outputs = self.transitions().flat_map(|t| &t.outputs);
        values.extend(outputs.filter_map(|output| output.constant.get(step)));
        values
    }

    /// The step from which on nothing depends on the step.
    pub(crate) fn settles(&self) -> usize {
        let ranges = self.inputs.iter().chain(self.transitions().flat_map(|t| &t.inputs));
        let guards = self.transitions().flat_map(|t| t.guards.iter().chain(&t.prediction_guards));
        let resets = self.transitions().filter_map(|t| t.reset.as_ref());
        let ranges = ranges.map(|(_, range)| range.settles());
        let limits = self.limits.iter().chain(guards).map(|h| h.limit.settles());
        let outputs = self.transitions().flat_map(|t| &t.outputs);
        let limits = limits.chain(outputs.map(|output| output.constant.settles()));
        ranges.chain(limits).chain(resets.map(|r| r.offset.settles())).max().unwrap_or(0)
    }
}
