#![doc = include_str!("../docs/crate_page.md")]

pub mod collision_tolerant;
pub mod guide;
pub mod prelude;

#[doc(inline)]
pub use carom_conformance as conformance;
#[doc(inline)]
pub use carom_explicit as explicit;
#[doc(inline)]
pub use carom_hybrid::{graph_of_sets, hybrid, picture};
#[doc(inline)]
pub use carom_model::{Error, ErrorKind, error, interval, model, solution, solver, tolerance};
#[cfg(not(target_family = "wasm"))]
#[doc(inline)]
pub use carom_solver::external;
#[cfg(all(feature = "highs", not(target_family = "wasm")))]
#[doc(inline)]
pub use carom_solver::highs;
#[doc(inline)]
pub use carom_solver::{BranchAndBound, branch_and_bound, explain, reformulate};
#[cfg(not(target_family = "wasm"))]
#[doc(inline)]
pub use carom_sweep as sweep;
