//! The relaxed point of a root, and its value: for what strengthens a program before the search,
//! and for the search, which need not relax the same root again.

use super::cuts::Cut;
use super::root::Root;
use crate::presolve::{Domain, Reduced, tighten_coefficients};
use crate::program::Program;
use crate::relaxation::{
    MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict, WarmState, inverse_rows,
};
use crate::solver::{Options, StopToken};

/// Largest distance of a bound from the value of its point with which a root needs no other
/// relaxation, relative.
const TIGHT_BOUND: f64 = 1e-7;

/// The least fraction of a column whose row of the inverse is kept, and the most rows.
const MIN_FRACTION: f64 = 0.01;
const MOST_TABLEAU_ROWS: usize = 500;

/// The relaxed point of a program, and its value.
#[derive(Debug, Clone)]
pub(super) struct RootPoint {
    /// The proved bound.
    pub(super) bound: f64,
    pub(super) value: f64,
    pub(super) x: Vec<f64>,
    /// The state left by the relaxation.
    pub(super) warm: Option<WarmState>,
    /// Whether the point is a vertex; then, rows of the inverse of its basis at whole columns with
    /// fractions.
    pub(super) is_vertex: bool,
    pub(super) inverse: Vec<Vec<(usize, f64)>>,
    /// Whether the nodes below would start from the state of another method.
    lacks_state: bool,
    /// Whether there is a bound alone, which is the value then.
    is_unfinished: bool,
    /// Iterations of the relaxation.
    pub(super) iterations: u64,
}

/// A program with a tighter relaxation and the same points with whole integers.
pub(crate) struct Strengthened {
    pub(crate) program: Program,
    /// The value of the relaxed root before and after.
    pub(crate) values: [f64; 2],
    /// The cuts of all rounds, in their order: each follows from rows, bounds and those before it.
    /// The program has some of them.
    pub(crate) cuts: Vec<Cut>,
}

/// The cuts of a root, for the proof of a search.
#[derive(Debug, Clone)]
pub(crate) struct RootCuts {
    /// The program before it was cut, and the bounds of its root.
    pub(crate) program: Program,
    pub(crate) bounds: Vec<[f64; 2]>,
    /// The cuts of all rounds, in their order.
    pub(crate) found: Vec<Cut>,
    /// The terms of those that became rows.
    pub(crate) last: Vec<Vec<(usize, f64)>>,
}

impl RootCuts {
    pub(crate) fn new(begun: &Program, root: &Root, cut: &mut Strengthened) -> Self {
        let all = 0..begun.column_count();
        let last = begun.row_count()..cut.program.row_count();
        RootCuts {
            program: begun.clone(),
            bounds: all
                .map(|j| root.bounds(j).unwrap_or([begun.lower[j], begun.upper[j]]))
                .collect(),
            found: std::mem::take(&mut cut.cuts),
            last: last.map(|row| cut.program.row_terms(row)).collect(),
        }
    }
}

impl RootCuts {
    /// The root of a program without cuts.
    pub(crate) fn none(begun: &Program, root: &Root) -> Self {
        let all = 0..begun.column_count();
        let bounds = all.map(|j| root.bounds(j).unwrap_or([begun.lower[j], begun.upper[j]]));
        let bounds = bounds.collect();
        RootCuts { program: begun.clone(), bounds, found: Vec::new(), last: Vec::new() }
    }

    /// Adds cuts that are rows of the last program, too.
    pub(crate) fn add(&mut self, cuts: &[Cut]) {
        self.last.extend(cuts.iter().map(|cut| cut.terms.clone()));
        self.found.extend_from_slice(cuts);
    }
}

/// The result of a pilot search: a search of one node, which tells whether cuts are wanted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PilotResult {
    /// The value of its best point, if it found one.
    pub(crate) value: Option<f64>,
    /// The proved bound.
    pub(crate) bound: f64,
    /// Whether nothing is left to search.
    pub(crate) is_closed: bool,
}

impl RootPoint {
    /// Relaxes a program within a domain as the search does, from the state that a relaxation of
    /// nearly the same program has left. Returns `None` if nothing is left to relax or no optimum
    /// is found.
    pub(super) fn new(
        program: &Program,
        domain: &Domain,
        cascade: &mut MethodCascade,
        options: &Options,
        token: &StopToken,
        warm: Option<&WarmState>,
    ) -> Option<RootPoint> {
        let point = RootPoint::or_bound(program, domain, cascade, options, token, warm);
        point.filter(|point| !point.is_unfinished)
    }

