//! Continuous relaxations at a corner of cells, with multipliers for all rows.

use std::sync::Arc;

use carom_model::internals::solver::StopToken;
use carom_solver::internals::presolve::{Compressed, Reduced};
use carom_solver::internals::relaxation::{
    ActiveSet, ClarabelRelaxation, DualSimplex, Effort, InteriorPoint, Relaxation, RelaxationClaim,
    polish,
};

use crate::bounds::{CornerPlace, Evidence};
use crate::form::ParametricForm;

/// The largest violation of a row by a corner's plan, in the unit of the row.
pub(crate) const PLAN_TOLERANCE: f64 = 1e-7;

/// The gap between point and bound that ends the attempts, relative.
const GAP: f64 = 1e-8;

/// How far a ray must be above 0, at a largest multiplier of 1, to be more than a rounding.
pub(crate) const RAY_MARGIN: f64 = 1e-9;

/// A relaxation at a corner.
#[derive(Debug, Clone)]
pub(crate) enum CornerRelaxation {
    /// A point within [`PLAN_TOLERANCE`] with its cost, and multipliers near the optimal ones.
    Solved { x: Vec<f64>, cost: f64, evidence: Arc<Evidence> },
    /// There is no point.
    Refuted(Arc<Evidence>),
    /// No method has an answer that is good enough.
    Unknown,
}

/// Makes a method.
type NewMethod = fn() -> Box<dyn Relaxation>;

/// The methods, one after the other. Each is new for each relaxation, so that no answer depends on
/// what was solved before.
pub(crate) struct CornerRelaxer {
    methods: [NewMethod; 3],
    token: StopToken,
}

impl CornerRelaxer {
    pub(crate) fn new(form: &ParametricForm, token: StopToken) -> Self {
        let first: NewMethod = match form.quadratic.iter().all(Vec::is_empty) {
            true => || Box::new(DualSimplex::new()),
            false => || Box::new(ActiveSet::new()),
        };
        let methods: [NewMethod; 3] =
            [first, || Box::new(InteriorPoint::new()), || Box::new(ClarabelRelaxation::new())];
        CornerRelaxer { methods, token }
    }

    /// Whether the build is to end.
    pub(crate) fn is_over(&self) -> bool {
        self.token.is_over()
    }

    /// Solves the relaxation of a box of columns at a corner.
    pub(crate) fn solve(
        &mut self,
        form: &ParametricForm,
        place: &CornerPlace,
        sides: [&[f64]; 2],
    ) -> CornerRelaxation {
        let found = match CornerProgram::new(form, place, sides) {
            Ok(program) => self.attempts(form, place, sides, &program),
            Err(ray) => Some(CornerRelaxation::Refuted(Arc::new(Evidence::ray(form, &ray)))),
        };
        match found {
            Some(CornerRelaxation::Refuted(ray)) if ray.value(form, place, sides) <= RAY_MARGIN => {
                CornerRelaxation::Unknown
            }
            found => found.unwrap_or(CornerRelaxation::Unknown),
        }
    }

    fn attempts(
        &mut self,
        form: &ParametricForm,
        place: &CornerPlace,
        sides: [&[f64]; 2],
        program: &CornerProgram,
    ) -> Option<CornerRelaxation> {
        let effort = Effort {
            iterations: 500,
            tolerance: 1e-10,
            refinements: 1,
            cutoff: f64::INFINITY,
            token: &self.token,
            warm: None,
        };
        let mut best: Option<(f64, CornerRelaxation)> = None;
        if program.reduced.columns.is_empty() {
            let (x, cost) = (program.all_columns(&[]), program.reduced.offset);
            let evidence = Evidence::bound(form, x.clone(), vec![0.0; form.rows.len()]);
            return Some(CornerRelaxation::Solved { x, cost, evidence: Arc::new(evidence) });
        }
        for method in self.methods {
            let mut result = method().solve(&program.reduced, &effort);
            let y = program.all_rows(form, &result.y);
            if result.claim == RelaxationClaim::Infeasible {
                let ray = Evidence::ray(form, &y);
                if ray.value(form, place, sides) > RAY_MARGIN {
                    return Some(CornerRelaxation::Refuted(Arc::new(ray)));
                }
            }
            if !result.x.iter().chain(&result.y).all(|value| value.is_finite()) {
                continue;
            }
            polish(&program.reduced, &mut result.x, &self.token);
            let x = program.all_columns(&result.x);
            let evidence = Evidence::bound(form, x.clone(), y);
            let bound = evidence.value(form, place, sides);
            let cost = program.reduced.objective(&result.x);
            let gap = (cost - bound).abs() / (1.0 + cost.abs());
            let better = best.as_ref().is_none_or(|(least, _)| gap < *least);
            if better && form.violation(&x) <= PLAN_TOLERANCE {
                let evidence = Arc::new(evidence);
                best = Some((gap, CornerRelaxation::Solved { x, cost, evidence }));
            }
            if best.as_ref().is_some_and(|(gap, _)| *gap <= GAP) {
                break;
            }
        }
        best.map(|(_, found)| found)
    }
}

