#![doc = include_str!("../README.md")]
#![no_std]

mod answer;
mod real;
mod simplex;
mod table;

pub use answer::LookupAnswer;
pub use real::LookupNumber;
pub use table::{LookupLeaf, LookupNode, LookupTable};
