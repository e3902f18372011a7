//! carom

pub mod branch_and_bound;
pub mod collision_tolerant;
pub mod error;
pub mod hybrid;
pub mod interval;
pub mod model;
pub mod prelude;
pub mod presolve;
pub mod program;
pub mod reformulate;
pub mod relaxation;
pub mod search;
pub mod solution;
pub mod solver;
pub mod tolerance;

pub use branch_and_bound::BranchAndBound;
pub use error::Error;
