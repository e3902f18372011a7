//! The independent check of a point against a model.
//!
//! It shares no code with lowering, presolve or search: it reads the model's own statements and
//! evaluates them. Indicators are checked as implications on the binaries' values, so a big-M
//! that leaks cannot hide, disjunctions by the rows of the selected term, logic by the truth of
//! its formulas, functions by their values, and ordered sets by the members that are not 0.

use std::fmt;

use crate::interval::Interval;
use crate::model::{BigM, Model, Name, TermRef, Variable};
use crate::number::rounded;

use super::evaluation::{Evaluation, Miss};
use super::point::Point;

/// The result of checking a [`Point`] against a [`Model`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Verification {
    violations: Vec<Violation>,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    largest_residual: f64,
    checked: Checked,
    assumed: Vec<String>,
}

/// How many statements of each kind were checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checked {
    /// Variables: bounds and integrality.
    pub variables: usize,
    /// Linear rows.
    pub rows: usize,
    /// Indicators.
    pub implications: usize,
    /// Indicators whose condition holds, so that their row must hold.
    pub active_implications: usize,
    /// Disjunctions.
    pub disjunctions: usize,
    /// Logic statements.
    pub logic: usize,
    /// Functions.
    pub functions: usize,
    /// Semi-continuous variables.
    #[cfg_attr(feature = "serde", serde(default))]
    pub semicontinuous: usize,
    /// Special ordered sets.
    #[cfg_attr(feature = "serde", serde(default))]
    pub sets: usize,
    /// Norms and quadratic rows, with and without a condition.
    #[cfg_attr(feature = "serde", serde(default))]
    pub cones: usize,
}

/// A statement that a point violates by more than the tolerance.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Violation {
    /// The kind of statement that is violated.
    pub kind: ViolationKind,
    /// The variable or statement.
    pub name: String,
    /// By how much, in the statement's own unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub amount: f64,
    /// By how much, without a unit: the amount divided by the largest term or limit of the
    /// statement, or by 1 if that is smaller.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub relative: f64,
}

/// The kind of statement that a [`Violation`] is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ViolationKind {
    /// A variable's bound, or a value that is not a number.
    Bound,
    /// A binary or integer variable's value is not whole.
    Integrality,
    /// A linear row.
    Row,
    /// A norm or a quadratic row that must hold.
    Cone,
    /// An indicator whose condition holds and whose row does not.
    Implication,
    /// A disjunction: a row of the selected term that does not hold, or (with an amount of 1) not
    /// exactly one selected term.
    Disjunction,
    /// A logic statement that is false; the amount is 1.
    Logic,
    /// A semi-continuous variable that is neither 0 nor one of its other values; the amount is the
    /// distance to the nearest of them.
    SemiContinuity,
    /// A special ordered set with other members than allowed at values other than 0; the amount is
    /// the magnitude of the largest one that should be 0.
    OrderedSet,
    /// A variable that is not the function that it should be, or the argument of a
    /// piecewise-affine function outside its domain.
    Function,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.kind {
            ViolationKind::Bound => "a bound of",
            ViolationKind::Integrality => "the integrality of",
            ViolationKind::Row => "the row",
            ViolationKind::Cone => "the cone",
            ViolationKind::Implication => "the implication",
            ViolationKind::Logic => return write!(f, "the logic `{}`", self.name),
            ViolationKind::Disjunction => "the disjunction",
            ViolationKind::SemiContinuity => "the semi-continuity of",
            ViolationKind::OrderedSet => "the ordered set",
            ViolationKind::Function => "the function",
        };
        write!(f, "{what} `{}` by {}", self.name, rounded(self.amount, 6))
    }
}

