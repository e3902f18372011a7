//! The search over beginnings of paths, the most promising one first.
//!
//! The cost of every path that begins in one way is at least the least cost of that beginning, less
//! the potential of its last vertex at its point, plus the least sum of prices from there to the
//! end: a convex program over the points of the beginning. Where a beginning is the whole path, the
//! program is that of the path itself.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::graph::GraphOfSets;
use super::handles::{GraphEdge, GraphVertex};
use super::path::{PathStop, ShortestPath};
use super::perspective::Copies;
use super::pruning::{Potentials, Prices};
use super::search::Timed;
use crate::error::Error;
use crate::model::{Affine, Model, Variable};
use crate::solution::{Solution, Termination};
use crate::solver::Solver;

/// The most beginnings that are solved before the search is left to the solver.
const MOST_BEGINNINGS: u64 = 20_000;

/// A beginning of a path, and a bound on the cost of all paths that begin so.
struct Beginning {
    bound: f64,
    edges: Vec<usize>,
}

impl PartialEq for Beginning {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Beginning {}

impl PartialOrd for Beginning {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Beginning {
    /// The largest one in a heap has the least bound; of several the longest, so that some end
    /// early.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_bound = other.bound.total_cmp(&self.bound);
        let by_length = || self.edges.len().cmp(&other.edges.len());
        by_bound.then_with(by_length).then_with(|| other.edges.cmp(&self.edges))
    }
}

/// The program of a beginning, and the points of its vertices from the lower ends of their ranges.
struct BeginningProgram {
    model: Model,
    shifts: Vec<Vec<Option<Variable>>>,
}

/// A search over beginnings of paths.
pub(super) struct Beginnings<'a> {
    graph: &'a GraphOfSets,
    potentials: &'a Potentials,
    prices: &'a Prices,
    /// By vertex, the edges that leave it and may be on a better path.
    leave: Vec<Vec<usize>>,
    edges_left: usize,
}

impl<'a> Beginnings<'a> {
    pub(super) fn new(
        graph: &'a GraphOfSets,
        potentials: &'a Potentials,
        prices: &'a Prices,
        is_used: &[bool],
    ) -> Self {
        let mut leave = vec![Vec::new(); graph.vertices.len()];
        let used = graph.edges.iter().enumerate().filter(|(edge, _)| is_used[*edge]);
        used.for_each(|(edge, data)| leave[data.ends[0]].push(edge));
        let edges_left = leave.iter().map(Vec::len).sum();
        Beginnings { graph, potentials, prices, leave, edges_left }
    }

    /// The best path, from a known one and the bound of the relaxation; `None` if there are too
    /// many beginnings or a program is not solved.
    pub(super) fn search<S: Solver + ?Sized>(
        &self,
        known: ShortestPath,
        relaxed: f64,
        timed: &mut Timed<'_, S>,
    ) -> Result<Option<ShortestPath>, Error> {
        let [from, to] = self.potentials.ends;
        let mut best = known;
        // Below all paths that are not on the heap.
        let mut bound = best.bound;
        let mut nodes = 0;
        let first = Beginning { bound: relaxed, edges: Vec::new() };
        let mut heap = BinaryHeap::from([first]);
        while let Some(beginning) = heap.pop() {
            let gap = timed.solver().options().allowed_gap(best.cost, 0.0);
            if beginning.bound >= best.cost - gap {
                bound = bound.min(beginning.bound);
                break;
            }
            let at = beginning.edges.last().map_or(from, |&edge| self.graph.edges[edge].ends[1]);
            for &edge in &self.leave[at] {
                let next = self.graph.edges[edge].ends[1];
                let is_visited = |&other: &usize| self.graph.edges[other].ends[1] == next;
                if next == from || beginning.edges.iter().any(is_visited) {
                    continue;
                }
                let edges = [&beginning.edges[..], &[edge]].concat();
                // A sum of prices may already be too large.
                let sum: f64 = edges.iter().map(|&edge| self.prices.prices[edge]).sum();
                let least = sum + self.prices.after[next] + self.prices.refund;
                let least = if least > beginning.bound { least } else { beginning.bound };
                if least > best.cost {
                    continue;
                }
                nodes += 1;
                let program = self.program(&edges)?;
                let solution = timed.solver().solve(&program.model)?;
                if solution.is_infeasible() {
                    continue;
                }
                if solution.termination().is_limit() {
                    best.bound = bound.min(beginning.bound).min(best.cost);
                    best.termination = solution.termination();
                    (best.nodes, best.edges_left) = (nodes, self.edges_left);
                    return Ok(Some(best));
                }
                if !solution.is_optimal() || nodes > MOST_BEGINNINGS {
                    return Ok(None);
                }
                if next == to {
                    bound = bound.min(solution.bound());
                    let cost = solution.objective().unwrap_or(f64::INFINITY);
                    if cost < best.cost {
                        best = self.read(&edges, &program, &solution)?;
                    }
                    continue;
                }
                let charges: f64 = edges.iter().map(|&edge| self.potentials.charges[edge]).sum();
                let rest = charges + self.prices.after[next] + self.prices.refund;
                let own = solution.bound() + rest;
                heap.push(Beginning { bound: if own > least { own } else { least }, edges });
            }
        }
        best.bound = bound.min(best.cost);
        best.termination = Termination::Optimal;
        (best.nodes, best.edges_left) = (nodes, self.edges_left);
        Ok(Some(best))
    }

