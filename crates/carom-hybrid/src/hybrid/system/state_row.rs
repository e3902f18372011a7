//! Nonlinear rows of the states at a sample: limits, starts and goals.

use crate::elementary::IntervalSeries;
use crate::interval::Interval;
use crate::model::{Affine, NonlinearRow, Variable};

/// A nonlinear row of states.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StateRow {
    pub(crate) name: String,
    /// Whether an explanation may drop it.
    pub(crate) is_limit: bool,
    /// Over the handles of the states.
    row: NonlinearRow,
    /// The handles, with the numbers of the states.
    states: Vec<(Variable, usize)>,
}

impl StateRow {
    pub(super) fn new(
        name: String,
        is_limit: bool,
        row: NonlinearRow,
        states: Vec<(Variable, usize)>,
    ) -> Self {
        StateRow { name, is_limit, row, states }
    }

    /// By how much a state keeps the row, in its unit; negative if it does not.
    pub(crate) fn slack(&self, state: &[f64]) -> f64 {
        self.row.slack(|variable| {
            let own = self.states.iter().find(|(own, _)| *own == variable);
            own.and_then(|(_, i)| state.get(*i)).copied().unwrap_or(f64::NAN)
        })
    }

    /// The least that every state of a box keeps the row by, in its unit; infinitely less than 0 if
    /// it may have no value there.
    pub(crate) fn least_slack(&self, states: &[Interval]) -> f64 {
        let of = |variable: Variable| {
            let own = self.states.iter().find(|(own, _)| *own == variable);
            let range = own.and_then(|(_, i)| states.get(*i)).copied();
            IntervalSeries::constant(range.unwrap_or(Interval::REALS), 1)
        };
        let Some(value) = self.row.expression().series(&of, 1) else { return f64::NEG_INFINITY };
        let value = value.coefficients()[0];
        (value.lower - self.row.lower()).min(self.row.upper() - value.upper)
    }

    /// The row of the states at a sample, in the user's numbers.
    pub(crate) fn over(&self, states: &[Affine]) -> NonlinearRow {
        let entry = &mut |own: &Affine| {
            let mut sum = Affine::constant(own.offset());
            for (variable, factor) in own.terms() {
                let found = self.states.iter().find(|(own, _)| *own == variable);
                if let Some(state) = found.and_then(|(_, i)| states.get(*i)) {
                    sum += factor * state;
                }
            }
            Ok(sum)
        };
        // The closure has no error.
        self.row.try_map(entry).unwrap_or_else(|_| self.row.clone())
    }

    /// The row as text, with the names of the states.
    pub(super) fn text(&self, name: &dyn Fn(usize) -> String) -> String {
        self.row.text(&|variable| {
            let own = self.states.iter().find(|(own, _)| *own == variable);
            own.map_or(String::new(), |(_, i)| name(*i))
        })
    }
}
