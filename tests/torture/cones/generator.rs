//! Random programs with cones: under no condition, under binaries with and without a given M, in
//! disjunctions, as costs; with whole numbers, parameters, equalities, open columns, tangent and
//! empty insides, repeated and constant entries, and units from 1e-4 to 1e4.
//!
//! A program is a function of its seed. It is made around a point that keeps it, mostly, in numbers
//! that are small whole numbers times powers of two, with lengths that are whole.

use carom::ErrorKind;
use carom::model::Method;
use carom::prelude::*;

use super::case::{Choice, ConicCase, Form, Guarded, Shape, length};
use crate::common::case::{Case, Column, Line, Square, Switch};
use crate::common::quadratic_program::dot;
use crate::torture::generator::Random;

/// Tails whose lengths are whole.
const WHOLE_LENGTHS: [&[i32]; 12] = [
    &[0],
    &[0, 0],
    &[1],
    &[3, 4],
    &[0, 2],
    &[5, 12],
    &[8, 15],
    &[1, 2, 2],
    &[2, 3, 6],
    &[4, 4, 7],
    &[2, 4, 5, 6],
    &[3, 0, 4, 0],
];

struct Space {
    columns: Vec<Column>,
    units: Vec<f64>,
    parameters: Vec<usize>,
    /// The columns that expressions may have: all, or those with two bounds.
    bounded: Vec<bool>,
    unit: f64,
}

fn number(r: &mut Random, low: i32, high: i32) -> f64 {
    f64::from(r.within(low, high))
}

/// A small whole number that is not zero.
fn factor(r: &mut Random, most: i32) -> f64 {
    f64::from(r.within(1, most)) * if r.chance(0.5) { 1.0 } else { -1.0 }
}

/// The program of a seed.
pub(crate) fn program(seed: u64) -> ConicCase {
    let r = &mut Random::new(seed ^ 0xc0de);
    let (mut space, anchor) = space(r);
    let n = space.columns.len();
    let is_binary = |j: &usize| space.columns[*j].kind == VariableKind::Binary;
    let binaries: Vec<usize> = (0..n).filter(is_binary).collect();
    let mut anchor = anchor;

    let mut choices = Vec::new();
    if binaries.len() >= 2 && r.chance(0.3) {
        let terms = 2 + usize::from(binaries.len() > 2 && r.chance(0.4));
        let selectors: Vec<usize> = binaries[..terms].to_vec();
        let selected = r.below(terms);
        for (k, &j) in selectors.iter().enumerate() {
            anchor[j] = if k == selected { 1.0 } else { 0.0 };
        }
        let method = Method::ALL[r.below(3)];
        let mut term = |k: usize| {
            let at = if k == selected { anchor.clone() } else { elsewhere(r, &space) };
            let lines = (0..r.below(2)).filter_map(|_| line(r, &space, &at, true)).collect();
            let shapes = (0..1 + r.below(2)).filter_map(|_| shape(r, &space, &at, true));
            (lines, shapes.collect())
        };
        let terms = (0..terms).map(&mut term).collect();
        choices.push(Choice { selectors, terms, method });
    }
    let cones = (0..1 + r.below(3)).filter_map(|_| {
        let mut condition = Vec::new();
        if !binaries.is_empty() && r.chance(0.4) {
            condition.push((binaries[r.below(binaries.len())], r.chance(0.6)));
            let other = binaries[r.below(binaries.len())];
            if r.chance(0.2) && other != condition[0].0 {
                condition.push((other, r.chance(0.6)));
            }
        }
        let holds = condition.iter().all(|&(j, on)| (anchor[j] > 0.5) == on);
        let at = if holds || r.chance(0.3) { anchor.clone() } else { elsewhere(r, &space) };
        let shape = shape(r, &space, &at, !condition.is_empty())?;
        let big_m = (condition.len() == 1 && r.chance(0.3)).then(|| large_m(&shape, &space));
        Some(Guarded { condition, big_m: big_m.flatten(), shape })
    });
    let cones = cones.collect();
    let lines: Vec<Line> =
        (0..r.below(3)).filter_map(|_| line(r, &space, &anchor, false)).collect();
    let mut switches = Vec::new();
    if !binaries.is_empty() && r.chance(0.2) {
        let (binary, on) = (binaries[r.below(binaries.len())], r.chance(0.5));
        let at = if (anchor[binary] > 0.5) == on { anchor.clone() } else { elsewhere(r, &space) };
        if let Some(line) = line(r, &space, &at, true) {
            switches.push(Switch { binary, on, line });
        }
    }
    let norms = (0..if r.chance(0.35) { 1 + r.below(2) } else { 0 }).map(|_| {
        let tail = (0..1 + r.below(3)).map(|_| {
            let value = number(r, -4, 4) * 0.5 * space.unit;
            form(r, &space, &anchor, value, space.unit, false)
        });
        let tail: Vec<Form> = tail.collect();
        (2.0_f64.powi(r.within(-2, 2)) / space.unit, tail)
    });
    let norms: Vec<_> = norms.collect();
    let (linear, squares) = cost(r, &space, &anchor);
    let maximize = r.chance(0.3);
    let base = Case {
        columns: std::mem::take(&mut space.columns),
        lines,
        switches,
        squares,
        linear,
        constant: if r.chance(0.3) { number(r, -9, 9) } else { 0.0 },
        maximize,
    };
    let Space { units, parameters, .. } = space;
    let mut case = ConicCase { base, cones, choices, norms, parameters, units, witness: None };
    case.drop_refused();
    case.witness = case.violation(&anchor, 0.0).is_none().then_some(anchor);
    case
}