/// The program over the columns that are free at a corner.
struct CornerProgram {
    reduced: Reduced,
    /// The rows of the form that are in it.
    rows: Vec<usize>,
}

impl CornerProgram {
    /// Returns multipliers that refute it where a row without free columns does.
    fn new(
        form: &ParametricForm,
        place: &CornerPlace,
        [lower, upper]: [&[f64]; 2],
    ) -> Result<Self, Vec<f64>> {
        let n = form.columns();
        let mut values = lower.to_vec();
        form.axes.iter().zip(&place.at).for_each(|(&j, &t)| values[j] = t);
        let is_free = |j: &usize| !form.is_axis[*j] && lower[*j] < upper[*j];
        let columns: Vec<usize> = (0..n).filter(is_free).collect();
        let mut position = vec![usize::MAX; n];
        columns.iter().enumerate().for_each(|(k, &j)| position[j] = k);
        let none = Compressed { start: vec![0], ..Compressed::default() };
        let mut reduced = Reduced {
            rows: none.clone(),
            quadratic: none,
            spread: 1.0,
            lower: columns.iter().map(|&j| lower[j]).collect(),
            upper: columns.iter().map(|&j| upper[j]).collect(),
            ..Reduced::default()
        };
        let mut kept = Vec::new();
        for (i, row) in form.rows.iter().enumerate() {
            let mut fixed = 0.0;
            let before = reduced.rows.index.len();
            for &(j, a) in row.terms.iter().filter(|(_, a)| *a != 0.0) {
                match position[j] {
                    usize::MAX => fixed += a * values[j],
                    k => {
                        reduced.rows.index.push(k);
                        reduced.rows.value.push(a);
                    }
                }
            }
            if reduced.rows.index.len() == before {
                let missed = (row.lower - fixed).max(fixed - row.upper);
                if missed > PLAN_TOLERANCE {
                    let mut ray = vec![0.0; form.rows.len()];
                    ray[i] = if fixed > row.upper { 1.0 } else { -1.0 };
                    return Err(ray);
                }
                continue;
            }
            reduced.rows.start.push(reduced.rows.index.len());
            reduced.row_lower.push(row.lower - fixed);
            reduced.row_upper.push(row.upper - fixed);
            kept.push(i);
        }
        // What the fixed columns say of the cost.
        let mut fixed = values.clone();
        columns.iter().for_each(|&j| fixed[j] = 0.0);
        let product = form.times_quadratic(&fixed);
        reduced.offset = form.offset + form.linear_cost(&fixed);
        reduced.offset += 0.5 * product.iter().zip(&fixed).map(|(a, b)| a * b).sum::<f64>();
        for &j in &columns {
            reduced.linear.push(form.linear[j] + product[j]);
            for &(i, p) in form.quadratic[j].iter().filter(|(i, _)| *i <= j) {
                if position[i] != usize::MAX {
                    reduced.quadratic.index.push(position[i]);
                    reduced.quadratic.value.push(p);
                }
            }
            reduced.quadratic.start.push(reduced.quadratic.index.len());
        }
        (reduced.columns, reduced.values) = (columns, values);
        Ok(CornerProgram { reduced, rows: kept })
    }

    fn all_columns(&self, x: &[f64]) -> Vec<f64> {
        let mut all = self.reduced.values.clone();
        self.reduced.columns.iter().zip(x).for_each(|(&j, &x)| all[j] = x);
        all
    }

    fn all_rows(&self, form: &ParametricForm, y: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; form.rows.len()];
        self.rows.iter().zip(y).for_each(|(&i, &y)| all[i] = y);
        all
    }
}
