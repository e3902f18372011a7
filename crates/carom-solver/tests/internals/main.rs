//! What no user sees: presolve, propagation, relaxations and the proofs of what they claim.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod active_set;
mod cone_towers;
mod congruence;
mod conic_propagation;
mod convex_forms;
mod extended;
mod linear_programs;
mod loosened;
mod open_columns;
mod presolve;
mod propagation;
mod raised_squares;
mod records;
mod relaxation;
mod search;
mod sequential_quadratic;
mod simplex;
mod strengthening;
mod warm_states;
mod whole_terms;
mod worklist;
