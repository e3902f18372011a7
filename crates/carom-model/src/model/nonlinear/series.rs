//! Nonlinear expressions of power series with intervals.

use super::{FunctionPart, Nonlinear};
use crate::elementary::IntervalSeries;
use crate::interval::Interval;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::piecewise::PiecewiseAffine;

impl Nonlinear {
    /// The expression of series; `None` where it has no value, or is not smooth enough.
    ///
    /// # Arguments
    ///
    /// * `of`: the series of each variable, all with `count` coefficients.
    #[doc(hidden)]
    pub fn series(
        &self,
        of: &dyn Fn(Variable) -> IntervalSeries,
        count: usize,
    ) -> Option<IntervalSeries> {
        let mut sum = affine(self.rest.affine(), of, count);
        for (first, second, factor) in self.rest.products() {
            let product = match first == second {
                true => of(first).of(&crate::elementary::Elementary::Power(2.0))?,
                false => of(first) * of(second),
            };
            sum = sum + product.scaled(factor);
        }
        for (factor, part) in &self.parts {
            sum = sum + part.series(of, count)?.scaled(*factor);
        }
        Some(sum)
    }
}

fn affine(own: &Affine, of: &dyn Fn(Variable) -> IntervalSeries, count: usize) -> IntervalSeries {
    let constant = IntervalSeries::constant(Interval::point(own.offset()), count);
    own.terms().into_iter().fold(constant, |sum, (v, factor)| sum + of(v).scaled(factor))
}

impl FunctionPart {
    fn series(
        &self,
        of: &dyn Fn(Variable) -> IntervalSeries,
        count: usize,
    ) -> Option<IntervalSeries> {
        match self {
            FunctionPart::Elementary(function, inner) => inner.series(of, count)?.of(function),
            FunctionPart::Product(a, b) => Some(a.series(of, count)? * b.series(of, count)?),
            FunctionPart::Quotient(a, b) => a.series(of, count)?.quotient(&b.series(of, count)?),
            FunctionPart::Absolute(inner) => absolute(&inner.series(of, count)?),
            FunctionPart::Maximum(a, b) => {
                // max(a, b) = (a + b + |a - b|) / 2
                let (a, b) = (a.series(of, count)?, b.series(of, count)?);
                let apart = absolute(&(a.clone() + b.scaled(-1.0)))?;
                Some((a + b + apart).scaled(0.5))
            }
            FunctionPart::Piecewise(graph, inner) => piecewise(graph, &inner.series(of, count)?),
            FunctionPart::Dropped => None,
        }
    }
}

/// The magnitude: beside its kink one of both sides, and over it a range of slopes.
fn absolute(own: &IntervalSeries) -> Option<IntervalSeries> {
    let all = own.coefficients();
    if all[0].lower >= 0.0 {
        return Some(own.clone());
    }
    if all[0].upper <= 0.0 {
        return Some(own.scaled(-1.0));
    }
    let value = Interval::new(0.0, all[0].magnitude());
    match all {
        [_] => Some(IntervalSeries::new(vec![value])),
        [_, slope] => Some(IntervalSeries::new(vec![value, Interval::new(-1.0, 1.0) * *slope])),
        _ => None,
    }
}

/// A table: within a piece it is affine, and over several a range of slopes.
fn piecewise(graph: &PiecewiseAffine, own: &IntervalSeries) -> Option<IntervalSeries> {
    let all = own.coefficients();
    let domain = graph.domain();
    if all[0].lower < domain.lower || all[0].upper > domain.upper {
        return None;
    }
    let values = graph.values_within(all[0].lower, all[0].upper);
    // Values are interpolated with a few roundings.
    let margin = 16.0 * f64::EPSILON * values.magnitude();
    let values = Interval::new(values.lower - margin, values.upper + margin);
    let slopes = graph.points().windows(2).filter_map(|pair| {
        let [(left, low), (right, high)] = [pair[0], pair[1]];
        let touches = left <= all[0].upper && all[0].lower <= right;
        let [rise, run] =
            [[high, low], [right, left]].map(|[a, b]| Interval::point(a) + Interval::point(-b));
        touches.then(|| rise / run)
    });
    let slopes: Vec<Interval> = slopes.collect();
    let slope = slopes.iter().copied().reduce(|a, b| a.hull(b))?;
    if all.len() > 2 && slopes.len() > 1 {
        return None;
    }
    let mut series = vec![values];
    series.extend(all[1..].iter().map(|own| slope * *own));
    Some(IntervalSeries::new(series))
}
