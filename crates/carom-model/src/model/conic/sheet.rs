//! The sign of the head of a cone, as far as the bounds of the variables tell.
//!
//! `|tail|^2 <= head^2` is two cones, one of them the mirror image of the other, and the bounds
//! must exclude one. They do if they show the sign of the head, or of another affine expression `f`
//! that is positive on one cone and negative on its mirror image. With `f = a head + b'tail`, that
//! is so if `|b| < |a|`. The bounds give such expressions, and sums of multiples of them.

use super::squares::{Completed, SumOfSquares};
use crate::activity;
use crate::interval::Interval;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::store::Model;

/// Rounding of the constants of a head, relative to its terms: what may be below 0 (no unit).
const HEAD_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// How much shorter `b` must be than `a`, as `b` and `a` are rounded (no unit).
const STRICT: f64 = 1e-9;

/// Most variables of a head whose bounds are combined.
const MOST_COMBINED: usize = 64;

/// Most steps towards the combination of bounds that tells the most.
const MOST_SHEET_STEPS: usize = 200;

/// An affine expression `along * head + across'tail`, without a constant that is at most 0.
struct InSquares {
    along: f64,
    /// First, for a product `u v` as `((u + v) / 2)^2 - ((u - v) / 2)^2`, that of the second
    /// square.
    across: Vec<f64>,
    is_below: bool,
}

impl Model {
    /// The values that an expression can have within the bounds, and within the ranges of
    /// parameters.
    #[doc(hidden)]
    pub fn range_of(&self, expression: &Affine) -> Interval {
        let terms = expression.terms().into_iter().map(|(v, a)| (a, self.widest(v)));
        activity::range(expression.offset(), terms)
    }

    /// The bounds of a variable, or the range of a parameter.
    fn widest(&self, variable: Variable) -> Interval {
        let data = &self.stored.variables[variable.index()];
        let (lower, upper) = data.range.unwrap_or((data.lower, data.upper));
        Interval::new(lower, upper)
    }

    /// Whether an expression is at least 0 within the bounds, but for rounding.
    pub(super) fn is_not_negative(&self, expression: &Affine) -> bool {
        let lower = self.range_of(expression).lower;
        let size = |(v, a): (Variable, f64)| {
            let Interval { lower, upper } = self.widest(v);
            let end = if a > 0.0 { lower } else { upper };
            (a * end).abs()
        };
        let sizes: f64 = expression.terms().into_iter().map(size).sum();
        lower >= 0.0
            || lower.is_finite() && lower >= -HEAD_ROUNDING * (sizes + expression.offset().abs())
    }

    /// The sign of the only negative square or product of a sum: 1 if the root or both factors are
    /// at least 0 where the sum is at most 0, -1 if they are at most 0; `None` if the bounds do not
    /// tell.
    pub(super) fn sheet(&self, sum: &SumOfSquares) -> Option<f64> {
        let is_head = |completed: &&Completed| completed.is_head();
        let head = sum.completed().find(is_head)?;
        let factors: Vec<&Affine> = match head {
            Completed::Square { root, .. } => vec![root],
            Completed::Product { factors, .. } => factors.iter().collect(),
        };
        // A positive product is made negative by the sign of its first factor.
        let first = match head {
            Completed::Product { coefficient, .. } => -coefficient.signum(),
            Completed::Square { .. } => 1.0,
        };
        for sign in [1.0, -1.0] {
            let signs = [sign * first, sign];
            let mut signed = factors.iter().zip(signs).map(|(&factor, sign)| sign * factor);
            if signed.all(|factor| self.is_not_negative(&factor)) {
                return Some(sign);
            }
        }
        self.sheet_by_bounds(sum)
    }

    /// The same by the bounds of other variables of the block, one by one and together.
    fn sheet_by_bounds(&self, sum: &SumOfSquares) -> Option<f64> {
        let block = sum.blocks.iter().find(|block| block.iter().any(Completed::is_head))?;
        let variables = block_variables(block);
        if variables.len() > MOST_COMBINED {
            return None;
        }
        let mut known = Vec::new();
        for v in variables {
            let Interval { lower, upper } = self.widest(v);
            for (end, sign) in [(lower, 1.0), (upper, -1.0)] {
                if end.is_finite() {
                    let at_least_zero = sign * (Affine::from(v) - Affine::constant(end));
                    known.extend(InSquares::of(&at_least_zero, block, sum.constant));
                }
            }
        }
        known.extend(InSquares::of(&Affine::constant(1.0), block, sum.constant));
        let of_one = known.iter().find_map(|one| one.sheet(sum.constant > 0.0));
        of_one.or_else(|| [1.0, -1.0].into_iter().find(|&sheet| InSquares::tell(&known, sheet)))
    }
}

