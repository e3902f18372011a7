//! Searches with several workers.

pub(super) mod deterministic;
pub(super) mod opportunistic;
