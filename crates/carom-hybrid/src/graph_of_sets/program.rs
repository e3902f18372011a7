//! The program of a shortest path: flows, copies of points, and their balances.

use super::graph::{GraphOfSets, Said};
use super::handles::{GraphEdge, GraphVertex};
use super::perspective::Copies;
use crate::error::Error;
use crate::model::{Affine, Constraint, Model, Name, Row, Variable, VariableKind};

/// The mixed-integer program of a shortest path through a [`GraphOfSets`], for those who want to
/// add rows.
///
/// Each edge has a binary, its flow, and copies of the points at both of its ends, times the flow.
/// A point of the program is a path, and cycles apart from it, which a shortest path seldom has;
/// [`solve`](Self::solve) excludes those that it meets.
#[derive(Debug, Clone)]
pub struct PathProgram {
    pub(super) graph: GraphOfSets,
    pub(super) model: Model,
    pub(super) ends: [usize; 2],
    /// By edge of the graph; `None` for those that no path takes.
    pub(super) used: Vec<Option<UsedEdge>>,
    /// By vertex: the balance of the flow and those of the coordinates.
    pub(super) balances: Vec<Option<Balance>>,
    /// Rows over flows that all paths satisfy.
    pub(super) flow_rows: Vec<FlowRow>,
    pub(super) is_changed: bool,
    pub(super) cut_count: usize,
}

/// The variables of an edge.
#[derive(Debug, Clone)]
pub(super) struct UsedEdge {
    pub(super) flow: Variable,
    /// The points of both ends, times the flow and from the lower ends of their ranges; `None` for
    /// a coordinate that is fixed.
    pub(super) shifts: [Vec<Option<Variable>>; 2],
    pub(super) cost: Affine,
}

#[derive(Debug, Clone)]
pub(super) struct Balance {
    pub(super) flow: Constraint,
    pub(super) shifts: Vec<Option<Constraint>>,
}

/// `sum terms <= right`, over flows of edges.
#[derive(Debug, Clone)]
pub(super) struct FlowRow {
    pub(super) constraint: Constraint,
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) right: f64,
}

impl GraphOfSets {
    /// The program of a shortest path.
    ///
    /// # Errors
    ///
    /// As for [`shortest_path`](Self::shortest_path), but for those of the solver.
    pub fn program(&self, from: GraphVertex, to: GraphVertex) -> Result<PathProgram, Error> {
        let ends = self.two_ends(from, to, "a path")?;
        self.program_of(ends, &self.usable_edges(ends), VariableKind::Binary)
    }

    /// For each edge, whether a walk between the ends takes it that leaves the first one once and
    /// ends at the last one.
    pub(super) fn usable_edges(&self, [from, to]: [usize; 2]) -> Vec<bool> {
        let is_inner = |edge: &[usize; 2]| edge[1] != from && edge[0] != to;
        let reached = |start: usize, [near, far]: [usize; 2]| {
            let mut reached = vec![false; self.vertices.len()];
            let mut waiting = vec![start];
            let mut next = vec![Vec::new(); self.vertices.len()];
            for edge in self.edges.iter().filter(|edge| is_inner(&edge.ends)) {
                next[edge.ends[near]].push(edge.ends[far]);
            }
            reached[start] = true;
            while let Some(at) = waiting.pop() {
                for &other in &next[at] {
                    if !std::mem::replace(&mut reached[other], true) {
                        waiting.push(other);
                    }
                }
            }
            reached
        };
        let (before, after) = (reached(from, [0, 1]), reached(to, [1, 0]));
        let is_used = |[a, b]: [usize; 2]| is_inner(&[a, b]) && before[a] && after[b];
        self.edges.iter().map(|edge| is_used(edge.ends)).collect()
    }

    /// The program over some edges, with flows of a kind.
    pub(super) fn program_of(
        &self,
        ends: [usize; 2],
        is_used: &[bool],
        kind: VariableKind,
    ) -> Result<PathProgram, Error> {
        let mut model = Model::new(self.name());
        let mut used = Vec::with_capacity(self.edges.len());
        for (edge, _) in is_used.iter().enumerate() {
            let variables = if is_used[edge] {
                let flow = model.variable(self.edges[edge].name.clone(), kind, 0.0, 1.0)?;
                Some(self.add_edge(&mut model, edge, flow, edge_pays_start(self, ends, edge))?)
            } else {
                None
            };
            used.push(variables);
        }
        model.minimize(used.iter().flatten().map(|edge| edge.cost.clone()).sum::<Affine>())?;
        let balances = vec![None; self.vertices.len()];
        let (graph, flow_rows) = (self.clone(), Vec::new());
        let mut program = PathProgram {
            graph,
            model,
            ends,
            used,
            balances,
            flow_rows,
            is_changed: false,
            cut_count: 0,
        };
        for vertex in 0..self.vertices.len() {
            program.add_balance(vertex)?;
        }
        program.add_two_cycles()?;
        Ok(program)
    }

