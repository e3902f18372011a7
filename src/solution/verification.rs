//! The independent check of a point against a model.
//!
//! It shares no code with lowering, presolve or search: it reads the model's own statements and
//! evaluates them. Indicators are checked as implications on the binaries' values, so a big-M
//! that leaks cannot hide, disjunctions by the rows of the selected term, logic by the truth of
//! its formulas, and functions by their values.

use std::fmt;

use crate::interval::Interval;
use crate::model::{Affine, BigM, Function, Model, Name, TermRef, Variable};
use crate::tolerance;

use super::point::Point;

/// The result of checking a [`Point`] against a [`Model`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Verification {
    violations: Vec<Violation>,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
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
    /// Indicators whose condition holds, so that their row had to.
    pub active_implications: usize,
    /// Disjunctions.
    pub disjunctions: usize,
    /// Logic statements.
    pub logic: usize,
    /// Functions.
    pub functions: usize,
}

/// A statement that a point violates by more than the tolerance.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Violation {
    /// What is violated.
    pub kind: ViolationKind,
    /// The variable or statement.
    pub name: String,
    /// By how much, in the statement's own unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub amount: f64,
    /// By how much, without a unit: the amount over the largest term or limit of the statement,
    /// which counts as 1 where it is smaller.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub relative: f64,
}

/// What kind of statement a [`Violation`] is about.
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
    /// An indicator whose condition holds and whose row does not.
    Implication,
    /// A disjunction: a row of the selected term that does not hold, or (with an amount of 1) not
    /// exactly one selected term.
    Disjunction,
    /// A logic statement that is false; the amount is 1.
    Logic,
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
            ViolationKind::Implication => "the implication",
            ViolationKind::Logic => return write!(f, "the logic `{}`", self.name),
            ViolationKind::Disjunction => "the disjunction",
            ViolationKind::Function => "the function",
        };
        write!(f, "{what} `{}` by {}", self.name, for_reading(self.amount))
    }
}

impl Verification {
    /// Checks a point: bounds, integrality, rows, implications, disjunctions, logic, functions.
    ///
    /// # Arguments
    ///
    /// * `feasibility`: the tolerance of rows and bounds, multiplied by
    ///   [`tolerance::row_scale`]. Integer variables must be whole within 1e-9.
    pub fn of(model: &Model, point: &Point, feasibility: f64) -> Self {
        let values = point.as_slice();
        let mut check = Verification {
            violations: Vec::new(),
            largest_residual: 0.0,
            checked: Checked::default(),
            assumed: Vec::new(),
        };
        for variable in model.variables() {
            let value = values[variable.id().index()];
            let miss = excess(value, variable.bounds(), value.abs());
            check.note(ViolationKind::Bound, miss, feasibility, || variable.name().to_string());
            if variable.kind().is_integral() {
                let miss = Miss::new((value - value.round()).abs(), 0.0);
                check.note(ViolationKind::Integrality, miss, 1e-9, || variable.name().to_string());
            }
        }
        for row in model.constraints() {
            let miss = residual(row.terms(), row.limits(), values);
            check.note(ViolationKind::Row, miss, feasibility, || row.name().to_string());
        }
        for function in model.functions() {
            let result = function.result();
            let miss = distance(function.function(), result, values, feasibility);
            let name = || function.name().to_string();
            check.note(ViolationKind::Function, miss, feasibility, name);
        }
        let on = |variable: Variable| values[variable.index()].round() == 1.0;
        for logical in model.logical_constraints() {
            let amount = f64::from(u8::from(!logical.logic().evaluate(on)));
            let name = || logical.name().to_string();
            check.note(ViolationKind::Logic, Miss::new(amount, 0.0), 0.0, name);
        }
        for indicator in model.indicators() {
            let name = || indicator.name().to_string();
            if let BigM::Assumed(_) = indicator.big_m() {
                check.assumed.push(name());
            }
            if indicator.condition().evaluate(on) {
                check.checked.active_implications += 1;
                let miss = residual(indicator.terms(), indicator.limits(), values);
                check.note(ViolationKind::Implication, miss, feasibility, name);
            }
        }
        for disjunction in model.disjunctions() {
            check.one_of(disjunction.name(), disjunction.terms(), true, values, feasibility);
        }
        check.checked = Checked {
            variables: model.variable_count(),
            rows: model.constraint_count(),
            implications: model.indicator_count(),
            disjunctions: model.disjunction_count(),
            logic: model.logical_constraint_count(),
            functions: model.function_count(),
            ..check.checked
        };
        check
    }

