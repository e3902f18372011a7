//! The one question of every explanation: does a part of the model have a solution?
//!
//! Two answers are cheaper than a solve and just as certain: an earlier point that satisfies the
//! part, and a refutation by propagation and probing.

use std::collections::HashMap;

use crate::error::Error;
use crate::interval::Interval;
use crate::model::{AnyStatement, Model, VariableKind, statements, subset};
use crate::presolve::{Domain, Propagator, probe};
use crate::program::Program;
use crate::reformulate;
use crate::solution::{Point, Verification};
use crate::solver::{Solver, StopToken};

/// Trials of probing before a solve; see `search/root.rs`.
const MAX_PROBING_TRIALS: usize = 4000;

/// The distance from 0 up to which a variable of a part is searched if neither bounds nor rows
/// limit it, in its unit.
const SEARCH_RADIUS: f64 = 1e5;

/// The answer to whether a part of a model has a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Feasibility {
    /// A point satisfies it: its place among the known points.
    Feasible(usize),
    /// It is proved that no point does.
    Infeasible,
    /// A limit was reached first.
    Open,
}

/// A point that was found, and the statements that it violates with their relative amounts.
pub(super) struct KnownPoint {
    pub(super) point: Point,
    pub(super) violated: Vec<(usize, f64)>,
}

impl KnownPoint {
    /// Whether the point satisfies all statements that are kept.
    pub(super) fn satisfies(&self, keep: &[bool]) -> bool {
        self.violated.iter().all(|&(statement, _)| !keep[statement])
    }
}

/// Asks a solver about parts of a model, and remembers the points it found.
pub(super) struct Oracle<'a> {
    model: &'a Model,
    solver: &'a mut dyn Solver,
    token: StopToken,
    solve_limit: usize,
    /// Statements by the names that verifications use.
    places: HashMap<String, Vec<usize>>,
    /// Bounds for parts that lack the rows that bound a variable, once such a part was met.
    wide: Option<Vec<Interval>>,
    pub(super) known: Vec<KnownPoint>,
    pub(super) solves: usize,
    /// Parts refuted by propagation and probing alone.
    pub(super) propagations: usize,
}

impl<'a> Oracle<'a> {
    pub(super) fn new(
        model: &'a Model,
        solver: &'a mut dyn Solver,
        token: StopToken,
        solve_limit: Option<usize>,
    ) -> Self {
        let mut places: HashMap<String, Vec<usize>> = HashMap::new();
        for (position, statement) in statements(model).enumerate() {
            places.entry(statement.name().to_string()).or_default().push(position);
        }
        let solve_limit = solve_limit.unwrap_or(usize::MAX);
        let (wide, known, solves, propagations) = (None, Vec::new(), 0, 0);
        Oracle { model, solver, token, solve_limit, places, wide, known, solves, propagations }
    }

    /// The stop token that ends the explanation.
    pub(super) fn token(&self) -> &StopToken {
        &self.token
    }

    /// Whether the time is over, or the interrupt triggered.
    pub(super) fn is_stopped(&self) -> bool {
        self.token.is_over()
    }

    /// Whether nothing more may be solved.
    pub(super) fn is_exhausted(&self) -> bool {
        self.solves >= self.solve_limit || self.is_stopped()
    }

    /// Whether the statements that are kept can hold together.
    pub(super) fn ask(&mut self, keep: &[bool]) -> Result<Feasibility, Error> {
        if let Some(place) = self.known.iter().position(|known| known.satisfies(keep)) {
            return Ok(Feasibility::Feasible(place));
        }
        let part = self.part(keep)?;
        if self.refutes(&part)? {
            self.propagations += 1;
            return Ok(Feasibility::Infeasible);
        }
        if self.is_exhausted() {
            return Ok(Feasibility::Open);
        }
        self.solves += 1;
        let (solution, is_whole) = match self.token.solve(self.solver, &part, &mut |_| {}) {
            // Rows that bound a variable are left out. A point may be found all the same.
            Err(error) if reformulate::is_missing_bound(&error) && !keep.iter().all(|k| *k) => {
                let Some(part) = self.bounded(part)? else { return Ok(Feasibility::Open) };
                match self.token.solve(self.solver, &part, &mut |_| {}) {
                    Err(error) if reformulate::is_missing_bound(&error) => {
                        return Ok(Feasibility::Open);
                    }
                    other => (other?, false),
                }
            }
            other => (other?, true),
        };
        match solution.point() {
            Some(point) => {
                self.learn(point.clone());
                Ok(Feasibility::Feasible(self.known.len() - 1))
            }
            None if is_whole && solution.is_infeasible() => Ok(Feasibility::Infeasible),
            None => Ok(Feasibility::Open),
        }
    }

