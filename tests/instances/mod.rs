//! The programs of `docs/benchmarks.md`, for tests, benches and examples.

// Each of these uses a part of this module.
#![allow(dead_code)]

pub(crate) mod generators;
pub(crate) mod large;
pub(crate) mod moving_walls;
pub(crate) mod random_miqp;
mod riccati;
pub(crate) mod suite;
pub(crate) mod unit_commitment;
