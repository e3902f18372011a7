//! Statements evaluated at a point, with compensated sums.

use crate::interval::Interval;
use crate::model::{Affine, Function, Model, Quadratic, StoredConic, Variable};
use crate::mutations::{self, Mutation};
use crate::sum::Sum;
use crate::tolerance;

/// By how much a statement is missed, the largest number in it, and how much may be missed.
pub(super) struct Miss {
    pub(super) amount: f64,
    pub(super) size: f64,
    pub(super) allowed: f64,
}

impl Miss {
    /// A miss of something without terms.
    pub(super) fn beyond(amount: f64, allowed: f64) -> Self {
        Miss { amount, size: 0.0, allowed }
    }
}

/// The value of an expression.
struct Value {
    sum: Sum,
    /// The sum of the magnitudes of its terms.
    magnitude: f64,
    largest: f64,
    /// Whether it is a whole number whenever its variables are, so that nothing was rounded.
    whole: bool,
}

/// Statements evaluated at a point, with compensated sums.
pub(super) struct Evaluation<'a> {
    model: &'a Model,
    values: &'a [f64],
    integral: Vec<bool>,
    feasibility: f64,
}

impl<'a> Evaluation<'a> {
    pub(super) fn new(model: &'a Model, values: &'a [f64], feasibility: f64) -> Self {
        let integral = model.variables().map(|variable| variable.kind().is_integral()).collect();
        Evaluation { model, values, integral, feasibility }
    }

    /// The tolerance of a row: relative to its terms where these are tiny wherever its variables
    /// are within their bounds. What the terms are at a point says nothing: at rest they are 0.
    fn tolerance(&self, terms: &[(Variable, f64)], limit: f64) -> f64 {
        let size = |&(variable, a): &(Variable, f64)| {
            let bounds = self.model.variable_ref(variable).map(|variable| variable.bounds());
            a.abs() * bounds.map_or(f64::INFINITY, |bounds| bounds.magnitude())
        };
        let size = terms.iter().map(size).sum::<f64>() + limit;
        let is_small = size > 0.0 && size < tolerance::SMALL_UNIT;
        if is_small { self.feasibility * size } else { self.feasibility }
    }

    pub(super) fn is_on(&self, variable: Variable) -> bool {
        self.value(variable).round() == 1.0
    }

    pub(super) fn value(&self, variable: Variable) -> f64 {
        self.values[variable.index()]
    }

    fn terms(&self, terms: impl Iterator<Item = (Variable, f64)>, constant: f64) -> Value {
        let (magnitude, whole) = (constant.abs(), constant == constant.round());
        let mut value = Value { sum: Sum::new(constant), magnitude, largest: magnitude, whole };
        for (variable, a) in terms {
            let x = self.value(variable);
            value.sum.add_product(a, x);
            value.magnitude += (a * x).abs();
            value.largest = value.largest.max((a * x).abs());
            value.whole &= self.integral[variable.index()] && a == a.round();
        }
        value
    }

    /// By how much a row misses its limits, and by how much it may.
    ///
    /// A whole number misses a limit by at most the tolerance exactly if it does not miss the limit
    /// rounded, within the tolerance, to a whole number; so rows of whole numbers are compared
    /// exactly.
    pub(super) fn row(&self, terms: &[(Variable, f64)], limits: Interval) -> Miss {
        let value = self.terms(terms.iter().copied(), 0.0);
        if !value.magnitude.is_finite() {
            return Miss::beyond(value.magnitude, 0.0);
        }
        let beyond = |limit: f64| {
            let mut miss = value.sum;
            miss.add(-limit);
            miss.value()
        };
        let (below, above) = (-beyond(limits.lower), beyond(limits.upper));
        let limit = if below > above { limits.lower } else { limits.upper };
        let limit = tolerance::finite_size(limit);
        let rounded = if value.whole { 0.0 } else { value.magnitude + limit };
        let amount = below.max(above).max(0.0);
        let size = value.largest.max(limit);
        let mut allowed = if mutations::has(Mutation::ScaledTolerance) {
            self.feasibility * tolerance::margin_scale(value.largest, limit)
        } else {
            tolerance::allowed_miss(self.feasibility, rounded)
        };
        // Only what is missed visibly, by terms that are tiny at the point, is measured by bounds.
        let is_visible = amount > tolerance::ROUNDING * rounded && amount <= allowed;
        if is_visible && size < tolerance::SMALL_UNIT && !self.model.has_systems() {
            let limits = [limits.lower, limits.upper].into_iter().filter(|limit| limit.is_finite());
            let largest = tolerance::largest_magnitude(limits);
            allowed = tolerance::allowed_miss(self.tolerance(terms, largest), rounded);
        }
        Miss { amount, size, allowed }
    }

    /// By how much a norm exceeds its bound, or a quadratic expression exceeds 0.
    pub(super) fn conic(&self, conic: &StoredConic) -> Miss {
        match conic {
            StoredConic::Norm { entries, bound } => self.norm(entries, bound),
            StoredConic::Quadratic { expression } => self.quadratic(expression),
        }
    }

