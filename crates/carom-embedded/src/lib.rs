#![doc = include_str!("../README.md")]
#![no_std]

mod answer;
mod program;
mod real;
mod simplex;
mod table;

pub use answer::LookupAnswer;
pub use program::LookupProgram;
pub use real::LookupNumber;
pub use table::{LookupLeaf, LookupNode, LookupTable};
