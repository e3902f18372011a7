//! Random small programs.
//!
//! All numbers are small whole numbers and halves, and rows are scaled by powers of two. So a
//! program is either feasible or infeasible by a wide margin, one optimum is either equal to
//! another or visibly different, and no test has to argue about programs that a tolerance of 1e-6
//! could decide either way. The one exception are rows scaled down: a tolerance in their unit is a
//! distance in the variables' units; the comparison allows for it, see
//! [`relaxed_optimum`](super::enumeration::relaxed_optimum).

use carom::prelude::{Options, VariableKind};
use carom::solver::PoolMode;
use proptest::prelude::*;
use proptest::sample::select;

use super::case::{Case, Column, Line, Square, Switch};
use super::quadratic_program::dot;

/// Most columns of a case.
const COLUMNS: usize = 8;

/// Most continuous columns of a case: the exact method tries all sets of active constraints.
const CONTINUOUS: usize = 3;

/// Most assignments of the integers.
const ASSIGNMENTS: f64 = 96.0;

/// What kind of programs to generate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape {
    /// Continuous columns at all.
    pub(crate) continuous: bool,
    /// Infinite bounds of continuous columns.
    pub(crate) unbounded: bool,
    /// Squares in the objective.
    pub(crate) quadratic: bool,
    /// Any objective at all.
    pub(crate) objective: bool,
    /// Rows in other units, from 2^-13 (about 1e-4) to 2^17 (about 1e5).
    pub(crate) scaled: bool,
}

impl Shape {
    pub(crate) const LINEAR: Shape = Shape {
        continuous: true,
        unbounded: true,
        quadratic: false,
        objective: true,
        scaled: false,
    };
    pub(crate) const QUADRATIC: Shape = Shape { quadratic: true, ..Shape::LINEAR };
    pub(crate) const SCALED: Shape = Shape { scaled: true, quadratic: true, ..Shape::LINEAR };
    pub(crate) const BOUNDED: Shape = Shape { unbounded: false, ..Shape::QUADRATIC };
    pub(crate) const FEASIBILITY: Shape = Shape { objective: false, ..Shape::LINEAR };
}

/// A row before it is cut to the number of columns: coefficients, which sides it has, how far its
/// limits are from the activity of a common anchor point, a scale.
type RawLine = (Vec<f64>, u8, f64, f64, i32);

/// A program of a shape.
pub(crate) fn case(shape: Shape) -> impl Strategy<Value = Case> {
    let parts = (
        prop::collection::vec(column(shape), 1..=COLUMNS),
        prop::collection::vec(raw_line(shape), 0..=6),
        prop::collection::vec((0..COLUMNS, any::<bool>(), raw_line(shape)), 0..=3),
        prop::collection::vec((select(vec![0.5, 1.0, 2.0]), coefficients(0.5), halves(4)), 0..=3),
        (coefficients(0.7), halves(6), any::<bool>()),
        prop::collection::vec(-3i32..=3, COLUMNS),
        // Which row is copied, and with which factor.
        prop::option::weighted(0.3, (0usize..5, select(vec![-2.0, -1.0, 0.5, 1.0, 2.0]))),
    );
    parts.prop_map(move |(columns, rows, switches, squares, objective, anchor, copy)| {
        let columns = limited(columns);
        let n = columns.len();
        let anchor: Vec<f64> = (0..n).map(|j| anchored(&columns[j], anchor[j])).collect();
        let mut lines: Vec<Line> = rows.iter().filter_map(|raw| line(raw, n, &anchor)).collect();
        if let Some((which, factor)) = copy
            && let Some(original) = lines.get(which).cloned()
        {
            lines.push(multiple(&original, factor));
        }
        let switches = switches
            .iter()
            .filter_map(|(pick, on, raw)| switch(&columns, &anchor, *pick, *on, raw));
        let (linear, constant, maximize) = objective;
        let squares = squares.into_iter().map(|(weight, a, constant)| Square {
            weight,
            coefficients: a[..n].to_vec(),
            constant,
        });
        Case {
            switches: switches.collect(),
            squares: squares.filter(|_| shape.quadratic && shape.objective).collect(),
            linear: if shape.objective { linear[..n].to_vec() } else { vec![0.0; n] },
            constant,
            maximize,
            columns,
            lines,
        }
    })
}

fn column(shape: Shape) -> impl Strategy<Value = Column> {
    let column = |kind, lower, upper| Column { kind, lower, upper };
    let binary = prop_oneof![
        6 => Just((0.0, 1.0)),
        1 => Just((0.0, 0.0)),
        1 => Just((1.0, 1.0)),
    ]
    .prop_map(move |(lower, upper)| column(VariableKind::Binary, lower, upper));
    // Some bounds are not whole, and some such ranges hold no whole number.
    let integer = (-4i32..=3, 0i32..=4, 0i32..8).prop_map(move |(lower, width, part)| {
        let offset = if part == 0 { 0.5 } else { 0.0 };
        let lower = f64::from(lower) - offset;
        let width = if part == 0 && width > 0 { width - 1 } else { width };
        column(VariableKind::Integer, lower, lower + f64::from(width) + 0.5 * offset)
    });
    let continuous = (-6i32..=6, 0i32..=8, 0u8..12).prop_map(move |(lower, width, open)| {
        let (lower, upper) = (0.5 * f64::from(lower), 0.5 * f64::from(lower + width));
        let (lower, upper) = match open {
            0 if shape.unbounded => (f64::NEG_INFINITY, upper),
            1 if shape.unbounded => (lower, f64::INFINITY),
            2 if shape.unbounded => (f64::NEG_INFINITY, f64::INFINITY),
            _ => (lower, upper),
        };
        column(VariableKind::Continuous, lower, upper)
    });
    let weight = if shape.continuous { 3 } else { 0 };
    prop_oneof![4 => binary, 2 => integer, weight => continuous]
}

