//! Slips of the past that tests bring back, to try what must notice them: the comparison of
//! strengthened programs with accepted points, and the checker of proofs.
//!
//! A slip is brought back for a thread and the time of a call, in builds with debug assertions.
//! Other builds know none.

use std::cell::Cell;

/// A mended slip of which a false optimum came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slip {
    /// The tolerance of a row grows with its largest term.
    ScaledTolerance,
    /// A case that others have selected is left out of the hull of a disjunction.
    ExcludedCase,
    /// A column that a row leaves open on one side counts as switched off.
    OpenSquare,
}

thread_local! {
    static PRESENT: Cell<Option<Slip>> = const { Cell::new(None) };
}

/// Runs something with a slip.
pub fn with_slip<T>(slip: Slip, run: impl FnOnce() -> T) -> T {
    struct Mend;
    impl Drop for Mend {
        fn drop(&mut self) {
            PRESENT.set(None);
        }
    }
    PRESENT.set(Some(slip));
    let _mend = Mend;
    run()
}

/// Whether a slip is there.
pub fn has(slip: Slip) -> bool {
    cfg!(debug_assertions) && PRESENT.get() == Some(slip)
}

/// Whether any slip is there.
pub fn has_any() -> bool {
    cfg!(debug_assertions) && PRESENT.get().is_some()
}