    /// Checks that one term is selected (or none, where the disjunction stands in a term that is
    /// not) and that its rows hold.
    fn one_of<'a>(
        &mut self,
        name: &Name,
        terms: impl Iterator<Item = TermRef<'a>>,
        active: bool,
        values: &[f64],
        feasibility: f64,
    ) {
        let mut selected = 0;
        for term in terms {
            let selector = term.selector();
            let on = (values[selector.variable().index()].round() == 1.0) == selector.is_on();
            selected += usize::from(on);
            for (terms, limits) in term.rows().filter(|_| on) {
                let (miss, name) = (residual(terms, limits, values), || name.to_string());
                self.note(ViolationKind::Disjunction, miss, feasibility, name);
            }
            for inner in term.nested() {
                self.one_of(name, inner.into_iter(), on, values, feasibility);
            }
        }
        let wrong = f64::from(u8::from(selected != usize::from(active)));
        self.note(ViolationKind::Disjunction, Miss::new(wrong, 0.0), 0.0, || name.to_string());
    }

    /// Whether nothing is violated beyond the tolerance.
    pub fn holds(&self) -> bool {
        self.violations.is_empty()
    }

    /// What is violated beyond the tolerance.
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

    fn note(
        &mut self,
        kind: ViolationKind,
        Miss { amount, size, scale }: Miss,
        tolerance: f64,
        name: impl FnOnce() -> String,
    ) {
        // NaN is a violation.
        if amount.is_nan() || amount > tolerance * scale {
            let relative = amount / size.max(1.0);
            self.violations.push(Violation { kind, name: name(), amount, relative });
        }
        if amount.is_nan() || amount > self.largest_residual {
            self.largest_residual = amount;
        }
    }
}

/// A number as a reader wants it: rounded to six significant digits.
pub(crate) fn for_reading(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// By how much a statement is missed, the largest number in it, and the scale of its tolerance.
struct Miss {
    amount: f64,
    size: f64,
    scale: f64,
}

impl Miss {
    fn new(amount: f64, size: f64) -> Self {
        Miss { amount, size, scale: tolerance::row_scale(size, 0.0) }
    }
}

/// How far a variable is from the function it should be.
fn distance(function: &Function, result: Variable, values: &[f64], feasibility: f64) -> Miss {
    let (value, at) = (values[result.index()], |v: Variable| values[v.index()]);
    let terms = function.expressions().iter().flat_map(Affine::terms);
    let largest = terms.map(|(v, a)| (a * at(v)).abs()).fold(value.abs(), f64::max);
    let scale = tolerance::row_scale(largest, 0.0);
    match function {
        Function::Piecewise { of, graph } => {
            // The argument is known up to a tolerance of its own, which a steep piece enlarges.
            let (x, slack) = (of.evaluate(at), feasibility * scale);
            let near = graph.values_within(x - slack, x + slack);
            let amount = excess(value, near, 0.0).amount + excess(x, graph.domain(), 0.0).amount;
            Miss::new(amount, largest)
        }
        // The expression is known up to a tolerance of its own, which the factor enlarges.
        Function::Product { factor, .. } => {
            let miss = Miss::new((value - function.evaluate(at)).abs(), largest);
            Miss { scale: scale * at(*factor).abs().max(1.0), ..miss }
        }
        _ => Miss::new((value - function.evaluate(at)).abs(), largest),
    }
}

/// By how much a row misses its limits.
fn residual(terms: &[(Variable, f64)], limits: Interval, values: &[f64]) -> Miss {
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for &(variable, coefficient) in terms {
        let term = coefficient * values[variable.index()];
        sum += term;
        largest = largest.max(term.abs());
    }
    excess(sum, limits, largest)
}

fn excess(value: f64, limits: Interval, largest_term: f64) -> Miss {
    if value.is_nan() {
        return Miss::new(f64::NAN, 0.0);
    }
    let below = limits.lower - value;
    let above = value - limits.upper;
    let limit = if below > above { limits.lower } else { limits.upper };
    let limit = if limit.is_finite() { limit.abs() } else { 0.0 };
    Miss::new(below.max(above).max(0.0), largest_term.max(limit))
}
