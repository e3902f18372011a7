//! Tables of laws against solves of single states.

mod certificates;
mod laws;
mod limits;
mod programs;
mod sources;
