//! The simplex method for linear relaxations, started from the parent's basis.
//!
//! Children differ from their parent in bounds only. So the parent's basis is dual feasible there,
//! and a few exchanges of the dual method away from an optimal one. Where rows or columns of the
//! parent are gone, its basis is mended with the rows' own columns. Reduced costs of the wrong sign
//! that have no bound to go to are shifted away for the dual method, and if it stalls, costs are
//! perturbed; the primal method ends the solve with the true costs. The dual objective never falls,
//! so the dual method stops when it exceeds the cutoff.
//!
//! If the numbers are too bad, the method gives up. Only what `bound.rs` proves is believed.

mod dual;
mod factors;
mod inverse;
mod parameters;
mod primal;
mod program;
mod ratio;
mod row_copy;
mod run;
mod sparse;
mod tableau;
mod violations;

use super::{Effort, Relaxation, RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::Reduced;
use dual::Dual;
pub(crate) use inverse::inverse_rows;
use parameters::{COLUMNS_PER_COST, LARGE_PROGRAM};
use program::LinearProgram;
use ratio::NonbasicStatus;
use run::{Run, RunEnd};
use tableau::{NONBASIC, Tableau};

/// The dual simplex method.
#[derive(Debug, Clone, Default)]
pub struct DualSimplex {}

/// A basis: where each column and row is.
#[derive(Debug, Default)]
struct Basis {
    /// By name.
    columns: Vec<Option<BasisStatus>>,
    /// In the order of their names, which may be far apart.
    rows: Vec<BasisRow>,
}

/// A row by its name, where it is, and its multiplier.
#[derive(Debug, Clone, Copy)]
struct BasisRow {
    name: usize,
    status: BasisStatus,
    y: f64,
}

#[derive(Debug, Clone, Copy)]
enum BasisStatus {
    /// In the basis, with a weight, which is an estimate.
    Inside(f32),
    Outside(NonbasicStatus),
}

impl DualSimplex {
    /// A fresh instance.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether the method suits a program. An objective with few terms leaves a large face of
    /// optima. An interior-point method ends in its middle, which is a better point for branching
    /// than a vertex.
    pub fn suits(program: &Reduced) -> bool {
        // Each round of cuts of cones begins with the basis of the last one.
        let is_cut_off = program.is_cut_off && !program.cones.is_empty();
        program.quadratic.index.is_empty()
            && (is_cut_off || program.wants_vertex || DualSimplex::suits_costs(&program.linear))
    }

    /// Whether cuts are to separate a vertex. The middle of the face of optima is farther inside
    /// what cuts take away, but an interior-point method is many times slower in large programs.
    pub(super) fn suits_separation(program: &Reduced) -> bool {
        program.columns.len() >= LARGE_PROGRAM && DualSimplex::suits(program)
    }

    /// As [`suits`](Self::suits), by the costs alone.
    pub(super) fn suits_costs(costs: &[f64]) -> bool {
        COLUMNS_PER_COST * costs.iter().filter(|q| **q != 0.0).count() > costs.len()
    }
}

impl Relaxation for DualSimplex {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        if !DualSimplex::suits(program) {
            return RelaxationResult::nothing(program);
        }
        let parent = effort.warm.and_then(WarmState::get::<Basis>);
        let StartBasis { wanted, rest, y } = StartBasis::of(program, parent);
        let linear = LinearProgram::of(program);
        let y = parent.is_some().then(|| linear.scaled_multipliers(&y));
        let tableau = Tableau::new(linear, wanted, rest);
        let Some(mut dual) = Dual::new(tableau, y.as_deref()) else {
            return RelaxationResult::nothing(program);
        };
        dual.allow(effort.tolerance);
        let unit = dual.tableau.program.objective_unit;
        let enough = (effort.sufficient_bound() - program.offset) * unit;
        let mut run = Run::new(dual, effort, enough);
        let RunEnd { claim, ray } = run.solve();
        let iterations = u64::from(run.iterations);
        let mut tableau = run.dual.tableau;
        let (x, y) = match (claim, ray) {
            (RelaxationClaim::Unbounded, Some(ray)) => {
                (tableau.program.point(&ray), vec![0.0; program.rows.len()])
            }
            (_, Some(ray)) => {
                let x = tableau.program.point(&tableau.point());
                (x, tableau.program.multipliers(&ray, 1.0))
            }
            (_, None) => {
                tableau.solve_multipliers(true);
                let x = tableau.program.point(&tableau.point());
                (x, tableau.program.multipliers(&tableau.sum.value, unit))
            }
        };
        let warm = Some(WarmState::new(basis(program, &tableau, &y)));
        RelaxationResult { claim, x, y, iterations, warm }
    }
}

/// The basis to begin with.
struct StartBasis {
    /// The columns that it should have, with their weights.
    wanted: Vec<(usize, f64)>,
    /// Where the others rest.
    rest: Vec<NonbasicStatus>,
    /// By row, its multiplier.
    y: Vec<f64>,
}

impl StartBasis {
    /// As at the parent; the rows without a parent.
    fn of(program: &Reduced, parent: Option<&Basis>) -> Self {
        let (n, m) = (program.columns.len(), program.rows.len());
        let mut start = StartBasis {
            wanted: Vec::with_capacity(m),
            rest: vec![NonbasicStatus::Lower; n + m],
            y: vec![0.0; m],
        };
        let status_of = |basis: &Basis, name: &usize| basis.columns.get(*name).copied().flatten();
        for (k, name) in program.columns.iter().enumerate() {
            start.put(k, parent.and_then(|basis| status_of(basis, name)));
        }
        let rows = parent.map_or(&[][..], |basis| &basis.rows);
        let mut next = 0;
        for i in 0..m {
            let name = program.origin.get(i).copied().unwrap_or(usize::MAX);
            // Most rows follow each other as they did at the parent.
            let found = match rows.get(next) {
                Some(row) if row.name == name => Some(next),
                _ => rows.binary_search_by_key(&name, |row| row.name).ok(),
            };
            let known = found.map(|place| rows[place]);
            next = found.map_or(next, |place| place + 1);
            start.y[i] = known.map_or(0.0, |row| row.y);
            start.put(n + i, Some(known.map_or(BasisStatus::Inside(1.0), |row| row.status)));
        }
        start
    }

    fn put(&mut self, k: usize, status: Option<BasisStatus>) {
        match status {
            Some(BasisStatus::Inside(weight)) => self.wanted.push((k, f64::from(weight))),
            Some(BasisStatus::Outside(at)) => self.rest[k] = at,
            None => {}
        }
    }
}

/// The basis by the names of columns and rows.
fn basis(program: &Reduced, dual: &Tableau, y: &[f64]) -> Basis {
    let n = program.columns.len();
    let status = |k: usize| match dual.slot[k] {
        NONBASIC => BasisStatus::Outside(dual.rest[k]),
        slot => BasisStatus::Inside(dual.weight[slot] as f32),
    };
    let last = program.columns.iter().max();
    let mut columns = vec![None; last.map_or(0, |last| last + 1)];
    program.columns.iter().enumerate().for_each(|(k, &name)| columns[name] = Some(status(k)));
    let row =
        |(i, (&name, &y)): (usize, (&usize, &f64))| BasisRow { name, status: status(n + i), y };
    let named = program.origin.iter().zip(y).enumerate();
    let mut rows: Vec<BasisRow> = named.map(row).filter(|row| row.name != usize::MAX).collect();
    rows.sort_by_key(|row| row.name);
    Basis { columns, rows }
}
