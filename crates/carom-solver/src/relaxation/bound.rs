//! Rigorous bounds from approximate multipliers.
//!
//! For any `x̂` and any row multipliers `y` (clipped where a limit is missing), convexity gives
//!
//! `f(x) >= offset - ½ x̂'Px̂ - Σ y_i limit_i + Σ_j g_j x_j`,  `g = q + Px̂ + A'y`,
//!
//! over all points that satisfy the rows, and the last sum is smallest at a corner of the box. So
//! every pair `(x̂, y)` proves *some* bound, and a good pair proves a tight one. Where plain floats
//! lose too much (see `plain_bound`), sums have twice their digits, and their possible rounding
//! error is subtracted.
//!
//! A column without a finite bound (or with a very large one) on the side that `g` points to needs
//! `g_j = 0`. The pair is corrected first: `x̂` on columns with curvature and `y` on active rows,
//! again with twice the digits. The remaining `g_j` (about 1e-30) is charged over
//! [`tolerance::FREE_RADIUS`] (or more if `x̂` is farther out), or over
//! [`tolerance::INFEASIBILITY_RADIUS`] if there is no objective. Where `g_j` is not slight, and
//! what is charged is within the gap of a bound of 1e16, the pair proves nothing.

use super::borderline::is_blurred;
use super::correction::Correction;
use super::extended::Extended;
use super::plain_bound::PlainSums;
use crate::presolve::{Reduced, refill};
use crate::tolerance::{self, largest_magnitude};

/// The error of a sum with twice the digits of a float, relative to the sum of its terms'
/// magnitudes.
const EXTENDED_ROUNDING: f64 = 1e-27;

/// The fraction of the largest multiplier, in the unit of the gradient, below which a multiplier
/// probably belongs to an inactive row; and the fraction of its terms below which a gradient is
/// slight.
const SLIGHT_MULTIPLIER: f64 = 1e-6;

/// The magnitude from which a bound of a column turns a slight error of the gradient into a large
/// error of the proved bound.
const FAR_BOUND: f64 = 1e6;

/// The ratio of the radius of a column without bounds to its claimed value, at least (no unit).
const RADIUS_FACTOR: f64 = 4.0;

/// The largest part of the terms of a bound by which the sum may fall within the radius, along
/// columns without bounds, so that a gap, or a point beyond the radius, hides it (no unit).
const HIDDEN_FALL: f64 = 1e-3;

/// The fraction of the largest terms of all gradients below which a gradient comes from multipliers
/// that ought to be 0 (no unit).
const TINY_GRADIENT: f64 = 1e-9;

/// The largest number of rounds of correction; each gains about ten digits.
const MAX_CORRECTIONS: usize = 8;

/// Proves bounds, one after the other in the same memory.
#[derive(Debug, Default)]
pub struct Prover {
    /// Multipliers, without those of missing limits.
    y: Vec<f64>,
    plain: PlainSums,
    /// Whether rounding of the rows' terms would move the last bound visibly.
    blurred: bool,
}

impl Prover {
    /// Whether rounding of the rows' terms would move the last [lower bound](Self::lower_bound)
    /// visibly: then the program may have no point but up to rounding.
    pub(super) fn is_blurred(&self) -> bool {
        self.blurred
    }

    /// A proved lower bound on the objective of a reduced program, from a claimed solution. `-inf`
    /// if the pair proves nothing.
    pub fn lower_bound(&mut self, program: &Reduced, x: &[f64], y: &[f64]) -> f64 {
        self.clip(program, y);
        self.blurred = false;
        if let Some(bound) = self.plain.bound(program, x, &self.y) {
            return bound;
        }
        let bound = self.pair(program, x).map_or(f64::NEG_INFINITY, PrimalDualPair::best_bound);
        self.blurred = is_blurred(program, x, &self.y, bound);
        bound
    }

