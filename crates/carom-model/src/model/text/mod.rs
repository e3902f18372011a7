//! Shared by the file formats: tokens with their positions, numbers, names, bounds, ordered
//! sets, warnings, and the statements that a file can hold.

pub(crate) mod ends;
pub(crate) mod lines;
pub(crate) mod names;
pub(crate) mod quadratic_rows;
pub(crate) mod read;
pub(crate) mod row_condition;
pub(crate) mod sets;
pub(crate) mod token;
