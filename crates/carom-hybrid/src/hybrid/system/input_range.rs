//! The range of an input in a step: the one rule for rows, sets, simulations and questions.
//!
//! A transition may set a range of an input, in place of the system's. A choice limits an input if
//! one of its transitions sets a range of it, or if no transition of any choice does; its
//! transitions that set none then leave the system's range. An input lies in the ranges of all
//! choices that limit it.

use super::{Choice, HybridSystem, Transition};
use crate::interval::Interval;

impl HybridSystem {
    /// The range that a transition of a choice leaves to an input in a step; `None` if the choice
    /// does not limit the input. The system has been checked.
    pub(crate) fn input_range(
        &self,
        choice: &Choice,
        transition: &Transition,
        input: usize,
        step: usize,
    ) -> Option<Interval> {
        let (name, common) = &self.inputs[input];
        if !choice.sets(name) && self.choices.iter().any(|other| other.sets(name)) {
            return None;
        }
        let range = transition.input_range(name).unwrap_or(common);
        Some(range.get(step).copied().unwrap_or(Interval::REALS))
    }

    /// The range of an input in a step that takes these transitions, one per choice; its ends are
    /// crossed if their ranges have nothing in common.
    pub(crate) fn input_range_of(
        &self,
        taken: &[&Transition],
        input: usize,
        step: usize,
    ) -> Interval {
        let taken = self.choices.iter().zip(taken);
        let ranges = taken.filter_map(|(choice, t)| self.input_range(choice, t, input, step));
        ranges.fold(Interval::REALS, |all, range| all.intersection(range))
    }

    /// The ranges that an input may have in a step, whatever the transitions: for each choice that
    /// limits it the hull over its transitions.
    pub(crate) fn input_ranges(&self, input: usize, step: usize) -> impl Iterator<Item = Interval> {
        self.choices.iter().filter_map(move |choice| {
            let own = choice.transitions.iter();
            let own = own.filter_map(|t| self.input_range(choice, t, input, step));
            own.reduce(|a, b| a.hull(b))
        })
    }
}
