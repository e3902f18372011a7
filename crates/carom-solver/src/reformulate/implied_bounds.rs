//! Bounds that rows imply, for variables that have none of their own.
//!
//! Takes a model; leaves bounds of its variables and largest values of sums, without a change of
//! the model.
//!
//! They come from propagation over everything that holds in every case: the rows of the model, what
//! functions say of their variables, and the bounds that all cases of a statement share
//! (`reformulate/cases.rs`). A sum of rows may bound what no row alone does, which takes a linear
//! program. Flows are bounded by what enters the network, once they circulate no more than they
//! must (`reformulate/circulations.rs`). Ms and the bounds of copies are computed from them; no
//! variable gets them.
//!
//! An accepted point may miss rows and bounds by a tolerance, and a chain of rows may multiply
//! that: after `x1 = 10 x0`, a miss of 1e-6 is one of 1e-5. So every row and every bound is
//! loosened by the tolerance *before* propagation, and the bounds hold for all points that are
//! accepted.

use super::cases::{Alternatives, BoundsByColumn};
use super::circulations::flows;
use super::conic_rows::implied_rows;
use super::linear_program::Maximizer;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{
    Affine, Function, FunctionRef, Model, StoredRow, Variable, VariableKind, VariableRef,
};
use crate::presolve::{Domain, Propagator};
use crate::program::Program;
use crate::solver::StopToken;
use crate::tolerance::{self, finite_size};

/// The largest magnitude of an implied bound that is used, in the variable's unit. A larger big-M
/// would not switch its row within the tolerances, and proofs do not look further out.
pub(super) const MAX_IMPLIED_BOUND: f64 = tolerance::FREE_RADIUS;

/// The big-M from implied bounds, in the row's unit, from which a linear program is solved for a
/// smaller one: times the tolerance of a binary, it is visible.
pub(super) const LARGE_BIG_M: f64 = 1e7;

/// The distance beyond implied bounds up to which points are searched if the bounds may not hold,
/// as a multiple of their magnitude.
const SEARCH_FACTOR: f64 = 10.0;

/// The smallest gain of a bound that is used, as a fraction of the width between the bounds.
const MIN_CASE_GAIN: f64 = 0.05;

/// The largest number of visits of each term of all cases.
const MAX_CASE_VISITS: usize = 100;

/// The largest number of visits of all terms together.
const MAX_CASE_WORK: usize = 100_000_000;

/// The bounds that rows imply for a model's variables.
pub(super) struct ImpliedBounds<'a> {
    /// Only rows: those of the model and those that functions imply in every case.
    rows: Model,
    maximizer: Maximizer<'a>,
}

impl<'a> ImpliedBounds<'a> {
    /// Of a model; `None` if the token is over first.
    pub(super) fn of(model: &Model, token: &'a StopToken) -> Result<Option<Self>, Error> {
        let mut rows = model.with_rows_only();
        for variable in model.variables() {
            if let Some(values) = variable.semicontinuous() {
                let own = variable.bounds().intersection(values.hull(Interval::point(0.0)));
                if !own.is_empty() {
                    rows.set_bounds(variable.id(), own.lower, own.upper)?;
                }
            }
        }
        for function in model.functions() {
            add_rows(&mut rows, &function)?;
        }
        for conic in model.conic_constraints().filter(|conic| conic.condition().is_none()) {
            let implied = implied_rows(conic.conic(), conic.name(), model)?;
            for (k, row) in implied.into_iter().enumerate() {
                let name = conic.name().suffixed(&format!("_{}", k + 1));
                let name = name.free(|name| rows.has_statement(name));
                rows.push_constraint(name, row)?;
            }
        }
        let mut program = Program::assemble(&rows)?;
        program.make_feasibility_problem();
        // Proofs hold for everything that is not treated as infinite.
        program.spread = tolerance::INFINITE / tolerance::FREE_RADIUS;
        loosen(&mut program, &rows);
        let mut maximizer = Maximizer::over(program, token);
        let cases = Alternatives::of(model, maximizer.domain());
        if !token.is_over() && !maximizer.is_empty() {
            maximizer.narrow(|program, domain, propagator| {
                go_through(&cases, program, domain, propagator, token)
            });
        }
        if !token.is_over() && !maximizer.is_empty() {
            for (variable, most) in flows(model, &maximizer) {
                maximizer.bound(variable, true, most);
            }
        }
        Ok((!token.is_over()).then_some(ImpliedBounds { rows, maximizer }))
    }

