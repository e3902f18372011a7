//! The readable text form of a model.

use std::fmt;

use super::affine::write_terms;
use super::conic::StoredConic;
use super::ids::Variable;
use super::literal::Literal;
use super::logic::Logic;
use super::quadratic::Quadratic;
use super::refs::SpecialOrderedSetRef;
use super::semicontinuous::with_zero;
use super::store::Model;
use super::stored::StoredTerm;
use super::variable::VariableKind;
use crate::interval::Interval;
use crate::number::Exact;

impl fmt::Display for Model {
    /// Objective, rows, norms and quadratic rows, indicators, disjunctions, logic, ordered sets,
    /// functions and bounds, with names, one statement per line.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous_family("x", 2, 0.0, 5.0)?;
    /// let z = model.binary("z")?;
    /// model.add("sum", (x[0] + x[1]).le(4.0))?;
    /// model.add("hit", z.on().implies(x[1].within(1.0, 2.0)))?;
    /// model.minimize((x[0] - 1.0).square() - 2.0 * x[1])?;
    /// assert_eq!(
    ///     model.to_string(),
    ///     "minimize x[0]^2 - 2 x[0] - 2 x[1] + 1\n\
    ///      subject to\n  \
    ///        sum: x[0] + x[1] <= 4\n  \
    ///        hit: z = 1 implies 1 <= x[1] <= 2\n\
    ///      where\n  \
    ///        0 <= x[0] <= 5\n  \
    ///        0 <= x[1] <= 5\n  \
    ///        z binary\n"
    /// );
    /// # Ok::<(), carom::Error>(())
    /// ```
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} {}", self.sense().word(), self.objective_text())?;
        writeln!(f, "subject to")?;
        for row in self.constraints() {
            writeln!(f, "  {}: {}", row.name(), self.row_text(row.terms(), row.limits()))?;
        }
        for conic in self.conic_constraints() {
            let row = self.conic_text(conic.conic());
            match conic.condition() {
                Some(condition) => {
                    let condition = self.condition_text(condition);
                    writeln!(f, "  {}: {condition} implies {row}", conic.name())?;
                }
                None => writeln!(f, "  {}: {row}", conic.name())?,
            }
        }
        for indicator in self.indicators() {
            let condition = self.condition_text(indicator.condition());
            let row = self.row_text(indicator.terms(), indicator.limits());
            writeln!(f, "  {}: {condition} implies {row}", indicator.name())?;
        }
        for disjunction in self.disjunctions() {
            let terms = self.terms_text(disjunction.stored_terms());
            writeln!(f, "  {}: {terms}", disjunction.name())?;
        }
        for logical in self.logical_constraints() {
            writeln!(f, "  {}: {}", logical.name(), logical.logic().text(&|v| self.name_of(v)))?;
        }
        for set in self.special_ordered_sets() {
            writeln!(f, "  {}: {}", set.name(), self.set_text(&set))?;
        }
        for function in self.functions() {
            let text = function.function().text(&|v| self.name_of(v));
            writeln!(f, "  {} = {text}", function.name())?;
        }
        writeln!(f, "where")?;
        for variable in self.variables() {
            let (name, bounds) = (variable.name().to_string(), variable.bounds());
            if let Some(range) = variable.parameter_range() {
                let value = Exact(bounds.lower);
                writeln!(f, "  {name} = {value}, a parameter in {}", interval_text(range))?;
                continue;
            }
            if let Some(values) = variable.semicontinuous() {
                let whole = if variable.kind().is_integral() { " integer" } else { "" };
                if bounds != with_zero(values) {
                    write!(f, "  {},", limits_text(&name, bounds))?;
                } else {
                    write!(f, " ")?;
                }
                writeln!(f, " {name} = 0 or {}{whole}", limits_text(&name, values))?;
                continue;
            }
            let relaxed = if variable.data.relaxed { ", relaxed" } else { "" };
            let limits = limits_text(&name, bounds);
            match variable.kind() {
                VariableKind::Binary if bounds == Interval::new(0.0, 1.0) => {
                    writeln!(f, "  {name} binary{relaxed}")?;
                }
                VariableKind::Binary => writeln!(f, "  {limits} binary{relaxed}")?,
                VariableKind::Integer => writeln!(f, "  {limits} integer{relaxed}")?,
                VariableKind::Continuous => writeln!(f, "  {limits}")?,
            }
        }
        Ok(())
    }
}

impl Model {
    /// The name of a variable, or its position if it belongs to another model.
    #[doc(hidden)]
    pub fn name_of(&self, variable: Variable) -> String {
        match self.variable_ref(variable) {
            Ok(v) => v.name().to_string(),
            Err(_) => format!("#{}", variable.index()),
        }
    }

