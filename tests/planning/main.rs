//! Planning: hybrid parts, contact laws, reach sets, the paper's planner, the shortest horizon.

#[path = "../common/mod.rs"]
mod common;

mod anytime;
mod collision_tolerant;
mod costs;
mod goals;
mod graph_of_sets;
mod hybrid;
mod loops;
mod mission;
#[cfg(feature = "nalgebra")]
mod nalgebra;
mod nonlinear;
mod physics;
mod reach;
mod receding;
mod robust;
mod rows;
mod runs;
mod scenes;
mod shortest;
mod system;
mod units;
mod words;
