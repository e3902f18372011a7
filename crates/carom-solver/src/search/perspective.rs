//! Perspective of squares that a binary switches off.
//!
//! A column with a quadratic cost, such as the power of a unit, is often fixed at one value while a
//! binary is off. Where the relaxation has the binary at a fraction, the square is too cheap: the
//! convex hull of both cases has the perspective `q d^2 / w` as its cost, where `d` is the distance
//! from the value when off, and `w` is 1 when on and 0 when off. It is no quadratic function, but
//! it is the largest of the functions
//!
//! `q d^2 + 2 q r d (1 - w) - q r^2 w (1 - w)`  over all slopes `r`,
//!
//! of which each is a convex quadratic, `q (d + r (1 - w))^2 - q r^2 (1 - w)`, never above the
//! perspective (Jensen), equal to it where `d = r w`, and equal to the square wherever the binary
//! is whole. So one of them takes the place of each square: no column or row is added, and no point
//! with whole binaries changes its cost. The function is concave in `r`, so the best slopes are a
//! saddle point with the relaxed point: `r = d / w`. A few relaxations of the root find them.

use std::collections::BTreeMap;

use super::root::Root;
use super::root_point::{RootPoint, Strengthened};
use crate::activity::{ends, implied_ends};
use crate::mutations::{self, Mutation};
use crate::presolve::Domain;
use crate::program::Program;
use crate::relaxation::MethodCascade;
use crate::solver::{Options, StopToken};

/// Longest rows that are looked at (columns).
const ROW_ENTRIES: usize = 200;

/// Width of bounds, relative, up to which a column counts as fixed by a binary.
const FIXED_WIDTH: f64 = 1e-12;

/// Most relaxations of the root.
const MOST_ROUNDS: usize = 12;

/// Part of the way to the slope of the relaxed point that a round goes.
const SLOPE_STEP: f64 = 0.7;

/// A round that lifts the bound by less than this, relative, is idle; so many in a row are the end.
const IDLE_LIFT: f64 = 1e-4;
const IDLE_ROUNDS: usize = 2;

/// A first round that lifts the bound by less than this, relative, is the last.
const FIRST_LIFT: f64 = 5e-4;

/// All rounds together must lift the bound by this much, relative.
const TOTAL_LIFT: f64 = 2e-3;

/// Below this value of `w` the slope of a point says nothing (no unit).
const LEAST_WEIGHT: f64 = 1e-4;

/// A square that a binary switches off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Switched {
    /// The column with the square.
    pub column: usize,
    /// The second derivative of the square.
    pub curvature: f64,
    /// The binary.
    pub binary: usize,
    /// Whether the square is off while the binary is 1, or 0.
    pub off_at_one: bool,
    /// The column's value when off.
    pub value: f64,
}

/// The squares of a program that binaries switch off. Where several binaries switch one off, all of
/// them are listed.
pub fn switched_squares(program: &Program, token: &StopToken) -> Vec<Switched> {
    let alone = |j: usize| match program.quadratic_column(j) {
        (&[i], &[p]) if i == j && p > 0.0 => p,
        _ => 0.0,
    };
    let curvature: Vec<f64> = (0..program.column_count()).map(alone).collect();
    if program.integers.is_empty() || curvature.iter().all(|&p| p == 0.0) {
        return Vec::new();
    }
    let mut switched = Vec::new();
    let curved = curvature.iter().enumerate().filter(|(_, p)| **p > 0.0);
    for (column, &curvature) in curved {
        // The bounds of the column while a binary is at 0 or 1, by binary and value.
        let mut sides: BTreeMap<(usize, bool), [f64; 2]> = BTreeMap::new();
        for &row in program.column(column).0 {
            if token.spend(program.row(row).0.len()) {
                return Vec::new();
            }
            tighten_by_row(program, row, column, &mut sides);
        }
        let own = [program.lower[column], program.upper[column]];
        for ((binary, off_at_one), [lower, upper]) in sides {
            if let Some(value) = only_value(own, [lower, upper]) {
                switched.push(Switched { column, curvature, binary, off_at_one, value });
            }
        }
    }
    switched
}

