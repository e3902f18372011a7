//! Warm starts from the relaxation of a node for those of its children.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// An opaque state that a method returns from a node and receives at the children of the node.
///
/// Only the method that made it can read it. A clone costs one reference count.
#[derive(Clone)]
pub struct WarmState(Arc<dyn Any + Send + Sync>);

impl WarmState {
    /// Wraps the state of a method.
    pub fn new<T: Any + Send + Sync>(state: T) -> Self {
        WarmState(Arc::new(state))
    }

    /// The state for rewriting, or `None` if it belongs to another method or is shared.
    pub(super) fn get_mut<T: Any>(&mut self) -> Option<&mut T> {
        Arc::get_mut(&mut self.0)?.downcast_mut()
    }

    /// The state, or `None` if it belongs to another method.
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.downcast_ref()
    }
}

impl fmt::Debug for WarmState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WarmState").finish_non_exhaustive()
    }
}
