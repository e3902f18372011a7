#![doc = include_str!("../README.md")]

mod bounds;
mod build;
mod builder;
mod corner;
mod form;
mod integer_tree;
mod proof_of_cell;
mod relaxed;
mod simplex_cell;
mod table;

pub use builder::{ExplicitProgram, TableProgress};
pub use carom_embedded::{Answer, LookupLeaf, LookupNode, LookupTable, Real};
pub use table::{ExplicitTable, TableReport};
