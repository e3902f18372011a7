//! The conditions of a step, and by how much they hold.

use crate::error::Condition;
use crate::hybrid::step::{ConditionSet, Moment, StepCondition};
use crate::hybrid::system::{Coordinates, Measure, power_of_two};
use crate::interval::Interval;
use crate::sum::Sum;
use crate::tolerance::margin_scale;

/// How many half roundings of numbers far from 0 a condition may have.
const ROUNDED_TERMS: f64 = 8.0;

/// A limit of the system.
pub(crate) fn limit_condition(own: StepCondition<'_>) -> Condition {
    Condition::Limit { name: own.name().to_owned() }
}

/// A condition of a transition.
pub(crate) fn guard_condition(own: StepCondition<'_>) -> Condition {
    let name = own.name().to_owned();
    match own.moment {
        Moment::Start => Condition::Guard { name },
        Moment::Prediction => Condition::PredictionGuard { name },
    }
}

/// By how much a condition holds.
#[derive(Debug, Clone)]
pub(super) struct Slack {
    pub(super) condition: Condition,
    /// In the condition's unit; negative if it is violated.
    pub(super) slack: f64,
    /// The violation that a tolerance of 1 allows, in the condition's unit: more than 1 for large
    /// numbers, and that of the domains in the condition where these are not of an ordinary size.
    pub(super) scale: f64,
    /// The violation that rounding of numbers far from 0 explains, in the condition's unit.
    pub(super) rounding: f64,
}

/// Sizes of the terms of a condition, for its tolerance: the measures of its states and inputs.
#[derive(Debug, Clone, Copy)]
struct TermSizes {
    /// The largest term, from the origins of its measures.
    largest: f64,
    /// The unit of the condition.
    unit: f64,
    rounding: f64,
}

impl TermSizes {
    /// Of factors at a point, with a constant.
    fn of<'a>(
        coordinates: &Coordinates,
        parts: impl Iterator<Item = (&'a [f64], f64)>,
        point: &[f64],
    ) -> Self {
        let mut own = TermSizes { largest: 0.0, unit: 0.0, rounding: 0.0 };
        let mut is_plain = true;
        for (factors, constant) in parts {
            let mut rest = constant;
            for (k, (&factor, &value)) in factors.iter().zip(point).enumerate() {
                if factor == 0.0 {
                    continue;
                }
                let measure = coordinates.state(k);
                is_plain &= measure.scale == 1.0;
                own.unit = own.unit.max((factor * measure.scale).abs());
                own.largest = own.largest.max((factor * (value - measure.origin)).abs());
                rest += factor * measure.origin;
                if measure.origin != 0.0 {
                    own.rounding = own.rounding.max((factor * value).abs());
                }
            }
            if rest.is_finite() {
                own.largest = own.largest.max(rest.abs());
            }
        }
        match is_plain || own.unit == 0.0 {
            true => TermSizes { unit: 1.0, ..own },
            // A unit of a power of two, as that of the measures.
            false => TermSizes { unit: power_of_two(own.unit), ..own },
        }
    }

    fn slack(self, condition: Condition, slack: f64) -> Slack {
        let scale = self.unit * margin_scale(self.largest / self.unit, 0.0);
        let rounding = ROUNDED_TERMS * f64::EPSILON * self.rounding;
        Slack { condition, slack, scale, rounding }
    }
}

impl Slack {
    /// Of a condition that is counted, or that holds or not.
    pub(super) fn counted(condition: Condition, slack: f64) -> Self {
        Slack { condition, slack, scale: 1.0, rounding: 0.0 }
    }

    /// Of a value within a range.
    pub(super) fn of_range(
        condition: Condition,
        range: Interval,
        value: f64,
        measure: Measure,
    ) -> Self {
        let slack = (value - range.lower).min(range.upper - value);
        let own = measure.inward_range(range);
        let scale = measure.scale * margin_scale(measure.inward(value).abs(), own.magnitude());
        let far = if measure.origin == 0.0 { 0.0 } else { value.abs() };
        Slack { condition, slack, scale, rounding: ROUNDED_TERMS * f64::EPSILON * far }
    }

    /// Of a set at a point of states, or of states and then inputs. `None` if nothing is limited
    /// at the step.
    pub(super) fn of_set(
        condition: Condition,
        set: ConditionSet<'_>,
        coordinates: &Coordinates,
        point: &[f64],
        step: usize,
    ) -> Option<Self> {
        match set {
            ConditionSet::HalfSpace(own) => {
                let limit = own.limit_at(step);
                if limit == f64::INFINITY {
                    return None;
                }
                let mut slack = Sum::new(limit);
                for (&factor, &value) in own.normal.iter().zip(point) {
                    slack.add_product(-factor, value);
                }
                let parts = std::iter::once((&own.normal[..], -limit));
                let sizes = TermSizes::of(coordinates, parts, point);
                Some(sizes.slack(condition, slack.value()))
            }
            ConditionSet::Norm(own) => {
                let parts = own.parts().map(|part| (&part.factors[..], part.constant_at(step)));
                let sizes = TermSizes::of(coordinates, parts, point);
                Some(sizes.slack(condition, own.slack(point, step)))
            }
        }
    }

    /// The slack in units of the scale, by which conditions are compared.
    pub(super) fn scaled(&self) -> f64 {
        self.slack / self.scale
    }

    /// Whether the condition holds to a tolerance. NaN does not.
    pub(super) fn holds(&self, tolerance: f64) -> bool {
        self.slack >= -(tolerance * self.scale + self.rounding)
    }
}

/// The condition that is the nearest to being violated, or the most violated one.
pub(super) fn tightest(slacks: impl IntoIterator<Item = Slack>) -> Option<Slack> {
    slacks.into_iter().min_by(|a, b| a.scaled().total_cmp(&b.scaled()))
}