    /// Adds what is said of an edge and of both of its ends.
    pub(super) fn add_edge(
        &self,
        model: &mut Model,
        edge: usize,
        flow: Variable,
        pays_start: bool,
    ) -> Result<UsedEdge, Error> {
        let data = &self.edges[edge];
        let mut shifts = [Vec::new(), Vec::new()];
        for (end, word) in ["from", "into"].into_iter().enumerate() {
            for (k, &variable) in self.vertices[data.ends[end]].point.iter().enumerate() {
                let range = self.frame.variable_ref(variable)?.bounds();
                if range.lower == range.upper {
                    shifts[end].push(None);
                    continue;
                }
                let width = range.upper - range.lower;
                let name = data.name.suffixed(&format!(" {word} {k}"));
                let shift = model.continuous(name.clone(), 0.0, width)?;
                model.add(name, (shift - width * flow).le(0.0))?;
                shifts[end].push(Some(shift));
            }
        }
        let copy = |variable: Variable| self.copy(edge, flow, &shifts, variable);
        let copies = Copies { flow, of: &copy };
        let mut cost = Affine::zero();
        let ends = data.ends.map(|vertex| &self.vertices[vertex].said);
        let parts: [(&str, &Said, bool); 3] =
            [("", &data.said, true), (" from", ends[0], pays_start), (" into", ends[1], true)];
        for (word, said, pays) in parts {
            for (k, statement) in said.statements.iter().enumerate() {
                let name = data.name.suffixed(&format!("{word} set {k}"));
                copies.add_statement(model, &self.frame, &name, statement)?;
            }
            for (k, own) in said.costs.iter().enumerate().filter(|_| pays) {
                let name = data.name.suffixed(&format!("{word} cost {k}"));
                cost += copies.add_cost(model, &self.frame, &name, own)?;
            }
        }
        Ok(UsedEdge { flow, shifts, cost })
    }

    /// A coordinate of an end of an edge, times its flow.
    pub(super) fn copy(
        &self,
        edge: usize,
        flow: Variable,
        shifts: &[Vec<Option<Variable>>; 2],
        variable: Variable,
    ) -> Affine {
        let ends = self.edges[edge].ends.iter().zip(shifts);
        for (&vertex, shifts) in ends {
            let point = &self.vertices[vertex].point;
            let Some(k) = point.iter().position(|v| *v == variable) else { continue };
            let lower = self.frame.variable_ref(variable).map_or(0.0, |v| v.bounds().lower);
            let mut copy = lower * flow;
            if let Some(shift) = shifts[k] {
                copy.add_term(1.0, shift);
            }
            return copy;
        }
        Affine::zero()
    }
}

/// Whether an edge pays the cost of the vertex that it leaves, which nothing enters.
pub(super) fn edge_pays_start(graph: &GraphOfSets, ends: [usize; 2], edge: usize) -> bool {
    graph.edges[edge].ends[0] == ends[0]
}

