//! The conditions of a system and of its transitions, one after the other: half-spaces and norms of
//! the start of a step, and of what a transition predicts.

use super::affine_form::{AffineForm, combine};
use crate::hybrid::system::{Halfspace, HybridSystem, NormEntry, NormLimit, SystemRow, Transition};
use crate::model::{Affine, norm};

/// The part of a step that a condition speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moment {
    /// States and inputs at the start of the step.
    Start,
    /// Predicted states.
    Prediction,
}

/// The set of a condition.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ConditionSet<'a> {
    HalfSpace(&'a Halfspace),
    Norm(&'a NormLimit),
}

/// A condition as it is stated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepCondition<'a> {
    /// Its position among those of the transition, or of the system.
    pub(crate) number: usize,
    pub(crate) moment: Moment,
    pub(crate) set: ConditionSet<'a>,
}

/// A condition at a step, as maps of the state and the input at its start.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ConditionMaps {
    /// The map is at most 0.
    HalfSpace(AffineForm),
    /// The length of the entries is at most the bound.
    Norm { entries: Vec<AffineForm>, bound: AffineForm },
}

impl Moment {
    /// `factors . z + constant` of what the moment is about, as a map of the state and the input at
    /// the start of the step.
    ///
    /// # Arguments
    ///
    /// * `predicted`: the predicted states.
    /// * `width`: the number of states and inputs.
    pub(crate) fn map(
        self,
        factors: &[f64],
        constant: f64,
        predicted: &[AffineForm],
        width: usize,
    ) -> AffineForm {
        match self {
            Moment::Start => {
                let mut factors = factors.to_vec();
                factors.resize(width, 0.0);
                AffineForm { factors, constant }
            }
            Moment::Prediction => combine(factors.iter().copied(), predicted, width, constant),
        }
    }
}

impl<'a> ConditionSet<'a> {
    pub(crate) fn name(self) -> &'a str {
        match self {
            ConditionSet::HalfSpace(own) => &own.name,
            ConditionSet::Norm(own) => &own.name,
        }
    }

    /// Whether it is a limit for the planner, which explanations may drop, rather than a part of
    /// the system.
    pub(crate) fn is_limit(self) -> bool {
        match self {
            ConditionSet::HalfSpace(own) => own.is_limit,
            ConditionSet::Norm(own) => own.is_limit,
        }
    }

    /// Whether it is about inputs, too.
    ///
    /// # Arguments
    ///
    /// * `states`: the number of states.
    pub(crate) fn is_joint(self, states: usize) -> bool {
        match self {
            ConditionSet::HalfSpace(own) => own.is_joint(states),
            ConditionSet::Norm(own) => own.is_joint(states),
        }
    }

    /// Whether it depends on the step.
    pub(crate) fn varies(self) -> bool {
        match self {
            ConditionSet::HalfSpace(own) => own.limit.varies(),
            ConditionSet::Norm(own) => own.varies(),
        }
    }

    /// The step from which on it does not depend on the step.
    pub(crate) fn settles(self) -> usize {
        match self {
            ConditionSet::HalfSpace(own) => own.limit.settles(),
            ConditionSet::Norm(own) => own.settles(),
        }
    }

    /// The factors of states and inputs, row by row.
    pub(crate) fn factors(self) -> Vec<&'a [f64]> {
        match self {
            ConditionSet::HalfSpace(own) => vec![&own.normal],
            ConditionSet::Norm(own) => own.parts().map(|part| &part.factors[..]).collect(),
        }
    }

    /// The limit, or the constants of the entries and of the bound, at a step.
    pub(crate) fn values_at(self, step: usize) -> Vec<f64> {
        match self {
            ConditionSet::HalfSpace(own) => vec![own.limit_at(step)],
            ConditionSet::Norm(own) => own.parts().map(|part| part.constant_at(step)).collect(),
        }
    }
}

