#![doc = include_str!("../docs/modelling.md")]

#[doc = include_str!("../docs/hybrid_system.md")]
pub mod hybrid_system {}
