//! Edges that no path takes which is better than a known one.
//!
//! Multipliers of the balances of a relaxation are potentials: an affine function of the point at each
//! vertex. Along a path their differences cancel, so its cost is at least the sum of the prices of its edges,
//! where the price is the least cost of the edge with the potentials of both ends, over all pairs of points.
//! That holds for any potentials. The multipliers of a relaxation are those for which the least sum of
//! prices is the bound of the relaxation, and sums that are larger than the cost of a known path exclude
//! all edges that are only on such paths. The price of each edge is a small convex program, whose bound is
//! proved.

use super::graph::GraphOfSets;
use super::program::PathProgram;
use crate::error::Error;
use crate::model::{Affine, Model};
use crate::solution::Solution;

/// The most paths that are solved one by one, and the most edges looked at for them.
const FEW: usize = 60;
const LOOKS: usize = 20_000;

/// The most edges of such a path.
const LONGEST: usize = 200;

/// Potentials of vertices, and charges for edges.
pub(super) struct Potentials {
    ends: [usize; 2],
    /// By vertex: of the flow and of each coordinate, from the lower end of its range.
    flow: Vec<f64>,
    shifts: Vec<Vec<f64>>,
    /// By edge, for rows over flows that all paths satisfy, and what these charges give back.
    charges: Vec<f64>,
    refund: f64,
}

impl Potentials {
    /// Those that the solution of a relaxation proves its bound with; `None` if it has none.
    pub(super) fn of(relaxed: &PathProgram, solution: &Solution) -> Option<Potentials> {
        let prices = solution.multipliers()?;
        let count = relaxed.balances.len();
        let mut potentials = Potentials {
            ends: relaxed.ends,
            flow: vec![0.0; count],
            shifts: vec![Vec::new(); count],
            charges: vec![0.0; relaxed.used.len()],
            refund: 0.0,
        };
        for (vertex, balance) in relaxed.balances.iter().enumerate() {
            let Some(balance) = balance else { continue };
            potentials.flow[vertex] = prices.shadow_price(balance.flow).ok()?;
            for shift in &balance.shifts {
                let price = shift.map_or(Ok(0.0), |row| prices.shadow_price(row)).ok()?;
                potentials.shifts[vertex].push(price);
            }
        }
        for row in &relaxed.flow_rows {
            // Less than 0 where the row binds.
            let price = prices.shadow_price(row.constraint).ok()?.min(0.0);
            row.terms.iter().for_each(|&(edge, a)| potentials.charges[edge] -= price * a);
            potentials.refund += price * row.right;
        }
        Some(potentials)
    }
}

impl GraphOfSets {
    /// Leaves out the edges that are on no path with a cost of at most `cost`. Returns the paths that may have
    /// such a cost, each with its least possible one, the most promising ones first, if they are few.
    ///
    /// # Arguments
    ///
    /// * `minimum`: proves a lower bound on the objective of a program.
    pub(super) fn prune(
        &self,
        potentials: &Potentials,
        cost: f64,
        is_used: &mut [bool],
        mut minimum: impl FnMut(&Model) -> Result<f64, Error>,
    ) -> Result<Option<Vec<PricedPath>>, Error> {
        let mut prices = vec![f64::INFINITY; self.edges.len()];
        for edge in (0..self.edges.len()).filter(|&edge| is_used[edge]) {
            let model = self.price_program(potentials, edge)?;
            prices[edge] = minimum(&model)? + potentials.charges[edge];
        }
        let [from, to] = potentials.ends;
        let before = self.distances(from, &prices, [0, 1]);
        let after = self.distances(to, &prices, [1, 0]);
        for (edge, is_used) in is_used.iter_mut().enumerate() {
            let [a, b] = self.edges[edge].ends;
            let least = before[a] + prices[edge] + after[b] + potentials.refund;
            // Not a number where a price is not bounded, which excludes nothing.
            *is_used &= !(least > cost);
        }
        let mut left = PathsLeft {
            graph: self,
            is_used,
            prices: &prices,
            after: &after,
            allowed: cost - potentials.refund,
            to,
            found: Vec::new(),
            looks: 0,
        };
        let mut is_visited = vec![false; self.vertices.len()];
        if !left.extend(from, 0.0, &mut Vec::new(), &mut is_visited) {
            return Ok(None);
        }
        left.found.sort_by(|a, b| a.0.total_cmp(&b.0));
        left.found.iter_mut().for_each(|(price, _)| *price += potentials.refund);
        Ok(Some(left.found))
    }

    /// The program whose least objective is the price of an edge, without its charge.
    fn price_program(&self, potentials: &Potentials, edge: usize) -> Result<Model, Error> {
        let mut model = Model::new(self.edges[edge].name.to_string());
        // A program with integers, if fixed ones, is solved without multipliers, which nobody asks for.
        let flow = model.binary("flow")?;
        model.fix(flow, 1.0)?;
        let ends = self.edges[edge].ends;
        let used = self.add_edge(&mut model, edge, flow, ends[0] == potentials.ends[0])?;
        let mut price: Affine = used.cost.clone();
        for (end, sign) in [(0, 1.0), (1, -1.0)] {
            let vertex = ends[end];
            price = price + Affine::constant(sign * potentials.flow[vertex]);
            for (&shift, &potential) in used.shifts[end].iter().zip(&potentials.shifts[vertex]) {
                shift.iter().for_each(|&shift| price.add_term(sign * potential, shift));
            }
        }
        model.minimize(price)?;
        Ok(model)
    }

    /// For each vertex, at most the least sum of prices on a path from or to another one.
    fn distances(&self, start: usize, prices: &[f64], [near, far]: [usize; 2]) -> Vec<f64> {
        let mut least = vec![f64::INFINITY; self.vertices.len()];
        least[start] = 0.0;
        // Prices may be below 0. No path has more edges than there are vertices.
        for _ in 0..self.vertices.len() {
            let mut is_changed = false;
            for (edge, &price) in self.edges.iter().zip(prices) {
                let along = least[edge.ends[near]] + price;
                if along < least[edge.ends[far]] {
                    least[edge.ends[far]] = along;
                    is_changed = true;
                }
            }
            if !is_changed {
                break;
            }
        }
        least
    }
}

/// The least cost that a path may have, and its edges.
pub(super) type PricedPath = (f64, Vec<usize>);

/// The paths whose prices do not exclude them.
struct PathsLeft<'a> {
    graph: &'a GraphOfSets,
    is_used: &'a [bool],
    prices: &'a [f64],
    after: &'a [f64],
    allowed: f64,
    to: usize,
    found: Vec<PricedPath>,
    looks: usize,
}

impl PathsLeft<'_> {
    /// Finds the paths that begin with one; `false` if there are many.
    fn extend(
        &mut self,
        at: usize,
        price: f64,
        path: &mut Vec<usize>,
        is_visited: &mut [bool],
    ) -> bool {
        if at == self.to {
            self.found.push((price, path.clone()));
            return self.found.len() <= FEW;
        }
        is_visited[at] = true;
        for (edge, data) in self.graph.edges.iter().enumerate() {
            let [from, next] = data.ends;
            if from != at || !self.is_used[edge] || is_visited[next] {
                continue;
            }
            self.looks += 1;
            let price = price + self.prices[edge];
            if price + self.after[next] > self.allowed {
                continue;
            }
            path.push(edge);
            let are_few = self.looks <= LOOKS
                && path.len() <= LONGEST
                && self.extend(next, price, path, is_visited);
            path.pop();
            if !are_few {
                return false;
            }
        }
        is_visited[at] = false;
        true
    }
}