    /// Proved reduced costs from a claimed solution: a lower bound on the objective, and for each
    /// column the least growth of the objective per unit by which the column moves away from one of
    /// its bounds: the lower bound if the entry is positive, the upper one if it is negative. Zero
    /// if nothing is proved.
    pub fn reduced_costs(&mut self, program: &Reduced, x: &[f64], y: &[f64]) -> (f64, &[f64]) {
        self.clip(program, y);
        if let Some(bound) = self.plain.bound(program, x, &self.y) {
            return (bound, &self.plain.slopes);
        }
        let pair = self.pair(program, x);
        let slopes = &mut self.plain.slopes;
        refill(slopes, program.columns.len(), 0.0);
        let Some(pair) = pair else { return (f64::NEG_INFINITY, slopes) };
        let gradient = pair.gradient();
        for (j, slope) in slopes.iter_mut().enumerate() {
            let g = gradient.value[j].high;
            let proved = g.abs() * (1.0 - 1e-9) - gradient.error(j);
            if proved > 0.0 {
                *slope = proved.copysign(g);
            }
        }
        (pair.bound(&gradient, pair.radius()), slopes)
    }

    /// Whether row multipliers prove that a reduced program has no feasible point.
    ///
    /// The certificate must survive a disturbance of every limit that it uses. Otherwise it may
    /// refute a program that is infeasible only by rounding.
    pub fn proves_infeasible(&mut self, program: &Reduced, y: &[f64]) -> bool {
        self.clip(program, y);
        let size = largest_magnitude(&self.y);
        if !(size > 0.0 && size.is_finite()) {
            return false;
        }
        let mut disturbance = 0.0;
        for (i, y) in self.y.iter_mut().enumerate().filter(|(_, y)| **y != 0.0) {
            *y /= size;
            let limit = if *y > 0.0 { program.row_upper[i] } else { program.row_lower[i] };
            disturbance += y.abs() * limit.abs().max(1.0);
        }
        let least = 1e-9 * disturbance;
        let bound = self.plain.certificate(program, &self.y);
        let is_near = |(l, u): (&f64, &f64)| *l >= -FAR_BOUND && *u <= FAR_BOUND;
        match bound {
            Some(bound) if bound > least => return true,
            // Without corrections, more digits would prove hardly more.
            Some(_) if program.lower.iter().zip(&program.upper).all(is_near) => return false,
            _ => {}
        }
        let x = vec![Extended::default(); program.columns.len()];
        let y = self.y.iter().map(|&v| Extended::from(v)).collect();
        PrimalDualPair { program, x, y, objective: false }.best_bound() > least
    }

    /// Takes multipliers, without those of missing limits.
    fn clip(&mut self, program: &Reduced, y: &[f64]) {
        let limit =
            |i: usize, y: f64| if y > 0.0 { program.row_upper[i] } else { program.row_lower[i] };
        let has_limit = |(i, &y): (usize, &f64)| if limit(i, y).is_finite() { y } else { 0.0 };
        self.y.clear();
        self.y.extend(y.iter().enumerate().map(has_limit));
    }

    /// The pair of a claimed point and the multipliers; `None` if it contains a NaN.
    fn pair<'a>(&self, program: &'a Reduced, x: &[f64]) -> Option<PrimalDualPair<'a>> {
        if x.iter().chain(&self.y).any(|v| !v.is_finite()) {
            return None;
        }
        let extended = |v: &f64| Extended::from(*v);
        let (x, y) = (x.iter().map(extended).collect(), self.y.iter().map(extended).collect());
        Some(PrimalDualPair { program, x, y, objective: true })
    }
}

pub(super) struct PrimalDualPair<'a> {
    pub(super) program: &'a Reduced,
    pub(super) x: Vec<Extended>,
    pub(super) y: Vec<Extended>,
    /// Whether the objective is included; certificates of infeasibility exclude it.
    pub(super) objective: bool,
}

/// `g` and, per entry, the sum of its terms' magnitudes.
pub(super) struct Gradient {
    pub(super) value: Vec<Extended>,
    size: Vec<f64>,
}

impl Gradient {
    /// The possible rounding error of an entry.
    fn error(&self, j: usize) -> f64 {
        EXTENDED_ROUNDING * self.size[j]
    }

    /// Whether an entry may be what a method has left of terms that cancel.
    fn is_slight(&self, j: usize) -> bool {
        self.value[j].high.abs() <= SLIGHT_MULTIPLIER * self.size[j]
    }
}

/// A sum and the sum of its terms' magnitudes.
#[derive(Default)]
struct ExtendedSum {
    value: Extended,
    size: f64,
}

impl ExtendedSum {
    fn add(&mut self, a: Extended, b: Extended) {
        self.value = self.value.plus_product(a, b);
        self.size += (a.high * b.high).abs();
    }
}

