//! The rounding of one aggregate.
//!
//! Takes a relaxed point and an aggregate of rows; leaves the cut of those tried that is deepest at
//! the point, if there is one (Nemhauser and Wolsey, A recursive procedure to generate all cuts for
//! 0-1 mixed integer programs, Mathematical Programming 46, 1990).
//!
//! Columns are measured from a bound (`t >= 0`), continuous ones also from a variable bound
//! `x <= c + v z`. From `sum a_j t_j + sum c_k t_k <= b` with integral `t_j`, divided by `d > 0`,
//! follows `sum F(a_j / d) t_j + sum min(c_k, 0) / (d (1 - f)) t_k <= floor(b / d)`, where `f` is
//! the fraction of `b / d` and `F(a) = floor(a) + max(0, fraction(a) - f) / (1 - f)`.

use super::cut::Cut;
use super::parameters::CUTS;
use super::rounded_cut::write;
use super::separated_point::{From, SeparatedPoint};

/// A whole column measured from a bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct WholeColumn {
    pub(super) column: usize,
    pub(super) coefficient: f64,
    pub(super) bounds: [f64; 2],
    pub(super) at_upper: bool,
    value: f64,
}

/// A continuous column or slack with a negative coefficient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub(super) key: usize,
    pub(super) coefficient: f64,
    pub(super) from: From,
}

#[derive(Default)]
pub(super) struct Base {
    pub(super) whole: Vec<WholeColumn>,
    pub(super) rest: Vec<Rest>,
    /// The sum of coefficient times value over the rest, and of the squares of the coefficients.
    rest_sum: f64,
    rest_norm: f64,
    pub(super) right: f64,
    /// Whether a column of the rest is measured from a variable bound.
    is_switched: bool,
    /// The least change of the right side that is more than what limits of rows allow.
    least: f64,
    /// The sum of coefficient times value over continuous columns and slacks with positive ones.
    slack: f64,
    /// The rows behind the variable bounds of such columns, with the multipliers that remove them.
    pub(super) removed: Vec<(usize, f64)>,
}

/// An aggregate in measured columns, with the divisor that cuts deepest.
struct DivisorTrial {
    base: Base,
    divisor: f64,
    depth: f64,
}

/// An aggregate `sum of terms = right side`; terms past the columns are slacks of rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Aggregate {
    /// By key.
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) right: f64,
    /// The accuracy to which the coefficients are known, since rows that nearly cancel leave little
    /// else.
    pub(super) noise: f64,
    /// The sum over its rows of the largest magnitude of a term or side, with what has cancelled.
    pub(super) size: f64,
    /// The rows, each with its multiplier: as an equation with a slack of the coefficient 1.
    pub(super) rows: Vec<(usize, f64)>,
}

/// Rounds one aggregate after the other, in the same memory.
#[derive(Default)]
pub(super) struct Rounder {
    /// Bases of finished trials, to be used again.
    spare: Vec<Base>,
    /// Terms in integers, before those of one column are added up.
    integers: Vec<(usize, f64)>,
    /// The whole columns whose coefficients are tried as divisors.
    candidates: Vec<(usize, f64)>,
}

impl Rounder {
    /// The best rounding of `sign * aggregate <= sign * right side` that the point violates.
    pub(super) fn round(
        &mut self,
        point: &SeparatedPoint<'_>,
        aggregate: &Aggregate,
        sign: f64,
    ) -> Option<Cut> {
        let n = point.program.column_count();
        let side = (point, aggregate, sign);
        let mut best = self.measure(side, &|j, _| point.nearest(j), false);
        // A column may be far below its variable bound because this is wide, and the rounding makes
        // it narrow: all variable bounds, and then those of them that pay.
        let hidden = |&(j, _): &(usize, f64)| j < n && point.hides_variable_bound(j);
        if aggregate.terms.iter().any(hidden) {
            let all = self.measure(side, &|j, _| point.variable(j).or(point.simple(j)), true);
            if let Some(all) = all {
                let chosen = fraction(&all.base, all.divisor).and_then(|f| {
                    self.measure(side, &|j, a| deeper(point, j, a, all.divisor, f), false)
                });
                for trial in chosen.into_iter().chain([all]) {
                    if best.as_ref().is_none_or(|best| trial.depth > best.depth) {
                        self.spare.extend(best.replace(trial).map(|trial| trial.base));
                    } else {
                        self.spare.push(trial.base);
                    }
                }
            }
        }
        let DivisorTrial { mut base, divisor, mut depth } = best?;
        turn_around(&mut base, divisor, &mut depth);
        let cut = (depth > 0.0).then(|| write(side, &base, divisor));
        self.spare.push(base);
        cut?
    }