    /// Whether it is proved that no point satisfies everything that holds in every case.
    pub(super) fn is_empty(&self) -> bool {
        self.maximizer.is_empty()
    }

    /// A variable's bounds, with implied ones where its own are missing.
    pub(super) fn complete(&self, variable: Variable, own: Interval) -> Interval {
        let known = |end: f64| end.abs() < tolerance::INFINITE;
        if known(own.lower) && known(own.upper) {
            return own;
        }
        if self.is_empty() {
            // No point satisfies the model, so any bound holds. All rows stay, so that none
            // satisfies the lowered one either.
            return Interval::point(own.nearest(0.0));
        }
        let implied = self.implied(variable);
        let end = |own: f64, implied: f64| {
            if known(own) || implied.abs() > MAX_IMPLIED_BOUND { own } else { implied }
        };
        Interval::new(end(own.lower, implied.lower), end(own.upper, implied.upper))
    }

    /// The bounds that rows imply, however large; infinite if there are none.
    pub(super) fn implied(&self, variable: Variable) -> Interval {
        self.maximizer.bounds(variable)
    }

    /// For each variable, bounds well beyond those that rows imply, where its own are missing; for
    /// searches that need some bounds and whose points are verified.
    pub(super) fn wide(&self, model: &Model) -> Vec<Interval> {
        let wide = |variable: VariableRef<'_>| {
            let (own, implied) = (variable.bounds(), self.implied(variable.id()));
            // Contradictory rows may cross them.
            let [low, high] = [implied.lower.min(implied.upper), implied.upper.max(implied.lower)];
            let room = SEARCH_FACTOR * finite_size(low).max(finite_size(high)).max(1.0);
            let end = |own: f64, implied: f64| if own.is_finite() { own } else { implied };
            Interval::new(end(own.lower, low - room), end(own.upper, high + room))
        };
        model.variables().map(wide).collect()
    }

    /// The largest value of an expression over all rows, by a linear program; infinite if there is
    /// no proof of one below [`MAX_IMPLIED_BOUND`].
    pub(super) fn upper_bound(&mut self, terms: &[(Variable, f64)]) -> f64 {
        let most = self.maximizer.upper_bound(terms, &[]);
        if most.abs() > MAX_IMPLIED_BOUND && most > 0.0 { f64::INFINITY } else { most }
    }

    /// Looks for missing bounds of a variable by linear programs, and keeps them.
    pub(super) fn find(&mut self, variable: Variable, own: Interval) {
        let bounds = self.complete(variable, own);
        for (end, sign) in [(bounds.lower, -1.0), (bounds.upper, 1.0)] {
            if end.abs() < tolerance::INFINITE {
                continue;
            }
            let most = self.upper_bound(&[(variable, sign)]);
            if most.is_finite() {
                self.maximizer.bound(variable, sign > 0.0, sign * most);
            }
        }
    }

    /// The rows, in the order of the program.
    pub(super) fn rows(&self) -> &Model {
        &self.rows
    }
}

/// The limits of a row, loosened by what an accepted point may miss it by, without the rounding of
/// its terms.
pub(super) fn loosened(model: &Model, terms: &[(Variable, f64)], limits: Interval) -> [f64; 2] {
    let is_integral = |v: Variable| {
        model.variable_ref(v).is_ok_and(|variable| variable.kind() != VariableKind::Continuous)
    };
    let integral: f64 = terms.iter().filter(|(v, _)| is_integral(*v)).map(|(_, a)| a.abs()).sum();
    let most = tolerance::FEASIBILITY + tolerance::INTEGRALITY * integral;
    let scale = |limit: f64| most + tolerance::PROPAGATION_SLACK * limit.abs();
    // Infinite limits stay infinite.
    let end = |limit: f64, sign: f64| {
        if limit.is_finite() { limit + sign * scale(limit) } else { limit }
    };
    [end(limits.lower, -1.0), end(limits.upper, 1.0)]
}

