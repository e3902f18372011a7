//! Paths, as a solution of the program tells them.

use super::graph::GraphOfSets;
use super::handles::{GraphEdge, GraphVertex};
use super::program::PathProgram;
use crate::error::{Error, ErrorKind};
use crate::model::{Affine, Variable};
use crate::solution::{Solution, Termination};
use crate::solver::{Control, MipStart, Solver};

/// A flow above this is taken (no unit).
const TAKEN: f64 = 0.5;

/// The cost of cycles below which they pay, as a part of the objective.
const SLIGHT: f64 = 1e-9;

/// A path through a [`GraphOfSets`](super::GraphOfSets), with a proved bound.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ShortestPath {
    /// The vertices in their order, with their points.
    pub stops: Vec<PathStop>,
    /// The edges in their order.
    pub edges: Vec<GraphEdge>,
    /// The cost, in its unit.
    pub cost: f64,
    /// The proved lower bound on the cost of all paths.
    pub bound: f64,
    /// Why the search stopped.
    pub termination: Termination,
    /// The number of edges that were left to the search, after those that no shortest path takes.
    pub edges_left: usize,
    /// The number of nodes of the search: beginnings of paths, or nodes of the solver's tree.
    pub nodes: u64,
}

/// A vertex on a path.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PathStop {
    /// The vertex.
    pub vertex: GraphVertex,
    /// Its point, in the units of its coordinates.
    pub point: Vec<f64>,
}

/// The error for a search without a path.
pub(super) fn no_path(termination: Termination) -> Error {
    let help = match termination {
        Termination::Infeasible => "no path of the graph satisfies its sets and edges; check them",
        _ => "give the search more time or nodes",
    };
    ErrorKind::NoPlan { termination: termination.to_string(), help }.into()
}

impl GraphOfSets {
    /// The point of a vertex in a solution, from its distances to the lower ends of its ranges.
    pub(super) fn point_at(
        &self,
        vertex: usize,
        shifts: &[Option<Variable>],
        solution: &Solution,
    ) -> Result<Vec<f64>, Error> {
        let coordinates = self.vertices[vertex].point.iter().zip(shifts);
        coordinates
            .map(|(&variable, shift)| {
                let range = self.frame.variable_ref(variable)?.bounds();
                let shift = shift.map_or(Ok(0.0), |shift| solution.value(shift))?;
                Ok((range.lower + shift).clamp(range.lower, range.upper))
            })
            .collect()
    }
}

impl PathProgram {
    /// Finds a shortest path that satisfies the added rows, too.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPlan`] if there is none, or none was found within the limits; and those of
    /// the solver.
    pub fn solve<S: Solver + ?Sized>(&mut self, solver: &mut S) -> Result<ShortestPath, Error> {
        self.solve_from(None, solver)
    }

    /// As [`solve`](Self::solve), from the edges of a path.
    pub(super) fn solve_from<S: Solver + ?Sized>(
        &mut self,
        path: Option<&[usize]>,
        solver: &mut S,
    ) -> Result<ShortestPath, Error> {
        if self.used.iter().all(Option::is_none) {
            return Err(no_path(Termination::Infeasible));
        }
        let mut start = path.map(|path| self.start(path));
        loop {
            let mut control = Control::default();
            if let Some(start) = &start {
                control = control.with_start(start);
            }
            let solution = solver.solve_with(&self.model, &mut control)?;
            if solution.point().is_none() {
                return Err(no_path(solution.termination()));
            }
            let (path, rest) = self.taken(&solution)?;
            let cost = solution.value(self.cost_of(&rest))?;
            let objective = solution.objective().unwrap_or_default();
            let is_harmless = !self.is_changed && cost >= -SLIGHT * objective.abs().max(1.0);
            if rest.is_empty() || is_harmless {
                return self.read(&solution, &path);
            }
            start = Some(self.start(&path));
            self.cut_cycles(rest)?;
        }
    }

