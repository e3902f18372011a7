//! Edges that no path takes which is better than a known one.
//!
//! Multipliers of the balances of a relaxation are potentials: an affine function of the point at
//! each vertex. Along a path their differences cancel, so its cost is at least the sum of the
//! prices of its edges, where the price is the least cost of the edge with the potentials of both
//! ends, over all pairs of points. That holds for any potentials. The multipliers of a relaxation
//! are those for which the least sum of prices is the bound of the relaxation, and sums that are
//! larger than the cost of a known path exclude all edges that are only on such paths. The price of
//! each edge is a small convex program, whose bound is proved.

use super::graph::GraphOfSets;
use super::program::PathProgram;
use crate::error::Error;
use crate::model::{Affine, Model, Variable};
use crate::solution::Solution;

/// Potentials of vertices, and charges for edges.
pub(super) struct Potentials {
    pub(super) ends: [usize; 2],
    /// By vertex: of the flow and of each coordinate, from the lower end of its range.
    flow: Vec<f64>,
    shifts: Vec<Vec<f64>>,
    /// By edge, for rows over flows that all paths satisfy, and what these charges give back.
    pub(super) charges: Vec<f64>,
    refund: f64,
}

/// Prices of edges with their charges.
pub(super) struct Prices {
    /// By edge.
    pub(super) prices: Vec<f64>,
    /// By vertex, at most the least sum of prices from it to the end.
    pub(super) after: Vec<f64>,
    /// The part of the charges that a whole path gives back.
    pub(super) refund: f64,
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

    /// The potential of a vertex at its point.
    pub(super) fn at(&self, vertex: usize, shifts: &[Option<Variable>]) -> Affine {
        let mut potential = Affine::constant(self.flow[vertex]);
        for (&shift, &price) in shifts.iter().zip(&self.shifts[vertex]) {
            shift.iter().for_each(|&shift| potential.add_term(price, shift));
        }
        potential
    }
}

impl GraphOfSets {
    /// Leaves out the edges that are on no path with a cost of at most `cost`.
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
    ) -> Result<Prices, Error> {
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
            // It is not a number where a price is not bounded, which excludes nothing.
            if least > cost {
                *is_used = false;
            }
        }
        let refund = potentials.refund;
        Ok(Prices { prices, after, refund })
    }

    /// The program whose least objective is the price of an edge, without its charge.
    fn price_program(&self, potentials: &Potentials, edge: usize) -> Result<Model, Error> {
        let mut model = Model::new(self.edges[edge].name.to_string());
        // A program with integers, if fixed ones, is solved without multipliers, which nobody asks
        // for.
        let flow = model.binary("flow")?;
        model.fix(flow, 1.0)?;
        let ends = self.edges[edge].ends;
        let used = self.add_edge(&mut model, edge, flow, ends[0] == potentials.ends[0])?;
        let [from, into] = &used.shifts;
        let price = used.cost.clone() + potentials.at(ends[0], from) - potentials.at(ends[1], into);
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
