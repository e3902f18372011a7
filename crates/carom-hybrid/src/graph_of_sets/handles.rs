//! Handles of a graph, and what a place of it holds.

use crate::error::{Error, ErrorKind};
use crate::model::{Affine, ConicRow, ModelTag, Norm, Quadratic, Row, Variable};

/// A vertex of a [`GraphOfSets`](super::GraphOfSets).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GraphVertex {
    pub(super) index: usize,
    pub(super) tag: ModelTag,
}

impl GraphVertex {
    /// Position among the vertices, in the order of creation, from 0.
    pub fn index(self) -> usize {
        self.index
    }
}

/// A directed edge of a [`GraphOfSets`](super::GraphOfSets).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GraphEdge {
    pub(super) index: usize,
    pub(super) tag: ModelTag,
}

impl GraphEdge {
    /// Position among the edges, in the order of creation, from 0.
    pub fn index(self) -> usize {
        self.index
    }
}

/// A vertex or an edge: what a statement or a cost is said of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum GraphPlace {
    /// Of the point of a vertex.
    Vertex(GraphVertex),
    /// Of the points at both ends of an edge.
    Edge(GraphEdge),
}

impl From<GraphVertex> for GraphPlace {
    fn from(vertex: GraphVertex) -> Self {
        GraphPlace::Vertex(vertex)
    }
}

impl From<GraphEdge> for GraphPlace {
    fn from(edge: GraphEdge) -> Self {
        GraphPlace::Edge(edge)
    }
}

/// A convex statement of a place: a row, a norm or a convex quadratic row.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ConvexStatement {
    /// An affine row.
    Row(Row),
    /// A norm or a quadratic row.
    Conic(ConicRow),
}

impl From<Row> for ConvexStatement {
    fn from(row: Row) -> Self {
        ConvexStatement::Row(row)
    }
}

impl From<ConicRow> for ConvexStatement {
    fn from(row: ConicRow) -> Self {
        ConvexStatement::Conic(row)
    }
}

/// A convex cost of a place, in the unit of the path's cost: an affine expression, a convex
/// quadratic one or a norm.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ConvexCost {
    /// An affine or convex quadratic expression.
    Quadratic(Quadratic),
    /// A norm.
    Norm(Norm),
}

impl From<Norm> for ConvexCost {
    fn from(norm: Norm) -> Self {
        ConvexCost::Norm(norm)
    }
}

macro_rules! quadratic_costs {
    ($($from:ty),*) => {$(
        impl From<$from> for ConvexCost {
            fn from(cost: $from) -> Self {
                ConvexCost::Quadratic(cost.into())
            }
        }
    )*};
}

quadratic_costs!(f64, Variable, Affine, Quadratic);

/// An error for a handle that another graph made.
pub(super) fn foreign(kind: &'static str, index: usize, place: &str) -> Error {
    ErrorKind::ForeignHandle { kind, index, place: place.to_owned(), name: None }.into()
}
