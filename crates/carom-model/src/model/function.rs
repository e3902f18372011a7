//! Functions of variables that are not affine, as first-class statements of a model.

use super::affine::Affine;
use super::ids::Variable;
use super::piecewise::PiecewiseAffine;
use crate::activity;
use crate::elementary::Elementary;
use crate::error::Error;
use crate::interval::Interval;

/// The function that a variable equals, made by [`Model::product`](super::Model::product),
/// [`absolute`](super::Model::absolute) and similar methods.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Function {
    /// A binary or integer variable times an affine expression.
    Product {
        /// The binary or integer variable.
        factor: Variable,
        /// The expression.
        of: Affine,
    },
    /// The absolute value.
    Absolute(Affine),
    /// The largest of several expressions.
    Maximum(Vec<Affine>),
    /// The smallest of several expressions.
    Minimum(Vec<Affine>),
    /// A piecewise-affine function of an expression, which must lie in its domain.
    Piecewise {
        /// The expression.
        of: Affine,
        /// The function.
        graph: PiecewiseAffine,
    },
    /// An elementary function of an expression, which must lie in its domain.
    Elementary {
        /// The function.
        function: Elementary,
        /// The expression.
        of: Affine,
    },
    /// The product of two expressions.
    Bilinear([Affine; 2]),
    /// An expression divided by another one, which must be other than 0.
    Quotient([Affine; 2]),
}

impl Function {
    /// Value at a point, given as a function from variables to values. The argument of a
    /// piecewise-affine function is clamped to its domain.
    pub fn evaluate(&self, value: impl Fn(Variable) -> f64) -> f64 {
        match self {
            Function::Product { factor, of } => value(*factor) * of.evaluate(&value),
            Function::Absolute(of) => of.evaluate(&value).abs(),
            Function::Maximum(of) => {
                of.iter().map(|e| e.evaluate(&value)).fold(f64::NEG_INFINITY, f64::max)
            }
            Function::Minimum(of) => {
                of.iter().map(|e| e.evaluate(&value)).fold(f64::INFINITY, f64::min)
            }
            Function::Piecewise { of, graph } => graph.value_near(of.evaluate(&value)),
            Function::Elementary { function, of } => function.value(of.evaluate(&value)),
            Function::Bilinear([left, right]) => left.evaluate(&value) * right.evaluate(&value),
            Function::Quotient([left, right]) => left.evaluate(&value) / right.evaluate(&value),
        }
    }

    /// The range of the function over ranges of its variables, with outward rounding.
    #[doc(hidden)]
    pub fn range(&self, range: impl Fn(Variable) -> Interval) -> Interval {
        let of = |e: &Affine| {
            activity::range(e.offset(), e.terms().into_iter().map(|(v, factor)| (factor, range(v))))
        };
        let zero = Interval::point(0.0);
        match self {
            Function::Product { factor, of: e } => range(*factor) * of(e),
            Function::Absolute(e) => {
                let Interval { lower, upper } = of(e);
                let least = if zero.intersection(of(e)).is_empty() {
                    lower.abs().min(upper.abs())
                } else {
                    0.0
                };
                Interval::new(least, lower.abs().max(upper.abs()))
            }
            Function::Maximum(list) => {
                let ranges = list.iter().map(of);
                let both = |a: Interval, b: Interval| {
                    Interval::new(a.lower.max(b.lower), a.upper.max(b.upper))
                };
                ranges.reduce(both).unwrap_or(Interval::REALS)
            }
            Function::Minimum(list) => {
                let ranges = list.iter().map(of);
                let both = |a: Interval, b: Interval| {
                    Interval::new(a.lower.min(b.lower), a.upper.min(b.upper))
                };
                ranges.reduce(both).unwrap_or(Interval::REALS)
            }
            Function::Piecewise { graph, .. } => {
                let values = graph.points().iter().map(|(_, y)| Interval::point(*y));
                values.reduce(|a, b| a.hull(b)).unwrap_or(Interval::REALS)
            }
            Function::Elementary { function, of: e } => function.range(of(e)),
            Function::Bilinear([a, b]) => of(a) * of(b),
            Function::Quotient([a, b]) => of(a) / of(b),
        }
    }

    /// The function with other expressions in the places of its own; `None` for a product with a
    /// binary.
    #[doc(hidden)]
    pub fn try_map(
        &self,
        mut entry: impl FnMut(&Affine) -> Result<Affine, Error>,
    ) -> Result<Option<Function>, Error> {
        let list = |of: &[Affine], entry: &mut dyn FnMut(&Affine) -> Result<Affine, Error>| {
            of.iter().map(entry).collect::<Result<Vec<Affine>, Error>>()
        };
        Ok(Some(match self {
            Function::Product { .. } => return Ok(None),
            Function::Absolute(of) => Function::Absolute(entry(of)?),
            Function::Maximum(of) => Function::Maximum(list(of, &mut entry)?),
            Function::Minimum(of) => Function::Minimum(list(of, &mut entry)?),
            Function::Piecewise { of, graph } => {
                Function::Piecewise { of: entry(of)?, graph: graph.clone() }
            }
            Function::Elementary { function, of } => {
                Function::Elementary { function: function.clone(), of: entry(of)? }
            }
            Function::Bilinear([a, b]) => Function::Bilinear([entry(a)?, entry(b)?]),
            Function::Quotient([a, b]) => Function::Quotient([entry(a)?, entry(b)?]),
        }))
    }

    /// The expressions that it depends on, without the factor of a product.
    pub fn expressions(&self) -> &[Affine] {
        match self {
            Function::Product { of, .. }
            | Function::Absolute(of)
            | Function::Piecewise { of, .. }
            | Function::Elementary { of, .. } => std::slice::from_ref(of),
            Function::Maximum(of) | Function::Minimum(of) => of,
            Function::Bilinear(of) | Function::Quotient(of) => of,
        }
    }

    /// The factor of a product.
    pub fn factor(&self) -> Option<Variable> {
        match self {
            Function::Product { factor, .. } => Some(*factor),
            _ => None,
        }
    }

    /// Whether it is neither affine nor piecewise affine, so that rows only enclose it.
    #[doc(hidden)]
    pub fn is_smooth(&self) -> bool {
        matches!(self, Function::Elementary { .. } | Function::Bilinear(_) | Function::Quotient(_))
    }

    /// The function with its variables named.
    #[doc(hidden)]
    pub fn text(&self, name: &dyn Fn(Variable) -> String) -> String {
        let list = |of: &[Affine]| of.iter().map(|e| e.text(name)).collect::<Vec<_>>().join(", ");
        match self {
            Function::Product { factor, of } => format!("{} * ({})", name(*factor), of.text(name)),
            Function::Absolute(of) => format!("|{}|", of.text(name)),
            Function::Maximum(of) => format!("max({})", list(of)),
            Function::Minimum(of) => format!("min({})", list(of)),
            Function::Piecewise { of, graph } => {
                let points = graph.points().iter().map(|(x, y)| format!("({x}, {y})"));
                let points = points.collect::<Vec<_>>().join(" ");
                format!("f({}) through {points}", of.text(name))
            }
            Function::Elementary { function, of } => function.text(&of.text(name)),
            Function::Bilinear([left, right]) => {
                format!("({}) * ({})", left.text(name), right.text(name))
            }
            Function::Quotient([left, right]) => {
                format!("({}) / ({})", left.text(name), right.text(name))
            }
        }
    }
}
