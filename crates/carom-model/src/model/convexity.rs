//! The check that a quadratic objective is convex; see `semidefinite` for the proof.

use super::ids::Variable;
use super::sense::Sense;
use super::store::Model;
use crate::error::{Error, ErrorKind};
use crate::semidefinite::{Direction, Product, negative_direction};
use crate::tolerance;

/// Entries of a direction that an error names.
const NAMED_STEPS: usize = 6;

/// The amount that the square of a variable without bounds may lack until bounds are looked for, as
/// a part of its coefficient (no unit).
const UNDECIDED_CURVATURE: f64 = 1e-9;

/// The part of its coefficient that the square of a variable with bounds may lack until a solve
/// compares the loss of a convex form with its gap (no unit).
const SLIGHT_CURVATURE: f64 = 1e-3;

/// The help of an error about a direction without binaries.
pub const WRITE_SQUARES: &str = "only convex costs to minimise (concave ones to maximise) have a \
                                        proof of optimality here; write squares";

/// The convexity of an objective that may be set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Convexity {
    Proved,
    /// It is not convex, and has a convex form over binaries and bounds, which may change, or may
    /// follow from rows: a solve finds it, or returns the error.
    WithinBounds,
}

impl Model {
    /// Checks an objective that is to be set: that it is convex, or within the tolerance of one
    /// that is.
    pub(super) fn convexity(
        &self,
        sense: Sense,
        products: &[(Variable, Variable, f64)],
    ) -> Result<Convexity, Error> {
        let products = indexed(sense, products);
        let Some(direction) = negative_direction(&products, &|_| 0.0) else {
            return Ok(Convexity::Proved);
        };
        let has_two_values = |j: usize| {
            let data = &self.stored.variables[j];
            data.must_be_whole() && data.range.is_none() && data.upper - data.lower <= 1.0
        };
        // Products with binaries have linear forms.
        let others = |(a, b, _): &Product| !has_two_values(*a) && !has_two_values(*b);
        let others: Vec<Product> = products.iter().copied().filter(others).collect();
        let count = variables(&products);
        let squares = squares(&products);
        let allowed = |j: usize| {
            let data = &self.stored.variables[j];
            if let Some((lower, upper)) = data.range {
                return slack(upper - lower, count);
            }
            let width = data.upper - data.lower;
            match width.is_finite() {
                true => slack(width, count).max(SLIGHT_CURVATURE * squares(j)),
                false => UNDECIDED_CURVATURE * squares(j),
            }
        };
        match negative_direction(&others, &allowed) {
            None => Ok(Convexity::WithinBounds),
            Some(worse) if worse.curvature < 0.0 || others.len() < products.len() => {
                Err(self.not_convex(sense, worse, WRITE_SQUARES))
            }
            Some(_) => Err(self.not_convex(sense, direction, WRITE_SQUARES)),
        }
    }

    /// The products of the objective, as of one that is minimised, by the numbers of their
    /// variables.
    #[doc(hidden)]
    pub fn minimized_products(&self) -> Vec<Product> {
        indexed(self.sense(), &self.objective().products())
    }

    /// A direction along which the objective is not convex, with what is known of bounds before a
    /// solve.
    ///
    /// # Arguments
    ///
    /// * `width`: by variable, the distance of its bounds.
    #[doc(hidden)]
    pub fn concave_direction(&self, width: impl Fn(usize) -> f64) -> Option<Direction> {
        let products = self.minimized_products();
        let count = variables(&products);
        negative_direction(&products, &|j| slack(width(j), count))
    }

    /// The error that the objective is not convex along a direction.
    #[doc(hidden)]
    pub fn not_convex(&self, sense: Sense, direction: Direction, help: &'static str) -> Error {
        let curvature = direction.curvature;
        let (name, direction) = self.direction_text(direction);
        ErrorKind::NotConvex { sense: sense.word(), curvature, name, direction, help }.into()
    }

    /// The variable with the largest step of a direction, and its steps in words, the largest ones
    /// first.
    pub(super) fn direction_text(&self, direction: Direction) -> (String, String) {
        let name = |j: usize| self.stored.variables[j].name.to_string();
        let mut steps = direction.steps;
        steps.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
        let largest = steps.first().map_or(String::new(), |&(j, _)| name(j));
        let named = steps.iter().take(NAMED_STEPS);
        let mut text: Vec<String> =
            named.map(|&(j, step)| format!("`{}` {step}", name(j))).collect();
        if steps.len() > NAMED_STEPS {
            text.push(format!("{} more", steps.len() - NAMED_STEPS));
        }
        (largest, text.join(", "))
    }
}

/// The amount that the square of a variable may lack so that, with as much for each of the others,
/// the objective is nowhere below its tangents by more than the tolerance.
fn slack(width: f64, count: usize) -> f64 {
    if width > 0.0 { tolerance::CONVEXITY / (count as f64 * width * width) } else { f64::MAX }
}

/// Products by the numbers of their variables, the smaller one first, merged.
fn indexed(sense: Sense, products: &[(Variable, Variable, f64)]) -> Vec<Product> {
    let product = |&(a, b, q): &(Variable, Variable, f64)| {
        (a.index().min(b.index()), a.index().max(b.index()), sense.sign() * q)
    };
    let mut products: Vec<Product> = products.iter().map(product).collect();
    if !products.is_sorted_by(|a, b| (a.0, a.1) < (b.0, b.1)) {
        products.sort_by_key(|&(a, b, _)| (a, b));
        products.dedup_by(|later, kept| {
            let same = (later.0, later.1) == (kept.0, kept.1);
            kept.2 += if same { later.2 } else { 0.0 };
            same
        });
    }
    products
}

/// The number of variables with a square or product.
fn variables(products: &[Product]) -> usize {
    let size = products.iter().map(|&(_, b, _)| b + 1).max().unwrap_or(0);
    let mut is_used = vec![false; size];
    products.iter().for_each(|&(a, b, _)| (is_used[a], is_used[b]) = (true, true));
    is_used.into_iter().filter(|used| *used).count()
}

/// By variable, the coefficient of its square if that is positive.
fn squares(products: &[Product]) -> impl Fn(usize) -> f64 {
    let squares = products.iter().filter(|(a, b, q)| a == b && *q > 0.0);
    let squares: Vec<(usize, f64)> = squares.map(|&(a, _, q)| (a, q)).collect();
    move |j| squares.binary_search_by_key(&j, |entry| entry.0).map_or(0.0, |at| squares[at].1)
}
