//! Tables of laws against solves of single states.

mod builds;
mod certificates;
mod laws;
mod limits;
mod programs;
mod sources;
