//! Proved upper bounds of expressions over rows and bounds, from linear programs.
//!
//! Takes an expression, rows and bounds; leaves an upper bound of the expression (Neumaier and
//! Shcherbina, Safe bounds in linear and mixed-integer linear programming, Mathematical Programming
//! 99, 2004).
//!
//! The answer is the *dual* bound, recomputed from the multipliers
//! ([`Prover`](crate::relaxation::Prover)), so an inaccurate solve gives an M that is
//! larger than necessary but never too small. Bounds are propagated first, which is often enough.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use crate::activity;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Literal, Model, StoredRow, Variable};
use crate::presolve::{Domain, Propagator, reduce};
use crate::program::Program;
use crate::relaxation::{MethodCascade, Purpose, RelaxationClaim};
use crate::solver::{RelaxationMethod, StopToken};
use crate::tolerance;

/// The amount by which a bound on an expression is raised, relative to its size (at least 1), to
/// cover rounding in propagation and reduction.
const EXPRESSION_MARGIN: f64 = 1e-9;

/// Ms of at most this magnitude, in the row's unit, become 0, because coefficients like 1e-9 next
/// to 1 ruin the accuracy of an interior-point method. The error is a hundredth of the default
/// feasibility tolerance.
const NEGLIGIBLE_BIG_M: f64 = 1e-8;

/// An M from a linear program, without its numerical noise.
pub(super) fn tidy(m: f64) -> f64 {
    if m.abs() <= NEGLIGIBLE_BIG_M { 0.0 } else { m }
}

/// As [`tidy`] for a conic row, rounded up: without its M, such a row would hold where it should
/// not, and its curvature makes much of a little.
pub(super) fn tidy_up(m: f64) -> f64 {
    if m > 0.0 { m.max(NEGLIGIBLE_BIG_M) } else { tidy(m) }
}

/// Maximises expressions over one set of rows, bounds and integrality conditions.
pub(super) struct Maximizer<'a> {
    /// Once it is over, nothing is solved any more.
    token: &'a StopToken,
    program: Program,
    domain: Domain,
    propagator: Propagator,
    cascade: MethodCascade,
    /// Rows and bounds are infeasible.
    empty: bool,
}

impl<'a> Maximizer<'a> {
    /// Over a model with only rows; its objective is ignored.
    pub(super) fn of(model: &Model, token: &'a StopToken) -> Result<Self, Error> {
        let mut program = Program::assemble(model)?;
        program.make_feasibility_problem();
        Ok(Maximizer::over(program, token))
    }

    /// Over a program without an objective.
    pub(super) fn over(program: Program, token: &'a StopToken) -> Self {
        let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
        propagator.set_stop_token(token);
        let empty = propagator.propagate_all(&program, &mut domain).is_err();
        let cascade = MethodCascade::new(RelaxationMethod::default());
        Maximizer { token, program, domain, propagator, cascade, empty }
    }

    /// Over some rows and given bounds of their variables. Variables are renumbered; the second
    /// part maps them.
    pub(super) fn of_rows(
        model: &Model,
        rows: &[&StoredRow],
        terms: &[(Variable, f64)],
        bounds: &dyn Fn(Variable) -> Result<Interval, Error>,
        token: &'a StopToken,
    ) -> Result<(Self, BTreeMap<Variable, Variable>), Error> {
        let mut small = Model::new("term");
        let mut renamed = BTreeMap::new();
        let all = rows.iter().flat_map(|row| &row.terms).chain(terms);
        for &(variable, _) in all {
            if let Entry::Vacant(entry) = renamed.entry(variable) {
                let name = format!("v{}", variable.index());
                let Interval { lower, upper } = bounds(variable)?;
                let kind = model.variable_ref(variable)?.kind();
                entry.insert(small.variable(name, kind, lower, upper)?);
            }
        }
        for (k, row) in rows.iter().enumerate() {
            let terms = row.terms.iter().map(|(v, a)| (renamed[v], *a)).collect();
            let row = StoredRow { terms, lower: row.lower, upper: row.upper };
            small.push_constraint(("row", k).into(), row)?;
        }
        Ok((Maximizer::of(&small, token)?, renamed))
    }

