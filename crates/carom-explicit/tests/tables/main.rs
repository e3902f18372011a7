//! Tables of laws against solves of single states.

mod certificates;
mod laws;
mod programs;
mod sources;