/// Columns, and a point within their bounds.
fn space(r: &mut Random) -> (Space, Vec<f64>) {
    let power = |r: &mut Random| 2.0_f64.powi(r.within(-13, 13));
    let is_mixed = r.chance(0.08);
    let unit = if r.chance(0.75) { 1.0 } else { power(r) };
    let (mut columns, mut units, mut anchor) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..1 + r.below(4) {
        let unit = if is_mixed { 2.0_f64.powi(r.within(-6, 6)) } else { unit };
        let mut value = number(r, -4, 4) * 0.5 * unit;
        let mut lower = value - number(r, 0, 8) * 0.5 * unit;
        let mut upper = value + number(r, 0, 8) * 0.5 * unit;
        match r.below(10) {
            0 => lower = f64::NEG_INFINITY,
            1 => upper = f64::INFINITY,
            2 => (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY),
            3 => (value, lower, upper) = (value.abs(), 0.0, f64::INFINITY),
            4..=6 => (value, lower, upper) = (value.abs(), 0.0, value.abs() + 4.0 * unit),
            _ => {}
        }
        columns.push(Column { kind: VariableKind::Continuous, lower, upper });
        units.push(unit);
        anchor.push(value);
    }
    let mut parameters = Vec::new();
    if r.chance(0.2) {
        let value = number(r, -4, 4) * 0.5 * unit;
        parameters.push(columns.len());
        columns.push(Column { kind: VariableKind::Continuous, lower: value, upper: value });
        units.push(unit);
        anchor.push(value);
    }
    for _ in 0..r.below(5) {
        columns.push(Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 });
        units.push(1.0);
        anchor.push(f64::from(r.within(0, 1)));
    }
    if r.chance(0.3) {
        let value = number(r, -3, 3);
        let (lower, upper) = (value - number(r, 0, 2), value + number(r, 0, 2));
        columns.push(Column { kind: VariableKind::Integer, lower, upper });
        units.push(1.0);
        anchor.push(value);
    }
    let is_bounded = |column: &Column| column.lower.is_finite() && column.upper.is_finite();
    let bounded = columns.iter().map(is_bounded).collect();
    (Space { columns, units, parameters, bounded, unit }, anchor)
}

/// Another point near 0.
fn elsewhere(r: &mut Random, space: &Space) -> Vec<f64> {
    let value = |(column, unit): (&Column, &f64)| {
        let value = match column.kind {
            VariableKind::Continuous => number(r, -6, 6) * 0.5 * unit,
            _ => number(r, -2, 3),
        };
        value.max(column.lower).min(column.upper)
    };
    space.columns.iter().zip(&space.units).map(value).collect()
}

/// An expression of some size with a value at a point.
fn form(
    r: &mut Random,
    space: &Space,
    at: &[f64],
    value: f64,
    unit: f64,
    is_bounded: bool,
) -> Form {
    let n = space.columns.len();
    let mut coefficients = vec![0.0; n];
    for _ in 0..1 + r.below(2) {
        let j = r.below(n);
        let is_continuous = space.columns[j].kind == VariableKind::Continuous;
        if (is_bounded && !space.bounded[j]) || (!is_continuous && r.chance(0.5)) {
            continue;
        }
        let size = if r.chance(0.5) { 1.0 } else { factor(r, 3) };
        coefficients[j] = size * unit / space.units[j];
    }
    let constant = value - dot(&coefficients, at);
    Form { coefficients, constant }
}

