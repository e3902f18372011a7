//! The conditions of a step, and by how much they hold.

use std::fmt;

use crate::hybrid::system::{Halfspace, NormLimit};
use crate::interval::Interval;
use crate::sum::Sum;
use crate::tolerance::margin_scale;

/// A condition on a step or a sample of a run, for reports.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Condition {
    /// A guard on the start of the step.
    Guard {
        /// Its name.
        name: String,
    },
    /// A guard on the prediction.
    PredictionGuard {
        /// Its name.
        name: String,
    },
    /// The range of an input.
    InputRange {
        /// The input.
        input: String,
    },
    /// The domain of a state.
    Domain {
        /// The state.
        state: String,
    },
    /// A limit of the system.
    Limit {
        /// Its name.
        name: String,
    },
    /// The transition begins in this mode. It has no slack: it holds or not.
    Mode {
        /// The mode.
        mode: String,
    },
    /// The mode is kept long enough before it is left; the slack is a number of samples.
    LeastDwell {
        /// The mode.
        mode: String,
    },
    /// The mode is not kept too long; the slack is a number of samples.
    MostDwell {
        /// The mode.
        mode: String,
    },
    /// The run has not too many events; the slack is a number of events.
    MostEvents,
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Guard { name } => write!(f, "the guard `{name}`"),
            Condition::PredictionGuard { name } => {
                write!(f, "the guard `{name}` on the prediction")
            }
            Condition::InputRange { input } => write!(f, "the range of `{input}`"),
            Condition::Domain { state } => write!(f, "the domain of `{state}`"),
            Condition::Limit { name } => write!(f, "the limit `{name}`"),
            Condition::Mode { mode } => write!(f, "the start in the mode `{mode}`"),
            Condition::LeastDwell { mode } => write!(f, "the least time in the mode `{mode}`"),
            Condition::MostDwell { mode } => write!(f, "the longest time in the mode `{mode}`"),
            Condition::MostEvents => write!(f, "the limit on the number of events"),
        }
    }
}

/// By how much a condition holds.
#[derive(Debug, Clone)]
pub(super) struct Slack {
    pub(super) condition: Condition,
    /// In the condition's unit; negative if it is violated.
    pub(super) slack: f64,
    /// The violation that a tolerance of 1 allows, in the condition's unit: more than 1 for large numbers.
    pub(super) scale: f64,
}

impl Slack {
    /// Of a condition that is counted, or that holds or not.
    pub(super) fn counted(condition: Condition, slack: f64) -> Self {
        Slack { condition, slack, scale: 1.0 }
    }

    /// Of a value within a range.
    pub(super) fn of_range(condition: Condition, range: Interval, value: f64) -> Self {
        let slack = (value - range.lower).min(range.upper - value);
        let scale = margin_scale(value.abs(), range.magnitude());
        Slack { condition, slack, scale }
    }

    /// Of a half-space at a point of states, or of states and then inputs. `None` if nothing is
    /// limited at the step.
    pub(super) fn of_halfspace(
        condition: impl FnOnce(String) -> Condition,
        halfspace: &Halfspace,
        point: &[f64],
        step: usize,
    ) -> Option<Self> {
        let limit = halfspace.limit_at(step);
        if limit == f64::INFINITY {
            return None;
        }
        let (mut slack, mut largest) = (Sum::new(limit), 0.0_f64);
        for (&factor, &value) in halfspace.normal.iter().zip(point) {
            slack.add_product(-factor, value);
            largest = largest.max((factor * value).abs());
        }
        let scale = margin_scale(largest, limit);
        Some(Slack { condition: condition(halfspace.name.clone()), slack: slack.value(), scale })
    }

    /// Of a norm at a point of states, or of states and then inputs.
    pub(super) fn of_norm(
        condition: impl FnOnce(String) -> Condition,
        norm: &NormLimit,
        point: &[f64],
        step: usize,
    ) -> Self {
        let (slack, largest) = norm.slack(point, step);
        Slack { condition: condition(norm.name.clone()), slack, scale: margin_scale(largest, 0.0) }
    }

    /// The slack in units of the scale, by which conditions are compared.
    pub(super) fn scaled(&self) -> f64 {
        self.slack / self.scale
    }

    /// Whether the condition holds to a tolerance. NaN does not.
    pub(super) fn holds(&self, tolerance: f64) -> bool {
        self.scaled() >= -tolerance
    }
}

/// The condition that is the nearest to being violated, or the most violated one.
pub(super) fn tightest(slacks: impl IntoIterator<Item = Slack>) -> Option<Slack> {
    slacks.into_iter().min_by(|a, b| a.scaled().total_cmp(&b.scaled()))
}
