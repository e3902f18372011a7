//! Hybrid systems, contact, reach sets and controllers as mixed-integer programs, for the crate
//! `carom`.
//!
//! Users take them from `carom`, which has the guide. Programs are solved through the trait of
//! solvers: this crate knows no solver.

pub mod graph_of_sets;
pub mod hybrid;
#[doc(hidden)]
pub mod internals;
pub mod picture;

#[cfg(feature = "serde")]
use carom_model::internals::serde_numbers;
use carom_model::internals::{
    activity, elementary, error, interval, model, number, random, setters, solution, solver, sum,
    tolerance, union_find,
};
