//! Model files: MPS, LP, CBF, QPLIB and NL, by section, damaged, at random and there and back.

mod cbf;
#[path = "../common/mod.rs"]
mod common;
mod cones;
mod corpus;
mod lp;
mod models;
mod mps;
mod nl;
mod qplib;
mod round_trips;
mod sweeps;
mod there_and_back;
