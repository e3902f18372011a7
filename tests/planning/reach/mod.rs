//! Reach sets: what they contain, what they exclude, and what they say about programs.

mod exact;
mod joint;
mod memory;
mod modes;
mod plants;
mod programs;
mod refusals;
mod rounding;
mod runs;
mod searches;
mod systems;