/// Loosens the rows of a program, and the bounds of its continuous columns.
fn loosen(program: &mut Program, rows: &Model) {
    for (k, row) in rows.constraints().enumerate() {
        let [lower, upper] = loosened(rows, row.terms(), row.limits());
        (program.row_lower[k], program.row_upper[k]) = (lower, upper);
    }
    for j in (0..program.column_count()).filter(|&j| !program.integral[j]) {
        program.lower[j] -= tolerance::FEASIBILITY;
        program.upper[j] += tolerance::FEASIBILITY;
    }
}

/// Adds what a function says of its variables in every case.
fn add_rows(rows: &mut Model, function: &FunctionRef<'_>) -> Result<(), Error> {
    let result = function.result();
    let (none, any) = (f64::NEG_INFINITY, f64::INFINITY);
    let above = |e: &Affine| (result - e, 0.0, any);
    match function.function() {
        Function::Absolute(of) => {
            let sides = [above(of), above(&-of), (result.into(), 0.0, any)];
            sides.into_iter().try_for_each(|row| add_row(rows, function, row))
        }
        Function::Maximum(of) => of.iter().try_for_each(|e| add_row(rows, function, above(e))),
        Function::Minimum(of) => {
            of.iter().try_for_each(|e| add_row(rows, function, (result - e, none, 0.0)))
        }
        Function::Product { .. }
        | Function::Elementary { .. }
        | Function::Bilinear(_)
        | Function::Quotient(_) => Ok(()),
        Function::Piecewise { of, graph } => {
            let (domain, values) = (graph.domain(), graph.values_within(none, any));
            add_row(rows, function, (of.clone(), domain.lower, domain.upper))?;
            add_row(rows, function, (result.into(), values.lower, values.upper))
        }
    }
}

/// Adds a row under a function's name, and underscores if that is taken.
fn add_row(
    rows: &mut Model,
    function: &FunctionRef<'_>,
    (expression, lower, upper): (Affine, f64, f64),
) -> Result<(), Error> {
    let (terms, constant) = expression.into_parts();
    let name = function.name().free(|name| rows.has_statement(name));
    let row = StoredRow { terms, lower: lower - constant, upper: upper - constant };
    rows.push_constraint(name, row).map(|_| ())
}

/// Goes through all cases, in alternating directions, until nothing moves.
fn go_through(
    cases: &[Alternatives],
    program: &Program,
    domain: &mut Domain,
    propagator: &mut Propagator,
    token: &StopToken,
) -> bool {
    let total: usize = cases.iter().map(Alternatives::work).sum();
    let mut work = MAX_CASE_WORK.min(MAX_CASE_VISITS.saturating_mul(total));
    let mut forward = true;
    loop {
        let start = domain.mark();
        for k in 0..cases.len() {
            let cases = &cases[if forward { k } else { cases.len() - 1 - k }];
            let cost = cases.work();
            if work < cost || token.spend(cost) {
                return true;
            }
            work -= cost;
            let mark = domain.mark();
            let Some(bounds) = cases.bounds(program, domain) else { return false };
            take_over(&bounds, domain);
            let moved = domain.mark() > mark;
            if moved && propagator.propagate_since(program, domain, mark).is_err() {
                return false;
            }
        }
        if domain.mark() == start {
            return true;
        }
        forward = !forward;
    }
}

/// Takes over new bounds that gain enough.
fn take_over(bounds: &BoundsByColumn, domain: &mut Domain) {
    for (&column, &[lower, upper]) in bounds {
        let [low, high] = domain.bounds(column);
        let least = MIN_CASE_GAIN * (high - low);
        let gains = |gain: f64| gain > 0.0 && (gain.is_infinite() || gain > least);
        if gains(lower - low) {
            domain.set_lower(column, lower);
        }
        if gains(high - upper) {
            domain.set_upper(column, upper);
        }
    }
}
