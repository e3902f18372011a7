//! Costs of the plans of a hybrid system, and where they must be when.
//!
//! | part | file |
//! | --- | --- |
//! | costs of stages, ends and transitions | `costs/cost.rs`, as expressions of a program in `costs/add.rs` |
//! | limits that may be exceeded at a price | `costs/soften.rs` |
//! | way-points and time windows | `costs/require.rs` |

mod add;
mod cost;
mod require;
mod soften;

pub use cost::Cost;
pub use require::When;
