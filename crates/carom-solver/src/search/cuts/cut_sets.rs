//! Cut sets of networks with arcs that binaries open.
//!
//! Takes a relaxed point and rows that share continuous columns; leaves cuts in integers alone. The
//! networks are shrunk first (Günlük, A branch-and-cut algorithm for capacitated network design
//! problems, Mathematical Programming 86, 1999).
//!
//! Two rows that share a continuous column are the ends of an arc. Arcs are contracted, the most
//! open ones first, as a spanning tree grows. Only arcs that are less open enter or leave the parts
//! that appear on the way, so if the rows of a part together need a flow, whole binaries open more
//! than the point does: the sum of the rows is rounded.

use super::parameters::CUTS;
use std::collections::BTreeMap;

use super::cut::Cut;
use super::rounding::{Aggregate, Rounder};
use super::separated_point::SeparatedPoint;
use crate::presolve::Domain;
use crate::program::Program;
use crate::solver::StopToken;
use crate::union_find::UnionFind;

/// A continuous column of two rows.
struct FlowArc {
    column: usize,
    /// The smaller one first.
    ends: [usize; 2],
    /// The value of the binary that opens it, infinite where none does.
    open: f64,
}

/// Cuts in integers alone that a point violates, from sums of rows that share continuous columns.
pub fn cut_set_cuts(program: &Program, domain: &Domain, x: &[f64], token: &StopToken) -> Vec<Cut> {
    let point = &SeparatedPoint::new(program, domain, x);
    let mut arcs = arcs(point);
    let mut search = SetSearch { point, token, rounder: Rounder::default(), cuts: Vec::new() };
    if arcs.iter().any(|arc| arc.open.is_finite()) {
        search.round_ends(&arcs);
        search.contract(&arcs);
        // Parallel arcs may be open together.
        let mut together = BTreeMap::new();
        arcs.iter().for_each(|arc| *together.entry(arc.ends).or_insert(0.0) += arc.open);
        arcs.iter_mut().for_each(|arc| arc.open = together[&arc.ends]);
        search.contract(&sorted(arcs));
    }
    search.cuts
}

/// The arcs that are open, the most open ones first.
fn arcs(point: &SeparatedPoint<'_>) -> Vec<FlowArc> {
    let program = point.program;
    let mut arcs = Vec::new();
    for column in (0..program.column_count()).filter(|&j| !program.integral[j]) {
        let Some(ends) = ends(point, column) else { continue };
        let open = match point.opening(column) {
            Some(bound) => point.x[bound.binary],
            None if point.distance(column) > CUTS.open_arc => f64::INFINITY,
            None => 0.0,
        };
        if open > CUTS.open_arc {
            arcs.push(FlowArc { column, ends, open });
        }
    }
    sorted(arcs)
}

/// The two rows that share a column. If there are more than two, only equations count. `None` if
/// that does not leave two.
fn ends(point: &SeparatedPoint<'_>, column: usize) -> Option<[usize; 2]> {
    let program = point.program;
    let rows = program.column(column).0.iter().copied();
    let equation = |row: &usize| program.row_lower[*row] == program.row_upper[*row];
    let fit = rows.filter(|row| point.is_fit(*row));
    only_two(fit.clone()).or_else(|| only_two(fit.filter(equation)))
}

fn only_two(mut rows: impl Iterator<Item = usize>) -> Option<[usize; 2]> {
    match (rows.next(), rows.next(), rows.next()) {
        (Some(a), Some(b), None) => Some([a.min(b), a.max(b)]),
        _ => None,
    }
}

fn sorted(mut arcs: Vec<FlowArc>) -> Vec<FlowArc> {
    arcs.sort_by(|a, b| b.open.total_cmp(&a.open));
    arcs
}

struct SetSearch<'a> {
    point: &'a SeparatedPoint<'a>,
    token: &'a StopToken,
    rounder: Rounder,
    cuts: Vec<Cut>,
}

impl SetSearch<'_> {
    /// Rounds the rows at the ends of arcs.
    fn round_ends(&mut self, arcs: &[FlowArc]) {
        let mut rows: Vec<usize> = arcs.iter().flat_map(|arc| arc.ends).collect();
        rows.sort_unstable();
        rows.dedup();
        for row in rows {
            if let Some(sum) = single(self.point, row) {
                if self.token.spend(100 * sum.terms.len()) {
                    return;
                }
                self.round(&sum);
            }
        }
    }

    /// Contracts arcs in their order, and rounds the sum of rows of each new part.
    fn contract(&mut self, arcs: &[FlowArc]) {
        let mut parts = Parts::new(self.point);
        let mut memory = Vec::new();
        for arc in arcs {
            let [a, b] = arc.ends.map(|row| parts.rows.root(row));
            if a == b {
                continue;
            }
            let [Some(mut sum), Some(other)] = parts.join(a, b) else { continue };
            sum.eliminate(arc.column, &other, &mut memory);
            if self.token.spend(100 * sum.terms.len()) {
                return;
            }
            if sum.terms.len() <= CUTS.set_entries {
                self.round(&sum);
                parts.sums[a.min(b)] = Some(sum);
            }
        }
    }

    fn round(&mut self, sum: &Aggregate) {
        for sign in [1.0, -1.0] {
            self.cuts.extend(self.rounder.round_integers(self.point, sum, sign));
        }
    }
}

/// Rows contracted to parts, each with a sum of its rows.
struct Parts {
    rows: UnionFind,
    /// By root; `None` for a sum with too many entries.
    sums: Vec<Option<Aggregate>>,
}

impl Parts {
    fn new(point: &SeparatedPoint<'_>) -> Self {
        let count = point.program.row_count();
        let sums = (0..count).map(|row| single(point, row)).collect();
        Parts { rows: UnionFind::new(count), sums }
    }

    /// Joins the parts of two roots, and hands their sums out.
    fn join(&mut self, a: usize, b: usize) -> [Option<Aggregate>; 2] {
        self.rows.join(a, b);
        [a, b].map(|row| self.sums[row].take())
    }
}

/// A row alone, if it can be summed up with others.
fn single(point: &SeparatedPoint<'_>, row: usize) -> Option<Aggregate> {
    let mut sum = Aggregate::default();
    (point.is_fit(row) && sum.set_to_row(point, row)).then_some(sum)
}
