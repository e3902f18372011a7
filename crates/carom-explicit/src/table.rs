//! The finished table.

use carom_embedded::LookupAnswer;
use web_time::Duration;

use crate::arrays::{LawOutput, LookupArrays};
use crate::build::Partition;
use crate::form::ParametricForm;

/// The size of a table, and what is proved of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TableReport {
    /// The cells that are not cut.
    pub cells: usize,
    /// The different laws.
    pub laws: usize,
    /// The most comparisons of a look-up.
    pub depth: usize,
    /// The share of the set with a plan whose loss is within ε, from 0 to 1.
    pub proved: f64,
    /// The share with a plan whose loss is larger, or not proved.
    pub unproved: f64,
    /// The share of the set that is proved to have no plan.
    pub refuted: f64,
    /// The share without an answer: cells across the border of what has a plan, and those that the
    /// build did not reach.
    pub open: f64,
    /// The largest proved loss of a plan within ε, in the unit of the objective.
    pub loss: f64,
    /// The relaxations that were solved.
    pub relaxations: u64,
    /// The time that the build took.
    pub duration: Duration,
}

/// A table of laws for a box of parameters, made by
/// [`ExplicitProgram::build`](crate::ExplicitProgram::build).
#[derive(Debug)]
pub struct ExplicitTable {
    pub(crate) form: ParametricForm,
    pub(crate) partition: Partition,
    pub(crate) outputs: Vec<LawOutput>,
    /// The absolute and the relative loss that was asked for.
    pub(crate) goal: [f64; 2],
    pub(crate) report: TableReport,
    pub(crate) arrays: LookupArrays<f64>,
}

impl ExplicitTable {
    /// The size of the table, and what is proved of it.
    #[must_use]
    pub fn report(&self) -> &TableReport {
        &self.report
    }

    /// The table as a device has it, in 64 bits.
    #[must_use]
    pub fn double(&self) -> &LookupArrays<f64> {
        &self.arrays
    }

    /// The table as a device has it, in 32 bits.
    ///
    /// Cells, integers and losses are the same; what is rounded is in
    /// [`state_rounding`](LookupArrays::state_rounding) and
    /// [`input_rounding`](LookupArrays::input_rounding).
    #[must_use]
    pub fn single(&self) -> LookupArrays<f32> {
        self.arrays.single()
    }

    /// Looks up the inputs of a state.
    ///
    /// # Arguments
    ///
    /// * `state`: an entry for each axis, in its unit.
    ///
    /// Returns the answer and the inputs, which are zeros if the answer has none.
    pub fn evaluate(&self, state: &[f64]) -> (LookupAnswer<f64>, Vec<f64>) {
        let mut inputs = vec![0.0; self.arrays.inputs()];
        let answer = self.arrays.view().evaluate(state, &mut inputs);
        (answer, inputs)
    }
}
