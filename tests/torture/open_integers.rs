//! Equalities over whole numbers with integers without bounds, and their exact answers.
//!
//! The open integers can all grow together along one direction that no equality notices. So their
//! bounds below and rows that ask for much of them exclude nothing, and for each value of the
//! others the question is whether the equalities have a solution in whole numbers: by elimination,
//! exactly.

use carom::prelude::VariableKind;

use super::families::BINARY;
use super::generator::Random;
use super::oracle::Truth;
use crate::common::case::{Case, Column, Line};
use crate::common::quadratic_program::dot;

pub(super) fn program(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let (bounded, open) = (1 + r.below(3), 2 + r.below(2));
    let mut columns: Vec<Column> = (0..bounded)
        .map(|_| {
            let lower = f64::from(r.within(-2, 2));
            match r.chance(0.7) {
                true => BINARY,
                false => Column { kind: VariableKind::Integer, lower, upper: lower + 2.0 },
            }
        })
        .collect();
    for _ in 0..open {
        let lower = [0.0, -5.0, f64::NEG_INFINITY][r.below(3)];
        columns.push(Column { kind: VariableKind::Integer, lower, upper: f64::INFINITY });
    }
    // A continuous column that the first one decides.
    let times = r.chance(0.3).then(|| f64::from(r.within(1, 3)));
    if times.is_some() {
        let (lower, upper) = (-20.0, 20.0);
        columns.push(Column { kind: VariableKind::Continuous, lower, upper });
    }
    let n = columns.len();
    let growth: Vec<i32> = (1..open).map(|_| r.within(1, 3)).chain([1]).collect();
    let mut lines = Vec::new();
    for _ in 0..(1 + r.below(2)).min(open - 1) {
        let mut whole: Vec<i32> = (1..open).map(|_| r.within(-6, 6)).collect();
        whole.push(-whole.iter().zip(&growth).map(|(m, p)| m * p).sum::<i32>());
        let mut coefficients: Vec<f64> = (0..bounded).map(|_| f64::from(r.within(-4, 4))).collect();
        coefficients.extend(whole.into_iter().map(f64::from));
        coefficients.resize(n, 0.0);
        if times.is_some() {
            coefficients[n - 1] = f64::from(r.within(-2, 2));
        }
        if coefficients.iter().all(|a| *a == 0.0) {
            continue;
        }
        let scale = [1.0, 1.0, 500.0, 1000.0][r.below(4)];
        let limit = scale * f64::from(r.within(-12, 12));
        coefficients.iter_mut().for_each(|a| *a *= scale);
        lines.push(Line { coefficients, lower: limit, upper: limit, scale: 1.0 });
    }
    if let Some(times) = times {
        let mut coefficients = vec![0.0; n];
        (coefficients[n - 1], coefficients[0]) = (1.0, -times);
        lines.push(Line { coefficients, lower: 0.0, upper: 0.0, scale: 1.0 });
    }
    if r.chance(0.5) {
        let mut coefficients = vec![0.0; n];
        for a in coefficients.iter_mut().skip(bounded).take(open) {
            *a = f64::from(r.within(1, 3));
        }
        let lower = f64::from(r.within(0, 9));
        lines.push(Line { coefficients, lower, upper: f64::INFINITY, scale: 1.0 });
    }
    let mut linear: Vec<f64> = (0..bounded).map(|_| 0.5 * f64::from(r.within(-4, 4))).collect();
    linear.resize(n, 0.0);
    let (switches, squares) = (Vec::new(), Vec::new());
    Case { columns, lines, switches, squares, linear, constant: 0.0, maximize: r.chance(0.3) }
}

pub(super) fn truth(case: &Case) -> Truth {
    let is_bounded = |column: &Column| column.lower.is_finite() && column.upper.is_finite();
    let n = case.columns.len();
    let (mut bounded, mut open) = (Vec::new(), Vec::new());
    for (j, column) in case.columns.iter().enumerate() {
        match column.kind {
            VariableKind::Continuous => {}
            _ if is_bounded(column) => bounded.push(j),
            _ => open.push(j),
        }
    }
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut x: Vec<f64> = vec![0.0; n];
    bounded.iter().for_each(|&j| x[j] = case.columns[j].lower);
    loop {
        for j in (0..n).filter(|&j| case.columns[j].kind == VariableKind::Continuous) {
            // The equality that decides it.
            let decides = |line: &&Line| {
                line.coefficients[j] == 1.0 && open.iter().all(|&k| line.coefficients[k] == 0.0)
            };
            let line = case.lines.iter().rfind(decides).expect("an equality");
            x[j] = 0.0;
            x[j] = line.lower - dot(&line.coefficients, &x);
        }
        let equalities = case.lines.iter().filter(|line| line.lower == line.upper);
        let rows: Vec<(Vec<i128>, i128)> = equalities
            .map(|line| {
                let of_open = open.iter().map(|&j| line.coefficients[j] as i128).collect();
                (of_open, (line.lower - dot(&line.coefficients, &x)) as i128)
            })
            .collect();
        let value = case.cost(&x);
        if has_whole_solution(rows) && best.as_ref().is_none_or(|(old, _)| value < *old) {
            best = Some((value, x.clone()));
        }
        // The next values of the bounded ones.
        let next = bounded.iter().position(|&j| x[j] < case.columns[j].upper);
        let Some(next) = next else { break };
        bounded[..next].iter().for_each(|&j| x[j] = case.columns[j].lower);
        x[bounded[next]] += 1.0;
    }
    best.map_or(Truth::Infeasible, |(value, point)| Truth::Least { value, point })
}

/// Whether whole numbers satisfy `a'y = b` for all rows: columns are combined until each row has
/// one coefficient left, which must divide what is to be reached.
fn has_whole_solution(mut rows: Vec<(Vec<i128>, i128)>) -> bool {
    let n = rows.first().map_or(0, |row| row.0.len());
    let mut first = 0;
    for i in 0..rows.len() {
        loop {
            let open = (first..n).filter(|&j| rows[i].0[j] != 0);
            let Some(pivot) = open.min_by_key(|&j| rows[i].0[j].abs()) else { break };
            rows.iter_mut().for_each(|(a, _)| a.swap(first, pivot));
            for j in first + 1..n {
                let quotient = rows[i].0[j] / rows[i].0[first];
                rows.iter_mut().for_each(|(a, _)| a[j] -= quotient * a[first]);
            }
            if (first + 1..n).all(|j| rows[i].0[j] == 0) {
                break;
            }
        }
        let pivot = if first < n { rows[i].0[first] } else { 0 };
        if pivot == 0 {
            if rows[i].1 != 0 {
                return false;
            }
            continue;
        }
        if rows[i].1 % pivot != 0 {
            return false;
        }
        let value = rows[i].1 / pivot;
        rows.iter_mut().for_each(|(a, b)| *b -= value * a[first]);
        first += 1;
    }
    true
}
