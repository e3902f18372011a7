#![doc = include_str!("../../../docs/modules/reach.md")]

mod compiled;
mod explain;
mod graph;
mod joint;
mod law;
mod lifted;
mod moves;
mod picture;
mod polygon;
mod rounding;
mod set;
mod sets;
mod shape;
mod step;
mod template;
mod tighten;
mod tube;

pub use explain::{Finding, Obstacle, ReachExplanation};
pub use set::ReachSet;
pub use sets::{ReachSets, SetOptions};
pub use tighten::{Change, HorizonVariables, Quantity, Reason, TighteningReport};
pub use tube::Tube;