    /// A row as text, `2 x[0] - y <= 4`.
    #[doc(hidden)]
    pub fn row_text(&self, terms: &[(Variable, f64)], limits: Interval) -> String {
        let mut text = String::new();
        // Writing into a string cannot fail.
        let _ = write_terms(&mut text, terms, |v| self.name_of(v));
        limits_text(if terms.is_empty() { "0" } else { &text }, limits)
    }

    /// A condition as text, `z = 1` or `(a & b)`.
    fn condition_text(&self, condition: &Logic) -> String {
        match condition.as_literal() {
            Some(literal) => {
                format!("{} = {}", self.name_of(literal.variable()), u8::from(literal.is_on()))
            }
            None => condition.operand(&|v| self.name_of(v)),
        }
    }

    /// A conic row as text, `|(x, y)| <= 3` or `x^2 + y^2 <= 4`.
    pub(crate) fn conic_text(&self, conic: &StoredConic) -> String {
        let name = |v: Variable| self.name_of(v);
        match conic {
            StoredConic::Norm { entries, bound } => {
                let entries: Vec<String> = entries.iter().map(|entry| entry.text(&name)).collect();
                format!("|({})| <= {}", entries.join(", "), bound.text(&name))
            }
            StoredConic::Quadratic { expression } => {
                let limit = 0.0 - expression.affine().offset();
                format!("{} <= {}", self.quadratic_text(expression, false), Exact(limit))
            }
        }
    }

    /// A disjunction as text, `(z = 1: x <= 1, y >= 2) or (z = 0: x >= 3)`.
    fn terms_text(&self, terms: &[StoredTerm]) -> String {
        let term = |term: &StoredTerm| {
            let rows = term.rows.iter();
            let rows =
                rows.map(|row| self.row_text(&row.terms, Interval::new(row.lower, row.upper)));
            let conic = term.conic.iter().map(|conic| self.conic_text(conic));
            let nested = term.nested.iter().map(|terms| self.terms_text(terms));
            let parts = rows.chain(conic).chain(nested).collect::<Vec<_>>();
            let parts = if parts.is_empty() { "anything".to_owned() } else { parts.join(", ") };
            let Literal { variable, on } = term.selector;
            format!("({} = {}: {parts})", self.name_of(variable), u8::from(on))
        };
        terms.iter().map(term).collect::<Vec<_>>().join(" or ")
    }

    /// An ordered set as text, `sos2(x: 1, y: 2)`.
    fn set_text(&self, set: &SpecialOrderedSetRef<'_>) -> String {
        let members = set.members().iter();
        let members = members.map(|&(v, weight)| format!("{}: {}", self.name_of(v), Exact(weight)));
        format!("sos{}({})", set.most(), members.collect::<Vec<_>>().join(", "))
    }

    fn objective_text(&self) -> String {
        self.quadratic_text(self.objective(), true)
    }

    fn quadratic_text(&self, expression: &Quadratic, with_constant: bool) -> String {
        let mut text = String::new();
        let mut part = |coefficient: f64, what: &str| {
            let sign = match (text.is_empty(), coefficient < 0.0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            text.push_str(sign);
            if what.is_empty() {
                text.push_str(&Exact(coefficient.abs()).to_string());
            } else {
                if coefficient.abs() != 1.0 {
                    text.push_str(&format!("{} ", Exact(coefficient.abs())));
                }
                text.push_str(what);
            }
        };
        for (a, b, q) in expression.products() {
            let (first, second) = (self.name_of(a), self.name_of(b));
            if a == b {
                part(q, &format!("{first}^2"));
            } else {
                part(q, &format!("{first} {second}"));
            }
        }
        for (v, a) in expression.affine().terms() {
            part(a, &self.name_of(v));
        }
        let constant = expression.affine().offset();
        if constant != 0.0 && with_constant {
            part(constant, "");
        }
        if text.is_empty() { "0".into() } else { text }
    }
}

fn interval_text(range: Interval) -> String {
    format!("[{}, {}]", Exact(range.lower), Exact(range.upper))
}

fn limits_text(middle: &str, limits: Interval) -> String {
    let (is_equal, finite) =
        (limits.lower == limits.upper, (limits.lower.is_finite(), limits.upper.is_finite()));
    let (lower, upper) = (Exact(limits.lower), Exact(limits.upper));
    match finite {
        _ if is_equal => format!("{middle} = {lower}"),
        (true, true) => format!("{lower} <= {middle} <= {upper}"),
        (true, false) => format!("{middle} >= {lower}"),
        (false, true) => format!("{middle} <= {upper}"),
        (false, false) => format!("{middle} free"),
    }
}
