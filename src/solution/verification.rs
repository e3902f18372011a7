//! The independent check of a point against a model.
//!
//! It shares no code with lowering, presolve or search: it reads the model's own statements and
//! evaluates them. Indicators are checked as implications on the binaries' values, so a big-M
//! that leaks cannot hide, disjunctions by the rows of the selected term, logic by the truth of
//! its formulas, and functions by their values.

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
            let (amount, scale) = excess(value, variable.bounds(), value.abs());
            check.note(ViolationKind::Bound, amount, feasibility * scale, || {
                variable.name().to_string()
            });
            if variable.kind().is_integral() {
                let amount = (value - value.round()).abs();
                check
                    .note(ViolationKind::Integrality, amount, 1e-9, || variable.name().to_string());
            }
        }
        for row in model.constraints() {
            let (amount, scale) = residual(row.terms(), row.limits(), values);
            let name = || row.name().to_string();
            check.note(ViolationKind::Row, amount, feasibility * scale, name);
        }
        for function in model.functions() {
            let result = function.result();
            let (amount, scale) = distance(function.function(), result, values, feasibility);
            let name = || function.name().to_string();
            check.note(ViolationKind::Function, amount, feasibility * scale, name);
        }
        let on = |variable: Variable| values[variable.index()].round() == 1.0;
        for logical in model.logical_constraints() {
            let amount = f64::from(u8::from(!logical.logic().evaluate(on)));
            check.note(ViolationKind::Logic, amount, 0.0, || logical.name().to_string());
        }
        for indicator in model.indicators() {
            let name = || indicator.name().to_string();
            if let BigM::Assumed(_) = indicator.big_m() {
                check.assumed.push(name());
            }
            if indicator.condition().evaluate(on) {
                check.checked.active_implications += 1;
                let (amount, scale) = residual(indicator.terms(), indicator.limits(), values);
                check.note(ViolationKind::Implication, amount, feasibility * scale, name);
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
                let (amount, scale) = residual(terms, limits, values);
                let name = || name.to_string();
                self.note(ViolationKind::Disjunction, amount, feasibility * scale, name);
            }
            for inner in term.nested() {
                self.one_of(name, inner.into_iter(), on, values, feasibility);
            }
        }
        let amount = selected.abs_diff(usize::from(active)) as f64;
        self.note(ViolationKind::Disjunction, amount.min(1.0), 0.0, || name.to_string());
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
        amount: f64,
        allowed: f64,
        name: impl FnOnce() -> String,
    ) {
        // NaN is a violation.
        if amount.is_nan() || amount > allowed {
            self.violations.push(Violation { kind, name: name(), amount });
        }
        if amount.is_nan() || amount > self.largest_residual {
            self.largest_residual = amount;
        }
    }
}

/// How far a variable is from the function it should be, and the scale of its tolerance.
fn distance(function: &Function, result: Variable, values: &[f64], feasibility: f64) -> (f64, f64) {
    let (value, at) = (values[result.index()], |v: Variable| values[v.index()]);
    let terms = function.expressions().iter().flat_map(Affine::terms);
    let largest = terms.map(|(v, a)| (a * at(v)).abs()).fold(value.abs(), f64::max);
    let scale = tolerance::row_scale(largest, 0.0);
    match function {
        Function::Piecewise { of, graph } => {
            // The argument is known up to a tolerance of its own, which a steep piece enlarges.
            let (x, slack) = (of.evaluate(at), feasibility * scale);
            let near = graph.values_within(x - slack, x + slack);
            (excess(value, near, 0.0).0 + excess(x, graph.domain(), 0.0).0, scale)
        }
        // The expression is known up to a tolerance of its own, which the factor enlarges.
        Function::Product { factor, .. } => {
            ((value - function.evaluate(at)).abs(), scale * at(*factor).abs().max(1.0))
        }
        _ => ((value - function.evaluate(at)).abs(), scale),
    }
}

/// By how much a row misses its limits, and the scale of its tolerance.
fn residual(terms: &[(Variable, f64)], limits: Interval, values: &[f64]) -> (f64, f64) {
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for &(variable, coefficient) in terms {
        let term = coefficient * values[variable.index()];
        sum += term;
        largest = largest.max(term.abs());
    }
    excess(sum, limits, largest)
}

fn excess(value: f64, limits: Interval, largest_term: f64) -> (f64, f64) {
    if value.is_nan() {
        return (f64::NAN, 1.0);
    }
    let below = limits.lower - value;
    let above = value - limits.upper;
    let limit = if below > above { limits.lower } else { limits.upper };
    (below.max(above).max(0.0), tolerance::row_scale(largest_term, limit))
}
