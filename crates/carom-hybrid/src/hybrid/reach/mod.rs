#![doc = include_str!("../../../docs/reach.md")]

mod compiled;
mod explain;
mod functions;
mod graph;
mod inputs;
mod joint;
mod joint_transitions;
mod law;
mod lifted;
mod margins;
mod options;
mod picture;
mod polygon;
mod rounding;
mod sentence;
mod set;
mod sets;
mod shape;
mod step;
mod template;
mod tighten;
mod tube;
mod words;

pub use explain::{EmptinessReason, Finding, ReachExplanation};
pub use options::SetOptions;
pub use set::ReachSet;
#[doc(alias("reachability", "reachable set"))]
pub use sets::ReachSets;
pub use tighten::{Change, HorizonVariables, Quantity, Reason, TighteningReport};
pub use tube::Tube;
pub(crate) use words::Words;
