//! Bounds of columns from one second-order cone.
//!
//! Takes a cone and the bounds of its columns; leaves tighter bounds, both ways: the largest head
//! bounds each entry of the tail, given the least of the others, and the least tail bounds the head
//! (Belotti, Lee, Liberti, Margot and Wächter, Branching and bounds tightening techniques for
//! non-convex MINLP, Optimization Methods and Software 24, 2009).
//!
//! Every step is rounded outward. A root turns a small change of the head into a large one of the
//! tail, so the head is taken larger by what a conflict must exceed: a bound of the tail cuts off
//! no point that misses the cone by less.
//!
//! Where the largest head is exactly as long as the least tail, the cone is one point:
//! `|(3, y)| <= 3` leaves `y` only 0, and so does a head of 0. There nothing is rounded, because
//! the root would leave room for far more than the tolerance, and no method finds an inside.

use super::coefficients::is_exact;
use super::parameters::{CONTRADICTION, FEW_ROUNDINGS};
use super::tightening::{RowState, Tightening, whole, worthwhile};
use crate::program::{Cone, ConeShape};
use crate::sum::Sum;
use crate::tolerance;

/// The columns of a program, and their bounds.
#[derive(Clone, Copy)]
pub(super) struct BoundedColumns<'a> {
    pub(super) integral: &'a [bool],
    pub(super) bounds: &'a [[f64; 2]],
}

impl BoundedColumns<'_> {
    fn upper(&self, column: usize) -> f64 {
        self.bounds[column][1]
    }

    /// The least square of a column, rounded down.
    fn least_square(&self, column: usize) -> f64 {
        let [lower, upper] = self.bounds[column];
        let nearest = lower.max(-upper).max(0.0);
        let slack = match self.integral[column] {
            true => 0.0,
            false => tolerance::PROPAGATION_SLACK * nearest.max(1.0),
        };
        let nearest = (nearest - slack).max(0.0);
        nearest * nearest * (1.0 - FEW_ROUNDINGS)
    }

    /// The largest square of a column, rounded up.
    fn largest_square(&self, column: usize) -> f64 {
        let [lower, upper] = self.bounds[column];
        let farthest = (-lower).max(upper);
        farthest * farthest * (1.0 + FEW_ROUNDINGS)
    }

    /// The value of a column that is nearest to 0.
    fn nearest(&self, column: usize) -> f64 {
        let [lower, upper] = self.bounds[column];
        if lower > 0.0 { lower } else { upper.min(0.0) }
    }

    /// Whether nothing of a bound of a column was rounded.
    fn is_exact(&self, column: usize, bound: f64) -> bool {
        self.integral[column] || is_exact(bound)
    }

    /// The amount by which the squares of a column may miss the cone: whole values must satisfy it
    /// as accepted points do.
    fn margin(&self, column: usize) -> f64 {
        if self.integral[column] { tolerance::FEASIBILITY } else { CONTRADICTION }
    }

    /// Offers a bound that the margin already is part of.
    fn offer(
        &self,
        column: usize,
        is_upper: bool,
        value: f64,
        least_gain: f64,
        found: &mut Vec<Tightening>,
    ) {
        if !value.is_finite() || value.abs() >= tolerance::INFINITE {
            return;
        }
        let bounds = self.bounds[column];
        found.extend(if self.integral[column] {
            let slack = tolerance::INTEGRALITY + tolerance::PROPAGATION_SLACK * value.abs();
            whole(bounds, column, is_upper, value, slack)
        } else {
            worthwhile(bounds, column, is_upper, value, value.abs().max(1.0), least_gain)
        });
    }
}

/// A value that is at least 0, moved up by a margin relative to it (at least 1); 0 is exact.
fn raised(value: f64, margin: f64) -> f64 {
    if value <= 0.0 { 0.0 } else { (value + margin * value.max(1.0)) * (1.0 + FEW_ROUNDINGS) }
}

