//! The modelling language and its reformulations: what statements mean, what they become, and
//! what is refused.

#[path = "../common/mod.rs"]
mod common;

mod bad_input;
mod big_m;
mod cones;
mod conic_conditions;
mod constant_rows;
mod disjunctions;
mod elementary;
mod fragments;
mod functions;
mod implied_bounds;
mod log;
mod logic;
mod nonlinear;
mod norm_sums;
mod ordered_sets;
mod out_of_range;
mod reify;
#[cfg(feature = "serde")]
mod serde;
mod threads;
mod verification;