impl Verification {
    /// Checks a point: bounds, integrality, semi-continuity, rows, cones, implications,
    /// disjunctions, logic, functions, ordered sets.
    ///
    /// # Arguments
    ///
    /// * `feasibility`: the absolute tolerance of rows, cones, bounds and functions, in their
    ///   units. Rounding is forgiven as well, but not in rows of integers with whole coefficients.
    ///   Integer variables must be whole within 1e-9.
    pub fn of(model: &Model, point: &Point, feasibility: f64) -> Self {
        let at = Evaluation::new(model, point.as_slice(), feasibility);
        let mut check = Verification {
            violations: Vec::new(),
            largest_residual: 0.0,
            checked: Checked::default(),
            assumed: Vec::new(),
        };
        for variable in model.variables() {
            let name = || variable.name().to_string();
            let miss = at.row(&[(variable.id(), 1.0)], variable.bounds());
            check.note(ViolationKind::Bound, miss, name);
            if variable.kind().is_integral() {
                let value = at.value(variable.id());
                let miss = Miss::beyond((value - value.round()).abs(), 1e-9);
                check.note(ViolationKind::Integrality, miss, name);
            }
            if let Some(values) = variable.semicontinuous() {
                check.checked.semicontinuous += 1;
                let miss = at.either(variable.id(), values);
                check.note(ViolationKind::SemiContinuity, miss, name);
            }
        }
        for row in model.constraints() {
            let miss = at.row(row.terms(), row.limits());
            check.note(ViolationKind::Row, miss, || row.name().to_string());
        }
        for function in model.functions() {
            let miss = at.function(function.function(), function.result());
            check.note(ViolationKind::Function, miss, || function.name().to_string());
        }
        let on = |variable: Variable| at.is_on(variable);
        for conic in model.conic_constraints() {
            let name = || conic.name().to_string();
            if let BigM::Assumed(_) = conic.big_m() {
                check.assumed.push(name());
            }
            if conic.condition().is_none_or(|condition| condition.is_true(on)) {
                let miss = at.conic(conic.conic());
                check.note(ViolationKind::Cone, miss, name);
            }
        }
        for logical in model.logical_constraints() {
            let amount = f64::from(u8::from(!logical.logic().is_true(on)));
            let name = || logical.name().to_string();
            check.note(ViolationKind::Logic, Miss::beyond(amount, 0.0), name);
        }
        for indicator in model.indicators() {
            let name = || indicator.name().to_string();
            if let BigM::Assumed(_) = indicator.big_m() {
                check.assumed.push(name());
            }
            if indicator.condition().is_true(on) {
                check.checked.active_implications += 1;
                let miss = at.row(indicator.terms(), indicator.limits());
                check.note(ViolationKind::Implication, miss, name);
            }
        }
        for disjunction in model.disjunctions() {
            check.one_of(disjunction.name(), disjunction.terms(), true, &at);
        }
        for set in model.special_ordered_sets() {
            let miss = at.ordered_set(set.members(), set.most());
            check.note(ViolationKind::OrderedSet, miss, || set.name().to_string());
        }
        check.checked = Checked {
            variables: model.variable_count(),
            rows: model.constraint_count(),
            implications: model.indicator_count(),
            disjunctions: model.disjunction_count(),
            logic: model.logical_constraint_count(),
            functions: model.function_count(),
            sets: model.special_ordered_set_count(),
            cones: model.conic_constraint_count(),
            ..check.checked
        };
        check
    }

    /// Checks that one term is selected and that its rows hold. If the disjunction is nested in a
    /// term that is not selected, no term may be.
    fn one_of<'a>(
        &mut self,
        name: &Name,
        terms: impl Iterator<Item = TermRef<'a>>,
        active: bool,
        at: &Evaluation<'_>,
    ) {
        let mut selected = 0;
        for term in terms {
            let selector = term.selector();
            let on = at.is_on(selector.variable()) == selector.is_on();
            selected += usize::from(on);
            for (terms, limits) in term.rows().filter(|_| on) {
                let miss = at.row(terms, limits);
                self.note(ViolationKind::Disjunction, miss, || name.to_string());
            }
            for conic in term.conic().iter().filter(|_| on) {
                let miss = at.conic(conic);
                self.note(ViolationKind::Disjunction, miss, || name.to_string());
            }
            for inner in term.nested() {
                self.one_of(name, inner.into_iter(), on, at);
            }
        }
        let wrong = f64::from(u8::from(selected != usize::from(active)));
        self.note(ViolationKind::Disjunction, Miss::beyond(wrong, 0.0), || name.to_string());
    }

    /// By how much a point misses a row, and whether that is more than the tolerance.
    #[doc(hidden)]
    pub fn of_row(
        model: &Model,
        point: &Point,
        (terms, limits): (&[(Variable, f64)], Interval),
        feasibility: f64,
    ) -> (f64, bool) {
        let miss = Evaluation::new(model, point.as_slice(), feasibility).row(terms, limits);
        // NaN is a violation.
        (miss.amount, miss.amount.is_nan() || miss.amount > miss.allowed)
    }

    /// Whether nothing is violated by more than the tolerance.
    pub fn holds(&self) -> bool {
        self.violations.is_empty()
    }

    /// The violations by more than the tolerance.
    pub fn violations(&self) -> &[Violation] {
        &self.violations
    }

    /// The largest residual over all statements, violated or not, in the unit of its statement.
    pub fn largest_residual(&self) -> f64 {
        self.largest_residual
    }

    /// How many statements of each kind were checked.
    pub fn checked(&self) -> Checked {
        self.checked
    }

    /// Number of indicators whose condition holds at the point.
    pub fn active_implications(&self) -> usize {
        self.checked.active_implications
    }

    /// Indicators whose big-M was taken on trust ([`BigM::Assumed`]): the point obeys them, but
    /// points may have been cut off.
    pub fn assumed(&self) -> &[String] {
        &self.assumed
    }

    fn note(&mut self, kind: ViolationKind, miss: Miss, name: impl FnOnce() -> String) {
        let Miss { amount, size, allowed } = miss;
        // NaN is a violation.
        if amount.is_nan() || amount > allowed {
            let relative = amount / size.max(1.0);
            self.violations.push(Violation { kind, name: name(), amount, relative });
        }
        if amount.is_nan() || amount > self.largest_residual {
            self.largest_residual = amount;
        }
    }
}
