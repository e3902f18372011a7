//! The values that depend on the step of a loop, for controllers whose program stays the same in
//! every step.

use super::Model;

impl Model {
    /// Notes that values in the model belong to a step of a loop; `what` in words.
    #[doc(hidden)]
    pub fn note_by_step(&mut self, what: String) {
        self.stored.by_step.get_or_insert(what);
    }

    /// The first note, in words; `None` if there is none.
    #[doc(hidden)]
    pub fn by_step(&self) -> Option<&str> {
        self.stored.by_step.as_deref()
    }
}