/// One variable.
fn single(r: &mut Random, space: &Space, unit: f64, is_bounded: bool) -> Option<Form> {
    let j = r.below(space.columns.len());
    if is_bounded && !space.bounded[j] {
        return None;
    }
    let mut coefficients = vec![0.0; space.columns.len()];
    coefficients[j] = unit / space.units[j];
    Some(Form { coefficients, constant: 0.0 })
}

/// By how much a row has room, in its unit; a little or much too little now and then.
fn room(r: &mut Random) -> f64 {
    match r.below(100) {
        0..40 => 0.0,
        40..82 => number(r, 1, 8) * 0.25,
        82..88 => 64.0,
        88..91 => -(-10.0_f64).exp2(),
        91..94 => -(-17.0_f64).exp2(),
        94..96 => -(-24.0_f64).exp2(),
        _ => -1.0,
    }
}

/// A cone that a point keeps, mostly.
fn shape(r: &mut Random, space: &Space, at: &[f64], is_bounded: bool) -> Option<Shape> {
    let unit = space.unit * if r.chance(0.1) { 2.0_f64.powi(r.within(-6, 6)) } else { 1.0 };
    let whole = WHOLE_LENGTHS[r.below(WHOLE_LENGTHS.len())];
    let scale = unit * 2.0_f64.powi(r.within(-2, 1));
    let mut tail: Vec<Form> = match r.chance(0.5) {
        true => {
            let values = whole.iter().map(|&t| f64::from(t) * scale);
            values.map(|t| form(r, space, at, t, unit, is_bounded)).collect()
        }
        false => (0..1 + r.below(4)).filter_map(|_| single(r, space, unit, is_bounded)).collect(),
    };
    if !tail.is_empty() && r.chance(0.08) {
        tail.push(tail[r.below(tail.len())].clone());
    }
    if r.chance(0.05) {
        let coefficients = vec![0.0; space.columns.len()];
        tail.push(Form { coefficients, constant: if r.chance(0.5) { 0.0 } else { unit } });
    }
    let values: Vec<f64> = tail.iter().map(|form| form.at(at)).collect();
    let size = length(values.iter().copied());
    // Exactly, or a little more.
    let size = if size * size == values.iter().map(|t| t * t).sum::<f64>() {
        size
    } else {
        (size / unit * 16.0 + 1.0).floor() / 16.0 * unit
    };
    let room = room(r);
    Some(match r.below(10) {
        0..5 => {
            let value = size + room * unit;
            let coefficients = vec![0.0; space.columns.len()];
            let head = match r.chance(0.45) {
                true => Form { coefficients, constant: value },
                false => form(r, space, at, value, unit, is_bounded),
            };
            Shape::Norm { tail, head, is_squared: r.chance(0.25) && value >= 0.0 }
        }
        5..8 => {
            let weight = |_: &Form| 2.0_f64.powi(r.within(-2, 2));
            let weights: Vec<f64> = tail.iter().map(weight).collect();
            let squares: Vec<(f64, Form)> = weights.into_iter().zip(tail).collect();
            let sum = squares.iter().map(|(w, form)| w * form.at(at).powi(2)).sum::<f64>();
            let value = sum + room * unit * unit;
            let bound = form(r, space, at, value, unit * unit, is_bounded);
            Shape::Convex { squares, bound }
        }
        _ => {
            let is_positive =
                |j: &usize| space.columns[*j].lower >= 0.0 && (!is_bounded || space.bounded[*j]);
            let positive: Vec<usize> = (0..space.columns.len()).filter(is_positive).collect();
            if positive.is_empty() {
                return None;
            }
            let mut head = |value: f64| {
                let mut coefficients = vec![0.0; space.columns.len()];
                let j = positive[r.below(positive.len())];
                coefficients[j] = unit / space.units[j];
                let own = coefficients[j] * at[j];
                Form { coefficients, constant: (value - own).max(0.0) }
            };
            let first = head(if size > 0.0 { unit } else { 0.0 });
            let a = first.at(at);
            let least = if a > 0.0 { size * size / a } else { 0.0 };
            let second = head((least + room * unit).max(0.0));
            Shape::Product { tail, first, second }
        }
    })
}

