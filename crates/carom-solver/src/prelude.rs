//! The names that most programs need, listed one by one.
//!
//! ```
//! use carom_solver::prelude::*;
//! ```

pub use crate::BranchAndBound;
pub use carom_model::Error;
pub use carom_model::model::{
    Affine, Either, Literal, Logic, Model, Name, Quadratic, Row, Sense, Variable, VariableKind,
    at_least, at_most, either, exactly, norm,
};
pub use carom_model::solution::{PrimalStatus, Solution, Statistics, Termination, Verification};
pub use carom_model::solver::{Control, Event, Interrupt, Log, Options, Progress, Solver};
