//! The same program in other words: other units, complements of variables, rows from the other
//! side.

use carom::prelude::*;

use super::case::{Case, Line};

/// All rows of a case, those of indicators included.
pub(crate) fn rows(case: &mut Case) -> impl Iterator<Item = &mut Line> {
    case.lines.iter_mut().chain(case.switches.iter_mut().map(|switch| &mut switch.line))
}

/// The program in continuous variables `x / 2^power`, its rows times other powers of two.
pub(crate) fn in_units(case: &Case, powers: &[i32], of_rows: &[i32]) -> Case {
    let mut other = case.clone();
    for (j, power) in powers.iter().enumerate().take(case.columns.len()) {
        if case.columns[j].kind != VariableKind::Continuous {
            continue;
        }
        let unit = f64::from(*power).exp2();
        other.columns[j].lower /= unit;
        other.columns[j].upper /= unit;
        other.linear[j] *= unit;
        other.squares.iter_mut().for_each(|square| square.coefficients[j] *= unit);
        rows(&mut other).for_each(|line| line.coefficients[j] *= unit);
    }
    for (line, power) in rows(&mut other).zip(of_rows) {
        line.scale *= f64::from(*power).exp2();
    }
    other
}

/// The program with `lower + upper - x`, up to a fraction, in the place of some bounded variables.
pub(crate) fn complemented(case: &Case, which: &[bool]) -> Case {
    let mut other = case.clone();
    for (j, column) in case.columns.iter().enumerate().filter(|&(j, _)| which[j]) {
        let sum = match column.kind {
            VariableKind::Binary => 1.0,
            VariableKind::Integer => (column.lower + column.upper).round(),
            VariableKind::Continuous => column.lower + column.upper,
        };
        if !(column.lower.is_finite() && column.upper.is_finite()) {
            continue;
        }
        (other.columns[j].lower, other.columns[j].upper) = (sum - column.upper, sum - column.lower);
        other.constant += case.linear[j] * sum;
        other.linear[j] *= -1.0;
        for square in &mut other.squares {
            square.constant += square.coefficients[j] * sum;
            square.coefficients[j] *= -1.0;
        }
        for line in rows(&mut other) {
            line.lower -= line.coefficients[j] * sum;
            line.upper -= line.coefficients[j] * sum;
            line.coefficients[j] *= -1.0;
        }
        let own = other.switches.iter_mut().filter(|switch| switch.binary == j);
        own.for_each(|switch| switch.on = !switch.on);
    }
    other
}

/// The program with some of its rows from the other side.
pub(crate) fn negated(case: &Case, which: &[bool]) -> Case {
    let mut other = case.clone();
    for (line, _) in rows(&mut other).zip(which).filter(|(_, negated)| **negated) {
        line.coefficients.iter_mut().for_each(|a| *a *= -1.0);
        (line.lower, line.upper) = (-line.upper, -line.lower);
    }
    other
}
