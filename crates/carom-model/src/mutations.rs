//! Mutations of the code: faults of the past that tests bring back, to try what must notice them:
//! the comparison of strengthened programs with accepted points, and the checker of proofs.
//!
//! A mutation is brought back for a thread and the time of a call, in builds with debug assertions.
//! Other builds know none.

use std::cell::Cell;

/// A corrected fault of which a false optimum came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mutation {
    /// The tolerance of a row grows with its largest term.
    ScaledTolerance,
    /// A case that others have selected is left out of the hull of a disjunction.
    ExcludedCase,
    /// A column that a row leaves open on one side counts as switched off.
    OpenSquare,
}

thread_local! {
    static PRESENT: Cell<Option<Mutation>> = const { Cell::new(None) };
}

/// Runs something with a mutation.
pub fn with_mutation<T>(mutation: Mutation, run: impl FnOnce() -> T) -> T {
    struct Restore;
    impl Drop for Restore {
        fn drop(&mut self) {
            PRESENT.set(None);
        }
    }
    PRESENT.set(Some(mutation));
    let _restore = Restore;
    run()
}

/// Whether a mutation is there.
pub fn has(mutation: Mutation) -> bool {
    cfg!(debug_assertions) && PRESENT.get() == Some(mutation)
}

/// Whether any mutation is there.
pub fn has_any() -> bool {
    cfg!(debug_assertions) && PRESENT.get().is_some()
}
