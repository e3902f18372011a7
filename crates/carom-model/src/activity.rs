//! Activities: what sums of terms are at least and at most over a box.
//!
//! Bounds, big-Ms and proofs rest on the activity of a row within the bounds of its columns, and on
//! the bounds that the limits of the row then leave to one of them. A [`range`] is rounded outward,
//! so it holds as it is. The other sums are plain ones, and whoever uses them allows for their
//! rounding.
//!
//! Ends are pairs of the least and the largest value, as bounds and limits are.

use crate::interval::Interval;

/// The range of `constant + a x + ...`, rounded outward; a term is its `a` and the range of its
/// `x`.
#[inline]
pub fn range(constant: f64, terms: impl IntoIterator<Item = (f64, Interval)>) -> Interval {
    terms.into_iter().fold(Interval::point(constant), |sum, (a, range)| sum + range * a)
}

/// As [`range`], or the first error of a term.
#[inline]
pub fn try_range<E>(
    constant: f64,
    terms: impl IntoIterator<Item = Result<(f64, Interval), E>>,
) -> Result<Interval, E> {
    terms.into_iter().try_fold(Interval::point(constant), |sum, term| {
        let (a, range) = term?;
        Ok(sum + range * a)
    })
}

/// The ends of `start + a x + ...`; a term is its `a` and the bounds of its `x`.
#[inline]
pub fn ends(start: [f64; 2], terms: impl IntoIterator<Item = (f64, [f64; 2])>) -> [f64; 2] {
    terms.into_iter().fold(start, |[least, most], (a, bounds)| {
        let [low, high] = term_ends(a, bounds);
        [least + low, most + high]
    })
}

/// The ends of `a x` within the bounds of `x`.
#[inline]
pub fn term_ends(a: f64, [lower, upper]: [f64; 2]) -> [f64; 2] {
    sorted(a * lower, a * upper)
}

/// The ends of the `x` with `lower <= a x <= upper`, where `a` is not 0.
///
/// Of a row, the limits of one term are those of the row less the activity of the other terms:
/// `[lower - most, upper - least]`.
#[inline]
pub fn implied_ends(a: f64, [lower, upper]: [f64; 2]) -> [f64; 2] {
    sorted(lower / a, upper / a)
}

#[inline]
fn sorted(p: f64, q: f64) -> [f64; 2] {
    [p.min(q), p.max(q)]
}

/// One end of an activity, so that it is known without any one of its terms.
#[derive(Debug, Clone, Copy, Default)]
pub struct RowActivity {
    /// The sum of the finite terms.
    pub finite: f64,
    /// The number of infinite terms.
    pub infinite: usize,
}

impl RowActivity {
    /// Adds the end of a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        if term.is_finite() {
            self.finite += term;
        } else {
            self.infinite += 1;
        }
    }

    /// Whether the activity without one of its terms is finite.
    #[inline]
    pub fn is_finite_without(&self, term: f64) -> bool {
        self.infinite == usize::from(!term.is_finite())
    }

    /// The activity without one of its terms; `None` if that is infinite.
    #[inline]
    pub fn without(&self, term: f64) -> Option<f64> {
        let rest = if term.is_finite() { self.finite - term } else { self.finite };
        self.is_finite_without(term).then_some(rest)
    }

    /// The room between the activity without one of its terms and a limit; `None` if that activity
    /// is infinite.
    #[inline]
    pub fn room(&self, term: f64, limit: f64) -> Option<f64> {
        let left = limit - self.finite;
        let room = if term.is_finite() { left + term } else { left };
        self.is_finite_without(term).then_some(room)
    }
}
