//! What no user sees: presolve, propagation, relaxations and the proofs of what they claim.

#[path = "../common/mod.rs"]
mod common;

mod active_set;
mod congruence;
mod conic_propagation;
mod decimal;
mod exponential;
mod extended;
mod lp_names;
mod name_table;
mod open_columns;
mod presolve;
mod propagation;
mod records;
mod relaxation;
mod search;
mod semidefinite;
mod simplex;
mod standard_cone;
mod strengthening;
mod subset;
mod sum;
mod warm_states;
mod whole_terms;
mod worklist;
