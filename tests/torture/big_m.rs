//! Random programs with coefficients of 1e4 to 1e8 beside small ones: rows that binaries switch,
//! bounds of integers that only a large coefficient tells, and equalities over integers of wide
//! ranges.
//!
//! What is switched on or off is missed by little: by less than the integrality of a relaxed binary
//! is worth in its row.

use carom::prelude::VariableKind;

use super::generator::Random;
use crate::common::case::{Case, Column, Line};

/// Columns of a program by kind, in this order.
struct Columns {
    binaries: usize,
    /// Integers of narrow ranges.
    narrow: usize,
    /// Integers of wide ranges; each is fixed by an equality once those before it have values.
    wide: usize,
    continuous: usize,
}

impl Columns {
    fn count(&self) -> usize {
        self.binaries + self.narrow + self.wide + self.continuous
    }

    fn wide_at(&self, k: usize) -> usize {
        self.binaries + self.narrow + k
    }

    /// The columns without those of wide ranges.
    fn small(&self) -> Vec<usize> {
        let wide = self.binaries + self.narrow..self.binaries + self.narrow + self.wide;
        (0..self.count()).filter(|j| !wide.contains(j)).collect()
    }
}

/// The program of a seed.
pub(crate) fn big_m(seed: u64) -> Case {
    let r = &mut Random::new(seed ^ 0xb16_0000_0000);
    let shape = Columns {
        binaries: 1 + r.below(5),
        narrow: r.below(3),
        wide: r.below(3),
        continuous: r.below(4),
    };
    let columns = columns(r, &shape);
    let anchor: Vec<f64> = columns.iter().map(|column| anchored(r, column)).collect();
    let equalities = (0..shape.wide).map(|k| equality(r, &shape, &columns, &anchor, k));
    let mut lines: Vec<Line> = equalities.collect();
    for _ in 0..1 + r.below(5) {
        lines.push(switched(r, &shape, &anchor));
    }
    for _ in 0..r.below(3) {
        lines.push(small(r, &shape, &anchor));
    }
    let mut linear = vec![0.0; columns.len()];
    for cost in &mut linear {
        if r.chance(0.6) {
            *cost = f64::from(r.within(-50, 50));
        }
    }
    let maximize = r.chance(0.5);
    Case { columns, lines, switches: vec![], squares: vec![], linear, constant: 0.0, maximize }
}

fn columns(r: &mut Random, shape: &Columns) -> Vec<Column> {
    let mut columns = Vec::new();
    for _ in 0..shape.binaries {
        columns.push(Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 });
    }
    for _ in 0..shape.narrow {
        let lower = f64::from(r.within(-5, 3));
        let upper = lower + f64::from(r.within(1, 6));
        columns.push(Column { kind: VariableKind::Integer, lower, upper });
    }
    for _ in 0..shape.wide {
        let size = power_of_ten(r, 4, 9);
        let lower = if r.chance(0.5) { 0.0 } else { -size };
        columns.push(Column { kind: VariableKind::Integer, lower, upper: size + 7.0 });
    }
    for _ in 0..shape.continuous {
        let (mut lower, mut upper) = (f64::from(r.within(-8, 0)), f64::from(r.within(0, 30)));
        match r.below(8) {
            0 => lower = f64::NEG_INFINITY,
            1 => upper = f64::INFINITY,
            _ => {}
        }
        columns.push(Column { kind: VariableKind::Continuous, lower, upper });
    }
    columns
}

fn power_of_ten(r: &mut Random, low: i32, high: i32) -> f64 {
    10.0_f64.powi(r.within(low, high))
}

/// A coefficient of 1e4 to 1e8, often not a round number.
fn large(r: &mut Random) -> f64 {
    let power = power_of_ten(r, 4, 8);
    match r.below(4) {
        0 => power - f64::from(r.within(1, 9)),
        1 => power - 0.25 * f64::from(r.within(1, 9)),
        _ => power,
    }
}

fn sign(r: &mut Random) -> f64 {
    if r.chance(0.5) { 1.0 } else { -1.0 }
}

