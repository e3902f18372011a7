//! A column that equals a smooth function of one or two others.

use crate::elementary::Elementary;
use crate::interval::Interval;
use crate::presolve::Domain;
use crate::reformulate::Tie;

/// A column that equals a smooth function of one or two others.
#[derive(Debug, Clone)]
pub(crate) struct SmoothTerm {
    pub(crate) result: usize,
    pub(crate) shape: Shape,
    /// Which side of the function matters, given what pushes the column.
    pub(crate) tie: Tie,
    /// Whether the other terms imply it, so that it is only there for its enclosure.
    pub(super) is_implied: bool,
}

/// The function of a term, with the columns of its arguments.
#[derive(Debug, Clone)]
pub(crate) enum Shape {
    Elementary {
        function: Elementary,
        of: usize,
    },
    /// The product of two columns.
    Bilinear([usize; 2]),
    /// The first column divided by the second one.
    Quotient([usize; 2]),
}

impl SmoothTerm {
    /// The columns of the arguments.
    pub(crate) fn arguments(&self) -> &[usize] {
        match &self.shape {
            Shape::Elementary { of, .. } => std::slice::from_ref(of),
            Shape::Bilinear(of) | Shape::Quotient(of) => of,
        }
    }

    /// The value of the function at a point.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        match &self.shape {
            Shape::Elementary { function, of } => function.value(x[*of]),
            Shape::Bilinear([a, b]) => x[*a] * x[*b],
            Shape::Quotient([a, b]) => x[*a] / x[*b],
        }
    }

    /// The derivatives by the arguments at a point, and the number of these.
    pub(crate) fn gradient(&self, x: &[f64]) -> ([(usize, f64); 2], usize) {
        match &self.shape {
            Shape::Elementary { function, of } => {
                ([(*of, function.derivative(x[*of])), (*of, 0.0)], 1)
            }
            Shape::Bilinear([a, b]) => ([(*a, x[*b]), (*b, x[*a])], 2),
            Shape::Quotient([a, b]) => ([(*a, 1.0 / x[*b]), (*b, -x[*a] / (x[*b] * x[*b]))], 2),
        }
    }

    /// The values over the bounds of a domain.
    pub(crate) fn range(&self, domain: &Domain) -> Interval {
        match &self.shape {
            Shape::Elementary { function, of } => function.range(bounds(domain, *of)),
            Shape::Bilinear([a, b]) => bounds(domain, *a) * bounds(domain, *b),
            Shape::Quotient([a, b]) => bounds(domain, *a) / bounds(domain, *b),
        }
    }

    /// By how much the column of a point is on a side of the function that matters.
    pub(crate) fn violation(&self, x: &[f64]) -> f64 {
        let off = x[self.result] - self.value(x);
        match self.tie {
            Tie::Exact => off.abs(),
            Tie::Above => (-off).max(0.0),
            Tie::Below => off.max(0.0),
        }
    }

    /// Whether lines below the function matter (the column must not be below it), and lines above.
    pub(crate) fn sides(&self) -> [bool; 2] {
        [self.tie != Tie::Below, self.tie != Tie::Above]
    }
}

/// The bounds of a column.
pub(crate) fn bounds(domain: &Domain, column: usize) -> Interval {
    let [lower, upper] = domain.bounds(column);
    Interval::new(lower, upper)
}
