//! Shared by the file formats: tokens with their positions, numbers, names, bounds, and the
//! statements that a file can hold.

pub(crate) mod ends;
pub(crate) mod lines;
pub(crate) mod names;
pub(crate) mod token;
