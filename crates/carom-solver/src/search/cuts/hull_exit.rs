//! Where a line leaves the hull of a union of polytopes.
//!
//! A point of the hull is a sum of points of the cases, each times its weight. One linear program
//! over these parts goes from a centre within the hull towards a relaxed point as far as it can.
//! Its multipliers are the direction in which the hull ends there (Balas, "Disjunctive
//! programming", Annals of Discrete Mathematics 5, 1979; Conforti and Wolsey, "“Facet” separation
//! with one linear program", Mathematical Programming 178, 2019), and those of the rows of each
//! case prove how far the case reaches in that direction. Nothing rests on the accuracy of the
//! method: any direction and any multipliers make a valid cut.

use super::facets::FacetTools;
use super::parameters::CUTS;
use super::unions::{CaseUnion, UnionRow, linear_program};
use crate::presolve::Compressed;
use crate::relaxation::{Purpose, RelaxationQuestion, RelaxationVerdict};
use crate::tolerance::largest_magnitude;

/// A direction in which a hull ends.
#[derive(Debug, Clone)]
pub(super) struct HullExit {
    /// By place of a column, its coefficient; the largest magnitude is 1.
    pub(super) direction: Vec<f64>,
    /// By case and row, the multiplier.
    pub(super) multipliers: Vec<Vec<f64>>,
}

impl HullExit {
    /// The exit of the line from a centre to a point, in the columns of a union; `None` if the
    /// point is inside, or if no exit is found.
    pub(super) fn find(
        union: &CaseUnion,
        centre: &[f64],
        x: &[f64],
        tools: &mut FacetTools<'_>,
    ) -> Option<HullExit> {
        let rows = union.own_rows(tools.program);
        let mut parts = ExitProgram::new(centre, x);
        for case in 0..union.cases.len() {
            parts.add_case(case, &rows, &union.bounds(tools.domain, case));
        }
        let first = parts.lines.len();
        let sources = std::mem::take(&mut parts.sources);
        let y = parts.solve(tools)?;
        let mut direction: Vec<f64> = y[first..first + x.len()].iter().map(|y| -y).collect();
        let largest = largest_magnitude(&direction);
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        for (a, &j) in direction.iter_mut().zip(&union.columns) {
            *a /= largest;
            if a.abs() < CUTS.slight_coefficient || tools.domain.is_fixed(j) {
                *a = 0.0;
            }
        }
        let mut multipliers = vec![vec![0.0; rows.len()]; union.cases.len()];
        for (source, y) in sources.iter().zip(&y) {
            if let Some((case, row)) = *source {
                multipliers[case][row] += y / largest;
            }
        }
        Some(HullExit { direction, multipliers })
    }
}

/// A column of a union in a case: a multiple of the weight of the case, and one of a column of its
/// own.
#[derive(Debug, Clone, Copy)]
struct ColumnPart {
    weight_factor: f64,
    own: Option<(usize, f64)>,
}

/// The linear program: its columns are the share of the way from the centre to the point, then, by
/// case, the weight and the parts.
struct ExitProgram<'a> {
    centre: &'a [f64],
    bounds: Vec<[f64; 2]>,
    /// The rows of the cases.
    lines: Vec<UnionRow>,
    /// By such a row, its case and the row of the union; `None` for bounds.
    sources: Vec<Option<(usize, usize)>>,
    /// By column of the union: the parts add up to the point on the way.
    links: Vec<Vec<(usize, f64)>>,
    /// The weights add up to 1.
    weights: Vec<(usize, f64)>,
}

impl<'a> ExitProgram<'a> {
    fn new(centre: &'a [f64], x: &[f64]) -> Self {
        ExitProgram {
            centre,
            bounds: vec![[0.0, 1.0]],
            lines: Vec::new(),
            sources: Vec::new(),
            links: x.iter().zip(centre).map(|(x, p)| vec![(0, p - x)]).collect(),
            weights: Vec::new(),
        }
    }

