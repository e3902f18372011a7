//! The ranges that sets leave to the nonlinear functions of a step, which are inputs.

use std::sync::Arc;

use super::rounding::EPSILON;
use crate::hybrid::system::{Coordinates, StepFunctions};
use crate::interval::Interval;
use crate::tolerance::margin_scale;

/// The functions of a system, for sets in its coordinates.
#[derive(Debug, Clone)]
pub(super) struct FunctionRanges {
    pub(super) functions: Arc<StepFunctions>,
    /// By how much a value in a plan may miss its function, relative to its size (no unit).
    pub(super) margin: f64,
}

impl FunctionRanges {
    /// The ranges of all inputs for states and predictions in boxes, in the coordinates of the sets
    /// but for functions, which have the user's numbers.
    pub(super) fn narrowed(
        &self,
        coordinates: &Coordinates,
        [states, predictions]: [&[Interval]; 2],
        inputs: &[Interval],
    ) -> Vec<Interval> {
        let stated = |own: &[Interval]| -> Vec<Interval> {
            let ranges = own.iter().enumerate();
            ranges.map(|(i, range)| coordinates.state(i).outward_range(*range)).collect()
        };
        let given = inputs.iter().enumerate();
        let given: Vec<Interval> =
            given.map(|(u, range)| coordinates.input(u).outward_range(*range)).collect();
        let found = self.functions.narrowed(&stated(states), &stated(predictions), &given);
        let narrow = |(u, (own, found)): (usize, (&Interval, Interval))| {
            if !self.functions.is_function(u) {
                return *own;
            }
            let size = found.magnitude();
            let slack = self.margin * margin_scale(size, 0.0) + 4.0 * EPSILON * size;
            own.intersection(Interval::new(found.lower - slack, found.upper + slack))
        };
        inputs.iter().zip(found).enumerate().map(narrow).collect()
    }

    /// Whether they depend on predictions.
    pub(super) fn use_predictions(&self) -> bool {
        self.functions.use_predictions()
    }
}