/// Finds the bounds that a cone tightens by more than `least_gain` of their width.
pub(super) fn tighten_cone(
    columns: BoundedColumns<'_>,
    cone: &Cone,
    least_gain: f64,
    found: &mut Vec<Tightening>,
) -> RowState {
    let tail = cone.tail();
    let least: f64 = tail.iter().map(|&j| columns.least_square(j)).sum();
    // The error of the sum, and of differences with it.
    let noise = least * (tail.len() + 4) as f64 * f64::EPSILON;
    let least = (least - noise).max(0.0);
    if !least.is_finite() {
        return RowState::Open;
    }
    if misses(columns, cone, least.sqrt()) || has_no_product(columns, cone, least) {
        return RowState::Violated;
    }
    if is_implied(columns, cone) {
        return RowState::Implied;
    }
    if largest_head_square(columns, cone, 0.0) <= least * (1.0 + NEARLY_FULL) {
        let pins = pins(columns, cone);
        if !pins.is_empty() {
            found.extend(pins);
            return RowState::Open;
        }
    }
    if least > 0.0 {
        bound_heads(columns, cone, least, least_gain, found);
    }
    if largest_head_square(columns, cone, CONTRADICTION).is_infinite() {
        return RowState::Open;
    }
    for &j in tail {
        let [lower, upper] = columns.bounds[j];
        if lower == upper {
            continue;
        }
        let rest = (least - columns.least_square(j) - noise).max(0.0);
        let most = largest_head_square(columns, cone, columns.margin(j)) * (1.0 + FEW_ROUNDINGS);
        let most = (most - rest).max(0.0).sqrt() * (1.0 + FEW_ROUNDINGS);
        if upper > most {
            columns.offer(j, true, most, least_gain, found);
        }
        if lower < -most {
            columns.offer(j, false, -most, least_gain, found);
        }
    }
    RowState::Open
}

/// By how much the square of the largest head may exceed that of the least tail, relative to it,
/// where exact numbers may be equal.
const NEARLY_FULL: f64 = 1e-12;

/// Bounds that fix the entries of a cone whose largest head is exactly as long as its least tail.
/// None if the numbers were rounded, or if nothing is left to fix.
pub(super) fn pins(columns: BoundedColumns<'_>, cone: &Cone) -> Vec<Tightening> {
    let (head, tail) = (cone.head(), cone.tail());
    let upper = |j: usize| columns.upper(j).max(0.0);
    let is_exact = head.iter().all(|&j| columns.is_exact(j, upper(j)))
        && tail.iter().all(|&j| columns.is_exact(j, columns.nearest(j)));
    let factors = match *head {
        [first, second] => [upper(first), upper(second)],
        [head] => [upper(head); 2],
        _ => return Vec::new(),
    };
    let is_empty = factors.contains(&0.0);
    let mut room = Sum::default();
    if !is_empty {
        room.add_product(factors[0], factors[1]);
    }
    for &j in tail {
        let nearest = columns.nearest(j);
        room.add_product(-nearest, nearest);
    }
    let mut pins = Vec::new();
    if !is_exact || room.value() != 0.0 {
        return pins;
    }
    let mut pin = |column: usize, value: f64| {
        let [lower, upper] = columns.bounds[column];
        for (is_upper, is_open) in [(false, lower < value), (true, upper > value)] {
            pins.extend(is_open.then_some(Tightening { column, is_upper, value }));
        }
    };
    tail.iter().for_each(|&j| pin(j, columns.nearest(j)));
    // A factor of 0 leaves the other one as it is.
    if !is_empty {
        head.iter().for_each(|&j| pin(j, upper(j)));
    }
    pins
}

/// Whether the product of a rotated cone is less than the square of its tail although its heads are
/// far apart: of `0 y >= 1` the distance to the cone is nearly 0 where `y` is large.
fn has_no_product(columns: BoundedColumns<'_>, cone: &Cone, least: f64) -> bool {
    let [first, second] = *cone.head() else { return false };
    let (first, second) = (columns.upper(first), columns.upper(second));
    // The square of the tail is in the unit of the model's row.
    (first <= 0.0 || second <= 0.0) && least > tolerance::FEASIBILITY
}

/// The square that the tail may have at most, where the head is raised by a margin.
fn largest_head_square(columns: BoundedColumns<'_>, cone: &Cone, margin: f64) -> f64 {
    let most = |j: usize| raised(columns.upper(j), margin);
    match (cone.shape, cone.head()) {
        (ConeShape::Rotated, &[x, y]) => {
            let (x, y) = (most(x), most(y));
            if x == 0.0 || y == 0.0 { 0.0 } else { x * y }
        }
        (_, head) => head.first().map_or(f64::INFINITY, |&h| most(h) * most(h)),
    }
}

