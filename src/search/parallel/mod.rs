//! Searches with several workers.
//!
//! * `opportunistic` - one thread, or several that exchange everything at once
//! * `deterministic` - rounds with the same answer for any number of threads, on a `worker_pool`

pub(super) mod deterministic;
pub(super) mod opportunistic;
mod worker_pool;