/// Tightens the bounds that a column has while one of a row's binaries is at 0, or at 1.
fn tighten_by_row(
    program: &Program,
    row: usize,
    column: usize,
    sides: &mut BTreeMap<(usize, bool), [f64; 2]>,
) {
    let (columns, values) = program.row(row);
    let bounds = |j: usize| [program.lower[j], program.upper[j]];
    let is_open = |j: usize| program.integral[j] && bounds(j) == [0.0, 1.0] && j != column;
    let Some(at) = columns.iter().position(|&j| j == column) else { return };
    let a = values[at];
    if columns.len() > ROW_ENTRIES || !columns.iter().any(|&j| is_open(j)) {
        return;
    }
    // Least and largest value of the others.
    let others = || columns.iter().zip(values).filter(|(j, _)| **j != column);
    let rest = ends([0.0; 2], others().map(|(&j, &b)| (b, bounds(j))));
    for (&z, &b) in others().filter(|(z, _)| is_open(**z)) {
        for one in [false, true] {
            // What is left without the binary, and what the binary adds.
            let term = if one { b } else { 0.0 };
            let [least, most] = [rest[0] - b.min(0.0) + term, rest[1] - b.max(0.0) + term];
            let limits = [program.row_lower[row] - most, program.row_upper[row] - least];
            let [lower, upper] = implied_ends(a, limits);
            let side = sides.entry((z, one)).or_insert(bounds(column));
            *side = [side[0].max(lower), side[1].min(upper)];
        }
    }
}

/// The only value that is left of a column that was not fixed before: 0 or a bound.
fn only_value(own: [f64; 2], [lower, upper]: [f64; 2]) -> Option<f64> {
    // A side without an end says nothing: its width and the room would both be infinite.
    let is_open = !lower.is_finite() || !upper.is_finite();
    if own[0] == own[1] || (is_open && !mutations::has(Mutation::OpenSquare)) {
        return None;
    }
    let room = FIXED_WIDTH * lower.abs().max(upper.abs()).max(1.0);
    if (upper - lower).abs() > room {
        return None;
    }
    let near = |v: &f64| (lower - room..=upper + room).contains(v);
    own.into_iter().chain([0.0]).find(near)
}

/// Replaces the squares that binaries switch off by tighter functions with the same cost at every
/// point with whole binaries. Returns `None` if that does not lift the bound of the root enough.
/// The root gets the relaxed point of the program that is left, where it was computed.
pub(crate) fn with_perspective(
    program: &Program,
    root: &mut Root,
    options: &Options,
    token: &StopToken,
    cascade: &mut MethodCascade,
) -> Option<Strengthened> {
    let all = switched_squares(program, token);
    if all.is_empty() || root.conflict.is_some() {
        return None;
    }
    let (best, point) = best_perspective(program, &root.domain, all, (options, token, cascade))?;
    let (tighter, point) = match best {
        Some(Perspective { program, point: best, .. }) => (
            Some(Strengthened { program, values: [point.value, best.value], cuts: Vec::new() }),
            best,
        ),
        None => (None, point),
    };
    root.point = Some(point);
    tighter
}

/// Slopes of squares of a program, with which the bound of its root is lifted enough; none if there
/// are none.
pub(crate) fn lifting_slopes(
    program: &Program,
    squares: Vec<Switched>,
    options: &Options,
    token: &StopToken,
    cascade: &mut MethodCascade,
) -> Vec<(Switched, f64)> {
    let domain = Domain::new(program);
    match best_perspective(program, &domain, squares, (options, token, cascade)) {
        Some((Some(best), _)) => best.squares.into_iter().zip(best.slopes).collect(),
        _ => Vec::new(),
    }
}

/// A program with tighter functions in place of squares, and its relaxed point.
struct Perspective {
    squares: Vec<Switched>,
    slopes: Vec<f64>,
    program: Program,
    point: RootPoint,
}

/// The perspective with the best bound, if that is lifted enough, and the relaxed point without it,
/// if there is one.
fn best_perspective(
    program: &Program,
    domain: &Domain,
    all: Vec<Switched>,
    (options, token, cascade): (&Options, &StopToken, &mut MethodCascade),
) -> Option<(Option<Perspective>, RootPoint)> {
    let point = RootPoint::new(program, domain, cascade, options, token, None)?;
    let squares = one_each(all, &point.x);
    // No function lifts the bound beyond its own value at this point.
    let most: f64 = squares.iter().map(|square| excess(square, &point.x)).sum();
    if !point.is_lifted_by(TOTAL_LIFT, point.value + most) {
        return Some((None, point));
    }
    let found = best_slopes(program, domain, &point, &squares, (options, token, cascade));
    let found = found.filter(|best| point.is_lifted_by(TOTAL_LIFT, best.point.value));
    Some((found, point))
}

