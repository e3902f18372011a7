//! What no user sees: presolve, propagation, relaxations and the proofs of what they claim.

#[path = "../common/mod.rs"]
mod common;

mod decimal;
mod exponential;
mod lp_names;
mod name_table;
mod presolve;
mod propagation;
mod relaxation;
mod strengthening;
mod subset;
mod sum;
mod warm_states;