impl PathProgram {
    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The flow of an edge, 1 if the path takes it; `None` if no path does.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`](crate::error::ErrorKind::ForeignHandle).
    pub fn flow(&self, edge: GraphEdge) -> Result<Option<Variable>, Error> {
        let edge = self.graph.edge_index(edge, "a look-up")?;
        Ok(self.used[edge].as_ref().map(|used| used.flow))
    }

    /// 1 if the path visits a vertex, 0 if not.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`](crate::error::ErrorKind::ForeignHandle).
    pub fn visits(&self, vertex: GraphVertex) -> Result<Affine, Error> {
        Ok(self.visits_of(self.graph.vertex_index(vertex, "a look-up")?))
    }

    /// An expression over the coordinates of both ends of an edge, times its flow: its value if the
    /// path takes the edge, 0 if not.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`](crate::error::ErrorKind::ForeignHandle),
    /// [`ErrorKind::Misplaced`](crate::error::ErrorKind::Misplaced) for a coordinate of another
    /// vertex.
    pub fn at(&self, edge: GraphEdge, expression: impl Into<Affine>) -> Result<Affine, Error> {
        let expression = expression.into();
        self.graph.check_expression(edge, &expression)?;
        let index = edge.index;
        let Some(used) = &self.used[index] else { return Ok(Affine::zero()) };
        let copy = |v: Variable| self.graph.copy(index, used.flow, &used.shifts, v);
        Ok(Copies { flow: used.flow, of: &copy }.times_flow(&expression))
    }

    /// Adds a row over flows and copies, such as one about the whole path.
    ///
    /// # Errors
    ///
    /// Those of [`Model::add`].
    pub fn add(&mut self, name: impl Into<Name>, row: Row) -> Result<Constraint, Error> {
        let constraint = self.model.add(name, row)?;
        self.is_changed = true;
        Ok(constraint)
    }

    fn flows(&self, is_wanted: impl Fn([usize; 2]) -> bool) -> Vec<usize> {
        let edges = self.graph.edges.iter().enumerate();
        let wanted = edges.filter(|(k, edge)| self.used[*k].is_some() && is_wanted(edge.ends));
        wanted.map(|(k, _)| k).collect()
    }

    pub(super) fn flow_sum(&self, edges: &[usize]) -> Affine {
        let mut sum = Affine::zero();
        for used in edges.iter().filter_map(|&edge| self.used[edge].as_ref()) {
            sum.add_term(1.0, used.flow);
        }
        sum
    }

    pub(super) fn visits_of(&self, vertex: usize) -> Affine {
        let near = usize::from(vertex != self.ends[0]);
        self.flow_sum(&self.flows(|ends| ends[near] == vertex))
    }

    /// Adds the balance of a vertex, and that it is visited once at most.
    fn add_balance(&mut self, vertex: usize) -> Result<(), Error> {
        let (enter, leave) = (self.flows(|e| e[1] == vertex), self.flows(|e| e[0] == vertex));
        let name = self.graph.vertices[vertex].name.clone();
        let [from, to] = self.ends;
        if vertex == from || vertex == to {
            let flow = self.flow_sum(if vertex == from { &leave } else { &enter });
            // Without an edge there is no path, which the other end says.
            if !flow.terms().is_empty() {
                self.model.add(name.suffixed(" once"), flow.equals(1.0))?;
            }
            return Ok(());
        }
        if enter.is_empty() && leave.is_empty() {
            return Ok(());
        }
        let difference = self.flow_sum(&enter) - self.flow_sum(&leave);
        let flow = self.model.add(name.suffixed(" flow"), difference.equals(0.0))?;
        let mut shifts = Vec::new();
        for k in 0..self.graph.vertices[vertex].point.len() {
            let mut sum = Affine::zero();
            for (edges, end, sign) in [(&leave, 0, -1.0), (&enter, 1, 1.0)] {
                for used in edges.iter().filter_map(|&edge| self.used[edge].as_ref()) {
                    used.shifts[end][k].iter().for_each(|&shift| sum.add_term(sign, shift));
                }
            }
            let name = name.suffixed(&format!(" balance {k}"));
            let row = sum.equals(0.0);
            let has_terms = !row.expression().terms().is_empty();
            shifts.push(has_terms.then(|| self.model.add(name, row)).transpose()?);
        }
        self.balances[vertex] = Some(Balance { flow, shifts });
        if enter.len() > 1 {
            self.add_flow_row(
                name.suffixed(" once"),
                enter.iter().map(|&e| (e, 1.0)).collect(),
                1.0,
            )?;
        }
        Ok(())
    }

    /// Adds that an edge and the one back are not both taken: both ends are visited from elsewhere,
    /// too.
    fn add_two_cycles(&mut self) -> Result<(), Error> {
        for edge in self.flows(|_| true) {
            let [a, b] = self.graph.edges[edge].ends;
            if self.flows(|ends| ends == [b, a]).is_empty() {
                continue;
            }
            let mut terms: Vec<(usize, f64)> = vec![(edge, 1.0)];
            // The flow into `a` from others than `b`.
            terms.extend(self.flows(|[c, d]| d == a && c != b).into_iter().map(|e| (e, -1.0)));
            let name = self.graph.edges[edge].name.suffixed(" no return");
            if a != self.ends[0] {
                self.add_flow_row(name, terms, 0.0)?;
            }
        }
        Ok(())
    }

    pub(super) fn add_flow_row(
        &mut self,
        name: Name,
        terms: Vec<(usize, f64)>,
        right: f64,
    ) -> Result<(), Error> {
        let mut sum = Affine::zero();
        for &(edge, coefficient) in &terms {
            self.used[edge].iter().for_each(|used| sum.add_term(coefficient, used.flow));
        }
        let constraint = self.model.add(name, sum.le(right))?;
        self.flow_rows.push(FlowRow { constraint, terms, right });
        Ok(())
    }
}
