//! Mixed-integer programs as models, for the crate `carom`.
//!
//! Variables, statements and files ([`model`]), solutions and their verification ([`solution`]),
//! and the trait of solvers with its options ([`solver`]). Users take them from `carom`, which has
//! the guide.

mod activity;
mod elementary;
pub mod error;
#[doc(hidden)]
pub mod internals;
pub mod interval;
pub mod model;
mod mutations;
mod number;
mod random;
mod rounding;
mod semidefinite;
#[cfg(feature = "serde")]
mod serde_numbers;
mod setters;
pub mod solution;
pub mod solver;
mod sum;
pub mod tolerance;
mod union_find;

pub use error::{Error, ErrorKind};