/// A point within the bounds.
fn anchored(r: &mut Random, column: &Column) -> f64 {
    let (lower, upper) = (column.lower.max(-9.0e9), column.upper.min(9.0e9));
    match column.kind {
        VariableKind::Continuous => {
            let value = lower.max(-8.0) + 0.25 * f64::from(r.within(0, 40));
            value.min(upper)
        }
        _ => {
            let width = (upper - lower).min(1e6) as i32;
            let from = if r.chance(0.5) { lower } else { upper - f64::from(width) };
            from + f64::from(r.within(0, width))
        }
    }
}

/// Small coefficients of some of the columns that are not wide.
fn coefficients(r: &mut Random, shape: &Columns, density: f64) -> Vec<f64> {
    let mut coefficients = vec![0.0; shape.count()];
    for j in shape.small() {
        if r.chance(density) {
            coefficients[j] = sign(r) * f64::from(r.within(1, 9));
        }
    }
    coefficients
}

fn activity(coefficients: &[f64], x: &[f64]) -> f64 {
    coefficients.iter().zip(x).map(|(a, x)| a * x).sum()
}

/// An equality for an integer of a wide range, over integers with whole coefficients.
fn equality(r: &mut Random, shape: &Columns, columns: &[Column], anchor: &[f64], k: usize) -> Line {
    let mut coefficients = coefficients(r, shape, 0.5);
    // The exact answer tries every value that is left: few, where at most one column moves
    // continuously.
    let mut room = usize::from(k == 0 && r.chance(0.3));
    for j in shape.count() - shape.continuous..shape.count() {
        let bounded = (columns[j].upper - columns[j].lower).is_finite();
        let kept = bounded && room > 0;
        room -= usize::from(kept);
        coefficients[j] = if kept { coefficients[j].signum() } else { 0.0 };
    }
    coefficients[shape.wide_at(k)] = sign(r) * f64::from(r.within(1, 7));
    if k > 0 && r.chance(0.6) {
        coefficients[shape.wide_at(k - 1)] = sign(r) * f64::from(r.within(1, 7));
    }
    if r.chance(0.6) {
        coefficients[r.below(shape.binaries)] = sign(r) * large(r).round();
    }
    let off = if r.chance(0.2) { f64::from(r.within(-3, 3)) } else { 0.0 };
    let right = activity(&coefficients, anchor) + off;
    Line { coefficients, lower: right, upper: right, scale: 1.0 }
}

/// A row that a binary switches, with a limit that is missed a little where it is off.
fn switched(r: &mut Random, shape: &Columns, anchor: &[f64]) -> Line {
    let density = [0.0, 0.2, 0.5][r.below(3)];
    let mut coefficients = coefficients(r, shape, density);
    let binary = r.below(shape.binaries);
    coefficients[binary] = 0.0;
    if shape.wide > 0 && r.chance(0.2) {
        coefficients[shape.wide_at(r.below(shape.wide))] = sign(r);
    }
    let base = activity(&coefficients, anchor);
    let missed = f64::from(r.within(-4, 40)) * [0.25, 1.0, 0.001_953_125][r.below(3)];
    let (big, is_upper, on) = (large(r), r.chance(0.5), r.chance(0.5));
    // Upper: terms + big z <= base + big - missed (off at 0), or terms - big z <= base - missed.
    let (coefficient, limit) = if on { (-big, base - missed) } else { (big, base + big - missed) };
    coefficients[binary] = coefficient;
    let limits = if is_upper { (f64::NEG_INFINITY, limit) } else { (-limit, f64::INFINITY) };
    if !is_upper {
        coefficients.iter_mut().for_each(|a| *a = -*a);
    }
    Line { coefficients, lower: limits.0, upper: limits.1, scale: 1.0 }
}

/// A row of small numbers.
fn small(r: &mut Random, shape: &Columns, anchor: &[f64]) -> Line {
    let mut coefficients = coefficients(r, shape, 0.6);
    if coefficients.iter().all(|&a| a == 0.0) {
        coefficients[0] = 1.0;
    }
    let base = activity(&coefficients, anchor);
    let (below, above) = (f64::from(r.within(-1, 6)), f64::from(r.within(-1, 6)));
    let (lower, upper) = match r.below(3) {
        0 => (base - below, f64::INFINITY),
        1 => (f64::NEG_INFINITY, base + above),
        _ => (base - below.abs(), base + above.abs()),
    };
    Line { coefficients, lower, upper, scale: 1.0 }
}