/// Whether a tail of some length misses the largest head by more than rounding explains.
fn misses(columns: BoundedColumns<'_>, cone: &Cone, length: f64) -> bool {
    let (miss, size) = missed_by(columns, cone, length);
    // Infinite heads give no number, or none that is larger.
    miss > CONTRADICTION * size
}

/// By how much a tail of some length misses the largest head, in the unit of the head, and the size
/// of both (at least 1).
pub(super) fn missed_by(columns: BoundedColumns<'_>, cone: &Cone, length: f64) -> (f64, f64) {
    let (miss, size) = match (cone.shape, cone.head()) {
        (ConeShape::Rotated, &[x, y]) => {
            let (x, y) = (columns.upper(x), columns.upper(y));
            (0.5 * ((x - y).hypot(2.0 * length) - (x + y)), x.abs().max(y.abs()))
        }
        (_, head) => {
            let head = head.first().map_or(f64::INFINITY, |&h| columns.upper(h));
            (length - head, head.abs())
        }
    };
    (miss, size.max(length).max(1.0))
}

/// Whether every point within the bounds is in the cone.
pub(super) fn is_implied(columns: BoundedColumns<'_>, cone: &Cone) -> bool {
    let lower = |j: usize| columns.bounds[j][0].max(0.0) * (1.0 - FEW_ROUNDINGS);
    let room = match (cone.shape, cone.head()) {
        (ConeShape::Rotated, &[x, y]) => lower(x) * lower(y),
        (_, head) => head.first().map_or(0.0, |&h| lower(h) * lower(h)),
    };
    let tail = cone.tail();
    // Most cones have a head that may be 0.
    if room <= 0.0 && tail.iter().any(|&j| columns.bounds[j] != [0.0, 0.0]) {
        return false;
    }
    let most: f64 = tail.iter().map(|&j| columns.largest_square(j)).sum();
    let heads_hold = cone.head().iter().all(|&j| columns.bounds[j][0] >= 0.0);
    heads_hold && most * (1.0 + (tail.len() + 4) as f64 * f64::EPSILON) <= room
}

/// Bounds an integral factor of a rotated cone from below. A whole value must satisfy the row
/// itself, whose unit is that of the product: 0 is near 2.5e-7, and `0 y` is not near 0.25 with any
/// `y` up to 1e6.
fn bound_whole_head(
    columns: BoundedColumns<'_>,
    [head, other]: [usize; 2],
    least: f64,
    found: &mut Vec<Tightening>,
) {
    let most = raised(columns.upper(other), columns.margin(other));
    let value = least / most * (1.0 - FEW_ROUNDINGS);
    if most > 0.0 && value.is_finite() && value < tolerance::INFINITE {
        let tolerated = tolerance::INTEGRALITY.min(tolerance::FEASIBILITY / most);
        let slack = tolerated + tolerance::PROPAGATION_SLACK * value;
        found.extend(whole(columns.bounds[head], head, false, value, slack));
    }
}

/// Bounds the head from below.
fn bound_heads(
    columns: BoundedColumns<'_>,
    cone: &Cone,
    least: f64,
    least_gain: f64,
    found: &mut Vec<Tightening>,
) {
    match (cone.shape, cone.head()) {
        (ConeShape::Rotated, &[x, y]) => {
            for (head, other) in [(x, y), (y, x)] {
                if columns.integral[head] {
                    bound_whole_head(columns, [head, other], least, found);
                    continue;
                }
                let margin = columns.margin(head);
                let most = raised(columns.upper(other), margin);
                if most > 0.0 && most.is_finite() {
                    let value = least / most * (1.0 - FEW_ROUNDINGS) - margin;
                    columns.offer(head, false, value, least_gain, found);
                }
            }
        }
        (_, head) => {
            if let Some(&h) = head.first() {
                let value = least.sqrt() * (1.0 - FEW_ROUNDINGS);
                columns.offer(h, false, value, least_gain, found);
            }
        }
    }
}
