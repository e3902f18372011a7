#![doc = include_str!("../docs/crate_page.md")]

pub mod branch_and_bound;
pub mod collision_tolerant;
pub mod conformance;
pub mod error;
pub mod explain;
#[cfg(not(target_family = "wasm"))]
pub mod external;
pub mod graph_of_sets;
pub mod guide;
#[cfg(all(feature = "highs", not(target_family = "wasm")))]
pub mod highs;
pub mod hybrid;
#[doc(hidden)]
pub mod internals;
pub mod interval;
pub mod model;
mod number;
pub mod picture;
pub mod prelude;
mod presolve;
mod program;
mod proof;
pub mod reformulate;
mod relaxation;
mod search;
mod semidefinite;
mod setters;
mod slips;
pub mod solution;
pub mod solver;
mod sum;
#[cfg(not(target_family = "wasm"))]
pub mod sweep;
pub mod tolerance;
#[cfg(feature = "serde")]
mod wire;

pub use branch_and_bound::BranchAndBound;
pub use error::{Error, ErrorKind};
