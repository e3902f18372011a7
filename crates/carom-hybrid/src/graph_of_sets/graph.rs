//! The graph: vertices with points and sets, edges with couplings, costs of both.

use std::ops::RangeInclusive;

use super::handles::{ConvexCost, ConvexStatement, GraphEdge, GraphPlace, GraphVertex, foreign};
use super::perspective::{checked_cone, norm_entries};
use crate::error::{Error, ErrorKind};
use crate::model::{Affine, Model, Name, Quadratic, StoredConic, Variable};

/// A directed graph whose vertices are convex sets and whose edges have convex costs.
///
/// See the [module](super).
#[derive(Debug, Clone)]
pub struct GraphOfSets {
    /// Holds the coordinates of all vertices, and what is said of them and of edges.
    pub(super) frame: Model,
    pub(super) vertices: Vec<VertexData>,
    pub(super) edges: Vec<EdgeData>,
    /// The vertex of each variable of the frame.
    owners: Vec<usize>,
}

/// The rows and costs of a vertex or an edge.
#[derive(Debug, Clone, Default)]
pub(super) struct Said {
    pub(super) statements: Vec<ConvexStatement>,
    pub(super) costs: Vec<ConvexCost>,
}

#[derive(Debug, Clone)]
pub(super) struct VertexData {
    pub(super) name: Name,
    pub(super) point: Vec<Variable>,
    pub(super) said: Said,
}

#[derive(Debug, Clone)]
pub(super) struct EdgeData {
    pub(super) name: Name,
    /// The vertices that it leaves and enters.
    pub(super) ends: [usize; 2],
    pub(super) said: Said,
}

impl GraphOfSets {
    /// A graph without vertices.
    pub fn new(name: impl Into<String>) -> Self {
        GraphOfSets {
            frame: Model::new(name),
            vertices: Vec::new(),
            edges: Vec::new(),
            owners: Vec::new(),
        }
    }

    /// The name.
    pub fn name(&self) -> &str {
        self.frame.name()
    }

    /// Adds a vertex whose point lies in a box, in the units of your coordinates. Statements of the
    /// vertex make the set smaller.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnboundedSet`] for an infinite end of a range, [`ErrorKind::CrossedBounds`],
    /// [`ErrorKind::NotFinite`] for one that is no number, [`ErrorKind::DuplicateName`] for a name
    /// of another vertex, [`ErrorKind::InvalidName`].
    pub fn vertex(
        &mut self,
        name: impl Into<Name>,
        ranges: &[RangeInclusive<f64>],
    ) -> Result<GraphVertex, Error> {
        let name = name.into();
        name.check()?;
        if self.vertices.iter().any(|other| other.name == name) {
            return Err(Error::duplicate_name(&name.to_string(), "vertex"));
        }
        for (k, range) in ranges.iter().enumerate() {
            let (lower, upper) = (*range.start(), *range.end());
            for (end, bound) in [(lower, "lower"), (upper, "upper")] {
                check_number("a bound", &name, end)?;
                if end.is_infinite() {
                    let vertex = name.to_string();
                    return Err(ErrorKind::UnboundedSet { vertex, coordinate: k, bound }.into());
                }
            }
            if lower > upper {
                let name = name.to_string();
                return Err(ErrorKind::CrossedBounds { name, lower, upper }.into());
            }
        }
        let mut point = Vec::with_capacity(ranges.len());
        for (k, range) in ranges.iter().enumerate() {
            let coordinate = format!("{name} {k}");
            point.push(self.frame.continuous(coordinate, *range.start(), *range.end())?);
        }
        let index = self.vertices.len();
        self.owners.extend(point.iter().map(|_| index));
        self.vertices.push(VertexData { name, point, said: Said::default() });
        Ok(GraphVertex { index, tag: self.frame.tag() })
    }

