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

/// The convexity of an objective that may be set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Convexity {
    Proved,
    /// It is not convex, and the difference is within the tolerance over bounds, which may change, or may
    /// follow from rows.
    WithinBounds,
}

impl Model {
    /// Checks an objective that is to be set: that it is convex, or within the tolerance of one that is.
    pub(super) fn convexity(
        &self,
        sense: Sense,
        products: &[(Variable, Variable, f64)],
    ) -> Result<Convexity, Error> {
        let products = indexed(sense, products);
        let Some(direction) = negative_direction(&products, &|_| 0.0) else {
            return Ok(Convexity::Proved);
        };
        let count = variables(&products);
        let squares = squares(&products);
        let allowed = |j: usize| {
            let data = &self.stored.variables[j];
            let ends = match data.range {
                Some(range) => range,
                None => (data.lower, data.upper),
            };
            let width = ends.1 - ends.0;
            if width.is_finite() { slack(width, count) } else { UNDECIDED_CURVATURE * squares(j) }
        };
        match negative_direction(&products, &allowed) {
            None => Ok(Convexity::WithinBounds),
            Some(worse) => {
                Err(self.not_convex(sense, if worse.curvature < 0.0 { worse } else { direction }))
            }
        }
    }

    /// Checks the objective with what is known of bounds before a solve; needed only where the objective is
    /// convex only as far as they tell.
    ///
    /// # Arguments
    ///
    /// * `width`: by variable, the distance of its bounds.
    pub(crate) fn check_convexity(&self, width: impl Fn(usize) -> f64) -> Result<(), Error> {
        let sense = self.sense();
        let products = indexed(sense, &self.objective().products());
        let count = variables(&products);
        match negative_direction(&products, &|j| slack(width(j), count)) {
            None => Ok(()),
            Some(direction) => Err(self.not_convex(sense, direction)),
        }
    }

    fn not_convex(&self, sense: Sense, direction: Direction) -> Error {
        let curvature = direction.curvature;
        let (name, direction) = self.direction_text(direction);
        ErrorKind::NotConvex {
            sense: sense.word(),
            curvature,
            name,
            direction,
            help: "only convex costs to minimise (concave ones to maximise) have a proof of \
                   optimality here; write squares, or linearise products with a binary",
        }
        .into()
    }

    /// The variable with the largest step of a direction, and its steps in words, the largest ones first.
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
