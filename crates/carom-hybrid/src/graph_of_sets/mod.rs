#![doc = include_str!("../../docs/graph_of_sets.md")]

mod beginnings;
mod graph;
mod handles;
mod path;
mod perspective;
mod program;
mod pruning;
mod search;

#[doc(alias("GCS", "graph of convex sets"))]
pub use graph::GraphOfSets;
pub use handles::{ConvexCost, ConvexStatement, GraphEdge, GraphPlace, GraphVertex};
pub use path::{PathStop, ShortestPath};
pub use program::PathProgram;