    fn norm(&self, entries: &[Affine], bound: &Affine) -> Miss {
        let of = |e: &Affine| self.terms(e.terms().into_iter(), e.offset());
        let (entries, bound): (Vec<Value>, Value) = (entries.iter().map(of).collect(), of(bound));
        let length = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0_f64, |length, value| length.hypot(value))
        };
        let magnitude = length(&mut entries.iter().map(|e| e.magnitude)) + bound.magnitude;
        if !magnitude.is_finite() {
            return Miss::beyond(magnitude, 0.0);
        }
        let limit = bound.sum.value();
        let rough = length(&mut entries.iter().map(|e| e.sum.value()));
        // `(S - b^2) / (sqrt(S) + b)` in a unit in which nothing overflows.
        let unit = rough.max(limit.abs());
        let amount = if unit > 0.0 && limit > 0.0 {
            let mut difference = Sum::default();
            for entry in &entries {
                let value = entry.sum.value() / unit;
                difference.add_product(value, value);
            }
            difference.add_product(-limit / unit, limit / unit);
            unit * (difference.value() / ((rough + limit) / unit))
        } else {
            rough - limit
        };
        let largest = entries.iter().map(|e| e.largest).fold(bound.largest, f64::max);
        Miss {
            amount: amount.max(0.0),
            size: largest,
            allowed: tolerance::allowed_miss(self.feasibility, magnitude),
        }
    }

    fn quadratic(&self, expression: &Quadratic) -> Miss {
        let affine = expression.affine();
        let mut value = self.terms(affine.terms().into_iter(), affine.offset());
        for (a, b, q) in expression.products() {
            let (x, y) = (self.value(a), self.value(b));
            value.sum.add_product_of_three(x, y, q);
            // Both factors were rounded.
            value.magnitude += 2.0 * (q * x * y).abs();
            value.largest = value.largest.max((q * x * y).abs());
        }
        if !value.magnitude.is_finite() {
            return Miss::beyond(value.magnitude, 0.0);
        }
        Miss {
            amount: value.sum.value().max(0.0),
            size: value.largest,
            allowed: tolerance::allowed_miss(self.feasibility, value.magnitude),
        }
    }

    /// How far a variable is from 0 or from other values, whichever is nearer.
    pub(super) fn either(&self, variable: Variable, values: Interval) -> Miss {
        let zero = self.row(&[(variable, 1.0)], Interval::point(0.0));
        let other = self.row(&[(variable, 1.0)], values);
        if other.amount < zero.amount { other } else { zero }
    }

    /// How far a member is from 0 that should be 0: the largest one outside `most` neighbours that
    /// include the largest of all.
    pub(super) fn ordered_set(&self, members: &[(Variable, f64)], most: usize) -> Miss {
        let at =
            |&(variable, _): &(Variable, f64)| self.row(&[(variable, 1.0)], Interval::point(0.0));
        let misses: Vec<Miss> = members.iter().map(at).collect();
        let size = |k: &usize| misses[*k].amount;
        let by_size = |a: &usize, b: &usize| size(a).total_cmp(&size(b));
        let top = (0..misses.len()).max_by(by_size).unwrap_or(0);
        let outside = |from: usize| {
            let outside = (0..misses.len()).filter(|k| !(from..from + most).contains(k));
            outside.max_by(by_size)
        };
        let places = (top + 1).saturating_sub(most)..=top;
        let best = places.map(outside).min_by(|a, b| match (a, b) {
            (Some(a), Some(b)) => by_size(a, b),
            (a, b) => a.cmp(b),
        });
        match best.flatten() {
            Some(k) => Miss { ..misses[k] },
            None => Miss::beyond(0.0, 0.0),
        }
    }

    /// How far a variable is from the function it should be, and how far it may be: argument and
    /// value may both be off the graph by the tolerance, unless they are whole numbers.
    pub(super) fn function(&self, function: &Function, result: Variable) -> Miss {
        let at = |variable| self.value(variable);
        let (own, factor) = (at(result), function.factor().map_or(1.0, at));
        let of = |e: &Affine| self.terms(e.terms().into_iter(), e.offset());
        let arguments: Vec<Value> = function.expressions().iter().map(of).collect();
        let magnitude = arguments.iter().map(|e| e.magnitude).fold(0.0, f64::max);
        let magnitude = own.abs() + magnitude * factor.abs();
        if !magnitude.is_finite() {
            return Miss::beyond(magnitude, 0.0);
        }
        let size = arguments.iter().map(|e| e.largest).fold(own.abs(), f64::max);
        let allowed = tolerance::allowed_miss(self.feasibility, magnitude);
        let amount = match function {
            Function::Piecewise { of, graph } => {
                let x = of.evaluate(at);
                let near = graph.values_within(x - allowed, x + allowed);
                excess(own, near) + excess(x, graph.domain())
            }
            _ => (own - function.evaluate(at)).abs(),
        };
        let allowed = match function {
            Function::Product { .. } if arguments.iter().any(|e| !e.whole) => {
                allowed + self.feasibility * (factor.abs() - 1.0).max(0.0)
            }
            _ => allowed,
        };
        Miss { amount, size, allowed }
    }
}

fn excess(value: f64, limits: Interval) -> f64 {
    (limits.lower - value).max(value - limits.upper).max(0.0)
}
