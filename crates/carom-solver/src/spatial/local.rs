//! Points from a sequence of linear programs: terms are replaced by their tangents within a trust
//! region, and what a tangent misses costs a penalty (Fletcher and Sainz de la Maza 1989).

use super::enclosure::merge_entries;
use super::program::SpatialProgram;
use super::relaxation::BoxRelaxer;
use crate::presolve::{Domain, Reduced};
use crate::relaxation::{MethodCascade, Purpose, RelaxationQuestion, RelaxationVerdict};

/// Most linear programs from one start.
const MAX_TANGENT_STEPS: usize = 60;

/// The radius at which a search ends, relative to the ranges of the columns (no unit).
const LEAST_RADIUS: f64 = 1e-9;

/// By how much rows are loosened, relative to their limits (no unit).
const LOOSE_ROWS: f64 = 1e-8;

/// By how much they are loosened at most: less than the tolerance of any check.
const MOST_LOOSE: f64 = 1e-7;

/// A search for a point near another one.
pub(super) struct TangentSearch<'a> {
    pub(super) relaxer: &'a BoxRelaxer<'a>,
    /// Ranges of integers have one value here.
    pub(super) domain: &'a Domain,
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
        let mut penalty = 10.0 * cost;
        let mut radius = 0.25;
        let mut merit = f64::INFINITY;
        let mut warm = None;
        let mut is_first = true;
        for _ in 0..MAX_TANGENT_STEPS {
            if self.relaxer.token.is_over() || radius < LEAST_RADIUS {
                return;
            }
            let Some((mut reduced, first)) = self.linear_program(&x, radius, penalty, is_first)
            else {
                return;
            };
            let question = RelaxationQuestion {
                purpose: Purpose::Leaf,
                cutoff: f64::INFINITY,
                options: self.relaxer.options,
                constant: 0.0,
                look_for_descent: false,
                token: self.relaxer.token,
                warm: warm.as_ref(),
            };
            let RelaxationVerdict::Relaxed { x: next, converged: true, warm: state, .. } =
                cascade.solve(&mut reduced, &question)
            else {
                if is_first {
                    return;
                }
                radius *= 0.25;
                continue;
            };
            warm = state.or(warm);
            let missed: f64 = next[first..].iter().sum();
            let predicted = reduced.objective(&next);
            let next = next[..first].to_vec();
            let (value, off) = self.merit(&next, penalty);
            if is_first {
                self.relaxer.cut_cones(&mut reduced, &next);
                // The first point keeps the rows, so that merits can be compared from here on.
                (x, merit, is_first) = (next, value, false);
                self.show(&x, accept);
                continue;
            }
            let (gain, promise) = (merit - value, merit - predicted);
            let scale = 1e-10 * merit.abs().max(1.0);
            if promise <= scale {
                if off > 1e-7 && penalty < 1e7 * cost && missed > 1e-9 {
                    penalty *= 10.0;
                    merit = self.merit(&x, penalty).0;
                    radius = radius.max(0.1);
                    continue;
                }
                return;
            }
            self.relaxer.cut_cones(&mut reduced, &next);
            if gain > 0.1 * promise {
                (x, merit) = (next, value);
                self.show(&x, accept);
                if gain > 0.5 * promise {
                    radius = (2.0 * radius).min(1.0);
                }
            } else {
                radius *= 0.3;
            }
        }
    }

    fn show(&self, x: &[f64], accept: &mut dyn FnMut(&[f64])) {
        let mut settled = x.to_vec();
        self.relaxer.program.settle(&mut settled);
        accept(&settled);
    }

    /// The objective with what terms are off, and that alone.
    fn merit(&self, x: &[f64], penalty: f64) -> (f64, f64) {
        let SpatialProgram { program, terms, .. } = self.relaxer.program;
        let off: f64 = terms.iter().map(|term| term.violation(x)).sum();
        let off = if off.is_nan() { f64::INFINITY } else { off };
        (program.objective(x) + penalty * off, off)
    }

    /// The linear program about a point, and its first column for what tangents miss.
    fn linear_program(
        &self,
        x: &[f64],
        radius: f64,
        penalty: f64,
        is_first: bool,
    ) -> Option<(Reduced, usize)> {
        let SpatialProgram { terms, spatial, program, .. } = self.relaxer.program;
        let mut reduced = self.relaxer.plain(self.domain);
        let first = reduced.columns.len();
        // The point keeps the rows up to rounding only, and has to stay a point of the program.
        for limit in reduced.row_lower.iter_mut().filter(|limit| limit.is_finite()) {
            *limit -= (LOOSE_ROWS * limit.abs().max(1.0)).min(MOST_LOOSE);
        }
        for limit in reduced.row_upper.iter_mut().filter(|limit| limit.is_finite()) {
            *limit += (LOOSE_ROWS * limit.abs().max(1.0)).min(MOST_LOOSE);
        }
        if !is_first {
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
            let value = term.value(x);
            let (gradient, count) = term.gradient(x);
            let mut constant = value;
            let mut entries = vec![(term.result, 1.0)];
            for &(j, slope) in &gradient[..count] {
                constant -= slope * x[j];
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
