//! Points from a sequence of quadratic programs (R. Fletcher, *Practical Methods of Optimization*,
//! 1987, chapters 12 and 14): terms are replaced by their tangents within a trust region, what a
//! tangent misses costs a penalty, and the objective has the convex part of the curvature of the
//! Lagrangian. Where the functions leave their tangents by too much, a second step corrects that.

use super::enclosure::merge_entries;
use super::program::SpatialProgram;
use super::relaxation::BoxRelaxer;
use super::term::Shape;
use crate::presolve::{Compressed, Domain, Reduced};
use crate::relaxation::{MethodCascade, RelaxationResult, WarmState};

/// Most quadratic programs from one start, without those that correct a step.
const MAX_TANGENT_STEPS: usize = 60;

/// The radius at which a search ends, relative to the ranges of the columns (no unit).
const LEAST_RADIUS: f64 = 1e-9;

/// By how much rows are loosened, relative to their limits (no unit).
const LOOSE_ROWS: f64 = 1e-8;

/// By how much they are loosened at most: less than the tolerance of any check.
const MOST_LOOSE: f64 = 1e-7;

/// Tangents are kept if they are missed by less, in all (no unit).
const MOST_MISSED: f64 = 1e-8;

/// Steps of linear programs that are refused before programs have curvature: until then, a vertex
/// may be where the search ends.
const LINEAR_REJECTIONS: u32 = 2;

/// A gain of the objective that ends a search, relative to it (no unit).
const SMALL_GAIN: f64 = 1e-9;

/// The least penalty, relative to the largest cost (no unit).
const LEAST_PENALTY: f64 = 1e-3;

/// The state of a search between its steps.
struct Walk {
    /// The cost of what tangents miss.
    penalty: f64,
    /// The multipliers of the terms.
    weights: Vec<f64>,
    warm: Option<WarmState>,
    /// Whether its programs have curvature.
    is_curved: bool,
}

/// Where tangents touch, and how far from there a step may go.
#[derive(Clone, Copy)]
struct Tangents<'x> {
    at: &'x [f64],
    /// Relative to the ranges of the columns; infinite for the first point.
    radius: f64,
    /// Where the tangents, with the slopes of `at`, have the values of the functions instead.
    values_at: Option<&'x [f64]>,
}

impl<'x> Tangents<'x> {
    fn loose(at: &'x [f64]) -> Self {
        Tangents { at, radius: f64::INFINITY, values_at: None }
    }

    fn within(at: &'x [f64], radius: f64) -> Self {
        Tangents { at, radius, values_at: None }
    }
}

/// The end of a step.
struct TangentStep {
    x: Vec<f64>,
    /// By how much tangents are missed.
    missed: f64,
    predicted: f64,
}

/// A search for a point near another one.
pub(super) struct TangentSearch<'a> {
    pub(super) relaxer: &'a BoxRelaxer<'a>,
    /// Ranges of integers have one value here.
    pub(super) domain: &'a Domain,
    /// Points with this objective are of no use.
    pub(super) cutoff: f64,
}