    /// Whether rows, bounds and integrality are proved to be infeasible.
    pub(super) fn is_empty(&self) -> bool {
        self.empty
    }

    /// A variable's bounds after propagation.
    pub(super) fn bounds(&self, variable: Variable) -> Interval {
        let column = variable.index();
        Interval::new(self.domain.lower(column), self.domain.upper(column))
    }

    /// The domain after propagation.
    pub(super) fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Narrows the domain; `narrow` returns `false` if it proves that no point is left.
    pub(super) fn narrow(
        &mut self,
        narrow: impl FnOnce(&Program, &mut Domain, &mut Propagator) -> bool,
    ) {
        let Maximizer { program, domain, propagator, .. } = self;
        self.empty |= !narrow(program, domain, propagator);
    }

    /// Takes over a proved bound of a variable.
    pub(super) fn bound(&mut self, variable: Variable, is_upper: bool, value: f64) {
        let column = variable.index();
        let value = match (self.program.integral[column], is_upper) {
            (false, _) => value,
            (true, true) => (value + tolerance::INTEGRALITY).floor(),
            (true, false) => (value - tolerance::INTEGRALITY).ceil(),
        };
        let mark = self.domain.mark();
        self.domain.apply(column, is_upper, value);
        let Maximizer { program, domain, propagator, .. } = self;
        self.empty |= propagator.propagate_since(program, domain, mark).is_err();
    }

    /// A proved upper bound on `terms` if all of `when` are true: `-inf` if that is proved
    /// impossible, `+inf` if there is no proof.
    pub(super) fn upper_bound(&mut self, terms: &[(Variable, f64)], when: &[Literal]) -> f64 {
        if self.empty {
            return f64::NEG_INFINITY;
        }
        let mark = self.domain.mark();
        for literal in when {
            let (column, on) = (literal.variable().index(), literal.is_on());
            let value = if on { 1.0 } else { 0.0 };
            if value < self.domain.lower(column) || value > self.domain.upper(column) {
                self.domain.undo_to(mark);
                return f64::NEG_INFINITY;
            }
            self.domain.apply(column, !on, value);
        }
        let most = self.upper_bound_in_domain(terms, mark);
        self.domain.undo_to(mark);
        // Infinities are unchanged.
        if most.is_finite() { most + EXPRESSION_MARGIN * most.abs().max(1.0) } else { most }
    }

    fn upper_bound_in_domain(&mut self, terms: &[(Variable, f64)], mark: usize) -> f64 {
        let Maximizer { token, program, domain, propagator, cascade, .. } = self;
        if propagator.propagate_since(program, domain, mark).is_err() {
            return f64::NEG_INFINITY;
        }
        let bounds = |j: usize| Interval::new(domain.lower(j), domain.upper(j));
        let range = activity::range(0.0, terms.iter().map(|&(v, a)| (a, bounds(v.index()))));
        program.linear.iter_mut().for_each(|cost| *cost = 0.0);
        terms.iter().for_each(|&(variable, a)| program.linear[variable.index()] = -a);
        if token.is_over() {
            return range.upper;
        }
        let Some(reduced) = reduce(program, domain) else {
            return f64::NEG_INFINITY;
        };
        if reduced.columns.is_empty() {
            return range.upper;
        }
        let answer = cascade.solve_once(&reduced, Purpose::Bound, token);
        match answer.claim {
            RelaxationClaim::Infeasible | RelaxationClaim::Unknown
                if cascade.prover().proves_infeasible(&reduced, &answer.y) =>
            {
                f64::NEG_INFINITY
            }
            // A bound that relies on the radius of free columns does not prove an M.
            _ if !range.is_bounded() && program.spread <= 1.0 => range.upper,
            _ => range.upper.min(-cascade.prover().lower_bound(&reduced, &answer.x, &answer.y)),
        }
    }
}
