//! The conditions that every solution must satisfy, and those of a right answer.

use carom_model::model::{Affine, Model};
use carom_model::solution::{PrimalStatus, Solution, Termination, Verification};
use carom_model::solver::{Options, Solver};

use super::answer::{Case, Truth, has_cones};
use super::report::CaseOutcome;

/// Slack of a bound, relative and absolute: "never beyond the optimum" up to rounding.
const BOUND_ROUNDING: f64 = 1e-9;

/// The faults of a backend, in words.
#[derive(Debug, Default)]
pub(super) struct Complaints {
    texts: Vec<String>,
    /// Prefix of each complaint.
    about: String,
}

impl Complaints {
    /// Sets the prefix of the following complaints.
    pub(super) fn about(&mut self, what: impl Into<String>) {
        self.about = what.into();
    }

    pub(super) fn add(&mut self, text: impl AsRef<str>) {
        let (about, text) = (&self.about, text.as_ref());
        let separator = if about.is_empty() { "" } else { ": " };
        let text = format!("{about}{separator}{text}");
        if !self.texts.contains(&text) {
            self.texts.push(text);
        }
    }

    pub(super) fn unless(&mut self, holds: bool, text: impl FnOnce() -> String) {
        if !holds {
            self.add(text());
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    pub(super) fn outcome(self) -> CaseOutcome {
        if self.texts.is_empty() { CaseOutcome::Passed } else { CaseOutcome::Failed(self.texts) }
    }
}

/// Solves a program and compares with its answer.
pub(super) fn solve(solver: &mut dyn Solver, case: &Case, complaints: &mut Complaints) {
    match solver.solve(&case.model) {
        Ok(solution) => judge(solver.options(), case, &solution, complaints),
        Err(error) => complaints.add(format!("an error instead of an answer: {error}")),
    }
}

/// The optimum in the model's own sense, infinite if there is none.
pub(super) fn optimum(case: &Case) -> f64 {
    let worst = case.model.sense().sign() * f64::INFINITY;
    match case.answer {
        Truth::Optimal(optimum, _) => optimum,
        Truth::Infeasible => worst,
        Truth::Unbounded => -worst,
    }
}

/// Compares a solution with the answer; the solve must not have ended at a limit.
pub(super) fn judge(
    options: &Options,
    case: &Case,
    solution: &Solution,
    complaints: &mut Complaints,
) {
    let (ended, optimum) = (solution.termination(), optimum(case));
    sound(&case.model, solution, optimum, options, complaints);
    let contradictions = solution.statistics().contradictions;
    complaints.unless(contradictions == 0, || {
        format!("{contradictions} rewritings of the program were contradicted by accepted points")
    });
    let wanted = match case.answer {
        Truth::Optimal(..) => Termination::Optimal,
        Truth::Infeasible => Termination::Infeasible,
        Truth::Unbounded => Termination::Unbounded,
    };
    if ended != wanted {
        complaints.add(format!("it ended with `{ended}` instead of `{wanted}`"));
        return;
    }
    complaints.unless(solution.is_optimal() == (wanted == Termination::Optimal), || {
        "`is_optimal` contradicts the termination".into()
    });
    complaints.unless(solution.is_infeasible() == (wanted == Termination::Infeasible), || {
        "`is_infeasible` contradicts the termination".into()
    });
    let Truth::Optimal(_, values) = &case.answer else {
        let bound = solution.bound();
        complaints.unless(bound == optimum, || format!("the bound is {bound}, not {optimum}"));
        let infeasible = case.answer == Truth::Infeasible;
        complaints.unless(!infeasible || solution.point().is_none(), || {
            "there is a point although the program is claimed to be infeasible".into()
        });
        return;
    };
    let Some(objective) = solution.objective() else {
        complaints.add("optimal without a point");
        return;
    };
    let gap = options.absolute_gap.max(options.relative_gap * objective.abs());
    complaints.unless(solution.gap() <= gap + BOUND_ROUNDING * objective.abs(), || {
        format!("it claims to be optimal with gap {}, but {gap} was requested", solution.gap())
    });
    let allowed = 1.01 * gap.max(1e-6 * optimum.abs().max(1.0));
    complaints.unless((objective - optimum).abs() <= allowed, || {
        format!("the objective is {objective}, not {optimum}")
    });
    // With curvature c, a gap g leaves a distance of sqrt(g / c) to the optimal point.
    let quadratic = !case.model.objective().products().is_empty();
    let curved = quadratic || has_cones(&case.model);
    let near = if curved { 1e-3 } else { 1e-5 };
    for &(variable, wanted) in values {
        let named = case.model.variable_ref(variable).map(|v| v.name().to_string());
        let name = named.unwrap_or_default();
        match solution.value(variable) {
            Ok(value) => {
                let close = (value - wanted).abs() <= near * wanted.abs().max(1.0);
                complaints.unless(close, || format!("`{name}` is {value}, not {wanted}"));
            }
            Err(error) => complaints.add(format!("`{name}` cannot be read: {error}")),
        }
    }
}

/// Checks what holds for every solution: a point is verified, a bound is never beyond the optimum,
/// and the figures are consistent.
pub(super) fn sound(
    model: &Model,
    solution: &Solution,
    optimum: f64,
    options: &Options,
    complaints: &mut Complaints,
) {
    let (sign, bound) = (model.sense().sign(), solution.bound());
    let allowed = BOUND_ROUNDING * if optimum.is_finite() { optimum.abs().max(1.0) } else { 0.0 };
    complaints.unless(sign * bound <= sign * optimum + allowed, || {
        format!("the bound {bound} is beyond the optimum {optimum}")
    });
    let Some(point) = solution.point() else {
        let none = solution.primal_status() == PrimalStatus::None
            && solution.objective().is_none()
            && solution.gap() == f64::INFINITY
            && solution.value(Affine::zero()).is_err();
        complaints.unless(none, || {
            "there is no point, but a status or a value says that there is".into()
        });
        return;
    };
    complaints.unless(solution.primal_status() == PrimalStatus::Feasible, || {
        "there is a point, but the primal status says that there is none".into()
    });
    if point.as_slice().len() != model.variable_count() {
        complaints.add("the point has another number of values than the model has variables");
        return;
    }
    complaints.unless(solution.verification().is_some_and(|v| v.holds()), || {
        "the solution does not carry a verification that holds".into()
    });
    let again = Verification::of(model, point, options.feasibility);
    for violation in again.violations() {
        let (kind, name, amount) = (violation.kind, &violation.name, violation.amount);
        complaints.add(format!("the point violates `{name}` ({kind:?}) by {amount}"));
    }
    let (told, own) = (solution.objective(), point.value(model.objective()).ok());
    let Some((told, own)) = told.zip(own) else {
        complaints.add("there is a point, but no objective");
        return;
    };
    complaints.unless(told == own, || format!("its objective is {own}, not {told}"));
    // The point may use the feasibility tolerance, so it may be a little better than the optimum.
    let slack = 1e-5 * optimum.abs().max(1.0);
    complaints.unless(sign * told >= sign * optimum - slack, || {
        format!("the objective {told} is better than the optimum {optimum}")
    });
    let gap = (sign * (told - bound)).max(0.0);
    complaints.unless(solution.gap() == gap, || {
        format!("the gap is {}, but objective and bound differ by {gap}", solution.gap())
    });
}