    /// As [`new`](Self::new), or what a relaxation proves that a limit has stopped.
    pub(super) fn or_bound(
        program: &Program,
        domain: &Domain,
        cascade: &mut MethodCascade,
        options: &Options,
        token: &StopToken,
        warm: Option<&WarmState>,
    ) -> Option<RootPoint> {
        let mut reduced = cascade.reducer().reduce(program, domain)?;
        tighten_coefficients(&mut reduced, &program.integral);
        let mut projection = cascade.reducer().project(reduced, &program.integral);
        let is_empty = projection.reduced.columns.is_empty();
        let question = RelaxationQuestion {
            purpose: Purpose::Separation,
            cutoff: f64::INFINITY,
            options,
            constant: program.constant,
            look_for_descent: false,
            token,
            warm,
        };
        let before = cascade.iterations();
        let verdict = (!is_empty).then(|| cascade.solve(&mut projection.reduced, &question));
        let iterations = cascade.iterations() - before;
        let reduced = &projection.reduced;
        let point = match verdict {
            Some(RelaxationVerdict::Relaxed { bound, x, converged: false, .. })
                if token.is_over() =>
            {
                Some(RootPoint::unfinished(bound, projection.lift(&x), iterations))
            }
            Some(RelaxationVerdict::Relaxed { bound, x, converged: true, warm, .. }) => {
                let (value, reduced_x) = (reduced.objective(&x), x);
                let x = projection.lift(&reduced_x);
                let is_vertex = cascade.separates_vertex(reduced);
                let lacks_state =
                    cascade.starts_warm(reduced) && !cascade.separates_by_state(reduced);
                let state = warm.as_ref().filter(|_| is_vertex);
                let inverse =
                    state.map(|state| fractional_rows(program, reduced, &reduced_x, state));
                let inverse = inverse.unwrap_or_default();
                Some(RootPoint {
                    bound,
                    value,
                    x,
                    warm,
                    is_vertex,
                    inverse,
                    lacks_state,
                    is_unfinished: false,
                    iterations,
                })
            }
            _ => None,
        };
        cascade.reducer().reuse_projection(projection);
        point
    }

    /// The bound that the bounds of the columns prove alone, for a search that is over before it
    /// begins; `None` if that is nothing.
    pub(super) fn of_bounds(
        program: &Program,
        domain: &Domain,
        cascade: &mut MethodCascade,
    ) -> Option<RootPoint> {
        let reduced = cascade.reducer().reduce(program, domain)?;
        let x = vec![0.0; reduced.columns.len()];
        let bound = cascade.prover().lower_bound(&reduced, &x, &vec![0.0; reduced.rows.len()]);
        let x = reduced.lift(&x);
        cascade.reducer().reuse(reduced);
        (bound > f64::NEG_INFINITY).then(|| RootPoint::unfinished(bound, x, 0))
    }

    /// A bound without a relaxed point.
    fn unfinished(bound: f64, x: Vec<f64>, iterations: u64) -> RootPoint {
        RootPoint {
            bound,
            value: bound,
            x,
            warm: None,
            is_vertex: false,
            inverse: Vec::new(),
            lacks_state: true,
            is_unfinished: true,
            iterations,
        }
    }

    /// Raises the bound to another proved one, if that is higher.
    pub(super) fn with_bound(self, bound: f64) -> RootPoint {
        RootPoint { bound: self.bound.max(bound), ..self }
    }

    /// Whether the search need not relax the root: the bound is as good as that of any relaxation.
    pub(super) fn is_final(&self) -> bool {
        !self.lacks_state && self.value - self.bound <= TIGHT_BOUND * self.value.abs().max(1.0)
    }

    /// Whether a value is above the relaxed one by at least a part of the latter.
    pub(super) fn is_lifted_by(&self, part: f64, value: f64) -> bool {
        value - self.value >= part * self.value.abs().max(1e-6)
    }
}

/// The rows of the inverse of a basis at whole columns, those first whose fractions are nearest to
/// a half.
fn fractional_rows(
    program: &Program,
    reduced: &Reduced,
    x: &[f64],
    state: &WarmState,
) -> Vec<Vec<(usize, f64)>> {
    let distance = |x: f64| (x - x.round()).abs();
    let whole = (0..x.len()).filter(|&k| program.integral[reduced.columns[k]]);
    let mut fractional: Vec<usize> = whole.filter(|&k| distance(x[k]) > MIN_FRACTION).collect();
    fractional.sort_by(|&a, &b| distance(x[b]).total_cmp(&distance(x[a])).then(a.cmp(&b)));
    fractional.truncate(MOST_TABLEAU_ROWS);
    inverse_rows(reduced, state, fractional.into_iter())
}
