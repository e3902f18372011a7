#![doc = include_str!("../README.md")]
#![no_std]

mod answer;
mod real;
mod simplex;
mod table;

pub use answer::Answer;
pub use real::Real;
pub use table::{LookupLeaf, LookupNode, LookupTable};
