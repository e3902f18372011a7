//! Random programs whose cones whole numbers make thin: heads at 0, and heads that are as long as a
//! tail.
//!
//! All but two columns are whole, and rows and bounds leave them few values, so that a node often
//! fixes a head and entries of its tail that take up all of it.

use carom::prelude::VariableKind;

use super::case::{ConicCase, Form, Guarded, Shape, length};
use crate::common::case::{Case, Column, Line};
use crate::torture::generator::Random;

/// The places of the head, which is whole, and of the continuous columns.
const HEAD: usize = 3;
const REAL: [usize; 2] = [4, 5];
const COLUMNS: usize = 6;

/// Tails and the head that is as long.
const TIGHT: [([i32; 3], i32); 6] = [
    ([0, 0, 0], 0),
    ([3, 0, 0], 3),
    ([3, 4, 0], 5),
    ([1, 2, 2], 3),
    ([-2, 0, 0], 2),
    ([0, 0, 4], 4),
];

pub(crate) fn program(seed: u64) -> ConicCase {
    let r = &mut Random::new(seed);
    let (tail, head) = TIGHT[r.below(TIGHT.len())];
    let mut anchor: Vec<f64> = tail.iter().map(|&t| f64::from(t)).collect();
    anchor.extend([f64::from(head), 0.0, f64::from(r.within(0, 2))]);
    let mut columns: Vec<Column> = anchor[..=HEAD]
        .iter()
        .map(|&value| {
            let (below, above) = (f64::from(r.within(0, 1)), f64::from(r.within(0, 1)));
            Column { kind: VariableKind::Integer, lower: value - below, upper: value + above }
        })
        .collect();
    columns[HEAD].lower = columns[HEAD].lower.max(0.0);
    let real = |lower: f64| Column { kind: VariableKind::Continuous, lower, upper: 2.0 };
    columns.extend([real(-2.0), real(0.0)]);
    let unit = |j: usize| {
        let mut coefficients = vec![0.0; COLUMNS];
        coefficients[j] = 1.0;
        Form { coefficients, constant: 0.0 }
    };
    let constant = |value: f64| Form { coefficients: vec![0.0; COLUMNS], constant: value };
    let cones = (0..1 + r.below(3)).map(|_| {
        let mut entries: Vec<usize> = (0..3).filter(|_| r.chance(0.7)).collect();
        entries.push(REAL[0]);
        let tail: Vec<Form> = entries.iter().map(|&j| unit(j)).collect();
        let size = length(entries.iter().map(|&j| anchor[j]));
        let shape = match r.below(4) {
            0 => Shape::Norm { tail, head: constant(size.ceil()), is_squared: r.chance(0.5) },
            1 | 2 => Shape::Norm { tail, head: unit(HEAD), is_squared: r.chance(0.3) },
            _ => Shape::Product {
                tail: vec![unit(REAL[0])],
                first: unit(HEAD),
                second: unit(REAL[1]),
            },
        };
        Guarded { condition: Vec::new(), big_m: None, shape }
    });
    let cones = cones.collect();
    let mut lines = Vec::new();
    if r.chance(0.4) {
        // The head is no longer than an entry, which leaves the others 0.
        let mut coefficients = vec![0.0; COLUMNS];
        coefficients[HEAD] = 1.0;
        coefficients[r.below(3)] = if r.chance(0.5) { -1.0 } else { 1.0 };
        lines.push(Line { coefficients, lower: f64::NEG_INFINITY, upper: 0.0, scale: 1.0 });
    }
    let linear = (0..COLUMNS).map(|_| 0.5 * f64::from(r.within(-6, 6))).collect();
    let (switches, squares) = (Vec::new(), Vec::new());
    let maximize = r.chance(0.3);
    let base = Case { columns, lines, switches, squares, linear, constant: 0.0, maximize };
    let (choices, norms, parameters) = (Vec::new(), Vec::new(), Vec::new());
    let units = vec![1.0; COLUMNS];
    let mut case = ConicCase { base, cones, choices, norms, parameters, units, witness: None };
    case.drop_refused();
    case.witness = case.violation(&anchor, 0.0).is_none().then_some(anchor);
    case
}