impl TangentSearch<'_> {
    /// Goes from a point to better ones, and shows each to `accept`, settled on the functions.
    pub(super) fn run(
        &self,
        cascade: &mut MethodCascade,
        start: &[f64],
        accept: &mut dyn FnMut(&[f64]),
    ) {
        let program = self.relaxer.program;
        let mut x = start.to_vec();
        for (j, v) in x.iter_mut().enumerate() {
            let [lower, upper] = self.domain.bounds(j);
            *v = if v.is_finite() { v.max(lower).min(upper) } else { lower.max(-1.0).min(upper) };
        }
        let cost = program.program.linear.iter().fold(1.0_f64, |most, q| most.max(q.abs()));
        let mut walk = Walk {
            penalty: 10.0 * cost,
            weights: program
                .stated_terms()
                .iter()
                .map(|t| program.program.linear[t.result])
                .collect(),
            warm: None,
            is_curved: false,
        };
        // The first point keeps the rows, so that merits can be compared from here on.
        let Some(first) = self.step(cascade, &mut walk, &Tangents::loose(&x)) else { return };
        x = first.x;
        self.show(&x, accept);
        let (mut radius, mut rejected, mut is_raised) = (0.25, 0, false);
        for _ in 0..MAX_TANGENT_STEPS {
            if self.relaxer.token.is_over() || radius < LEAST_RADIUS {
                return;
            }
            walk.is_curved = rejected >= LINEAR_REJECTIONS;
            let about = Tangents::within(&x, radius);
            let Some(step) = self.step(cascade, &mut walk, &about) else {
                radius *= 0.25;
                continue;
            };
            let is_missed = step.missed > MOST_MISSED;
            if walk.is_curved && !is_missed && !is_raised {
                // A penalty above the multipliers is exact; a much larger one makes steps along
                // curved rows short.
                let rowed = program.stated_terms().iter().zip(&walk.weights);
                let rowed = rowed.filter(|(term, _)| !program.is_cost(term));
                let most = rowed.fold(0.0_f64, |most, (_, weight)| most.max(weight.abs()));
                walk.penalty = walk.penalty.min((3.0 * most).max(LEAST_PENALTY * cost));
            } else if is_missed && walk.penalty < 10.0 * cost {
                // It was too small.
                (walk.penalty, is_raised) = (10.0 * cost, true);
                continue;
            }
            if walk.is_curved && step.predicted >= self.cutoff {
                return;
            }
            let merit = self.merit(&x, walk.penalty);
            let promise = merit - step.predicted;
            let small = SMALL_GAIN.max(0.01 * self.relaxer.options.relative_gap);
            if promise <= small * merit.abs().max(1.0) {
                if !is_missed || walk.penalty >= 1e7 * cost {
                    // It keeps the functions better than the point before.
                    self.show(&step.x, accept);
                    return;
                }
                (walk.penalty, is_raised) = (10.0 * walk.penalty, true);
                radius = radius.max(0.1);
                continue;
            }
            let mut next = step.x;
            let mut gain = merit - self.merit(&next, walk.penalty);
            if walk.is_curved && gain <= 0.75 * promise {
                // The functions at the end of the step instead of their tangents there.
                let corrected = Tangents { values_at: Some(&next), ..about };
                if let Some(second) = self.step(cascade, &mut walk, &corrected) {
                    let own = merit - self.merit(&second.x, walk.penalty);
                    if own > gain {
                        (next, gain) = (second.x, own);
                    }
                }
            }
            if gain > 0.1 * promise {
                x = next;
                self.show(&x, accept);
                if gain > 0.5 * promise {
                    radius = (2.0 * radius).min(1.0);
                }
            } else {
                radius *= 0.3;
                rejected += 1;
            }
        }
    }

    /// Solves the program about a point; `None` if that does not end well.
    fn step(
        &self,
        cascade: &mut MethodCascade,
        walk: &mut Walk,
        tangents: &Tangents<'_>,
    ) -> Option<TangentStep> {
        let program = self.relaxer.program;
        let (mut reduced, first) = self.linear_program(tangents, walk.penalty)?;
        if walk.is_curved {
            self.add_curvature(&mut reduced, tangents.at, &walk.weights);
        }
        let token = self.relaxer.token;
        let RelaxationResult { x, y, warm, .. } =
            cascade.solve_unproved(&reduced, walk.warm.as_ref(), token)?;
        walk.warm = warm.or(walk.warm.take());
        if y.len() == reduced.rows.len() && tangents.radius.is_finite() {
            let tangents = &y[y.len() - program.stated_terms().len()..];
            walk.weights.iter_mut().zip(tangents).for_each(|(own, y)| *own = -y);
        }
        let (missed, predicted) = (x[first..].iter().sum(), reduced.objective(&x));
        let mut x = x[..first].to_vec();
        for term in program.stated_terms().iter().filter(|term| program.is_cost(term)) {
            x[term.result] = term.value(&x);
        }
        self.relaxer.cut_cones(&mut reduced, &x);
        Some(TangentStep { x, missed, predicted })
    }

    fn show(&self, x: &[f64], accept: &mut dyn FnMut(&[f64])) {
        let mut settled = x.to_vec();
        self.relaxer.program.settle(&mut settled);
        accept(&settled);
    }

    /// The objective with what terms are off.
    fn merit(&self, x: &[f64], penalty: f64) -> f64 {
        let SpatialProgram { program, .. } = self.relaxer.program;
        let terms = self.relaxer.program.stated_terms();
        let off: f64 = terms.iter().map(|term| term.violation(x)).sum();
        let off = if off.is_nan() { f64::INFINITY } else { off };
        program.objective(x) + penalty * off
    }

    /// Adds the convex part of the curvature of the Lagrangian about a point.
    ///
    /// # Arguments
    ///
    /// * `weights`: of the terms, from the multipliers of their tangents.
    fn add_curvature(&self, reduced: &mut Reduced, x: &[f64], weights: &[f64]) {
        let mut columns: Vec<Vec<(usize, f64)>> =
            (0..reduced.columns.len()).map(|j| reduced.quadratic.entries(j).collect()).collect();
        let mut add = |i: usize, j: usize, p: f64| {
            let (i, j) = (i.min(j), i.max(j));
            match columns[j].iter_mut().find(|(k, _)| *k == i) {
                Some((_, own)) => *own += p,
                None => columns[j].push((i, p)),
            }
        };
        let mut linear = vec![0.0; x.len()];
        let mut offset = 0.0;
        for (term, &weight) in self.relaxer.program.stated_terms().iter().zip(weights) {
            // p/2 (d . (z - x))² for a direction d of one or two columns.
            let (direction, p) = match &term.shape {
                Shape::Elementary { function, of } => {
                    ([(*of, 1.0), (*of, 0.0)], weight * function.second_derivative(x[*of]))
                }
                Shape::Bilinear([a, b]) if a != b => {
                    ([(*a, 1.0), (*b, weight.signum())], 0.5 * weight.abs())
                }
                Shape::Bilinear(_) | Shape::Quotient(_) => continue,
            };
            if !(p > 0.0 && p.is_finite()) {
                continue;
            }
            let [(a, d), (b, e)] = direction;
            add(a, a, p * d * d);
            let mut at = d * x[a];
            if e != 0.0 {
                add(b, b, p * e * e);
                add(a, b, p * d * e);
                at += e * x[b];
                linear[b] -= p * e * at;
            }
            linear[a] -= p * d * at;
            offset += 0.5 * p * at * at;
        }
        for (own, linear) in reduced.linear.iter_mut().zip(linear) {
            *own += linear;
        }
        reduced.offset += offset;
        reduced.quadratic = Compressed { start: vec![0], ..Compressed::default() };
        for mut column in columns {
            column.sort_by_key(|(i, _)| *i);
            reduced.quadratic.push(column.into_iter());
        }
        reduced.wants_vertex = reduced.quadratic.index.is_empty();
    }

    /// The linear program about a point, and its first column for what tangents miss.
    fn linear_program(&self, about: &Tangents<'_>, penalty: f64) -> Option<(Reduced, usize)> {
        let Tangents { at: x, radius, values_at } = *about;
        let SpatialProgram { spatial, program, .. } = self.relaxer.program;
        let terms = self.relaxer.program.stated_terms();
        let mut reduced = self.relaxer.plain(self.domain);
        let first = reduced.columns.len();
        // The point keeps the rows up to rounding only, and has to stay a point of the program.
        for limit in reduced.row_lower.iter_mut().filter(|limit| limit.is_finite()) {
            *limit -= (LOOSE_ROWS * limit.abs().max(1.0)).min(MOST_LOOSE);
        }
        for limit in reduced.row_upper.iter_mut().filter(|limit| limit.is_finite()) {
            *limit += (LOOSE_ROWS * limit.abs().max(1.0)).min(MOST_LOOSE);
        }
        if radius.is_finite() {
            for &j in spatial {
                let [lower, upper] = self.domain.bounds(j);
                let width = (upper - lower).min(2.0 * x[j].abs().max(1.0) * 10.0);
                reduced.lower[j] = lower.max(x[j] - radius * width);
                reduced.upper[j] = upper.min(x[j] + radius * width);
                if reduced.lower[j] > reduced.upper[j] {
                    return None;
                }
            }
        }
        for (k, term) in terms.iter().enumerate() {
            let (gradient, count) = term.gradient(x);
            let touches = values_at.unwrap_or(x);
            let mut constant = term.value(touches);
            let mut entries = vec![(term.result, 1.0)];
            for &(j, slope) in &gradient[..count] {
                constant -= slope * touches[j];
                entries.push((j, -slope));
            }
            if !constant.is_finite() || entries.iter().any(|(_, a)| !a.is_finite()) {
                return None;
            }
            merge_entries(&mut entries);
            let [below, above] = term.sides();
            let mut slack = |sign: f64, reduced: &mut Reduced| {
                let column = reduced.columns.len();
                reduced.columns.push(column);
                reduced.values.push(0.0);
                reduced.linear.push(penalty);
                reduced.lower.push(0.0);
                reduced.upper.push(f64::INFINITY);
                reduced.quadratic.start.push(reduced.quadratic.index.len());
                entries.push((column, sign));
            };
            if below {
                slack(1.0, &mut reduced);
            }
            if above {
                slack(-1.0, &mut reduced);
            }
            reduced.rows.push(entries.into_iter());
            reduced.row_lower.push(if below { constant } else { f64::NEG_INFINITY });
            reduced.row_upper.push(if above { constant } else { f64::INFINITY });
            reduced.origin.push(program.row_count() + k);
        }
        Some((reduced, first))
    }
}
