//! Handles: small `Copy` values that name a part of one model.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::atomic::{AtomicU64, Ordering};

/// Identifies the model that made a handle. A clone keeps its original's tag, so handles of the
/// original work in the clone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct ModelTag(u32);

impl ModelTag {
    /// A tag that no other model has, not even (with overwhelming probability) one that was
    /// written to a file by another process.
    #[doc(hidden)]
    pub fn fresh() -> Self {
        static TAGS: AtomicU64 = AtomicU64::new(0);
        let mut hasher = RandomState::new().build_hasher();
        hasher.write_u64(TAGS.fetch_add(1, Ordering::Relaxed));
        ModelTag(hasher.finish() as u32)
    }
}

macro_rules! handle {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name {
            pub(crate) index: u32,
            pub(crate) tag: ModelTag,
        }

        impl $name {
            #[doc(hidden)]
            pub fn new(index: usize, tag: ModelTag) -> Self {
                $name { index: u32::try_from(index).unwrap_or(u32::MAX), tag }
            }

            /// The model, or the system, that made it.
            #[doc(hidden)]
            pub fn tag(self) -> ModelTag {
                self.tag
            }

            /// The handle that comes next in the order of creation.
            #[doc(hidden)]
            pub fn successor(self) -> Self {
                $name { index: self.index + 1, ..self }
            }

            /// Position among its kind in the model, in the order of creation, from 0.
            #[inline]
            pub fn index(self) -> usize {
                self.index as usize
            }
        }
    };
}

handle! {
    /// A variable of one [`Model`](super::Model); its value is read from a
    /// [`Solution`](crate::solution::Solution) through this handle.
    Variable
}
handle! {
    /// A linear row `lower <= a'x <= upper` of one [`Model`](super::Model).
    Constraint
}
handle! {
    /// An implication "binary on (or off) implies a row" of one [`Model`](super::Model).
    Indicator
}
handle! {
    /// A disjunction of one [`Model`](super::Model).
    Disjunction
}
handle! {
    /// A special ordered set of one [`Model`](super::Model).
    SpecialOrderedSet
}
handle! {
    /// A norm or a convex quadratic row of one [`Model`](super::Model).
    ConicConstraint
}
handle! {
    /// A logic statement of one [`Model`](super::Model).
    LogicalConstraint
}
