//! Power series with intervals as coefficients: values and derivatives of functions over ranges, in
//! one go (R. E. Moore, "Methods and Applications of Interval Analysis", 1979, chapter 3).
//!
//! The recurrences follow from the derivative of each function, as `y' = y a'` of `y = exp(a)`.

use std::ops::{Add, Mul};

use super::function::{Elementary, is_whole};
use crate::interval::Interval;

/// A power series up to a degree, with outward rounding: the coefficient k holds the k-th
/// derivative divided by `k!` of every function that the series stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalSeries(Vec<Interval>);

const NO_TERM: Interval = Interval { lower: 0.0, upper: 0.0 };

impl IntervalSeries {
    /// The series with these coefficients, from degree 0 on; at least one.
    pub fn new(coefficients: Vec<Interval>) -> Self {
        IntervalSeries(coefficients)
    }

    /// A constant, with the number of coefficients.
    pub fn constant(value: Interval, count: usize) -> Self {
        let mut coefficients = vec![NO_TERM; count.max(1)];
        coefficients[0] = value;
        IntervalSeries(coefficients)
    }

    /// The coefficients, from degree 0 on.
    pub fn coefficients(&self) -> &[Interval] {
        &self.0
    }

    /// The number of coefficients.
    fn count(&self) -> usize {
        self.0.len()
    }

    /// A multiple.
    pub fn scaled(&self, factor: f64) -> Self {
        IntervalSeries(self.0.iter().map(|own| *own * factor).collect())
    }

    /// `sum over j from 1 to k of j a_j b_(k-j) / k`: what `y' = b a'` makes of the coefficient k.
    fn integral(&self, b: &[Interval], k: usize) -> Interval {
        let terms = (1..=k).map(|j| self.0[j] * (j as f64) * b[k - j]);
        terms.fold(NO_TERM, |sum, own| sum + own) / Interval::point(k as f64)
    }

    /// The quotient; `None` if the divisor may be 0.
    pub fn quotient(&self, divisor: &IntervalSeries) -> Option<Self> {
        let first = divisor.0[0];
        if first.contains(0.0) {
            return None;
        }
        let mut own: Vec<Interval> = Vec::with_capacity(self.count());
        for k in 0..self.count() {
            let known = (1..=k).map(|j| divisor.0[j] * own[k - j]);
            let known = known.fold(NO_TERM, |sum, part| sum + part);
            own.push((self.0[k] + -known) / first);
        }
        Some(IntervalSeries(own))
    }

    /// A function of the series; `None` if it is not smooth enough there, or has no value.
    pub fn of(&self, function: &Elementary) -> Option<Self> {
        let value = function.range(self.0[0]);
        let is_inside = function.domain().lower <= self.0[0].lower
            && self.0[0].upper <= function.domain().upper;
        if value.is_empty() || !value.is_bounded() || !is_inside {
            return None;
        }
        let count = self.count();
        if count == 1 {
            return Some(IntervalSeries(vec![value]));
        }
        let one = IntervalSeries::constant(Interval::point(1.0), count);
        let negative_square = || self.clone() * self.scaled(-1.0);
        match function {
            Elementary::Sin => Some(self.waves(-1.0, [Elementary::Sin, Elementary::Cos])?.0),
            Elementary::Cos => Some(self.waves(-1.0, [Elementary::Sin, Elementary::Cos])?.1),
            Elementary::Sinh => Some(self.waves(1.0, [Elementary::Sinh, Elementary::Cosh])?.0),
            Elementary::Cosh => Some(self.waves(1.0, [Elementary::Sinh, Elementary::Cosh])?.1),
            Elementary::Tan => self.of(&Elementary::Sin)?.quotient(&self.of(&Elementary::Cos)?),
            Elementary::Tanh => self.of(&Elementary::Sinh)?.quotient(&self.of(&Elementary::Cosh)?),
            Elementary::Exp => {
                let mut own = vec![value];
                for k in 1..count {
                    own.push(self.integral(&own, k));
                }
                Some(IntervalSeries(own))
            }
            Elementary::Ln => self.by_slope(value, &one.quotient(self)?),
            Elementary::Atan => {
                let slope = one.quotient(&(one.clone() + self.clone() * self.clone()))?;
                self.by_slope(value, &slope)
            }
            Elementary::Asin | Elementary::Acos => {
                let root = (one.clone() + negative_square()).of(&Elementary::Power(0.5))?;
                let sign = if *function == Elementary::Asin { 1.0 } else { -1.0 };
                self.by_slope(value, &one.quotient(&root)?.scaled(sign))
            }
            Elementary::Power(p) => self.power(*p, value),
            Elementary::Own(own) => {
                if count > 3 {
                    return None;
                }
                let (own, range) = (own.function(), self.0[0]);
                let slope = own.slope_range(range);
                let mut all = vec![value, slope * self.0[1]];
                if count == 3 {
                    let bend = own.curvature_range(range) * (self.0[1] * self.0[1]) * 0.5;
                    all.push(slope * self.0[2] + bend);
                }
                all.iter().all(Interval::is_bounded).then_some(IntervalSeries(all))
            }
        }
    }

    /// The series with a first coefficient and the derivative `slope a'`.
    fn by_slope(&self, first: Interval, slope: &IntervalSeries) -> Option<Self> {
        let mut own = vec![first];
        for k in 1..self.count() {
            own.push(self.integral(&slope.0, k));
        }
        Some(IntervalSeries(own))
    }

    /// Sine and cosine, or those of the hyperbola, whose second derivatives are `sign` themselves.
    fn waves(&self, sign: f64, pair: [Elementary; 2]) -> Option<(Self, Self)> {
        let [sin, cos] = pair.map(|own| own.range(self.0[0]));
        let (mut sin, mut cos) = (vec![sin], vec![cos]);
        for k in 1..self.count() {
            let (to_sin, to_cos) = (self.integral(&cos, k), self.integral(&sin, k) * sign);
            sin.push(to_sin);
            cos.push(to_cos);
        }
        Some((IntervalSeries(sin), IntervalSeries(cos)))
    }

    /// A power with this range of values.
    fn power(&self, p: f64, value: Interval) -> Option<Self> {
        if is_whole(p) && (0.0..=8.0).contains(&p) {
            let mut own = IntervalSeries::constant(Interval::point(1.0), self.count());
            for _ in 0..p as usize {
                own = own * self.clone();
            }
            own.0[0] = value;
            return Some(own);
        }
        let first = self.0[0];
        if first.contains(0.0) {
            return None;
        }
        let mut own = vec![value];
        for k in 1..self.count() {
            let terms = (1..=k).map(|j| {
                let factor = Interval::point(p) * (j as f64) + Interval::point(j as f64 - k as f64);
                factor * self.0[j] * own[k - j]
            });
            let sum = terms.fold(NO_TERM, |sum, part| sum + part);
            own.push(sum / (first * (k as f64)));
        }
        Some(IntervalSeries(own))
    }
}

impl Add for IntervalSeries {
    type Output = IntervalSeries;

    fn add(self, other: IntervalSeries) -> IntervalSeries {
        IntervalSeries(self.0.iter().zip(&other.0).map(|(a, b)| *a + *b).collect())
    }
}

impl Mul for IntervalSeries {
    type Output = IntervalSeries;

    fn mul(self, other: IntervalSeries) -> IntervalSeries {
        let entry = |k: usize| {
            let terms = (0..=k).map(|j| self.0[j] * other.0[k - j]);
            terms.fold(NO_TERM, |sum, part| sum + part)
        };
        IntervalSeries((0..self.count().min(other.count())).map(entry).collect())
    }
}
