//! The only file that names Clarabel.
//!
//! Rows become `Ax + s = b` with `s` in a zero cone (equalities) or a nonnegative cone (one entry
//! per finite side of a row or column). Infinite sides are never passed on, empty programs never
//! reach the backend, and its panics are caught.

use std::panic::{AssertUnwindSafe, catch_unwind};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use super::conic_form::{ConeRows, ConicForm};
use super::{Effort, Relaxation, RelaxationClaim, RelaxationResult};
use crate::presolve::Reduced;
use crate::tolerance::largest_magnitude;

/// Clarabel's interior-point method with settings measured for branch and bound.
#[derive(Debug, Clone, Default)]
pub struct ClarabelRelaxation {}

impl ClarabelRelaxation {
    /// A fresh instance.
    pub fn new() -> Self {
        Self::default()
    }
}

/// The side of a row or column that a conic row represents.
#[derive(Clone, Copy)]
enum ConicSource {
    Equality(usize),
    Upper(usize),
    Lower(usize),
    UpperBound(usize),
    LowerBound(usize),
    /// A row of a cone.
    Cone(usize),
}

impl Relaxation for ClarabelRelaxation {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        self.solve_conic(program, effort, &ConeRows::default()).0
    }
}

impl ClarabelRelaxation {
    /// Solves a program with its cones. Also returns the multipliers of the rows of the cones.
    pub(super) fn solve_cones(
        &mut self,
        form: &ConicForm<'_>,
        effort: &Effort<'_>,
    ) -> (RelaxationResult, Vec<f64>) {
        self.solve_conic(&form.program, effort, &form.cones)
    }

    fn solve_conic(
        &mut self,
        program: &Reduced,
        effort: &Effort<'_>,
        cones: &ConeRows,
    ) -> (RelaxationResult, Vec<f64>) {
        let conic = ConicProgram::of(program, cones);
        let n = program.columns.len();
        let has_cones = cones.len() > 0;
        let unit = conic.unit(has_cones);
        // The library's own time limit ignores the time before its first iteration.
        let token = effort.token;
        let run = || {
            if token.is_over() {
                return None;
            }
            let quadratic = &program.quadratic;
            let p = CscMatrix::new(
                n,
                n,
                quadratic.start.clone(),
                quadratic.index.clone(),
                quadratic.value.iter().map(|p| p * unit).collect(),
            );
            let right: Vec<f64> = conic.right.iter().map(|limit| limit / unit).collect();
            let mut solver = DefaultSolver::new(
                &p,
                &program.linear,
                &conic.matrix,
                &right,
                &conic.cones,
                settings(effort, has_cones),
            )
            .ok()?;
            // The caller checks the bound; a margin makes it likely to hold.
            let enough =
                effort.cutoff + CONIC_CUTOFF_MARGIN * effort.cutoff.abs().max(1.0) - program.offset;
            let stop = token.clone();
            solver.set_termination_callback(move |info| {
                let promised =
                    info.cost_dual * unit > enough && info.res_dual < CONIC_CUTOFF_MARGIN;
                promised || stop.is_over()
            });
            solver.solve();
            Some(solver.solution)
        };
        match catch_unwind(AssertUnwindSafe(run)) {
            Ok(Some(solution)) => {
                let of_cones = solution.z.get(conic.first_of_cones..);
                let multipliers = of_cones.map_or(Vec::new(), <[f64]>::to_vec);
                let result = RelaxationResult {
                    claim: match solution.status {
                        SolverStatus::Solved => RelaxationClaim::Solved,
                        SolverStatus::PrimalInfeasible => RelaxationClaim::Infeasible,
                        SolverStatus::DualInfeasible => RelaxationClaim::Unbounded,
                        SolverStatus::CallbackTerminated if !token.is_over() => {
                            RelaxationClaim::Beyond
                        }
                        _ => RelaxationClaim::Unknown,
                    },
                    y: conic.row_multipliers(&solution.z, program.rows.len()),
                    x: solution.x.iter().map(|x| x * unit).collect(),
                    iterations: u64::from(solution.iterations),
                    warm: None,
                };
                (result, multipliers)
            }
            _ => {
                let x = vec![0.0; n];
                (RelaxationResult { x, ..RelaxationResult::nothing(program) }, Vec::new())
            }
        }
    }
}

/// The relative margin by which a dual objective must exceed the cutoff, and the largest dual
/// residual at which it is considered.
const CONIC_CUTOFF_MARGIN: f64 = 1e-5;

/// Limits below this have a unit of their own (in the units of their rows).
const SMALL_LIMITS: f64 = 0.25;

/// Measured on relaxations of wall programs: a static regularisation of 1e-10 and a single
/// refinement step left no anomaly in 2,398 nodes, where the defaults left up to 26; presolve is
/// off because infinite sides never get this far. Programs with hundreds of cones stall far from
/// the optimum with that regularisation, and not with the default.
fn settings(effort: &Effort<'_>, has_cones: bool) -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        max_iter: effort.iterations,
        time_limit: effort.token.left().map_or(f64::INFINITY, |t| t.as_secs_f64().max(1e-3)),
        tol_gap_abs: effort.tolerance,
        tol_gap_rel: effort.tolerance,
        tol_feas: effort.tolerance,
        static_regularization_constant: if has_cones { 1e-8 } else { 1e-10 },
        iterative_refinement_max_iter: effort.refinements,
        presolve_enable: false,
        ..DefaultSettings::default()
    }
}

