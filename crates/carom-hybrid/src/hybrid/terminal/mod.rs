//! Ends of plans: the terminal cost and the terminal set of a mode under linear feedback.

mod lqr;
mod polyhedron;
mod set;
mod stay;

pub use lqr::Lqr;
pub use set::{TerminalOptions, TerminalSet};

pub(crate) use stay::Stay;