    /// The best rounding of the same in integers alone, if the point violates it: continuous
    /// columns are measured from where their terms vanish. It is less deep than others that keep
    /// them, and the point cannot evade it by moving them.
    pub(super) fn round_integers(
        &mut self,
        point: &SeparatedPoint<'_>,
        aggregate: &Aggregate,
        sign: f64,
    ) -> Option<Cut> {
        let side = (point, aggregate, sign);
        let trial = self.measure(side, &|j, a| Some(point.vanishing(j, a)), true)?;
        let DivisorTrial { mut base, divisor, mut depth } = trial;
        turn_around(&mut base, divisor, &mut depth);
        let cut = (depth > 0.0).then(|| write(side, &base, divisor));
        self.spare.push(base);
        cut?
    }

    /// Measures columns as `pick` says, and chooses the divisor.
    fn measure(
        &mut self,
        (point, aggregate, sign): (&SeparatedPoint<'_>, &Aggregate, f64),
        pick: &dyn Fn(usize, f64) -> Option<From>,
        any: bool,
    ) -> Option<DivisorTrial> {
        let mut base = self.spare.pop().unwrap_or_default();
        let measured = base.fill(point, pick, aggregate, sign, &mut self.integers);
        let best =
            measured.and_then(|()| divide(&base, aggregate.noise, any, &mut self.candidates));
        match best {
            Some((depth, divisor)) => Some(DivisorTrial { base, divisor, depth }),
            None => {
                self.spare.push(base);
                None
            }
        }
    }
}

/// The one of a column's bounds that makes the rounding of a term `a x` deeper.
fn deeper(point: &SeparatedPoint<'_>, column: usize, a: f64, divisor: f64, f: f64) -> Option<From> {
    let (Some(simple), Some(variable)) = (point.simple(column), point.variable(column)) else {
        return point.nearest(column);
    };
    // Without their constants, which are mostly the same.
    let term = |from: From| {
        let rest = (a * from.sign).min(0.0) / (divisor * (1.0 - f)) * from.value;
        let whole = if from.slope == 0.0 { 0.0 } else { rounded(a * from.slope / divisor, f) };
        rest + whole * point.x[from.binary]
    };
    Some(if term(variable) >= term(simple) { variable } else { simple })
}

/// Tries the coefficients of integers as divisors, and parts of the best one: depth and divisor.
///
/// Those that cannot cut the point off are left out, unless `any` are wanted.
fn divide(
    base: &Base,
    noise: f64,
    any: bool,
    candidates: &mut Vec<(usize, f64)>,
) -> Option<(f64, f64)> {
    let can_cut = |divisor| any || base.can_cut(divisor);
    let (mut divisors, mut count) = ([0.0_f64; CUTS.most_divisors], 0);
    let values = base.whole.iter().map(|whole| whole.value).enumerate();
    candidates.clear();
    candidates.extend(values.filter(|(_, value)| *value > 1e-6));
    // Whole columns are sorted.
    candidates.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    for &(k, _) in &*candidates {
        let size = base.whole[k].coefficient.abs();
        let clear = size >= CUTS.divisor_noise * noise && can_cut(size);
        let is_new = |found: &[f64]| found.iter().all(|d| (d - size).abs() > 1e-6 * size);
        if count < CUTS.most_divisors && clear && is_new(&divisors[..count]) {
            divisors[count] = size;
            count += 1;
        }
    }
    let best = divisors[..count].iter().map(|&d| (depth(base, d), d));
    let (mut most, mut divisor) = best.max_by(|a, b| a.0.total_cmp(&b.0))?;
    if most == f64::NEG_INFINITY {
        return None;
    }
    let first = divisor;
    for part in [2.0, 4.0, 8.0] {
        if !can_cut(first / part) {
            break;
        }
        let depth = depth(base, first / part);
        if depth > most {
            (most, divisor) = (depth, first / part);
        }
    }
    Some((most, divisor))
}

/// Measures integers from their other bound where that cuts deeper.
fn turn_around(base: &mut Base, divisor: f64, most: &mut f64) {
    let mut flips: Vec<usize> = (0..base.whole.len())
        .filter(|&k| {
            let whole = &base.whole[k];
            whole.value > 1e-6 && whole.bounds[1] - whole.bounds[0] < f64::INFINITY
        })
        .collect();
    let centre = |w: &WholeColumn| (w.value - 0.5 * (w.bounds[1] - w.bounds[0])).abs();
    flips.sort_by(|&a, &b| centre(&base.whole[a]).total_cmp(&centre(&base.whole[b])));
    for k in flips.into_iter().take(CUTS.most_flips) {
        base.flip(k);
        let depth = depth(base, divisor);
        if depth > *most {
            *most = depth;
        } else {
            base.flip(k);
        }
    }
}

impl Base {
    /// Becomes an aggregate times a sign in measured columns.
    fn fill(
        &mut self,
        point: &SeparatedPoint<'_>,
        pick: &dyn Fn(usize, f64) -> Option<From>,
        aggregate: &Aggregate,
        sign: f64,
        integers: &mut Vec<(usize, f64)>,
    ) -> Option<()> {
        let SeparatedPoint { program, domain, x, .. } = *point;
        let n = program.column_count();
        let Base { whole, rest, removed, .. } = self;
        let (mut right, mut slack) = (sign * aggregate.right, 0.0);
        integers.clear();
        whole.clear();
        rest.clear();
        removed.clear();
        for &(key, a) in &aggregate.terms {
            let a = sign * a;
            if key < n && program.integral[key] {
                integers.push((key, a));
                continue;
            }
            let from = if key < n { pick(key, a)? } else { point.slack_from(key - n) };
            if !from.constant.is_finite() {
                return None;
            }
            right -= a * from.constant;
            if from.slope != 0.0 {
                integers.push((from.binary, a * from.slope));
            }
            if a * from.sign < 0.0 {
                rest.push(Rest { key, coefficient: a * from.sign, from });
            } else {
                slack += a * from.sign * from.value;
                if from.slope != 0.0 {
                    removed.push((from.row, a / point.coefficient(from.row, key)));
                }
            }
        }
        integers.sort_by_key(|&(column, _)| column);
        for same in integers.chunk_by(|p, q| p.0 == q.0) {
            let (column, a) = (same[0].0, same.iter().map(|&(_, a)| a).sum::<f64>());
            if a == 0.0 {
                continue;
            }
            let bounds = domain.bounds(column);
            let at_upper = bounds[1] - x[column] < x[column] - bounds[0];
            let bound = bounds[usize::from(at_upper)];
            if bound.is_infinite() {
                return None;
            }
            right -= a * bound;
            let (coefficient, value) =
                if at_upper { (-a, bound - x[column]) } else { (a, x[column] - bound) };
            whole.push(WholeColumn {
                column,
                coefficient,
                bounds,
                at_upper,
                value: value.max(0.0),
            });
        }
        self.rest_sum = rest.iter().map(|rest| rest.coefficient * rest.from.value).sum();
        self.rest_norm = rest.iter().map(|rest| rest.coefficient * rest.coefficient).sum();
        self.is_switched = rest.iter().any(|rest| rest.from.slope != 0.0);
        (self.right, self.slack) = (right, slack);
        self.least = CUTS.least_missing * aggregate.size;
        Some(())
    }

