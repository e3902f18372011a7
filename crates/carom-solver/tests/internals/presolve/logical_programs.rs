//! Random programs made of logic: codes of binaries, conjunctions, rows that hold a column.

use carom::prelude::VariableKind;
use proptest::prelude::*;

use crate::common::case::{Case, Column, Line};

fn column(kind: VariableKind, lower: f64, upper: f64) -> Column {
    Column { kind, lower, upper }
}

fn line(coefficients: &[f64], lower: f64, upper: f64) -> Line {
    Line { coefficients: coefficients.to_vec(), lower, upper, scale: 1.0 }
}

fn case(columns: Vec<Column>, lines: Vec<Line>, costs: &[i8]) -> Case {
    let linear = costs.iter().take(columns.len()).map(|&c| f64::from(c)).collect();
    let (switches, squares) = (Vec::new(), Vec::new());
    Case { columns, lines, switches, squares, linear, constant: 1.0, maximize: false }
}

fn costs() -> impl Strategy<Value = Vec<i8>> {
    prop::collection::vec(prop_oneof![2 => Just(0i8), 3 => -3i8..=3], 8)
}

/// Further rows over some columns: `-room <= a'x <= room`.
fn extra(rows: &[(Vec<i8>, u8)], columns: &[usize], count: usize) -> Vec<Line> {
    let line = |(a, room): &(Vec<i8>, u8)| {
        let mut coefficients = vec![0.0; count];
        columns.iter().zip(a).for_each(|(&j, &a)| coefficients[j] = f64::from(a));
        line(&coefficients, f64::NEG_INFINITY, f64::from(*room))
    };
    let lines = rows.iter().map(line);
    lines.filter(|line| line.coefficients.iter().any(|a| *a != 0.0)).collect()
}

fn rows() -> impl Strategy<Value = Vec<(Vec<i8>, u8)>> {
    prop::collection::vec((prop::collection::vec(-3i8..=3, 8), 0u8..4), 0..3)
}

/// Exactly one of up to four columns, told by two binaries; the codes are distinct or not.
pub(crate) fn coded() -> impl Strategy<Value = Case> {
    let codes = prop_oneof![
        4 => Just(vec![0u8, 1, 2, 3]).prop_shuffle(),
        1 => prop::collection::vec(0u8..4, 4),
    ];
    (codes, 2usize..=4, costs(), rows(), any::<bool>(), any::<bool>()).prop_map(
        |(codes, members, mut costs, rows, tops, priced)| {
            let top = if tops { 1.0 } else { f64::INFINITY };
            let mut columns: Vec<Column> =
                (0..members).map(|_| column(VariableKind::Continuous, 0.0, top)).collect();
            columns.extend((0..2).map(|_| column(VariableKind::Binary, 0.0, 1.0)));
            columns.push(column(VariableKind::Integer, 0.0, 2.0));
            let count = columns.len();
            let mut one = vec![0.0; count];
            one[..members].fill(1.0);
            let mut lines = vec![line(&one, 1.0, 1.0)];
            for bit in 0..2 {
                let (mut inside, mut outside) = (vec![0.0; count], vec![0.0; count]);
                (inside[members + bit], outside[members + bit]) = (-1.0, 1.0);
                for (j, code) in codes.iter().enumerate().take(members) {
                    let side = if code >> bit & 1 == 1 { &mut inside } else { &mut outside };
                    side[j] = 1.0;
                }
                lines.push(line(&inside, f64::NEG_INFINITY, 0.0));
                lines.push(line(&outside, f64::NEG_INFINITY, 1.0));
            }
            if !priced {
                costs[members..members + 2].fill(0);
            }
            let others: Vec<usize> = (0..members).chain([count - 1]).collect();
            lines.extend(extra(&rows, &others, count));
            case(columns, lines, &costs)
        },
    )
}

/// Columns below binaries, and above columns, of which at least one is wanted.
pub(crate) fn conjunctions() -> impl Strategy<Value = Case> {
    let below = prop::collection::vec((0usize..3, 0usize..4, any::<bool>()), 1..7);
    (below, costs(), rows(), any::<bool>()).prop_map(|(below, costs, rows, cover)| {
        let mut columns: Vec<Column> =
            (0..3).map(|_| column(VariableKind::Continuous, 0.0, 1.0)).collect();
        columns.extend((0..3).map(|_| column(VariableKind::Binary, 0.0, 1.0)));
        columns.push(column(VariableKind::Continuous, -2.0, 2.0));
        let count = columns.len();
        let mut lines = Vec::new();
        for (x, z, holds) in below {
            let mut coefficients = vec![0.0; count];
            (coefficients[x], coefficients[3 + z]) = (1.0, -1.0);
            if holds {
                coefficients.iter_mut().for_each(|a| *a = -*a);
            }
            lines.push(line(&coefficients, f64::NEG_INFINITY, 0.0));
        }
        if cover {
            lines.push(line(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0], 1.0, f64::INFINITY));
        }
        lines.extend(extra(&rows, &[0, 3, 4, 5, 6], count));
        case(columns, lines, &costs)
    })
}