fn coefficients(density: f64) -> impl Strategy<Value = Vec<f64>> {
    let entry =
        prop::option::weighted(density, select(vec![1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 0.5, -1.5]));
    prop::collection::vec(entry.prop_map(|a| a.unwrap_or(0.0)), COLUMNS)
}

fn halves(most: i32) -> impl Strategy<Value = f64> {
    (-2 * most..=2 * most).prop_map(|v| 0.5 * f64::from(v))
}

fn raw_line(shape: Shape) -> impl Strategy<Value = RawLine> {
    let slack = || select(vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 2.0, 3.0, 5.0, -0.5, -1.0, -4.0]);
    let scale = if shape.scaled { -13..=17 } else { 0..=0 };
    (coefficients(0.5), 0u8..6, slack(), slack(), scale)
}

/// Keeps the exact method fast: later columns are fixed or made binary where there are too many
/// continuous ones or too many assignments.
fn limited(mut columns: Vec<Column>) -> Vec<Column> {
    let (mut continuous, mut assignments) = (0, 1.0);
    for column in &mut columns {
        if column.kind == VariableKind::Continuous {
            continuous += 1;
            if continuous > CONTINUOUS {
                *column = Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 };
            }
        }
        if column.kind != VariableKind::Continuous {
            let count = (column.upper.floor() - column.lower.ceil() + 1.0).max(1.0);
            if assignments * count > ASSIGNMENTS {
                column.lower = column.lower.ceil();
                column.upper = column.lower;
            } else {
                assignments *= count;
            }
        }
    }
    columns
}

/// A value inside a column's bounds.
fn anchored(column: &Column, value: i32) -> f64 {
    let whole = f64::from(value);
    if column.kind == VariableKind::Continuous {
        return whole.max(column.lower).min(column.upper);
    }
    whole.max(column.lower.ceil()).min(column.upper.floor())
}

/// A row whose limits lie around its activity at the anchor; nothing without a coefficient.
fn line(raw: &RawLine, n: usize, anchor: &[f64]) -> Option<Line> {
    let (coefficients, sides, below, above, scale) = raw;
    let coefficients = coefficients[..n].to_vec();
    if coefficients.iter().all(|&a| a == 0.0) {
        return None;
    }
    let activity = dot(&coefficients, anchor);
    let (lower, upper) = match sides {
        0 | 1 => (f64::NEG_INFINITY, activity + above),
        2 | 3 => (activity - below, f64::INFINITY),
        4 => (activity + above.max(0.0), activity + above.max(0.0)),
        _ => (activity - below.abs(), activity + above.abs()),
    };
    Some(Line { coefficients, lower, upper, scale: 2.0_f64.powi(*scale) })
}

fn multiple(line: &Line, factor: f64) -> Line {
    let (p, q) = (line.lower * factor, line.upper * factor);
    Line {
        coefficients: line.coefficients.iter().map(|a| a * factor).collect(),
        lower: p.min(q),
        upper: p.max(q),
        scale: line.scale,
    }
}

/// An indicator on the first binary from `pick` on. Its row keeps bounded columns only, for a
/// big-M needs bounds; the binary itself may be among them.
fn switch(
    columns: &[Column],
    anchor: &[f64],
    pick: usize,
    on: bool,
    raw: &RawLine,
) -> Option<Switch> {
    let n = columns.len();
    let is_binary = |&j: &usize| columns[j].kind == VariableKind::Binary;
    let binary = (0..n).map(|k| (pick + k) % n).find(is_binary)?;
    let mut raw = raw.clone();
    for (a, column) in raw.0.iter_mut().zip(columns) {
        if column.lower.is_infinite() || column.upper.is_infinite() {
            *a = 0.0;
        }
    }
    Some(Switch { binary, on, line: line(&raw, n, anchor)? })
}

/// Unusual ways to search.
pub(crate) fn unusual_options() -> impl Strategy<Value = Options> {
    let switches = prop::collection::vec(any::<bool>(), 5);
    (switches, 1_usize..3, 1_usize..4).prop_map(|(on, threads, pool)| {
        let mode = if on[0] { PoolMode::Best } else { PoolMode::Found };
        Options::default()
            .with_presolve(on[1])
            .with_cuts(on[2])
            .with_deterministic(on[3])
            .with_leaves(on[4])
            .with_threads(threads)
            .with_pool(pool, mode)
    })
}
