//! A hybrid system, stated once.
//!
//! Statements are made of handles and their expressions, and kept as matrices and half-spaces:
//!
//! | part | file |
//! | --- | --- |
//! | the handles; finding them | `system/handles.rs`; `system/look_up.rs` |
//! | states, inputs, series, limits | `system/declarations.rs` |
//! | choices: modes, events, switches | `system/modes.rs` |
//! | a transition that is being stated; what it does after its flow | `system/transition_mut.rs`; `system/reset.rs` |
//! | nonlinear rows of states | `system/state_row.rs` |
//! | nonlinear flows, their steps; their functions | `system/nonlinear_flow.rs`, `system/discretization.rs`; `system/step_functions.rs` |
//! | rates and next values | `system/flow.rs`, `system/flow_rows.rs` |
//! | expressions and rows as coefficients | `system/coefficients.rs` |
//! | rows of norms and squares | `system/system_row.rs`, `system/norm_rows.rs` |
//!
//! | part as numbers | file |
//! | --- | --- |
//! | the system | `system/mod.rs` |
//! | a choice among transitions, modes, dwell times | `system/choice.rs` |
//! | a transition: flow, guards, reset, outputs | `system/transition.rs` |
//! | a half-space | `system/halfspace.rs` |
//! | a norm limit; its polygons | `system/norm_limit.rs`; `system/polygons.rs` |
//! | values by step | `system/schedule.rs` |
//! | in the units and about the centres of its domains | `system/coordinates.rs`, `system/measure.rs` |
//! | building it from numbers | `system/matrices.rs` |
//! | ranges of inputs under several choices; inputs with some values only | `system/input_range.rs`; `system/input_values.rs` |
//! | starts and goals | `system/region.rs`, `system/into_region.rs` |
//! | piecewise-affine systems, a ball, a thermostat | `system/piecewise_affine.rs`, `system/named.rs` |
//! | linear complementarity systems | `system/linear_complementarity.rs` |
//! | mixed logical dynamical systems | `system/mixed_logical_dynamical.rs`, `system/mixed_logical_rows.rs` |
//! | the text form; `serde` | `system/text.rs`, `system/serialized.rs` |
//! | what is refused | `system/check.rs` |

mod by_step;
mod check;
mod choice;
mod coefficients;
mod coordinates;
mod declarations;
mod discretization;
mod flow;
mod flow_rows;
mod halfspace;
mod handles;
mod input_range;
mod input_values;
mod into_region;
mod linear_complementarity;
mod look_up;
mod matrices;
mod measure;
mod mixed_logical_dynamical;
mod mixed_logical_rows;
mod modes;
mod named;
mod nonlinear_flow;
mod norm_limit;
mod norm_rows;
mod piecewise_affine;
mod polygons;
mod region;
mod reset;
mod schedule;
#[cfg(feature = "serde")]
mod serialized;
mod series_inputs;
mod state_row;
mod step_functions;
mod system_row;
mod text;
mod transition;
mod transition_mut;

pub use choice::Choice;
pub(crate) use coordinates::{Coordinates, Restated};
pub use discretization::Discretization;

pub use halfspace::Halfspace;
pub use handles::{Input, State};
pub(crate) use input_values::InputValues;
pub use into_region::IntoRegion;
pub(crate) use into_region::StatedRegion;
pub use linear_complementarity::LinearComplementarity;
pub(crate) use measure::{Measure, check_digits, power_of_two};
pub use mixed_logical_dynamical::MixedLogicalDynamical;
pub(crate) use norm_limit::{NormEntry, NormLimit};
pub(crate) use polygons::Approximation;
pub use region::Region;
pub(crate) use region::{check_cut, outside_domain};
pub use schedule::Schedule;
pub(crate) use state_row::StateRow;
pub(crate) use step_functions::{StepFunctions, StepSlot};
pub use system_row::SystemRow;
pub use transition::Transition;
pub(crate) use transition::{Reset, Uncertain};
pub use transition_mut::TransitionMut;

pub(crate) use handles::Meaning;

pub(crate) use check::check_ends;

#[cfg(feature = "serde")]
use serialized::StoredSystem;

use std::collections::BTreeMap;

use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;
use flow_rows::FlowRows;
pub(crate) use handles::Handles;

/// The name of the choice to which [`HybridSystem::with_transition`] adds.
pub(crate) const MODE: &str = "mode";