    /// The program over the points of a beginning: its cost, less the potential of its last vertex.
    fn program(&self, edges: &[usize]) -> Result<BeginningProgram, Error> {
        let graph = self.graph;
        let mut model = Model::new("beginning");
        // A program with integers, if fixed ones, is solved without multipliers, which nobody asks
        // for.
        let flow = model.binary("flow")?;
        model.fix(flow, 1.0)?;
        let (mut shifts, mut cost) = (Vec::new(), Affine::zero());
        let stops = self.stops(edges);
        for &stop in &stops {
            let data = &graph.vertices[stop];
            let mut own = Vec::new();
            for (k, &variable) in data.point.iter().enumerate() {
                let width = graph.frame.variable_ref(variable)?.bounds().width();
                let name = data.name.suffixed(&format!(" {k}"));
                let shift = |model: &mut Model| model.continuous(name, 0.0, width);
                own.push((width > 0.0).then(|| shift(&mut model)).transpose()?);
            }
            shifts.push(own);
        }
        for (k, &edge) in edges.iter().enumerate() {
            let data = &graph.edges[edge];
            let pair = [shifts[k].clone(), shifts[k + 1].clone()];
            let copy = |variable: Variable| graph.copy(edge, flow, &pair, variable);
            let copies = Copies { flow, of: &copy };
            let parts = [
                (k == 0)
                    .then_some((&graph.vertices[stops[0]].said, &graph.vertices[stops[0]].name)),
                Some((&data.said, &data.name)),
                Some((&graph.vertices[stops[k + 1]].said, &graph.vertices[stops[k + 1]].name)),
            ];
            for (said, name) in parts.into_iter().flatten() {
                for (k, statement) in said.statements.iter().enumerate() {
                    let name = name.suffixed(&format!(" set {k}"));
                    copies.add_statement(&mut model, &graph.frame, &name, statement)?;
                }
                for (k, own) in said.costs.iter().enumerate() {
                    let name = name.suffixed(&format!(" cost {k}"));
                    cost += copies.add_cost(&mut model, &graph.frame, &name, own)?;
                }
            }
        }
        if let (Some(&last), Some(shifts)) = (stops.last(), shifts.last())
            && last != self.potentials.ends[1]
        {
            cost -= self.potentials.at(last, shifts);
        }
        model.minimize(cost)?;
        Ok(BeginningProgram { model, shifts })
    }

    /// The vertices of a beginning.
    fn stops(&self, edges: &[usize]) -> Vec<usize> {
        let mut stops = vec![self.potentials.ends[0]];
        stops.extend(edges.iter().map(|&edge| self.graph.edges[edge].ends[1]));
        stops
    }

    /// The path of a solution.
    fn read(
        &self,
        edges: &[usize],
        program: &BeginningProgram,
        solution: &Solution,
    ) -> Result<ShortestPath, Error> {
        let tag = self.graph.frame.tag();
        let mut stops = Vec::new();
        for (index, shifts) in self.stops(edges).into_iter().zip(&program.shifts) {
            let point = self.graph.point_at(index, shifts, solution)?;
            stops.push(PathStop { vertex: GraphVertex { index, tag }, point });
        }
        Ok(ShortestPath {
            stops,
            edges: edges.iter().map(|&index| GraphEdge { index, tag }).collect(),
            cost: solution.objective().unwrap_or(f64::INFINITY),
            bound: solution.bound(),
            termination: solution.termination(),
            edges_left: self.edges_left,
            nodes: 0,
        })
    }
}
