//! Random programs made of what the rules look for.

use carom::prelude::VariableKind;
use proptest::prelude::*;

use crate::common::case::{Case, Column, Line, Square};

/// Columns of a program, and the most continuous ones: the exact method tries all sets of active
/// constraints.
const COLUMNS: usize = 7;
const CONTINUOUS: usize = 4;

/// What a row is made of, before it is cut to size.
#[derive(Debug, Clone)]
struct RawRow {
    kind: u8,
    coefficients: Vec<i8>,
    columns: [usize; 3],
    room: (u8, u8),
}

fn raw_row() -> impl Strategy<Value = RawRow> {
    let coefficients = prop::collection::vec(-3i8..=3, COLUMNS);
    let columns = [0..COLUMNS, 0..COLUMNS, 0..COLUMNS];
    (0u8..10, coefficients, columns, (0u8..5, 0u8..5)).prop_map(
        |(kind, coefficients, columns, room)| RawRow { kind, coefficients, columns, room },
    )
}

/// A program with chains of equalities, single columns, multiples of rows and columns, and rows
/// that bounds imply.
pub(crate) fn program(curved: bool) -> impl Strategy<Value = Case> {
    let column = (0u8..7, -2i8..=2, 0u8..4, 0u8..4);
    let columns = prop::collection::vec(column, COLUMNS);
    let rows = prop::collection::vec(raw_row(), 1..7);
    let costs = prop::collection::vec(prop_oneof![2 => Just(0i8), 3 => -3i8..=3], COLUMNS);
    let square = (prop::collection::vec(-1i8..=1, COLUMNS), -2i8..=2);
    let squares = prop::collection::vec(square, if curved { 1..3 } else { 0..1 });
    let twin =
        prop::option::of((0..COLUMNS, 0..COLUMNS, prop_oneof![Just(1i8), Just(-1), Just(2)]));
    (columns, rows, costs, squares, twin).prop_map(|(columns, rows, costs, squares, twin)| {
        build(&columns, &rows, costs, &squares, twin)
    })
}

/// The columns, and a point inside their bounds.
fn columns_at(raw: &[(u8, i8, u8, u8)]) -> (Vec<Column>, Vec<f64>) {
    let (mut columns, mut anchor) = (Vec::new(), Vec::new());
    let mut continuous = 0;
    for &(kind, at, below, above) in raw {
        let at = f64::from(at);
        let (below, above) = (at - f64::from(below), at + f64::from(above));
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let kind = if kind < 5 && continuous == CONTINUOUS { 5 } else { kind };
        continuous += usize::from(kind < 5);
        let (kind, lower, upper) = match kind {
            0 | 1 => (VariableKind::Continuous, below, above),
            2 => (VariableKind::Continuous, low, high),
            3 => (VariableKind::Continuous, below, high),
            4 => (VariableKind::Continuous, low, above),
            5 => (VariableKind::Binary, 0.0, 1.0),
            _ => (VariableKind::Integer, at, above),
        };
        columns.push(Column { kind, lower, upper });
        anchor.push(at.clamp(lower, upper));
    }
    (columns, anchor)
}

/// The coefficients of a row, and whether it is an equality.
fn coefficients(row: &RawRow, columns: &[Column], lines: &[Line]) -> (Vec<f64>, bool) {
    let mut coefficients = vec![0.0; COLUMNS];
    let [a, b, c] = row.columns;
    let value = |k: usize| {
        let v = f64::from(row.coefficients[k]);
        if v == 0.0 { 1.0 } else { v }
    };
    let mut equal = false;
    match row.kind {
        0 | 1 => {
            (coefficients[a], coefficients[b], equal) = (value(0), value(1), true);
        }
        2 | 3 => {
            (coefficients[a], coefficients[b], coefficients[c]) = (value(0), value(1), value(2));
            equal = true;
        }
        4 => coefficients[a] = value(0),
        5 if !lines.is_empty() => {
            let other = &lines[a % lines.len()].coefficients;
            coefficients = other.iter().map(|v| v * 2.0 * value(0)).collect();
        }
        6 => {
            for (v, column) in coefficients.iter_mut().zip(columns) {
                *v = f64::from(u8::from(column.kind == VariableKind::Binary));
            }
        }
        _ => {
            let pairs = coefficients.iter_mut().zip(&row.coefficients);
            pairs.for_each(|(v, &a)| *v = f64::from(a));
        }
    }
    (coefficients, equal)
}

fn build(
    raw: &[(u8, i8, u8, u8)],
    rows: &[RawRow],
    mut costs: Vec<i8>,
    squares: &[(Vec<i8>, i8)],
    twin: Option<(usize, usize, i8)>,
) -> Case {
    let (columns, anchor) = columns_at(raw);
    let mut lines: Vec<Line> = Vec::new();
    for row in rows {
        let (coefficients, equal) = coefficients(row, &columns, &lines);
        let activity: f64 = coefficients.iter().zip(&anchor).map(|(a, x)| a * x).sum();
        let side = |room: u8| if room == 4 { f64::INFINITY } else { f64::from(room) };
        let (mut lower, mut upper) = (activity - side(row.room.0), activity + side(row.room.1));
        if equal {
            (lower, upper) = (activity, activity);
        }
        if coefficients.iter().all(|a| *a == 0.0) || (lower.is_infinite() && upper.is_infinite()) {
            continue;
        }
        lines.push(Line { coefficients, lower, upper, scale: 1.0 });
    }
    if let Some((from, to, ratio)) = twin.filter(|(from, to, _)| from != to) {
        for line in &mut lines {
            line.coefficients[to] = f64::from(ratio) * line.coefficients[from];
        }
        lines.retain(|line| line.coefficients.iter().any(|a| *a != 0.0));
        costs[to] = ratio * costs[from];
    }
    let squares = squares.iter().map(|(coefficients, constant)| Square {
        weight: 1.0,
        coefficients: coefficients.iter().map(|&a| f64::from(a)).collect(),
        constant: f64::from(*constant),
    });
    Case {
        columns,
        lines,
        switches: Vec::new(),
        squares: squares.filter(|s| s.coefficients.iter().any(|a| *a != 0.0)).collect(),
        linear: costs.into_iter().map(f64::from).collect(),
        constant: 1.0,
        maximize: false,
    }
}