    /// A part with wide bounds for variables that have none; `None` if the time is over.
    fn bounded(&mut self, mut part: Model) -> Result<Option<Model>, Error> {
        if self.wide.is_none() {
            self.wide = reformulate::wide_bounds(self.model, &self.token)?;
        }
        let Some(wide) = &self.wide else { return Ok(None) };
        for (variable, bounds) in self.model.variables().zip(wide) {
            if variable.bounds().is_bounded() || variable.parameter_range().is_some() {
                continue;
            }
            let own = part.variable_ref(variable.id())?.bounds();
            let or_far =
                |end: f64| if end.is_finite() { end } else { end.signum() * SEARCH_RADIUS };
            let wide = Interval::new(or_far(bounds.lower), or_far(bounds.upper));
            let bounds = own.intersection(wide);
            if !bounds.is_empty() {
                part.set_bounds(variable.id(), bounds.lower, bounds.upper)?;
            }
        }
        Ok(Some(part))
    }

    /// Whether propagation alone proves that the statements that are kept contradict each other.
    pub(super) fn refutes_at_once(&mut self, keep: &[bool]) -> Result<bool, Error> {
        let refuted = self.refutes(&self.part(keep)?)?;
        self.propagations += usize::from(refuted);
        Ok(refuted)
    }

    /// The model with the statements that are kept. Rows on one continuous variable also tighten
    /// its bounds, because that costs nothing and makes the big-Ms smaller.
    fn part(&self, keep: &[bool]) -> Result<Model, Error> {
        let mut part = subset(self.model, |position| keep[position]);
        for (_, statement) in statements(self.model).enumerate().filter(|&(k, _)| keep[k]) {
            let AnyStatement::Row(row) = statement else { continue };
            let &[(variable, coefficient)] = row.terms() else { continue };
            let variable = part.variable_ref(variable)?;
            let (id, bounds) = (variable.id(), variable.bounds());
            let is_plain = variable.kind() == VariableKind::Continuous
                && variable.parameter_range().is_none()
                && coefficient.abs() == 1.0;
            if !is_plain {
                continue;
            }
            let bounds = bounds.intersection(row.limits() * coefficient);
            if bounds.lower <= bounds.upper {
                part.set_bounds(id, bounds.lower, bounds.upper)?;
            }
        }
        Ok(part)
    }

    fn refutes(&self, part: &Model) -> Result<bool, Error> {
        let lowered = match reformulate::lower_around_functions(part, &self.token) {
            Err(error) if reformulate::is_missing_bound(&error) => return Ok(false),
            other => other?,
        };
        let Some(lowered) = lowered else { return Ok(false) };
        let program = Program::assemble(lowered.model())?;
        let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
        let late_first: Vec<usize> = program.integers.iter().rev().copied().collect();
        let refuted = propagator
            .propagate_all(&program, &mut domain)
            .and_then(|()| {
                probe(
                    &program,
                    &mut domain,
                    &mut propagator,
                    &late_first,
                    MAX_PROBING_TRIALS,
                    &self.token,
                )
            })
            .is_err();
        Ok(refuted)
    }

    fn learn(&mut self, point: Point) {
        let feasibility = self.solver.options().feasibility;
        let verification = Verification::of(self.model, &point, feasibility);
        let mut violated = Vec::new();
        for violation in verification.violations() {
            let places = self.places.get(&violation.name).into_iter().flatten();
            violated.extend(places.map(|&place| (place, violation.relative)));
        }
        self.known.push(KnownPoint { point, violated });
    }
}
