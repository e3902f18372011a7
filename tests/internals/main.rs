//! What no user sees: presolve, propagation, relaxations and the proofs of what they claim.

#[path = "../common/mod.rs"]
mod common;

mod presolve;
mod propagation;
mod relaxation;
mod strengthening;
mod warm_states;
