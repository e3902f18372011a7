#![doc = include_str!("../README.md")]

mod arrays;
mod bounds;
mod build;
mod builder;
mod c_source;
mod certificate;
mod condensed;
mod corner;
mod device_cells;
mod edge_choice;
mod expected_cells;
mod followed_program;
mod form;
mod integer_tree;
mod operations;
mod partition;
mod program_text;
mod proof_of_cell;
mod relaxed;
mod rust_source;
mod saved_table;
mod simplex_cell;
mod source_text;
mod table;
mod tableau;

pub use arrays::LookupArrays;
pub use builder::{ExplicitProgram, TableProgress};
pub use carom_embedded::{
    LookupAnswer, LookupLeaf, LookupNode, LookupNumber, LookupProgram, LookupTable,
};
pub use operations::LookupOperations;
pub use table::{ExplicitTable, TableCell, TableReport};