/// Looks for the slopes with the best bound.
fn best_slopes(
    program: &Program,
    domain: &Domain,
    root: &RootPoint,
    squares: &[Switched],
    (options, token, cascade): (&Options, &StopToken, &mut MethodCascade),
) -> Option<Perspective> {
    let at_root = |square: &Switched| slope(square, &root.x).unwrap_or(0.0);
    let mut slopes: Vec<f64> = squares.iter().map(at_root).collect();
    let mut best: Option<Perspective> = None;
    let mut idle = 0;
    for _ in 0..MOST_ROUNDS {
        let tighter = with_slopes(program, squares, &slopes)?;
        let warm = best.as_ref().map_or(root, |best| &best.point).warm.as_ref();
        let point = RootPoint::new(&tighter, domain, cascade, options, token, warm);
        let Some(point) = point else { break };
        let tried = slopes.clone();
        for (r, square) in slopes.iter_mut().zip(squares) {
            let wanted = slope(square, &point.x).unwrap_or(*r);
            *r += SLOPE_STEP * (wanted - *r);
        }
        let (last, value) = (best.as_ref().map_or(root, |best| &best.point), point.value);
        idle = if last.is_lifted_by(IDLE_LIFT, value) { 0 } else { idle + 1 };
        if value > last.value {
            let squares = squares.to_vec();
            best = Some(Perspective { squares, slopes: tried, program: tighter, point });
        }
        // The first slopes are the largest: where they go too far, the bound falls.
        let hopeless = value >= root.value && !root.is_lifted_by(FIRST_LIFT, value);
        if hopeless || idle >= IDLE_ROUNDS || token.is_over() {
            break;
        }
    }
    best
}

/// For each column the square of the binary that is furthest off at a point.
fn one_each(all: Vec<Switched>, x: &[f64]) -> Vec<Switched> {
    let mut best: BTreeMap<usize, Switched> = BTreeMap::new();
    for square in all {
        let kept = best.entry(square.column).or_insert(square);
        if on(&square, x) < on(kept, x) {
            *kept = square;
        }
    }
    best.into_values().collect()
}

/// The degree to which a square is on: 1 for on, 0 for off.
fn on(square: &Switched, x: &[f64]) -> f64 {
    let z = x[square.binary].clamp(0.0, 1.0);
    if square.off_at_one { 1.0 - z } else { z }
}

/// `d / w` at a point; `None` where the square is off.
fn slope(square: &Switched, x: &[f64]) -> Option<f64> {
    let w = on(square, x);
    (w > LEAST_WEIGHT).then(|| (x[square.column] - square.value) / w)
}

/// By how much the perspective of a square exceeds the square at a point.
fn excess(square: &Switched, x: &[f64]) -> f64 {
    let (w, d) = (on(square, x).max(LEAST_WEIGHT), x[square.column] - square.value);
    0.5 * square.curvature * d * d * (1.0 / w - 1.0)
}

/// The program with a slope for each square.
pub fn with_slopes(program: &Program, squares: &[Switched], slopes: &[f64]) -> Option<Program> {
    let mut linear = program.linear.clone();
    let mut offset = program.offset;
    let mut products: Vec<_> = program.quadratic_entries().collect();
    for (square, &r) in squares.iter().zip(slopes) {
        let &Switched { column, curvature, binary, off_at_one, value } = square;
        // `1 - w = s + t z`, and `w (1 - w) = z - z^2`.
        let (s, t) = if off_at_one { (0.0, 1.0) } else { (1.0, -1.0) };
        let slanted = curvature * r;
        products.push((column, binary, t * slanted));
        products.push((binary, column, t * slanted));
        products.push((binary, binary, slanted * r));
        linear[column] += s * slanted;
        linear[binary] -= t * slanted * value + 0.5 * slanted * r;
        offset -= s * slanted * value;
    }
    let mut tighter = program.clone();
    tighter.rewrite_objective(linear, &products, offset)?;
    Some(tighter)
}