/// The power of two that scales a badly scaled row; 1 for all others. Clarabel gives up on rows
/// with coefficients of 1e5 next to a curvature of 1.
fn row_factor(program: &Reduced, row: usize) -> f64 {
    let largest = largest_magnitude(program.rows.vector(row).1);
    let usual = (1e-3..=1e3).contains(&largest) || largest == 0.0;
    if usual { 1.0 } else { (-largest.log2().round()).exp2() }
}

struct ConicProgram {
    matrix: CscMatrix<f64>,
    right: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
    sources: Vec<ConicSource>,
    /// The scale of each row of the program.
    factors: Vec<f64>,
    /// The first conic row that is one of a cone.
    first_of_cones: usize,
}

impl ConicProgram {
    fn of(program: &Reduced, cones: &ConeRows) -> Self {
        let (mut sources, mut right) = (Vec::new(), Vec::new());
        let mut push = |source, limit: f64| {
            if limit.is_finite() {
                sources.push(source);
                right.push(limit);
            }
        };
        let factors: Vec<f64> = (0..program.rows.len()).map(|i| row_factor(program, i)).collect();
        let limits = || program.row_lower.iter().zip(&program.row_upper).enumerate();
        let mut equalities = 0;
        for (i, (_, &limit)) in limits().filter(|(_, (l, u))| l == u) {
            push(ConicSource::Equality(i), limit * factors[i]);
            equalities += 1;
        }
        for (i, (&lower, &upper)) in limits().filter(|(_, (l, u))| l != u) {
            push(ConicSource::Upper(i), upper * factors[i]);
            push(ConicSource::Lower(i), -lower * factors[i]);
        }
        for (j, (&lower, &upper)) in program.lower.iter().zip(&program.upper).enumerate() {
            push(ConicSource::UpperBound(j), upper);
            push(ConicSource::LowerBound(j), -lower);
        }
        let inequalities = sources.len() - equalities;
        let mut kinds = Vec::new();
        if equalities > 0 {
            kinds.push(SupportedConeT::ZeroConeT(equalities));
        }
        if inequalities > 0 {
            kinds.push(SupportedConeT::NonnegativeConeT(inequalities));
        }
        let first_of_cones = sources.len();
        for cone in 0..cones.len() {
            let rows = cones.rows_of(cone);
            kinds.push(SupportedConeT::SecondOrderConeT(rows.len()));
            right.extend_from_slice(&cones.constant[rows.clone()]);
            sources.extend(rows.map(ConicSource::Cone));
        }
        let matrix = conic_matrix(program, cones, &sources, &factors);
        ConicProgram { matrix, right, cones: kinds, sources, factors, first_of_cones }
    }

    /// The unit of columns, a power of two, in which the limits of a program with cones are not all
    /// small: Clarabel's tolerances are absolute where numbers are less than 1. Cones have no unit,
    /// and multipliers stay the same if the objective has the unit of the columns.
    fn unit(&self, has_cones: bool) -> f64 {
        let largest = largest_magnitude(&self.right);
        let is_small = has_cones && largest > 0.0 && largest < SMALL_LIMITS;
        if is_small { largest.log2().ceil().exp2() } else { 1.0 }
    }

    /// Multipliers of the program's rows from conic ones, clipped to their cone.
    fn row_multipliers(&self, z: &[f64], rows: usize) -> Vec<f64> {
        let mut y = vec![0.0; rows];
        for (source, &z) in self.sources.iter().zip(z) {
            match *source {
                ConicSource::Equality(i) => y[i] = z * self.factors[i],
                ConicSource::Upper(i) => y[i] += z.max(0.0) * self.factors[i],
                ConicSource::Lower(i) => y[i] -= z.max(0.0) * self.factors[i],
                ConicSource::UpperBound(_) | ConicSource::LowerBound(_) | ConicSource::Cone(..) => {
                }
            }
        }
        y
    }
}

/// The conic matrix by columns; going through the conic rows in order keeps every column sorted.
fn conic_matrix(
    program: &Reduced,
    cones: &ConeRows,
    sources: &[ConicSource],
    factors: &[f64],
) -> CscMatrix<f64> {
    let n = program.columns.len();
    let for_each_entry = |visit: &mut dyn FnMut(usize, usize, f64)| {
        for (k, source) in sources.iter().enumerate() {
            match *source {
                ConicSource::Equality(i) | ConicSource::Upper(i) => {
                    let (columns, values) = program.rows.vector(i);
                    columns.iter().zip(values).for_each(|(&j, &a)| visit(j, k, a * factors[i]));
                }
                ConicSource::Lower(i) => {
                    let (columns, values) = program.rows.vector(i);
                    columns.iter().zip(values).for_each(|(&j, &a)| visit(j, k, -a * factors[i]));
                }
                ConicSource::UpperBound(j) => visit(j, k, 1.0),
                ConicSource::LowerBound(j) => visit(j, k, -1.0),
                ConicSource::Cone(row) => {
                    cones.rows.entries(row).for_each(|(j, g)| visit(j, k, -g));
                }
            }
        }
    };
    let mut start = vec![0usize; n + 1];
    for_each_entry(&mut |j, _, _| start[j + 1] += 1);
    for j in 0..n {
        start[j + 1] += start[j];
    }
    let mut next = start.clone();
    let (mut index, mut value) = (vec![0usize; start[n]], vec![0.0; start[n]]);
    for_each_entry(&mut |j, k, a| {
        index[next[j]] = k;
        value[next[j]] = a;
        next[j] += 1;
    });
    CscMatrix::new(sources.len(), n, start, index, value)
}
