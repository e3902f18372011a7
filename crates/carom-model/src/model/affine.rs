//! Affine expressions `constant + sum a_j x_j`.

use std::fmt;

use super::ids::Variable;
use crate::number::Exact;
use crate::sum::Sum;

/// An affine expression `constant + sum a_j x_j`, in any unit you choose.
///
/// Built with `+`, `-`, unary `-`, multiplication by a number, and `sum` over iterators, on values
/// and on references. Terms of the same variable are merged and sorted by variable when the
/// expression is read, so the order of building never shows.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.continuous_family("x", 3, 0.0, 1.0)?;
/// let total: Affine = x.iter().map(|v| 2.0 * v).sum();
/// assert_eq!((&total - x[1]).to_string(), "2 #0 + #1 + 2 #2");
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Affine {
    terms: Vec<(Variable, f64)>,
    constant: f64,
}

impl Affine {
    /// The expression 0.
    #[inline]
    pub fn zero() -> Self {
        Affine::default()
    }

    /// A constant.
    #[inline]
    pub fn constant(value: f64) -> Self {
        Affine { terms: Vec::new(), constant: value }
    }

    /// Adds `coefficient * variable` in place. This is the fastest way to build long rows.
    pub fn add_term(&mut self, coefficient: f64, variable: Variable) {
        self.terms.push((variable, coefficient));
    }

    /// The constant part.
    #[inline]
    pub fn offset(&self) -> f64 {
        self.constant
    }

    /// The terms sorted by variable, merged, without exact zeros.
    pub fn terms(&self) -> Vec<(Variable, f64)> {
        let mut terms = self.terms.clone();
        merge(&mut terms);
        terms
    }

    /// Value at a point given by a function from variables to values.
    #[inline]
    pub fn evaluate(&self, value: impl Fn(Variable) -> f64) -> f64 {
        self.sum(value).value()
    }

    pub(super) fn sum(&self, value: impl Fn(Variable) -> f64) -> Sum {
        let mut sum = Sum::new(self.constant);
        self.terms.iter().for_each(|&(v, a)| sum.add_product(a, value(v)));
        sum
    }

    #[doc(hidden)]
    pub fn into_parts(mut self) -> (Vec<(Variable, f64)>, f64) {
        merge(&mut self.terms);
        (self.terms, self.constant)
    }

    #[doc(hidden)]
    #[inline]
    pub fn raw_terms(&self) -> &[(Variable, f64)] {
        &self.terms
    }

    #[doc(hidden)]
    pub fn scale(&mut self, factor: f64) {
        self.constant *= factor;
        for (_, a) in &mut self.terms {
            *a *= factor;
        }
    }

    /// Divides by a number, which rounds less than multiplying by its inverse.
    pub(crate) fn divide(&mut self, divisor: f64) {
        self.constant /= divisor;
        for (_, a) in &mut self.terms {
            *a /= divisor;
        }
    }

    #[doc(hidden)]
    pub fn append(&mut self, other: &Affine, factor: f64) {
        self.constant += factor * other.constant;
        self.terms.extend(other.terms.iter().map(|&(v, a)| (v, factor * a)));
    }
}

/// Sorts by variable, adds up duplicates, drops exact zeros.
pub fn merge(terms: &mut Vec<(Variable, f64)>) {
    if !terms.is_sorted_by(|a, b| a.0 < b.0) {
        terms.sort_by_key(|&(v, _)| v); // stable: sums are formed in the order of building
        terms.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                kept.1 += later.1;
            }
            same
        });
    }
    terms.retain(|&(_, a)| a != 0.0);
}

impl PartialEq for Affine {
    fn eq(&self, other: &Self) -> bool {
        self.constant == other.constant && self.terms() == other.terms()
    }
}

impl From<f64> for Affine {
    fn from(value: f64) -> Self {
        Affine::constant(value)
    }
}

impl From<Variable> for Affine {
    fn from(variable: Variable) -> Self {
        Affine { terms: vec![(variable, 1.0)], constant: 0.0 }
    }
}

impl From<&Variable> for Affine {
    fn from(variable: &Variable) -> Self {
        Affine::from(*variable)
    }
}

impl From<&Affine> for Affine {
    fn from(expression: &Affine) -> Self {
        expression.clone()
    }
}

impl fmt::Display for Affine {
    /// Variables appear by position (`#3`); the model's own text form has their names.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(&|v| format!("#{}", v.index())))
    }
}

impl Affine {
    /// The expression with its variables named.
    #[doc(hidden)]
    pub fn text(&self, name: &dyn Fn(Variable) -> String) -> String {
        let (terms, mut text) = (self.terms(), String::new());
        // Writing into a string cannot fail.
        let _ = write_terms(&mut text, &terms, name);
        match self.constant {
            c if terms.is_empty() => c.to_string(),
            0.0 => text,
            c if c < 0.0 => format!("{text} - {}", -c),
            c => format!("{text} + {c}"),
        }
    }
}

/// Writes `2 a - b + 0.5 c`, naming variables through `name`.
pub(crate) fn write_terms(
    f: &mut impl fmt::Write,
    terms: &[(Variable, f64)],
    name: impl Fn(Variable) -> String,
) -> fmt::Result {
    for (k, &(v, a)) in terms.iter().enumerate() {
        match (k == 0, a < 0.0) {
            (true, true) => f.write_str("-")?,
            (true, false) => {}
            (false, true) => f.write_str(" - ")?,
            (false, false) => f.write_str(" + ")?,
        }
        if a.abs() != 1.0 {
            write!(f, "{} ", Exact(a.abs()))?;
        }
        f.write_str(&name(v))?;
    }
    Ok(())
}
