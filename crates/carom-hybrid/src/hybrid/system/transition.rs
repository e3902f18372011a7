//! One way to get from a sample to the next.

use faer::Mat;

use super::halfspace::Halfspace;
use super::norm_limit::NormLimit;
use super::schedule::Schedule;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::{Matrix, faer};
use crate::interval::Interval;

/// The reset after a transition's flow: `x⁺ = R y + r`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "super::serialized::StoredReset", into = "super::serialized::StoredReset")
)]
pub(crate) struct Reset {
    /// R, n x n.
    pub(crate) matrix: Mat<f64>,
    /// r, n entries, by step.
    pub(crate) offset: Schedule<Vec<f64>>,
}

/// A parameter that is not known: it adds `δ (M y + m)` to the next state.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Uncertain {
    /// The range of δ, which contains 0.
    pub(crate) range: Interval,
    /// M and m.
    pub(crate) effect: Reset,
}

/// An affine function of a transition's prediction, such as an impact speed, or of the state and
/// the input at the start of the step.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TransitionOutput {
    /// Its name, the same in every transition that has it.
    pub(crate) name: String,
    /// One coefficient per state, and at the start, optionally, one per input.
    pub(crate) factors: Vec<f64>,
    /// By step.
    pub(crate) constant: Schedule<f64>,
    /// Whether it is a function of the start of the step.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) is_at_start: bool,
}

/// One way to get from a sample to the next: from a state and an input that satisfy the guards, by
/// the flow to a prediction that satisfies the guards on the prediction, and by the reset to the
/// next state.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Transition {
    pub name: String,
    pub flow: LinearSystem,
    /// On the start of the step.
    pub guards: Vec<Halfspace>,
    pub prediction_guards: Vec<Halfspace>,
    /// Limits of lengths on the start of the step.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) norms: Vec<NormLimit>,
    /// Limits of lengths on the prediction.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) prediction_norms: Vec<NormLimit>,
    /// Ranges of inputs, by their names, that replace those of the system.
    pub inputs: Vec<(String, Schedule<Interval>)>,
    /// The mode that it leaves and the one that it enters, in a choice with memory.
    pub modes: Option<(String, String)>,
    pub(crate) reset: Option<Reset>,
    /// The uncertain parts of the next state.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) uncertain: Vec<Uncertain>,
    pub(crate) outputs: Vec<TransitionOutput>,
    /// Whether it counts as an event.
    pub is_event: bool,
}

impl Transition {
    pub fn new(name: impl Into<String>, flow: LinearSystem) -> Self {
        Transition {
            name: name.into(),
            flow,
            guards: Vec::new(),
            prediction_guards: Vec::new(),
            norms: Vec::new(),
            prediction_norms: Vec::new(),
            inputs: Vec::new(),
            modes: None,
            reset: None,
            uncertain: Vec::new(),
            outputs: Vec::new(),
            is_event: false,
        }
    }

    pub fn event(name: impl Into<String>, flow: LinearSystem) -> Self {
        Transition { is_event: true, ..Transition::new(name, flow) }
    }

    #[must_use]
    pub fn with_guard(mut self, guard: Halfspace) -> Self {
        self.guards.push(guard);
        self
    }

    #[must_use]
    pub fn with_guards(mut self, guards: impl IntoIterator<Item = Halfspace>) -> Self {
        self.guards.extend(guards);
        self
    }

    #[must_use]
    pub fn with_prediction_guard(mut self, guard: Halfspace) -> Self {
        self.prediction_guards.push(guard);
        self
    }

    /// The reset and the effects of what is not known.
    pub(crate) fn resets(&self) -> impl Iterator<Item = &Reset> {
        self.reset.iter().chain(self.uncertain.iter().map(|own| &own.effect))
    }

    /// Replaces the system's range of an input; see `system/input_range.rs`.
    #[must_use]
    pub fn with_input_range(
        mut self,
        input: impl Into<String>,
        range: impl Into<Schedule<Interval>>,
    ) -> Self {
        self.inputs.push((input.into(), range.into()));
        self
    }

    /// The range of an input that the transition sets.
    pub(crate) fn input_range(&self, input: &str) -> Option<&Schedule<Interval>> {
        self.inputs.iter().rfind(|(name, _)| name == input).map(|(_, range)| range)
    }

    /// Makes the transition lead from a mode to a mode, by their names.
    #[must_use]
    pub fn between(mut self, from: impl Into<String>, to: impl Into<String>) -> Self {
        self.modes = Some((from.into(), to.into()));
        self
    }

    #[must_use]
    pub fn within(self, mode: impl Into<String>) -> Self {
        let mode = mode.into();
        self.between(mode.clone(), mode)
    }

    /// Sets the reset `x⁺ = matrix . y + offset`.
    #[must_use]
    pub fn with_reset(self, matrix: impl Into<Matrix>, offset: impl Into<Vec<f64>>) -> Self {
        self.with_reset_by_step(matrix, offset.into())
    }

    /// As [`with_reset`](Transition::with_reset), with an offset by step, as at a moving wall.
    #[must_use]
    pub fn with_reset_by_step(
        mut self,
        matrix: impl Into<Matrix>,
        offset: impl Into<Schedule<Vec<f64>>>,
    ) -> Self {
        self.reset = Some(Reset { matrix: faer(matrix), offset: offset.into() });
        self
    }

    /// Adds an output `factors . y + constant` of the prediction y.
    #[must_use]
    pub fn with_output(
        mut self,
        name: impl Into<String>,
        factors: impl Into<Vec<f64>>,
        constant: impl Into<Schedule<f64>>,
    ) -> Self {
        let (name, factors, constant) = (name.into(), factors.into(), constant.into());
        self.outputs.push(TransitionOutput { name, factors, constant, is_at_start: false });
        self
    }

    /// Adds an output `factors . (x, u) + constant`; the coefficients of the inputs may be left
    /// out.
    #[must_use]
    pub fn with_start_output(
        mut self,
        name: impl Into<String>,
        factors: impl Into<Vec<f64>>,
        constant: impl Into<Schedule<f64>>,
    ) -> Self {
        let (name, factors, constant) = (name.into(), factors.into(), constant.into());
        self.outputs.push(TransitionOutput { name, factors, constant, is_at_start: true });
        self
    }
}