    /// Whether a divisor may lead to a cut that the point violates. `F(a) <= a`, so rounding takes
    /// away a fraction of the divisor at most, and what is slack already has to be less.
    fn can_cut(&self, divisor: f64) -> bool {
        self.slack < divisor * CUTS.right_fractions.end()
    }

    fn flip(&mut self, k: usize) {
        let whole = &mut self.whole[k];
        // t becomes range - t.
        let range = whole.bounds[1] - whole.bounds[0];
        self.right -= whole.coefficient * range;
        whole.coefficient = -whole.coefficient;
        whole.value = range - whole.value;
        whole.at_upper = !whole.at_upper;
    }
}

/// `F(a)` for the fraction `f` of the right side.
pub(super) fn rounded(a: f64, f: f64) -> f64 {
    // Quotients that are whole up to rounding count as whole; the margin of the limit covers that.
    let down = floor(a + 1e-11 * a.abs().max(1.0));
    let fraction = a - down;
    if fraction < f { down } else { down + (fraction - f) / (1.0 - f) }
}

/// As [`f64::floor`], which is a call where the processor's instruction is not taken for granted.
fn floor(a: f64) -> f64 {
    let whole = a as i32;
    if whole == i32::MIN || whole == i32::MAX {
        return a.floor();
    }
    let whole = f64::from(whole);
    if whole > a { whole - 1.0 } else { whole }
}

pub(super) fn fraction(base: &Base, divisor: f64) -> Option<f64> {
    let quotient = base.right / divisor;
    let fraction = quotient - quotient.floor();
    let [least, most] = [CUTS.right_fractions.start(), CUTS.right_fractions.end()];
    let least = if base.is_switched { &CUTS.least_switched_fraction } else { least };
    let gentle = (least..=most).contains(&&fraction);
    // Without continuous terms, nothing is divided by what is missing to the next whole number.
    let whole = base.rest.is_empty() && fraction > *CUTS.right_fractions.end();
    let clear = whole && (1.0 - fraction) * divisor >= base.least;
    (quotient.abs() < 1e7 && (gentle || clear)).then_some(fraction)
}

/// Distance by which the point violates the rounding, in the measured columns.
fn depth(base: &Base, divisor: f64) -> f64 {
    let Some(f) = fraction(base, divisor) else { return f64::NEG_INFINITY };
    let (mut sum, mut norm) = (0.0, 0.0);
    for whole in &base.whole {
        let a = rounded(whole.coefficient / divisor, f);
        sum += a * whole.value;
        norm += a * a;
    }
    let scale = 1.0 / (divisor * (1.0 - f));
    sum += scale * base.rest_sum;
    norm += scale * scale * base.rest_norm;
    (sum - (base.right / divisor).floor()) / f64::max(norm, 1e-12).sqrt()
}
