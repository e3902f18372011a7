//! The search for a shortest path: a relaxation, paths along its flows, and a program over the
//! edges that may be on a better path.

use std::time::Duration;

use web_time::Instant;

use super::beginnings::Beginnings;
use super::graph::GraphOfSets;
use super::handles::GraphVertex;
use super::path::{ShortestPath, no_path};
use super::program::PathProgram;
use super::pruning::Potentials;
use crate::error::{Error, ErrorKind};
use crate::model::VariableKind;
use crate::solution::{Solution, Termination};
use crate::solver::Solver;

/// The most walks along the flows of the relaxation.
const WALKS: u64 = 20;

/// A flow below this is none (no unit).
const SLIGHT_FLOW: f64 = 1e-6;

/// A path that was found, its edges and its points.
type Known = (Vec<usize>, ShortestPath);

impl GraphOfSets {
    /// Finds a path of least cost from one vertex to another, which visits each vertex at most once
    /// and whose points are in the sets of its vertices and satisfy the statements of its edges.
    ///
    /// The relaxation comes first. Paths along its flows are tried, its multipliers prove for most
    /// edges that no better path takes them, and beginnings of paths over the others are searched,
    /// the most promising one first; if there are very many, the program of the others is solved.
    /// The time limit of the solver is that of all.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPlan`](crate::error::ErrorKind::NoPlan) if there is no path, or none was
    /// found within the limits;
    /// [`ErrorKind::ForeignHandle`](crate::error::ErrorKind::ForeignHandle);
    /// [`ErrorKind::Misplaced`](crate::error::ErrorKind::Misplaced) if both ends are the same; and
    /// those of the solver.
    pub fn shortest_path<S: Solver + ?Sized>(
        &self,
        from: GraphVertex,
        to: GraphVertex,
        solver: &mut S,
    ) -> Result<ShortestPath, Error> {
        let ends = self.two_ends(from, to, "a path")?;
        let limit = solver.options().time_limit;
        let found = self.search(ends, &mut Timed { solver, limit, began: Instant::now() });
        solver.options_mut().time_limit = limit;
        found
    }

    fn search<S: Solver + ?Sized>(
        &self,
        ends: [usize; 2],
        timed: &mut Timed<'_, S>,
    ) -> Result<ShortestPath, Error> {
        let mut is_used = self.usable_edges(ends);
        let relaxed = self.program_of(ends, &is_used, VariableKind::Continuous)?;
        let solution = timed.solver().solve(&relaxed.model)?;
        if solution.is_infeasible() || !is_used.contains(&true) {
            return Err(no_path(Termination::Infeasible));
        }
        let known = self.along_flows(&relaxed, &solution, timed)?;
        let mut least = f64::INFINITY;
        if let Some((path, best)) = &known
            && let Some(potentials) = Potentials::of(&relaxed, &solution)
        {
            least = best.cost;
            let prices = self.prune(&potentials, least, &mut is_used, |model| {
                let solution = timed.solver().solve(model)?;
                Ok(if solution.is_infeasible() { f64::INFINITY } else { solution.bound() })
            })?;
            path.iter().for_each(|&edge| is_used[edge] = true);
            let beginnings = Beginnings::new(self, &potentials, &prices, &is_used);
            if let Some(found) = beginnings.search(best.clone(), solution.bound(), timed)? {
                return Ok(found);
            }
        }
        let mut program = self.program_of(ends, &is_used, VariableKind::Binary)?;
        let path = known.as_ref().map(|(path, _)| &path[..]);
        let mut found = match (program.solve_from(path, timed.solver()), known) {
            // The known path is better than none.
            (Err(error), Some((_, known))) if is_limit(&error) => {
                let termination = Termination::TimeLimit;
                ShortestPath { bound: solution.bound(), termination, ..known }
            }
            (found, _) => found?,
        };
        found.bound = found.bound.min(least);
        Ok(found)
    }

    /// The program over the edges of a path.
    fn program_along(&self, ends: [usize; 2], path: &[usize]) -> Result<PathProgram, Error> {
        let mut is_used = vec![false; self.edges.len()];
        path.iter().for_each(|&edge| is_used[edge] = true);
        self.program_of(ends, &is_used, VariableKind::Binary)
    }

    /// The best path along the flows of a relaxation.
    fn along_flows<S: Solver + ?Sized>(
        &self,
        relaxed: &PathProgram,
        solution: &Solution,
        timed: &mut Timed<'_, S>,
    ) -> Result<Option<Known>, Error> {
        if solution.point().is_none() {
            return Ok(None);
        }
        let mut flows = vec![0.0; self.edges.len()];
        for (flow, used) in flows.iter_mut().zip(&relaxed.used) {
            *flow = used.as_ref().map_or(Ok(0.0), |used| solution.value(used.flow))?;
        }
        let (mut best, mut seen): (Option<Known>, Vec<Vec<usize>>) = (None, Vec::new());
        for walk in 0..WALKS {
            let Some(path) = self.walk(relaxed.ends, &flows, walk) else { continue };
            if seen.contains(&path) {
                continue;
            }
            let along = self.program_along(relaxed.ends, &path)?;
            let solution = timed.solver().solve(&along.model)?;
            if solution.point().is_some() {
                let found = along.read(&solution, &path)?;
                if best.as_ref().is_none_or(|(_, least)| found.cost < least.cost) {
                    best = Some((path.clone(), found));
                }
            }
            seen.push(path);
        }
        Ok(best)
    }

    /// A walk that takes edges with the probabilities of their flows, or, for the number 0, the
    /// largest flow; `None` if it ends elsewhere.
    fn walk(&self, [from, to]: [usize; 2], flows: &[f64], number: u64) -> Option<Vec<usize>> {
        let (mut at, mut path, mut state) = (from, Vec::new(), number);
        let mut is_visited = vec![false; self.vertices.len()];
        while at != to {
            is_visited[at] = true;
            let leave = self.edges.iter().enumerate().filter(|(k, edge)| {
                edge.ends[0] == at && !is_visited[edge.ends[1]] && flows[*k] > SLIGHT_FLOW
            });
            let leave: Vec<usize> = leave.map(|(k, _)| k).collect();
            let mut taken = *leave.iter().max_by(|a, b| flows[**a].total_cmp(&flows[**b]))?;
            if number > 0 {
                // A linear congruential generator: the same walks in every run.
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(number | 1);
                let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
                let mut left = share * leave.iter().map(|&edge| flows[edge]).sum::<f64>();
                for &edge in &leave {
                    left -= flows[edge];
                    if left <= 0.0 {
                        taken = edge;
                        break;
                    }
                }
            }
            path.push(taken);
            at = self.edges[taken].ends[1];
        }
        Some(path)
    }
}

/// Whether a search was stopped before it had a path.
fn is_limit(error: &Error) -> bool {
    let infeasible = Termination::Infeasible.to_string();
    matches!(error.kind(), ErrorKind::NoPlan { termination, .. } if *termination != infeasible)
}

/// A solver whose time limit is that of several solves.
pub(super) struct Timed<'a, S: ?Sized> {
    solver: &'a mut S,
    limit: Option<Duration>,
    began: Instant,
}

impl<S: Solver + ?Sized> Timed<'_, S> {
    /// The solver, with the time that is left.
    pub(super) fn solver(&mut self) -> &mut S {
        let left = self.limit.map(|limit| limit.saturating_sub(self.began.elapsed()));
        self.solver.options_mut().time_limit = left;
        self.solver
    }
}