    fn add_case(&mut self, case: usize, rows: &[UnionRow], bounds: &[[f64; 2]]) {
        let weight = self.bounds.len();
        self.bounds.push([0.0, 1.0]);
        self.weights.push((weight, 1.0));
        let parts: Vec<ColumnPart> =
            bounds.iter().enumerate().map(|(k, bounds)| self.part(k, weight, *bounds)).collect();
        for (row, (terms, [lower, upper])) in rows.iter().enumerate() {
            let (mut line, mut constant) = (Vec::with_capacity(terms.len() + 1), 0.0);
            for &(k, a) in terms {
                constant += a * parts[k].weight_factor;
                line.extend(parts[k].own.map(|(own, factor)| (own, factor * a)));
            }
            if line.is_empty() {
                continue;
            }
            let mut add = |limit: f64, limits: [f64; 2]| {
                let shift = (constant != limit).then_some((weight, constant - limit));
                self.lines.push((shift.into_iter().chain(line.iter().copied()).collect(), limits));
                self.sources.push(Some((case, row)));
            };
            if lower == upper {
                add(*lower, [0.0, 0.0]);
                continue;
            }
            if lower.is_finite() {
                add(*lower, [0.0, f64::INFINITY]);
            }
            if upper.is_finite() {
                add(*upper, [f64::NEG_INFINITY, 0.0]);
            }
        }
    }

    /// Adds the part of a column of the union in a case. With both bounds it is scaled by their
    /// distance.
    fn part(&mut self, k: usize, weight: usize, [lower, upper]: [f64; 2]) -> ColumnPart {
        let own = self.bounds.len();
        let (weight_factor, factor, bounds) = match (lower.is_finite(), upper.is_finite()) {
            (true, true) => (lower, upper - lower, [0.0, f64::INFINITY]),
            (true, false) => (lower, 1.0, [0.0, f64::INFINITY]),
            (false, true) => (upper, -1.0, [0.0, f64::INFINITY]),
            (false, false) => (0.0, 1.0, [f64::NEG_INFINITY, f64::INFINITY]),
        };
        if weight_factor != 0.0 {
            self.links[k].push((weight, weight_factor));
        }
        if factor == 0.0 {
            return ColumnPart { weight_factor, own: None };
        }
        self.bounds.push(bounds);
        self.links[k].push((own, factor));
        // A bound of 1 in place of this row would take multipliers that the weight has to have.
        if lower.is_finite() && upper.is_finite() {
            self.lines.push((vec![(weight, -1.0), (own, 1.0)], [f64::NEG_INFINITY, 0.0]));
            self.sources.push(None);
        }
        ColumnPart { weight_factor, own: Some((own, factor)) }
    }

    /// The multipliers of the rows of the cases, then those of the links; `None` if the way does
    /// not end before the point.
    fn solve(mut self, tools: &mut FacetTools<'_>) -> Option<Vec<f64>> {
        // Rounding may have put the centre outside by a little.
        let near = |p: f64| {
            let room = CUTS.centre_room * p.abs().max(1.0);
            [p - room, p + room]
        };
        let links = self.links.into_iter().zip(self.centre).map(|(link, p)| (link, near(*p)));
        self.lines.extend(links);
        self.lines.push((self.weights, [1.0, 1.0]));
        let mut rows = Compressed::with_capacity(self.lines.len(), 4 * self.lines.len());
        self.lines.iter().for_each(|(terms, _)| rows.push(terms.iter().copied()));
        let mut cost = vec![0.0; self.bounds.len()];
        cost[0] = -1.0;
        let limits = self.lines.iter().map(|line| line.1);
        let mut program = linear_program(rows, limits, &self.bounds, cost);
        let question = RelaxationQuestion {
            purpose: Purpose::Round,
            cutoff: f64::INFINITY,
            options: tools.options,
            constant: 0.0,
            look_for_descent: false,
            token: tools.token,
            warm: None,
        };
        let before = tools.cascade.iterations();
        let verdict = tools.cascade.solve(&mut program, &question);
        tools.take_work(before, self.lines.len());
        let RelaxationVerdict::Relaxed { x, y, .. } = verdict else { return None };
        let is_inside = x.first().is_none_or(|share| *share > 1.0 - CUTS.least_fraction);
        (!is_inside && y.len() == self.lines.len()).then_some(y)
    }
}
