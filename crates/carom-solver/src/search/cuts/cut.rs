//! A cut, and the margins that make it safe.

use super::parameters::CUTS;
use std::collections::BTreeMap;

use crate::presolve::Domain;
use crate::tolerance::largest_magnitude;

/// A sum of whole multiples of integral columns. No point has it strictly between `value` and
/// `value + 1`.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeForm {
    /// Columns and multiples.
    pub terms: Vec<(usize, f64)>,
    /// The whole number that it is at most, or beyond.
    pub value: f64,
    /// Where it is at most `value`, and where it is at least the next whole number: the sum from
    /// which the cut follows.
    pub sides: [CutSide; 2],
}

/// Multipliers of the form and of rows. Their sum with the negated cut leaves nothing that bounds
/// of columns allow. A positive multiplier takes the lower limit of its row, a negative one the
/// upper limit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutSide {
    /// The multiplier of the form.
    pub form: f64,
    /// Rows and their multipliers.
    pub rows: Vec<(usize, f64)>,
}

/// A row `terms <= limit` that every whole point of a program satisfies.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Columns and coefficients, by column; the largest coefficient is 1 in magnitude.
    pub terms: Vec<(usize, f64)>,
    /// The limit.
    pub limit: f64,
    /// The form that was rounded: where it is at most its value, and where it is at least the next
    /// one, the cut follows from rows and bounds. `None` if it was found in another way.
    pub form: Option<WholeForm>,
    /// The binaries in each of whose cases it follows from rows and bounds; empty if it was found
    /// in another way.
    pub cases: Vec<usize>,
    /// The places of its union and of its direction among those of the search for facets; `None` if
    /// it is no facet that was just found.
    pub facet: Option<[usize; 2]>,
}

impl Cut {
    /// Makes a cut that rounding in the terms cannot make wrong: replaces terms with small
    /// coefficients by their values at bounds, and loosens the limit. Returns `None` if such a
    /// bound is missing or if the point satisfies the cut. `size` is the largest magnitude of the
    /// numbers that were added up to terms and limit.
    pub(super) fn new(
        terms: BTreeMap<usize, f64>,
        limit: f64,
        size: f64,
        domain: &Domain,
        x: &[f64],
    ) -> Option<Cut> {
        Cut::anywhere(terms, limit, size, domain).filter(|cut| cut.cuts_off(x))
    }

    /// A cut as [`new`](Self::new) makes it, whether or not a point violates it.
    pub(super) fn anywhere(
        terms: BTreeMap<usize, f64>,
        mut limit: f64,
        mut size: f64,
        domain: &Domain,
    ) -> Option<Cut> {
        let largest = largest_magnitude(terms.values());
        if !(largest > 0.0 && largest.is_finite() && limit.is_finite()) {
            return None;
        }
        let mut kept = Vec::with_capacity(terms.len());
        size = size.max(limit.abs());
        for (j, a) in terms {
            let [lower, upper] = domain.bounds(j);
            let corner = if a > 0.0 { lower } else { upper };
            if a.abs() * CUTS.dynamism > largest {
                size = size.max(a.abs() * reach(domain, j));
                kept.push((j, a));
            } else if a != 0.0 {
                if corner.is_infinite() {
                    return None;
                }
                limit -= a * corner;
            }
        }
        limit += CUTS.limit_margin * size;
        kept.iter_mut().for_each(|(_, a)| *a /= largest);
        let limit = limit / largest;
        let cut = Cut { terms: kept, limit, form: None, cases: Vec::new(), facet: None };
        limit.is_finite().then_some(cut)
    }

    /// Whether a point violates the cut by a distance that counts.
    pub(super) fn cuts_off(&self, x: &[f64]) -> bool {
        self.depth(x) >= CUTS.least_depth
    }

    fn activity(&self, x: &[f64]) -> f64 {
        self.terms.iter().map(|&(j, a)| a * x[j]).sum()
    }

    /// The distance of a point from violating the cut.
    pub fn room(&self, x: &[f64]) -> f64 {
        self.limit - self.activity(x)
    }

    /// The largest magnitude of terms and limit at a point, at least 1.
    pub(in crate::search) fn scale(&self, x: &[f64]) -> f64 {
        let terms = self.terms.iter().map(|&(j, a)| (a * x[j]).abs());
        terms.fold(self.limit.abs().max(1.0), f64::max)
    }

    fn norm(&self) -> f64 {
        self.terms.iter().map(|(_, a)| a * a).sum::<f64>().sqrt()
    }

    /// Distance by which a point violates the cut.
    pub(super) fn depth(&self, x: &[f64]) -> f64 {
        -self.room(x) / self.norm()
    }

    /// Cosine of the angle between two cuts.
    pub(super) fn cosine(&self, other: &Cut) -> f64 {
        let (mut p, mut q, mut dot) = (0, 0, 0.0);
        while let (Some(a), Some(b)) = (self.terms.get(p), other.terms.get(q)) {
            if a.0 == b.0 {
                dot += a.1 * b.1;
            }
            (p, q) = (p + usize::from(a.0 <= b.0), q + usize::from(b.0 <= a.0));
        }
        dot / (self.norm() * other.norm())
    }
}

/// The larger magnitude of a column's bounds, at least 1; missing ones do not count.
pub(super) fn reach(domain: &Domain, column: usize) -> f64 {
    let known = domain.bounds(column).into_iter().filter(|bound| bound.is_finite());
    known.fold(1.0, |most, bound| most.max(bound.abs()))
}
