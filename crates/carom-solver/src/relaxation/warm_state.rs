//! Warm starts from the relaxation of a node for those of its children.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use super::cone_cut::ConeCut;

/// A cut of a cone that was a row of a relaxation.
#[derive(Debug, Clone)]
pub(crate) struct ConeCutRow {
    /// The name of the row (see [`Reduced::origin`](crate::presolve::Reduced::origin)).
    pub(crate) name: usize,
    pub(crate) cut: Arc<ConeCut>,
    /// The relaxations in a row in which it had no multiplier.
    pub(crate) idle: u32,
}

/// An opaque state that a method returns from a node and receives at the children of the node, and
/// the cuts of cones that the relaxation had as rows.
///
/// Only the method that made the state can read it. A clone costs two reference counts.
#[derive(Clone)]
pub struct WarmState {
    state: Arc<dyn Any + Send + Sync>,
    cone_rows: Option<Arc<[ConeCutRow]>>,
}

impl WarmState {
    /// Wraps the state of a method.
    pub fn new<T: Any + Send + Sync>(state: T) -> Self {
        WarmState { state: Arc::new(state), cone_rows: None }
    }

    /// The same state with other cuts.
    pub(crate) fn with_cone_rows(self, rows: Vec<ConeCutRow>) -> Self {
        WarmState { cone_rows: Some(rows.into()), ..self }
    }

    /// The cuts of cones that the relaxation had as rows.
    pub(crate) fn cone_rows(&self) -> &[ConeCutRow] {
        self.cone_rows.as_deref().unwrap_or_default()
    }

    /// The state for rewriting, or `None` if it belongs to another method or is shared.
    pub(super) fn get_mut<T: Any>(&mut self) -> Option<&mut T> {
        Arc::get_mut(&mut self.state)?.downcast_mut()
    }

    /// The state, or `None` if it belongs to another method.
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.state.downcast_ref()
    }
}

impl fmt::Debug for WarmState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WarmState").finish_non_exhaustive()
    }
}
