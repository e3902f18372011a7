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

/// A basis: of each column or row by its name, where it is.
#[derive(Debug, Default)]
struct Basis {
    columns: Vec<Option<BasisStatus>>,
    rows: Vec<Option<BasisStatus>>,
    /// By row, its multiplier.
    y: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
enum BasisStatus {
    /// In the basis, with a weight.
    Inside(f64),
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
        let (wanted, rest) = start(program, parent);
        let linear = LinearProgram::of(program);
        let mut y = vec![0.0; program.rows.len()];
        if let Some(parent) = parent {
            let known = |name: &usize| parent.y.get(*name).copied().unwrap_or(0.0);
            y.iter_mut().zip(&program.origin).for_each(|(y, name)| *y = known(name));
        }
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

/// The columns that the basis should have, with their weights, and where the others rest: as at the
/// parent; the rows without a parent.
fn start(program: &Reduced, parent: Option<&Basis>) -> (Vec<(usize, f64)>, Vec<NonbasicStatus>) {
    let (n, m) = (program.columns.len(), program.rows.len());
    let mut wanted = Vec::with_capacity(m);
    let mut rest = vec![NonbasicStatus::Lower; n + m];
    for (k, rest) in rest.iter_mut().enumerate() {
        let place = parent.and_then(|basis| match k.checked_sub(n) {
            None => basis.columns.get(program.columns[k]).copied().flatten(),
            Some(i) => {
                let name = program.origin.get(i).copied();
                basis.rows.get(name.unwrap_or(usize::MAX)).copied().flatten()
            }
        });
        match place {
            Some(BasisStatus::Inside(weight)) => wanted.push((k, weight)),
            Some(BasisStatus::Outside(at)) => *rest = at,
            None if k >= n => wanted.push((k, 1.0)),
            None => {}
        }
    }
    (wanted, rest)
}

/// The basis by the names of columns and rows.
fn basis(program: &Reduced, dual: &Tableau, y: &[f64]) -> Basis {
    let n = program.columns.len();
    let mut basis = Basis::default();
    for k in 0..dual.slot.len() {
        let place = match dual.slot[k] {
            NONBASIC => BasisStatus::Outside(dual.rest[k]),
            slot => BasisStatus::Inside(dual.weight[slot]),
        };
        let (list, name) = match k.checked_sub(n) {
            None => (&mut basis.columns, program.columns[k]),
            Some(i) => match program.origin.get(i) {
                Some(&name) if name != usize::MAX => (&mut basis.rows, name),
                _ => continue,
            },
        };
        if list.len() <= name {
            list.resize(name + 1, None);
        }
        list[name] = Some(place);
    }
    basis.y = vec![0.0; basis.rows.len()];
    for (&name, y) in program.origin.iter().zip(y).filter(|(name, _)| **name != usize::MAX) {
        basis.y[name] = *y;
    }
    basis
}