    /// The coordinates of the point of a vertex, for expressions of its statements and costs and of
    /// those of its edges.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn point(&self, vertex: GraphVertex) -> Result<Vec<Variable>, Error> {
        Ok(self.vertices[self.vertex_index(vertex, "a look-up")?].point.clone())
    }

    /// Adds an edge between two vertices. Several edges may do so.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`]; [`ErrorKind::Misplaced`] if both ends are the same, because a
    /// path visits a vertex once.
    pub fn edge(&mut self, from: GraphVertex, to: GraphVertex) -> Result<GraphEdge, Error> {
        let ends = self.two_ends(from, to, "an edge")?;
        let [from, to] = ends.map(|end| self.vertices[end].name.to_string());
        let count = self.edges.iter().filter(|edge| edge.ends == ends).count();
        let name = match count {
            0 => Name::from(format!("{from} to {to}")),
            k => Name::from(format!("{from} to {to} again {k}")),
        };
        self.edges.push(EdgeData { name, ends, said: Said::default() });
        Ok(GraphEdge { index: self.edges.len() - 1, tag: self.frame.tag() })
    }

    /// Adds an edge each way between two vertices.
    ///
    /// # Errors
    ///
    /// As for [`edge`](Self::edge).
    pub fn edges_between(
        &mut self,
        one: GraphVertex,
        other: GraphVertex,
    ) -> Result<[GraphEdge; 2], Error> {
        Ok([self.edge(one, other)?, self.edge(other, one)?])
    }

    /// Adds a convex statement over the coordinates of a vertex, or over those of both ends of an
    /// edge.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`]; [`ErrorKind::Misplaced`] for a coordinate of another vertex;
    /// and those of [`Model::add`] for a row that says nothing or is not convex.
    pub fn add(
        &mut self,
        place: impl Into<GraphPlace>,
        statement: impl Into<ConvexStatement>,
    ) -> Result<(), Error> {
        let (place, statement) = (place.into(), statement.into());
        let (name, _) = self.place(place)?;
        self.check_variables(place, &variables_of(&statement))?;
        // What a model refuses, a graph refuses, too.
        let name = (name.to_string(), self.said(place).statements.len());
        match &statement {
            ConvexStatement::Row(row) => drop(self.frame.add(name, row.clone())?),
            ConvexStatement::Conic(row) => drop(self.frame.add(name, row.clone())?),
        }
        self.said(place).statements.push(statement);
        Ok(())
    }

    /// Adds a convex cost over the coordinates of a vertex, or over those of both ends of an edge,
    /// which a path pays that visits the vertex or takes the edge. Several costs of a place add up.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`]; [`ErrorKind::Misplaced`] for a coordinate of another vertex;
    /// [`ErrorKind::NotFinite`]; [`ErrorKind::NotConvex`].
    pub fn add_cost(
        &mut self,
        place: impl Into<GraphPlace>,
        cost: impl Into<ConvexCost>,
    ) -> Result<(), Error> {
        let (place, cost) = (place.into(), cost.into());
        let (name, _) = self.place(place)?;
        match &cost {
            ConvexCost::Quadratic(expression) => {
                self.check_variables(place, &quadratic_variables(expression))?;
                self.frame.minimize(expression.clone())?;
                self.frame.minimize(0.0)?;
                checked_cone(&self.frame, expression, &name)?;
            }
            ConvexCost::Norm(norm) => {
                let entries = norm_entries(norm);
                let all: Vec<&Affine> = entries.iter().collect();
                self.check_variables(place, &affine_variables(&all))?;
                for entry in &entries {
                    for (_, a) in entry.terms() {
                        check_number("a coefficient of the cost", &name, a)?;
                    }
                    check_number("a constant of the cost", &name, entry.offset())?;
                }
            }
        }
        self.said(place).costs.push(cost);
        Ok(())
    }

    /// The vertices that an edge leaves and enters.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn ends(&self, edge: GraphEdge) -> Result<[GraphVertex; 2], Error> {
        let index = self.edge_index(edge, "a look-up")?;
        Ok(self.edges[index].ends.map(|end| GraphVertex { index: end, tag: self.frame.tag() }))
    }

    /// The name of a vertex.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn vertex_name(&self, vertex: GraphVertex) -> Result<&Name, Error> {
        Ok(&self.vertices[self.vertex_index(vertex, "a look-up")?].name)
    }

    /// The ends of an edge or path.
    pub(super) fn two_ends(
        &self,
        from: GraphVertex,
        to: GraphVertex,
        what: &str,
    ) -> Result<[usize; 2], Error> {
        let ends = [self.vertex_index(from, what)?, self.vertex_index(to, what)?];
        if from == to {
            return Err(ErrorKind::Misplaced {
                name: format!("the vertex `{}`", self.vertices[from.index].name),
                place: format!("both ends of {what}"),
                help: "take two vertices, since a path visits each once; give the end a copy of \
                       the set",
            }
            .into());
        }
        Ok(ends)
    }

    pub(super) fn vertex_index(&self, vertex: GraphVertex, place: &str) -> Result<usize, Error> {
        let is_own = vertex.tag == self.frame.tag() && vertex.index < self.vertices.len();
        if is_own { Ok(vertex.index) } else { Err(foreign("vertex", vertex.index, place)) }
    }

    pub(super) fn edge_index(&self, edge: GraphEdge, place: &str) -> Result<usize, Error> {
        let is_own = edge.tag == self.frame.tag() && edge.index < self.edges.len();
        if is_own { Ok(edge.index) } else { Err(foreign("edge", edge.index, place)) }
    }

    /// The name of a place, and the vertices of which it may speak.
    fn place(&self, place: GraphPlace) -> Result<(Name, Vec<usize>), Error> {
        Ok(match place {
            GraphPlace::Vertex(vertex) => {
                let index = self.vertex_index(vertex, "a statement")?;
                (self.vertices[index].name.clone(), vec![index])
            }
            GraphPlace::Edge(edge) => {
                let data = &self.edges[self.edge_index(edge, "a statement")?];
                (data.name.clone(), data.ends.to_vec())
            }
        })
    }

    fn said(&mut self, place: GraphPlace) -> &mut Said {
        match place {
            GraphPlace::Vertex(vertex) => &mut self.vertices[vertex.index].said,
            GraphPlace::Edge(edge) => &mut self.edges[edge.index].said,
        }
    }

    /// Refuses expressions that an edge cannot take.
    pub(super) fn check_expression(&self, edge: GraphEdge, of: &Affine) -> Result<(), Error> {
        self.edge_index(edge, "an expression")?;
        self.check_variables(edge.into(), &affine_variables(&[of]))
    }

    fn check_variables(&self, place: GraphPlace, variables: &[Variable]) -> Result<(), Error> {
        let (name, vertices) = self.place(place)?;
        for variable in variables {
            let index = variable.index();
            let is_own = variable.tag() == self.frame.tag() && index < self.owners.len();
            if !is_own {
                return Err(foreign("variable", index, &name.to_string()));
            }
            if !vertices.contains(&self.owners[index]) {
                return Err(ErrorKind::Misplaced {
                    name: format!("`{}`", self.frame.variable_ref(*variable)?.name()),
                    place: match place {
                        GraphPlace::Vertex(_) => format!("what is said of the vertex `{name}`"),
                        GraphPlace::Edge(_) => format!("what is said of the edge `{name}`"),
                    },
                    help: "a vertex takes its own coordinates, and an edge those of its two ends",
                }
                .into());
            }
        }
        Ok(())
    }
}

fn check_number(what: &'static str, name: &Name, value: f64) -> Result<(), Error> {
    if value.is_nan() || (value.is_infinite() && what != "a bound") {
        return Err(ErrorKind::NotFinite { name: name.to_string(), what, value }.into());
    }
    Ok(())
}

fn affine_variables(expressions: &[&Affine]) -> Vec<Variable> {
    expressions.iter().flat_map(|e| e.raw_terms().iter().map(|&(v, _)| v)).collect()
}

fn quadratic_variables(expression: &Quadratic) -> Vec<Variable> {
    let products = expression.products().into_iter().flat_map(|(a, b, _)| [a, b]);
    products.chain(affine_variables(&[expression.affine()])).collect()
}

fn variables_of(statement: &ConvexStatement) -> Vec<Variable> {
    match statement {
        ConvexStatement::Row(row) => affine_variables(&[row.expression()]),
        ConvexStatement::Conic(row) => match row.stored() {
            StoredConic::Norm { entries, bound } => {
                let all: Vec<&Affine> = entries.iter().chain([bound]).collect();
                affine_variables(&all)
            }
            StoredConic::Quadratic { expression } => quadratic_variables(expression),
        },
    }
}