impl PrimalDualPair<'_> {
    fn best_bound(self) -> f64 {
        let gradient = self.gradient();
        let uncorrected = self.bound(&gradient, self.radius());
        if self.loose_columns(&gradient).is_empty() {
            return uncorrected;
        }
        // Multipliers of inactive rows are tiny rather than zero, and no correction can trade them
        // against large ones. The pair is sometimes better without them.
        let size = |i: usize, y: &Extended| y.high.abs() * largest(self.program, i);
        let most = self.y.iter().enumerate().map(|(i, y)| size(i, y)).fold(1.0_f64, f64::max);
        let mut plain = PrimalDualPair { x: self.x.clone(), y: self.y.clone(), ..self };
        for (i, y) in plain.y.iter_mut().enumerate() {
            if size(i, y) <= SLIGHT_MULTIPLIER * most && !is_equality(self.program, i) {
                *y = Extended::default();
            }
        }
        let same = plain.y == self.y;
        let (corrected, reach) = plain.correct();
        // The radius around a point far from the optima proves nothing about these.
        let uncorrected =
            if reach > self.radius() { self.bound(&gradient, reach) } else { uncorrected };
        let bound = corrected.max(uncorrected);
        if same { bound } else { bound.max(self.correct().0) }
    }

    /// The bound of the corrected pair, and the radius for which it is proved.
    fn correct(mut self) -> (f64, f64) {
        let mut gradient = self.gradient();
        let mut corrected: Vec<usize> = Vec::new();
        let mut correction: Option<Correction> = None;
        for _ in 0..MAX_CORRECTIONS {
            let stuck = self.loose_columns(&gradient);
            if stuck.iter().all(|&j| gradient.value[j].high.abs() <= gradient.error(j)) {
                break;
            }
            // All columns without bounds are corrected together, because correcting one would
            // disturb the others.
            let free = |j: &usize| {
                self.program.lower[*j] < -FAR_BOUND && self.program.upper[*j] > FAR_BOUND
            };
            let known = corrected.len();
            corrected.extend(stuck);
            corrected.extend((0..self.x.len()).filter(free));
            corrected.sort_unstable();
            corrected.dedup();
            // For the same columns, the same factors give the next digits.
            if corrected.len() != known || correction.is_none() {
                correction = Correction::new(&self, &corrected);
            }
            let Some(correction) = &correction else { break };
            if !correction.apply(&mut self, &gradient) {
                break;
            }
            gradient = self.gradient();
        }
        let radius = self.radius();
        (self.bound(&gradient, radius), radius)
    }

    fn gradient(&self) -> Gradient {
        let program = self.program;
        let n = self.x.len();
        let mut gradient = Gradient { value: vec![Extended::default(); n], size: vec![0.0; n] };
        let mut add = |j: usize, a: f64, b: Extended| {
            gradient.value[j] = gradient.value[j].plus_product(a.into(), b);
            gradient.size[j] += (a * b.high).abs();
        };
        if self.objective {
            for j in 0..n {
                add(j, program.linear[j], 1.0.into());
                let (rows, entries) = program.quadratic.vector(j);
                for (&i, &p) in rows.iter().zip(entries) {
                    add(i, p, self.x[j]);
                    if i != j {
                        add(j, p, self.x[i]);
                    }
                }
            }
        }
        for (i, &y) in self.y.iter().enumerate().filter(|(_, y)| y.high != 0.0) {
            let (columns, entries) = program.rows.vector(i);
            columns.iter().zip(entries).for_each(|(&j, &a)| add(j, a, y));
        }
        gradient
    }

    /// Columns whose gradient may point to a missing bound, given its rounding, or points slightly
    /// to a very large one.
    fn loose_columns(&self, gradient: &Gradient) -> Vec<usize> {
        let pulls = |j: &usize| {
            let (g, error) = (gradient.value[*j].high, gradient.error(*j));
            let is_slight = gradient.is_slight(*j);
            let loose = |bound: f64| bound.is_infinite() || (is_slight && bound.abs() > FAR_BOUND);
            (g + error > 0.0 && loose(self.program.lower[*j]))
                || (g - error < 0.0 && loose(self.program.upper[*j]))
        };
        (0..self.x.len()).filter(pulls).collect()
    }

    /// The radius of columns without bounds: with an objective, larger than their values at the
    /// claimed point.
    fn radius(&self) -> f64 {
        let spread = self.program.spread.max(1.0);
        if !self.objective {
            return spread * tolerance::INFEASIBILITY_RADIUS;
        }
        let sides = self.program.lower.iter().zip(&self.program.upper);
        let unbounded = sides.zip(&self.x).filter(|((l, u), _)| l.is_infinite() || u.is_infinite());
        unbounded.fold(spread * tolerance::FREE_RADIUS, |most, (_, x)| {
            most.max(RADIUS_FACTOR * x.high.abs())
        })
    }

    /// The steepness of a column without the bound that its gradient points to; `None` if it has
    /// one or is flat.
    fn runs_uphill(&self, j: usize, g: f64, error: f64) -> Option<f64> {
        let (lower, upper) = (self.program.lower[j], self.program.upper[j]);
        let is_open =
            (g + error > 0.0 && lower.is_infinite()) || (g - error < 0.0 && upper.is_infinite());
        let steepness = self.program.steepness.get(j).copied().unwrap_or(0.0);
        (self.objective && is_open && steepness > 0.0).then_some(steepness)
    }

    /// The bound that the pair proves for points within the radius.
    fn bound(&self, gradient: &Gradient, radius: f64) -> f64 {
        let program = self.program;
        let (mut sum, mut fall) = (ExtendedSum::default(), 0.0);
        let mut noise = TINY_GRADIENT * gradient.size.iter().copied().fold(0.0, f64::max);
        if self.objective {
            // An objective of 0 falls nowhere, and no terms of its own tell what noise is.
            let is_zero =
                program.linear.iter().all(|&q| q == 0.0) && program.quadratic.value.is_empty();
            noise = if is_zero { f64::INFINITY } else { noise };
            sum.add(program.offset.into(), 1.0.into());
            for j in 0..self.x.len() {
                let (rows, entries) = program.quadratic.vector(j);
                for (&i, &p) in rows.iter().zip(entries) {
                    let half = if i == j { -0.5 } else { -1.0 };
                    let slope = Extended::default().plus_product((half * p).into(), self.x[i]);
                    sum.add(slope, self.x[j]);
                }
            }
        }
        for (i, &y) in self.y.iter().enumerate().filter(|(_, y)| y.high != 0.0) {
            let limit = if y.high > 0.0 { program.row_upper[i] } else { program.row_lower[i] };
            sum.add(-y, limit.into());
        }
        for j in 0..self.x.len() {
            let (g, error) = (gradient.value[j], gradient.error(j));
            if let Some(steepness) = self.runs_uphill(j, g.high, error) {
                // As in `plain_bound`, for any radius.
                let missed = g.high.abs() * (1.0 + f64::EPSILON) + error;
                sum.add(g, self.x[j]);
                sum.add((-error).into(), self.x[j].high.abs().into());
                sum.add((-missed).into(), (missed / (2.0 * steepness)).next_up().into());
                continue;
            }
            let reach = |bound: f64| {
                if bound.is_finite() { bound } else { bound.signum() * radius }
            };
            let (lower, upper) = (reach(program.lower[j]), reach(program.upper[j]));
            if g.high.abs() <= error {
                // The sign is unknown, so take the worse of both ends.
                let slope = -(2.0 * g.high.abs() + error);
                sum.add(slope.into(), lower.abs().max(upper.abs()).into());
            } else {
                let own = [program.lower[j], program.upper[j]][usize::from(g.high < 0.0)];
                if own.is_infinite() && !gradient.is_slight(j) && g.high.abs() > noise {
                    fall += g.high.abs() * radius;
                }
                let corner = if g.high > 0.0 { lower } else { upper };
                sum.add(g, corner.into());
                sum.add((-error).into(), corner.abs().into());
            }
        }
        let bound = (sum.value.high - EXTENDED_ROUNDING * sum.size).next_down();
        // There is a point beyond the radius, or a fall that the gap hides.
        let hides_fall = fall > 0.0 && (!self.objective || fall <= HIDDEN_FALL * sum.size);
        if bound.is_nan() || hides_fall { f64::NEG_INFINITY } else { bound }
    }
}

pub(super) fn is_equality(program: &Reduced, row: usize) -> bool {
    program.row_lower[row] == program.row_upper[row]
}

pub(super) fn largest(program: &Reduced, row: usize) -> f64 {
    program.rows.vector(row).1.iter().fold(f64::MIN_POSITIVE, |m, a| m.max(a.abs()))
}
