//! Random programs that are meant to hurt: up to 12 integers, indicators, equalities, free
//! columns, copies and sums of rows, coefficients from 1e-4 to 1e5 by row or one by one, squared,
//! linear or no objectives, many of them infeasible or unbounded.
//!
//! A program is a function of its seed. All numbers are small whole numbers times powers of two,
//! so that the exact oracle needs few digits.

use carom::prelude::VariableKind;

use crate::common::case::{Case, Column, Line, Square, Switch};
use crate::common::quadratic_program::dot;

/// Most assignments of the integers without and with continuous columns.
const ASSIGNMENTS: [f64; 2] = [4096.0, 1024.0];

/// Numbers from a seed (SplitMix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        random.next();
        random
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Within `0..count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }

    /// Within `low..=high`.
    pub(crate) fn within(&mut self, low: i32, high: i32) -> i32 {
        low + self.below((high - low + 1) as usize) as i32
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64 <= probability
    }
}

/// How coefficients are spread.
#[derive(Clone, Copy)]
enum Scaling {
    Even,
    /// One power of two a row.
    ByRow,
    /// One a coefficient.
    Wild,
}

/// The program of a seed.
pub(crate) fn program(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let scaling = [Scaling::Even, Scaling::ByRow, Scaling::Wild][r.below(3)];
    scaled(r, scaling)
}

/// The program of a seed without large or small coefficients.
fn even(seed: u64) -> Case {
    scaled(&mut Random::new(seed), Scaling::Even)
}

fn scaled(r: &mut Random, scaling: Scaling) -> Case {
    let columns = columns(r);
    let n = columns.len();
    let anchor: Vec<f64> = columns.iter().map(|column| anchored(r, column)).collect();
    let mut lines = Vec::new();
    for _ in 0..r.below(8) {
        lines.push(line(r, &columns, &anchor, scaling));
    }
    // Degenerate rows: copies and sums, a little moved or not.
    if lines.len() >= 2 && r.chance(0.4) {
        let (a, b) = (r.below(lines.len()), r.below(lines.len()));
        let sum = sum(&lines[a], &lines[b], f64::from(r.within(-2, 2)));
        lines.extend(sum);
    }
    let binaries: Vec<usize> =
        (0..n).filter(|&j| columns[j].kind == VariableKind::Binary).collect();
    let mut switches = Vec::new();
    if !binaries.is_empty() {
        for _ in 0..r.below(5) {
            let (binary, on) = (binaries[r.below(binaries.len())], r.chance(0.6));
            if let Some(line) = switched(r, &columns, &anchor, binary, scaling) {
                switches.push(Switch { binary, on, line });
            }
        }
    }
    let objective = r.below(4);
    let mut squares = Vec::new();
    if objective >= 2 {
        for _ in 0..1 + r.below(4) {
            let weight = 2.0_f64.powi(r.within(-4, 4));
            let coefficients = coefficients(r, &columns, 0.5, Scaling::Even);
            squares.push(Square { weight, coefficients, constant: f64::from(r.within(-6, 6)) });
        }
    }
    let linear = match objective {
        0 => vec![0.0; n],
        _ => coefficients(r, &columns, 0.7, if objective == 3 { Scaling::Even } else { scaling }),
    };
    let constant = if r.chance(0.3) { f64::from(r.within(-50, 50)) } else { 0.0 };
    Case { columns, lines, switches, squares, linear, constant, maximize: r.chance(0.5) }
}

/// The program of a seed with terms of 1e6 to 1e10: the origins of its columns are moved, and
/// binaries get large coefficients. The optimum is that of the program around the old origins.
pub(crate) fn large(seed: u64) -> Case {
    let mut case = even(seed);
    let r = &mut Random::new(!seed);
    let binaries: Vec<usize> =
        (0..case.columns.len()).filter(|&j| case.columns[j].kind == VariableKind::Binary).collect();
    for line in &mut case.lines {
        if binaries.is_empty() || r.chance(0.6) {
            continue;
        }
        // A row that is only there, or only not, where the binary is on.
        let (j, big) = (binaries[r.below(binaries.len())], f64::from(r.within(1, 9)));
        let big = big * 10.0_f64.powi(r.within(6, 9));
        let (on, above) = (r.chance(0.5), r.chance(0.5));
        line.coefficients[j] += if on == above { big } else { -big };
        let moved = if above { big } else { -big } * f64::from(u8::from(on));
        if above {
            (line.lower, line.upper) = (f64::NEG_INFINITY, line.upper + moved);
        } else {
            (line.lower, line.upper) = (line.lower + moved, f64::INFINITY);
        }
    }
    case.lines.retain(|line| line.lower.is_finite() || line.upper.is_finite());
    let moves: Vec<f64> = case.columns.iter().map(|column| origin(r, column)).collect();
    for (column, by) in case.columns.iter_mut().zip(&moves) {
        (column.lower, column.upper) = (column.lower + by, column.upper + by);
    }
    let switched = case.switches.iter_mut().map(|switch| &mut switch.line);
    for line in case.lines.iter_mut().chain(switched) {
        let by = dot(&line.coefficients, &moves);
        (line.lower, line.upper) = (line.lower + by, line.upper + by);
    }
    // Squares of such numbers have more digits than a float.
    case.squares.clear();
    case.constant -= dot(&case.linear, &moves);
    case
}

/// How far a column is moved: all sums remain whole numbers of quarters that a float holds.
fn origin(r: &mut Random, column: &Column) -> f64 {
    let bounded = column.lower.is_finite() && column.upper.is_finite();
    if column.kind == VariableKind::Binary || r.chance(0.2) {
        return 0.0;
    }
    let digits = r.within(5, if bounded { 8 } else { 7 });
    f64::from(r.within(-9, 9)) * 10.0_f64.powi(digits)
}

fn columns(r: &mut Random) -> Vec<Column> {
    let continuous = r.below(4);
    let (integers, most) = (r.below(13), ASSIGNMENTS[usize::from(continuous > 0)]);
    let (mut columns, mut assignments) = (Vec::new(), 1.0);
    let general = r.chance(0.5);
    for _ in 0..integers {
        let column = if general && r.chance(0.4) {
            let (lower, width) = (f64::from(r.within(-9, 5)), f64::from(r.within(0, 9)));
            // Some bounds are not whole, and some ranges hold no whole number.
            let off = if r.chance(0.1) { 0.5 } else { 0.0 };
            let upper = (lower + width - off).max(lower + off);
            Column { kind: VariableKind::Integer, lower: lower + off, upper }
        } else {
            let fixed = r.below(20);
            let (lower, upper) = (f64::from(fixed == 1), f64::from(fixed != 0));
            Column { kind: VariableKind::Binary, lower, upper: upper.max(lower) }
        };
        let width = column.upper.floor() - column.lower.ceil() + 1.0;
        if assignments * width <= most {
            assignments *= width.max(1.0);
            columns.push(column);
        }
    }
    for _ in 0..continuous {
        let unit = 2.0_f64.powi(if r.chance(0.3) { r.within(-8, 8) } else { 0 });
        let (a, b) = (f64::from(r.within(-12, 8)), f64::from(r.within(0, 20)));
        let (mut lower, mut upper) = (a * unit, (a + b) * unit);
        match r.below(6) {
            0 => lower = f64::NEG_INFINITY,
            1 => upper = f64::INFINITY,
            2 => (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY),
            _ => {}
        }
        columns.push(Column { kind: VariableKind::Continuous, lower, upper });
    }
    if columns.is_empty() {
        columns.push(Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 });
    }
    // In no particular order.
    for i in (1..columns.len()).rev() {
        columns.swap(i, r.below(i + 1));
    }
    columns
}

/// A point within the bounds, for limits that it keeps.
fn anchored(r: &mut Random, column: &Column) -> f64 {
    let within = |value: f64| value.max(column.lower).min(column.upper);
    if column.kind == VariableKind::Continuous {
        let (lower, upper) = (column.lower, column.upper);
        let step = if lower.is_finite() && upper.is_finite() { (upper - lower) / 8.0 } else { 0.5 };
        let from = if lower.is_finite() { lower } else { within(0.0) };
        return within(from + step * f64::from(r.within(0, 8)));
    }
    let count = (column.upper.floor() - column.lower.ceil()).max(0.0) as usize + 1;
    column.lower.ceil() + r.below(count) as f64
}

fn coefficients(r: &mut Random, columns: &[Column], density: f64, scaling: Scaling) -> Vec<f64> {
    let common = match scaling {
        Scaling::ByRow => r.within(-13, 13),
        _ => 0,
    };
    let coefficient = |_: &Column| {
        if !r.chance(density) {
            return 0.0;
        }
        let exponent = match scaling {
            Scaling::Wild => r.within(-13, 13),
            _ => common,
        };
        f64::from(r.within(1, 9)) * 2.0_f64.powi(exponent) * if r.chance(0.5) { 1.0 } else { -1.0 }
    };
    columns.iter().map(coefficient).collect()
}

/// A row around the anchor: it keeps the row, is a little off, or far off.
fn line(r: &mut Random, columns: &[Column], anchor: &[f64], scaling: Scaling) -> Line {
    let density = [0.3, 0.6, 0.9][r.below(3)];
    let mut coefficients = coefficients(r, columns, density, scaling);
    if coefficients.iter().all(|&a| a == 0.0) {
        coefficients[r.below(columns.len())] = 1.0;
    }
    let activity = dot(&coefficients, anchor);
    let unit = coefficients.iter().map(|a| a.abs()).fold(0.0, f64::max);
    let unit = 2.0_f64.powi(unit.log2().floor() as i32);
    let off = if r.chance(0.12) { f64::from(r.within(-8, 8)) * 0.5 * unit } else { 0.0 };
    let slack = |r: &mut Random| f64::from(r.within(0, 8)) * 0.25 * unit;
    let (mut lower, mut upper) = (activity + off - slack(r), activity + off + slack(r));
    match r.below(8) {
        0 | 1 => (lower, upper) = (activity + off, activity + off),
        2 | 3 => lower = f64::NEG_INFINITY,
        4 | 5 => upper = f64::INFINITY,
        6 => lower = upper,
        _ => {}
    }
    Line { coefficients, lower, upper, scale: 1.0 }
}

/// `a + factor * b`, which follows from the two.
fn sum(a: &Line, b: &Line, factor: f64) -> Option<Line> {
    let pairs = a.coefficients.iter().zip(&b.coefficients);
    let coefficients: Vec<f64> = pairs.map(|(a, b)| a + factor * b).collect();
    let (low, high) = if factor < 0.0 { (b.upper, b.lower) } else { (b.lower, b.upper) };
    let add = |a: f64, b: f64| if factor == 0.0 { a } else { a + factor * b };
    let (lower, upper) = (add(a.lower, low), add(a.upper, high));
    let open = lower == f64::NEG_INFINITY && upper == f64::INFINITY;
    let usable = !open && coefficients.iter().any(|&a| a != 0.0);
    usable.then_some(Line { coefficients, lower, upper, scale: 1.0 })
}

/// The row of an indicator: over bounded columns, which its big-M needs, without its binary.
fn switched(
    r: &mut Random,
    columns: &[Column],
    anchor: &[f64],
    binary: usize,
    scaling: Scaling,
) -> Option<Line> {
    let mut line = line(r, columns, anchor, scaling);
    for (j, column) in columns.iter().enumerate() {
        let open = !(column.lower.is_finite() && column.upper.is_finite());
        if (open || j == binary) && line.coefficients[j] != 0.0 {
            let moved = line.coefficients[j] * anchor[j];
            line.coefficients[j] = 0.0;
            (line.lower, line.upper) = (line.lower - moved, line.upper - moved);
        }
    }
    line.coefficients.iter().any(|&a| a != 0.0).then_some(line)
}