    /// The start that takes these edges.
    fn start(&self, path: &[usize]) -> MipStart {
        let used = self.used.iter().enumerate();
        let values = used.filter_map(|(edge, used)| {
            let taken = if path.contains(&edge) { 1.0 } else { 0.0 };
            Some((used.as_ref()?.flow, taken))
        });
        MipStart::new().with_values(values)
    }

    fn cost_of(&self, edges: &[usize]) -> Affine {
        let used = edges.iter().filter_map(|&edge| self.used[edge].as_ref());
        used.map(|used| used.cost.clone()).sum()
    }

    /// The edges of the path, in their order, and the other edges with a flow.
    fn taken(&self, solution: &Solution) -> Result<(Vec<usize>, Vec<usize>), Error> {
        let mut rest = Vec::new();
        for (edge, used) in self.used.iter().enumerate() {
            if let Some(used) = used
                && solution.value(used.flow)? > TAKEN
            {
                rest.push(edge);
            }
        }
        let (mut path, mut at) = (Vec::new(), self.ends[0]);
        while let Some(k) = rest.iter().position(|&edge| self.graph.edges[edge].ends[0] == at) {
            let edge = rest.swap_remove(k);
            at = self.graph.edges[edge].ends[1];
            path.push(edge);
        }
        Ok((path, rest))
    }

    /// The path of a solution, from its edges in their order.
    pub(super) fn read(&self, solution: &Solution, path: &[usize]) -> Result<ShortestPath, Error> {
        let tag = self.graph.frame.tag();
        let mut stops = Vec::with_capacity(path.len() + 1);
        let mut stop = |edge: usize, end: usize| -> Result<(), Error> {
            let vertex = self.graph.edges[edge].ends[end];
            let Some(used) = &self.used[edge] else { return Ok(()) };
            let point = self.graph.point_at(vertex, &used.shifts[end], solution)?;
            stops.push(PathStop { vertex: GraphVertex { index: vertex, tag }, point });
            Ok(())
        };
        for (k, &edge) in path.iter().enumerate() {
            if k == 0 {
                stop(edge, 0)?;
            }
            stop(edge, 1)?;
        }
        let cost = solution.value(self.cost_of(path))?;
        Ok(ShortestPath {
            stops,
            edges: path.iter().map(|&index| GraphEdge { index, tag }).collect(),
            cost,
            bound: solution.bound().min(cost),
            termination: solution.termination(),
            edges_left: self.used.iter().flatten().count(),
            nodes: solution.statistics().nodes,
        })
    }

    /// Adds rows that exclude the cycles of these edges: of the edges within a set of vertices, at
    /// most as many are taken as vertices are visited, less one.
    fn cut_cycles(&mut self, mut rest: Vec<usize>) -> Result<(), Error> {
        while let Some(first) = rest.pop() {
            let mut cycle = vec![self.graph.edges[first].ends[0]];
            let mut at = self.graph.edges[first].ends[1];
            while let Some(k) = rest.iter().position(|&edge| self.graph.edges[edge].ends[0] == at) {
                cycle.push(at);
                at = self.graph.edges[rest.swap_remove(k)].ends[1];
            }
            let within = |vertex: usize| cycle.contains(&vertex);
            let mut terms = Vec::new();
            for edge in (0..self.used.len()).filter(|&edge| self.used[edge].is_some()) {
                let [a, b] = self.graph.edges[edge].ends;
                if within(a) && within(b) {
                    terms.push((edge, 1.0));
                }
                if within(b) && b != cycle[0] {
                    terms.push((edge, -1.0));
                }
            }
            let name = self.graph.vertices[cycle[0]].name.suffixed(" no cycle");
            self.cut_count += 1;
            let name = name.suffixed(&format!(" {}", self.cut_count));
            self.add_flow_row(name, terms, 0.0)?;
        }
        Ok(())
    }
}
