//! Mixed-integer programs as models, for the crate `carom`.
//!
//! Variables, statements and files ([`model`]), solutions and their verification ([`solution`]),
//! and the trait of solvers with its options ([`solver`]). Users take them from `carom`, which has
//! the guide.

pub mod error;
#[doc(hidden)]
pub mod internals;
pub mod interval;
pub mod model;
mod number;
mod rounding;
mod semidefinite;
mod setters;
mod slips;
pub mod solution;
pub mod solver;
mod sum;
pub mod tolerance;
#[cfg(feature = "serde")]
mod wire;

pub use error::{Error, ErrorKind};
