//! Tables of laws against solves of single states.

mod builds;
mod certificates;
mod laws;
mod limits;
mod loops;
mod programs;
mod solving;
mod sources;