/// A discrete-time hybrid system with bounded states and inputs.
///
/// The state at every sample lies in its domain and satisfies the limits. Each step takes one
/// transition of every choice, with every input within its range. Everything about the system is
/// said with [expressions](crate::model::Affine) and [rows](crate::model::Row) of its handles.
///
/// ```
/// use carom::prelude::*;
///
/// // High gear is stronger but allowed only above 0.4 m/s.
/// let mut lift = HybridSystem::new(0.1); // s
/// let x = lift.state("x", 0.0, 15.0)?; // m
/// let v = lift.state("v", -2.5, 2.5)?; // m/s
/// let u = lift.input("u", -1.0, 1.0)?;
/// lift.mode("low gear")?.rates([x.is(v), v.is(0.6 * u)])?;
/// lift.mode("high gear")?.rates([x.is(v), v.is(1.5 * u)])?.guard(v.ge(0.4))?;
///
/// let (start, goal) = ([x.equals(0.0), v.equals(0.0)], [x.equals(3.0), v.equals(0.0)]);
/// let found = lift.shortest(start, goal, &mut BranchAndBound::default())?;
/// assert_eq!(found.steps, Some(35));
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Several choices
///
/// With one choice, the next state is the one to which its transition leads. With several, each
/// transition adds what it changes: if `y` is the common flow's result and `x⁺_c` the state to
/// which the transition of choice c leads, the next state is `y + Σ_c (x⁺_c - y)`.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredSystem", into = "StoredSystem"))]
pub struct HybridSystem {
    /// Δt, in s.
    pub(crate) time_step: f64,
    /// Names and domains (finite) of the states.
    pub(crate) states: Vec<(String, Interval)>,
    /// Names and ranges (finite) of the inputs, by step.
    pub(crate) inputs: Vec<(String, Schedule<Interval>)>,
    /// The values within their ranges that inputs take, by name, of those that take some only.
    pub(crate) input_values: BTreeMap<String, InputValues>,
    /// Limits in addition to the domains: at every sample, or, if they depend on the inputs, at the
    /// start of every step.
    pub(crate) limits: Vec<Halfspace>,
    /// Limits of lengths, as the limits.
    pub(crate) norms: Vec<NormLimit>,
    /// Nonlinear limits of the states at every sample.
    pub(crate) state_rows: Vec<StateRow>,
    /// The common flow, to which the choices add; needed with two choices or more.
    pub(crate) flow: Option<LinearSystem>,
    /// The choices of a step, at least one.
    pub(crate) choices: Vec<Choice>,
    /// The most events of a run, if they are limited.
    pub(crate) most_events: Option<usize>,
    /// The range of the disturbance added to each next state; empty if there is none. Only
    /// simulations and robust sets see it.
    pub(crate) disturbance: Vec<Interval>,
    pub(crate) handles: Handles,
    /// The common flow as it was stated.
    common: Option<FlowRows>,
    /// The functions of its nonlinear flows, each of which is the value of an input.
    pub(crate) functions: StepFunctions,
    /// Transitions, by choice and number, that have not stated a flow and take that of no other
    /// yet.
    unstated: Vec<(usize, usize)>,
    /// Transitions, by choice and number, with guards on predictions that were stated by handles.
    predicting: Vec<(usize, usize)>,
}

impl PartialEq for HybridSystem {
    /// Whether two systems state the same, whatever their handles.
    fn eq(&self, other: &Self) -> bool {
        let parts = |of: &HybridSystem| (of.time_step, of.most_events);
        parts(self) == parts(other)
            && self.states == other.states
            && self.inputs == other.inputs
            && self.input_values == other.input_values
            && self.limits == other.limits
            && self.norms == other.norms
            && self.flow == other.flow
            && self.choices == other.choices
            && self.disturbance == other.disturbance
            && self.functions == other.functions
            && self.state_rows == other.state_rows
    }
}

impl HybridSystem {
    /// A system without states, inputs and choices.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt, the length of a step, in s; finite and positive.
    pub fn new(time_step: f64) -> Self {
        HybridSystem {
            time_step,
            states: Vec::new(),
            inputs: Vec::new(),
            input_values: BTreeMap::new(),
            limits: Vec::new(),
            norms: Vec::new(),
            state_rows: Vec::new(),
            flow: None,
            choices: Vec::new(),
            most_events: None,
            disturbance: Vec::new(),
            handles: Handles::default(),
            functions: StepFunctions::default(),
            common: None,
            unstated: Vec::new(),
            predicting: Vec::new(),
        }
    }

    /// Δt, in s.
    pub fn time_step(&self) -> f64 {
        self.time_step
    }

    /// All transitions, in the order of the choices. Their positions are their numbers.
    #[doc(hidden)]
    pub fn transitions(&self) -> impl Iterator<Item = &Transition> {
        self.choices.iter().flat_map(|choice| &choice.transitions)
    }

    /// Whether it states a disturbance or an uncertain parameter.
    pub(crate) fn is_disturbed(&self) -> bool {
        let mut parameters = self.transitions().flat_map(|t| &t.uncertain);
        self.disturbance.iter().any(|range| range.magnitude() > 0.0)
            || parameters.any(|own| own.range.magnitude() > 0.0)
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
        values.extend(self.all_conditions().flat_map(|own| own.set.values_at(step)));
        let resets = self.transitions().flat_map(Transition::resets);
        values.extend(resets.filter_map(|r| r.offset.get(step)).flatten());
        let outputs = self.transitions().flat_map(|t| &t.outputs);
        values.extend(outputs.filter_map(|output| output.constant.get(step)));
        values
    }

    /// The step from which on nothing depends on the step.
    pub(crate) fn settles(&self) -> usize {
        let ranges = self.inputs.iter().chain(self.transitions().flat_map(|t| &t.inputs));
        let resets = self.transitions().flat_map(Transition::resets);
        let ranges = ranges.map(|(_, range)| range.settles());
        let limits = self.all_conditions().map(|own| own.set.settles());
        let outputs = self.transitions().flat_map(|t| &t.outputs);
        let limits = limits.chain(outputs.map(|output| output.constant.settles()));
        ranges.chain(limits).chain(resets.map(|r| r.offset.settles())).max().unwrap_or(0)
    }
}
