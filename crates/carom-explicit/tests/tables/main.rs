//! Tables of laws against solves of single states.

mod laws;
mod programs;
mod sources;
