//! Programs with second-order cones under every construct; for the family `cones`.
//!
//! * `case` - a program as plain numbers, as a model, and evaluated
//! * `generator` - the program of a seed
//! * `thin` - programs whose cones have no inside
//! * `moved` - the same program in other coordinates
//! * `continuous` - the best point for fixed integers, by Clarabel and a translation of its own
//! * `oracle` - the answer by enumeration, and the verdict on a solver's

pub(crate) mod case;
mod continuous;
pub(crate) mod generator;
mod moved;
pub(crate) mod oracle;
pub(crate) mod thin;
