//! Model files: MPS and LP, by section, damaged, at random and there and back.

#[path = "../common/mod.rs"]
mod common;
mod lp;
mod models;
mod mps;
mod round_trips;