/// An M that is large enough for a norm.
fn large_m(shape: &Shape, space: &Space) -> Option<f64> {
    let Shape::Norm { tail, head, is_squared: false } = shape else { return None };
    let reach = |form: &Form| {
        let terms = form.coefficients.iter().zip(&space.columns).enumerate();
        let terms = terms.filter(|(_, (a, _))| **a != 0.0).map(|(j, (a, c))| {
            let most = (a * c.lower).abs().max((a * c.upper).abs());
            // The range of a parameter is wider than its value.
            if space.parameters.contains(&j) {
                most + a.abs() * c.lower.abs().max(1.0)
            } else {
                most
            }
        });
        terms.sum::<f64>() + form.constant.abs()
    };
    Some(1.5 * (length(tail.iter().map(reach)) + reach(head)) + space.unit)
}

/// A row that a point keeps, mostly.
fn line(r: &mut Random, space: &Space, at: &[f64], is_bounded: bool) -> Option<Line> {
    let form = form(r, space, at, 0.0, space.unit, is_bounded);
    let coefficients = form.coefficients;
    if coefficients.iter().all(|a| *a == 0.0) {
        return None;
    }
    let value = dot(&coefficients, at);
    let room = room(r).abs().max(0.0) * space.unit;
    let (lower, upper) = match r.below(4) {
        0 => (value, value),
        1 => (value - room, f64::INFINITY),
        2 => (f64::NEG_INFINITY, value + room),
        _ => (value - room, value + 0.5 * space.unit),
    };
    Some(Line { coefficients, lower, upper, scale: 1.0 })
}

fn cost(r: &mut Random, space: &Space, at: &[f64]) -> (Vec<f64>, Vec<Square>) {
    let mut linear = vec![0.0; space.columns.len()];
    for (j, c) in linear.iter_mut().enumerate() {
        let chance = if space.bounded[j] { 0.75 } else { 0.4 };
        if r.chance(chance) && !space.parameters.contains(&j) {
            *c = factor(r, 5) / space.units[j];
        }
    }
    let count = if r.chance(0.3) { 1 + r.below(2) } else { 0 };
    let squares = (0..count).map(|_| {
        let value = number(r, -4, 4) * 0.5 * space.unit;
        let Form { coefficients, constant } = form(r, space, at, value, space.unit, false);
        let weight = 2.0_f64.powi(r.within(-2, 3)) / (space.unit * space.unit);
        Square { weight, coefficients, constant }
    });
    let squares = squares.filter(|s| s.coefficients.iter().any(|a| *a != 0.0)).collect();
    (linear, squares)
}

impl ConicCase {
    /// Whether models take it: all but cones with a head of unknown sign.
    pub(crate) fn is_taken(&self) -> bool {
        let refused = |error: Error| matches!(error.kind(), ErrorKind::UnknownSign { .. });
        !self.build().is_err_and(refused)
    }

    /// Drops the cones that models refuse: without variables, or with a head of unknown sign. Norms
    /// whose head may be negative are not written with squares, which would say something else.
    pub(super) fn drop_refused(&mut self) {
        let columns = &self.base.columns;
        let choices = self.choices.iter_mut().flat_map(|choice| &mut choice.terms);
        let shapes = choices.flat_map(|(_, shapes)| shapes);
        for shape in shapes.chain(self.cones.iter_mut().map(|cone| &mut cone.shape)) {
            if let Shape::Norm { head, is_squared, .. } = shape {
                let terms = head.coefficients.iter().zip(columns).filter(|(a, _)| **a != 0.0);
                let least = terms.map(|(a, c)| (a * c.lower).min(a * c.upper));
                *is_squared &= least.sum::<f64>() + head.constant >= 0.0;
            }
        }
        let mut plain = self.clone();
        (plain.cones, plain.choices, plain.norms) = (Vec::new(), Vec::new(), Vec::new());
        let is_taken = |shape: &Shape| {
            let cone = Guarded { condition: Vec::new(), big_m: None, shape: shape.clone() };
            let one = ConicCase { cones: vec![cone], ..plain.clone() };
            match one.build() {
                Ok(_) => true,
                Err(error) => !matches!(
                    error.kind(),
                    ErrorKind::UnknownSign { .. } | ErrorKind::EmptyRow { .. }
                ),
            }
        };
        self.cones.retain(|cone| is_taken(&cone.shape));
        for choice in &mut self.choices {
            choice.terms.iter_mut().for_each(|(_, shapes)| shapes.retain(is_taken));
        }
        let has_rows =
            |(lines, shapes): &(Vec<Line>, Vec<Shape>)| !lines.is_empty() || !shapes.is_empty();
        self.choices.retain(|choice| choice.terms.iter().all(has_rows));
        let has_variable =
            |tail: &[Form]| tail.iter().any(|form| form.coefficients.iter().any(|a| *a != 0.0));
        self.norms.retain(|(_, tail)| has_variable(tail));
    }
}
