//! The rows of a flow.

use crate::model::Nonlinear;

/// How the rows of a flow are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FlowKind {
    /// Derivatives, in the states' units per second.
    Rates,
    /// Values at the end of the step.
    NextValues,
}

/// A flow by rows, one for each state.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FlowRows {
    pub(super) kind: FlowKind,
    pub(super) rows: Vec<Nonlinear>,
}