impl<'a> StepCondition<'a> {
    pub(crate) fn name(self) -> &'a str {
        self.set.name()
    }

    /// As [`ConditionSet::is_limit`].
    pub(crate) fn is_limit(self) -> bool {
        self.set.is_limit()
    }

    /// Its maps at a step; `None` if it limits nothing there.
    ///
    /// # Arguments
    ///
    /// * `predicted`: the predicted states, for conditions on them.
    /// * `width`: the number of states and inputs.
    pub(crate) fn maps(
        self,
        predicted: &[AffineForm],
        width: usize,
        step: usize,
    ) -> Option<ConditionMaps> {
        let map =
            |factors: &[f64], constant: f64| self.moment.map(factors, constant, predicted, width);
        match self.set {
            ConditionSet::HalfSpace(own) => {
                let limit = own.limit_at(step);
                limit.is_finite().then(|| ConditionMaps::HalfSpace(map(&own.normal, -limit)))
            }
            ConditionSet::Norm(own) => {
                let of = |part: &NormEntry| map(&part.factors, part.constant_at(step));
                let entries = own.entries.iter().map(of).collect();
                Some(ConditionMaps::Norm { entries, bound: of(&own.bound) })
            }
        }
    }
}

impl ConditionMaps {
    /// It as a row.
    pub(crate) fn row(&self, expression: impl Fn(&AffineForm) -> Affine) -> SystemRow {
        match self {
            ConditionMaps::HalfSpace(map) => expression(map).le(0.0).into(),
            ConditionMaps::Norm { entries, bound } => {
                norm(entries.iter().map(&expression)).le(expression(bound)).into()
            }
        }
    }
}

fn numbered<'a>(
    sets: impl Iterator<Item = (Moment, ConditionSet<'a>)>,
) -> impl Iterator<Item = StepCondition<'a>> {
    sets.enumerate().map(|(number, (moment, set))| StepCondition { number, moment, set })
}

/// Removes an entry of a list, or counts on to the next list; whether it removed one.
fn remove<T>(number: &mut usize, list: &mut Vec<T>) -> bool {
    if *number < list.len() {
        list.remove(*number);
        return true;
    }
    *number -= list.len();
    false
}

impl Transition {
    /// Its conditions: half-spaces, and then norms; of the start of the step, and then of the
    /// prediction.
    pub(crate) fn conditions(&self) -> impl Iterator<Item = StepCondition<'_>> {
        let of = |moment: Moment| {
            let (halfspaces, norms) = match moment {
                Moment::Start => (&self.guards, &self.norms),
                Moment::Prediction => (&self.prediction_guards, &self.prediction_norms),
            };
            let halfspaces = halfspaces.iter().map(ConditionSet::HalfSpace);
            let norms = norms.iter().map(ConditionSet::Norm);
            (halfspaces.map(move |set| (moment, set)), norms.map(move |set| (moment, set)))
        };
        let (start, prediction) = (of(Moment::Start), of(Moment::Prediction));
        numbered(start.0.chain(prediction.0).chain(start.1).chain(prediction.1))
    }

    /// Leaves out a condition by its number.
    pub(crate) fn remove_condition(&mut self, mut number: usize) {
        let k = &mut number;
        let _ = remove(k, &mut self.guards)
            || remove(k, &mut self.prediction_guards)
            || remove(k, &mut self.norms)
            || remove(k, &mut self.prediction_norms);
    }
}

impl HybridSystem {
    /// Its limits: half-spaces, and then norms. Those that are joint hold at every step, the others
    /// at every sample.
    pub(crate) fn conditions(&self) -> impl Iterator<Item = StepCondition<'_>> {
        let halfspaces = self.limits.iter().map(ConditionSet::HalfSpace);
        let all = halfspaces.chain(self.norms.iter().map(ConditionSet::Norm));
        numbered(all.map(|set| (Moment::Start, set)))
    }

    /// Leaves out a limit by its number.
    pub(crate) fn remove_condition(&mut self, mut number: usize) {
        let k = &mut number;
        let _ = remove(k, &mut self.limits) || remove(k, &mut self.norms);
    }

    /// Its limits, and the conditions of all transitions.
    pub(crate) fn all_conditions(&self) -> impl Iterator<Item = StepCondition<'_>> {
        self.conditions().chain(self.transitions().flat_map(Transition::conditions))
    }

    /// The limits of a sample, or those of a step, in whose numbers they are counted.
    pub(crate) fn limits_of(&self, is_step: bool) -> impl Iterator<Item = StepCondition<'_>> {
        let n = self.states.len();
        self.conditions().filter(move |own| own.set.is_joint(n) == is_step)
    }
}