/// One of several binaries is 1, and each holds a column within limits of its own; some cost.
pub(super) fn selections() -> impl Strategy<Value = Case> {
    let term = (0.0..6.0_f64, 0.0..6.0_f64, 0..3_u8);
    (prop::collection::vec(term, 3..=4), -2.0..2.0_f64).prop_map(|(terms, slope)| {
        let count = terms.len();
        let binary = Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 };
        let free = Column { kind: VariableKind::Continuous, lower: 0.0, upper: 10.0 };
        let columns = [vec![binary; count], vec![free]].concat();
        let entries = |pairs: &[(usize, f64)]| {
            let mut coefficients = vec![0.0; count + 1];
            pairs.iter().for_each(|(j, a)| coefficients[*j] = *a);
            coefficients
        };
        let line = |pairs: &[(usize, f64)], lower, upper| Line {
            coefficients: entries(pairs),
            lower,
            upper,
            scale: 1.0,
        };
        let all: Vec<(usize, f64)> = (0..count).map(|j| (j, 1.0)).collect();
        let mut lines = vec![line(&all, 1.0, 1.0)];
        let mut linear = entries(&[(count, slope)]);
        for (j, (low, width, cost)) in terms.into_iter().enumerate() {
            let (low, high) = (low, (low + width).min(10.0));
            lines.push(line(&[(count, 1.0), (j, -low)], 0.0, f64::INFINITY));
            lines.push(line(&[(count, 1.0), (j, 10.0 - high)], f64::NEG_INFINITY, 10.0));
            linear[j] = f64::from(cost);
        }
        let (switches, squares) = (Vec::new(), Vec::new());
        Case { columns, lines, switches, squares, linear, constant: 0.0, maximize: false }
    })
}

/// Two stages, each with up to three routes of which one is taken, or at most one; each route has a
/// row of its own for the time that it takes.
pub(super) fn routes() -> impl Strategy<Value = Case> {
    let stage = (prop::collection::vec((0i8..=6, -3i8..=3), 2..=3), any::<bool>(), any::<bool>());
    let end = (-2i8..=3, 0u8..12);
    (stage.clone(), stage, end, rows()).prop_map(|(first, second, (cost, end), rows)| {
        let (a, b) = (first.0.len(), second.0.len());
        let mut columns: Vec<Column> =
            (0..3).map(|_| column(VariableKind::Continuous, 0.0, 15.0)).collect();
        columns.extend((0..a + b).map(|_| column(VariableKind::Binary, 0.0, 1.0)));
        let count = columns.len();
        let (mut lines, mut linear) = (Vec::new(), vec![0.0; count]);
        for (k, begin, (routes, is_taken, is_below)) in [(0, 3, first), (1, 3 + a, second)] {
            let mut one = vec![0.0; count];
            one[begin..begin + routes.len()].fill(1.0);
            lines.push(line(&one, if is_taken { 1.0 } else { f64::NEG_INFINITY }, 1.0));
            for (j, (duration, own)) in routes.into_iter().enumerate() {
                let mut coefficients = vec![0.0; count];
                let sign = if is_below { -1.0 } else { 1.0 };
                (coefficients[k], coefficients[k + 1]) = (sign, -sign);
                coefficients[begin + j] = sign * f64::from(duration);
                let (lower, upper) = match is_below {
                    true => (0.0, f64::INFINITY),
                    false => (f64::NEG_INFINITY, 0.0),
                };
                lines.push(line(&coefficients, lower, upper));
                linear[begin + j] = f64::from(own);
            }
        }
        let mut last = vec![0.0; count];
        last[2] = 1.0;
        lines.push(line(&last, f64::from(end), f64::INFINITY));
        lines.extend(extra(&rows, &[0, 1, 2, 3, 4, 5, 6], count));
        linear[2] = f64::from(cost);
        let (switches, squares) = (Vec::new(), Vec::new());
        Case { columns, lines, switches, squares, linear, constant: 0.0, maximize: false }
    })
}