impl Completed {
    /// Whether it is a negative square or a product.
    pub(super) fn is_head(&self) -> bool {
        match self {
            Completed::Square { coefficient, .. } => *coefficient < 0.0,
            Completed::Product { .. } => true,
        }
    }
}

fn block_variables(block: &[Completed]) -> Vec<Variable> {
    let roots = block.iter().flat_map(|completed| match completed {
        Completed::Square { root, .. } => root.terms(),
        Completed::Product { factors, .. } => (&factors[0] + &factors[1]).terms(),
    });
    let mut variables: Vec<Variable> = roots.map(|term| term.0).collect();
    variables.sort_unstable();
    variables.dedup();
    variables
}

impl InSquares {
    /// An expression in terms of the squares of a block and of the square of a constant; `None` if
    /// they do not make it up.
    fn of(expression: &Affine, block: &[Completed], constant: f64) -> Option<Self> {
        let mut rest = expression.clone();
        let coefficient = |rest: &Affine, v: Variable| {
            let terms = rest.terms();
            terms.iter().find(|term| term.0 == v).map_or(0.0, |term| term.1)
        };
        let (mut along, mut across) = (0.0, vec![0.0]);
        for completed in block {
            match completed {
                Completed::Square { coefficient: d, root, lead } => {
                    let part = coefficient(&rest, *lead);
                    rest = without(rest, *lead, root, part);
                    let part = part / d.abs().sqrt();
                    if *d < 0.0 { along = part } else { across.push(part) }
                }
                Completed::Product { coefficient: d, factors, leads } => {
                    let parts = leads.map(|lead| coefficient(&rest, lead));
                    for k in 0..2 {
                        rest = without(rest, leads[k], &factors[k], parts[k]);
                    }
                    let scale = 1.0 / d.abs().sqrt();
                    let (u, v) = (-d.signum() * parts[0] * scale, parts[1] * scale);
                    (along, across[0]) = (u + v, u - v);
                }
            }
        }
        let left = rest.offset();
        if !rest.terms().is_empty() || left > 0.0 && constant <= 0.0 {
            return None;
        }
        across.push(if left > 0.0 { left / constant.sqrt() } else { 0.0 });
        Some(InSquares { along, across, is_below: left < 0.0 })
    }

    /// The sheet on which it is positive, if it is negative on the other one.
    ///
    /// # Arguments
    ///
    /// * `is_off_zero`: whether the product of the head is positive on both sheets.
    fn sheet(&self, is_off_zero: bool) -> Option<f64> {
        let squares = dot(&self.across, &self.across);
        let is_strict = squares < (1.0 - STRICT) * self.along * self.along;
        // A factor is 0 at most at the edge of a sheet.
        let is_factor = self.along != 0.0
            && self.across[0].abs() == self.along.abs()
            && self.across[1..].iter().all(|part| *part == 0.0);
        let tells = is_strict || is_factor && (is_off_zero || self.is_below);
        tells.then(|| self.along.signum())
    }

    /// Whether a sum of multiples of expressions that are at least 0 is positive on a sheet and
    /// negative on the other one: steps towards the shortest `across` for `along` 1 (Gilbert 1966).
    fn tell(known: &[InSquares], sheet: f64) -> bool {
        let (mut points, mut directions) = (Vec::new(), Vec::new());
        for one in known {
            let along = sheet * one.along;
            if along > 0.0 {
                points.push(one.across.iter().map(|part| part / along).collect::<Vec<f64>>());
            } else if along == 0.0 {
                directions.push(one.across.clone());
            }
        }
        let Some(mut best) = points.first().cloned() else { return false };
        for _ in 0..MOST_SHEET_STEPS {
            if dot(&best, &best) < 1.0 - STRICT {
                return true;
            }
            let by_point = |a: &&Vec<f64>, b: &&Vec<f64>| dot(a, &best).total_cmp(&dot(b, &best));
            if let Some(point) = points.iter().min_by(by_point) {
                let step: Vec<f64> = point.iter().zip(&best).map(|(a, b)| a - b).collect();
                advance(&mut best, &step, 1.0);
            }
            for direction in &directions {
                advance(&mut best, direction, f64::INFINITY);
            }
        }
        false
    }
}

/// Goes along a step, as far as that shortens a vector.
fn advance(vector: &mut [f64], step: &[f64], most: f64) {
    let squares = dot(step, step);
    if squares > 0.0 {
        let part = (-dot(vector, step) / squares).clamp(0.0, most);
        vector.iter_mut().zip(step).for_each(|(a, b)| *a += part * b);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `rest - part * root`, exactly without the lead of the root.
fn without(rest: Affine, lead: Variable, root: &Affine, part: f64) -> Affine {
    if part == 0.0 {
        return rest;
    }
    let difference = rest - part * root;
    let mut without = Affine::constant(difference.offset());
    let terms = difference.terms();
    terms.iter().filter(|term| term.0 != lead).for_each(|&(v, a)| without.add_term(a, v));
    without
}
