#![doc = include_str!("../README.md")]

pub mod branch_and_bound;
pub mod explain;
#[cfg(not(target_family = "wasm"))]
pub mod external;
#[cfg(all(feature = "highs", not(target_family = "wasm")))]
pub mod highs;
#[doc(hidden)]
pub mod internals;
pub mod prelude;
mod presolve;
mod program;
mod proof;
pub mod reformulate;
mod relaxation;
mod search;
#[cfg(feature = "nonlinear")]
mod spatial;

pub use branch_and_bound::BranchAndBound;
pub use carom_model;

#[cfg(feature = "nonlinear")]
use carom_model::internals::elementary;
#[cfg(feature = "serde")]
use carom_model::internals::serde_numbers;
use carom_model::internals::{
    activity, error, interval, model, mutations, number, random, semidefinite, setters, solution,
    solver, sum, tolerance, union_find,
};
