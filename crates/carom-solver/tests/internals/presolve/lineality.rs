//! Shifts that nothing notices: which ones are found, and the way back.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::root::{Presolve, PresolveRule, Presolved, presolve};
use carom_solver::internals::program::Program;

const INF: f64 = f64::INFINITY;

fn presolved(model: &Model) -> Box<Presolved> {
    let program = Program::assemble(model).unwrap();
    match presolve(&program, &[PresolveRule::Lineality], &StopToken::default()).unwrap() {
        Presolve::Presolved(presolved) => presolved,
        other => unreachable!("{other:?}"),
    }
}

/// Columns of one kind and one range each, rows `a'x <= 1`, and costs.
fn model(columns: &[(bool, f64, f64)], rows: &[&[f64]], costs: &[f64]) -> Model {
    let mut model = Model::new("shifts");
    let mut x = Vec::new();
    for (j, &(integral, lower, upper)) in columns.iter().enumerate() {
        let kind = if integral { VariableKind::Integer } else { VariableKind::Continuous };
        x.push(model.variable(format!("x{j}"), kind, lower, upper).unwrap());
    }
    let sum = |a: &[f64]| a.iter().zip(&x).map(|(&a, &x)| a * x).sum::<Affine>();
    for (i, row) in rows.iter().enumerate() {
        model.add(format!("r{i}"), sum(row).le(1.0)).unwrap();
    }
    model.minimize(sum(costs)).unwrap();
    model
}

fn fixed(columns: &[(bool, f64, f64)], rows: &[&[f64]], costs: &[f64]) -> usize {
    let left = presolved(&model(columns, rows, costs)).program.column_count();
    columns.len() - left
}

const FREE: (bool, f64, f64) = (false, -INF, INF);
const WHOLE: (bool, f64, f64) = (true, -INF, INF);

#[test]
fn differences_are_shifted() {
    let two: [&[f64]; 2] = [&[1.0, -1.0, 0.0, 0.0], &[0.0, 0.0, 1.0, -1.0]];
    assert_eq!(fixed(&[FREE; 4], &two, &[0.0; 4]), 2);
    // A cost that sees differences only, one that sees the sum, and one that ties the two blocks.
    assert_eq!(fixed(&[FREE; 4], &two, &[1.0, -1.0, 0.0, 0.0]), 2);
    assert_eq!(fixed(&[FREE; 4], &two, &[1.0, 0.0, 0.0, 0.0]), 1);
    let tied: [&[f64]; 3] = [two[0], two[1], &[1.0, 0.0, -1.0, 0.0]];
    assert_eq!(fixed(&[FREE; 4], &tied, &[0.0; 4]), 1);
    // A row over one of them.
    let held: [&[f64]; 3] = [two[0], two[1], &[1.0, 0.0, 0.0, 0.0]];
    assert_eq!(fixed(&[FREE; 4], &held, &[0.0; 4]), 1);
}

#[test]
fn rows_of_many_columns() {
    // The direction (1, 2, 3) and no other one.
    let rows: [&[f64]; 2] = [&[1.0, 1.0, -1.0], &[3.0, 0.0, -1.0]];
    assert_eq!(fixed(&[FREE; 3], &rows, &[0.0; 3]), 1);
    assert_eq!(fixed(&[FREE; 3], &rows, &[-3.0, 0.0, 1.0]), 1);
    assert_eq!(fixed(&[FREE; 3], &rows, &[-3.0, 0.0, 1.5]), 0);
    // A third of a third is not a float: the columns stay.
    assert_eq!(fixed(&[FREE; 3], &[&[3.0, 7.0, 0.0], &[0.0, 7.0, 9.0]], &[0.0; 3]), 0);
}

#[test]
fn integers_are_shifted_by_whole_steps() {
    assert_eq!(fixed(&[WHOLE; 2], &[&[1.0, -1.0]], &[0.0; 2]), 1);
    assert_eq!(fixed(&[WHOLE; 2], &[&[2.0, -1.0]], &[0.0; 2]), 1);
    // Steps of 2 and 3: no column can be put at 0.
    assert_eq!(fixed(&[WHOLE; 2], &[&[3.0, -2.0]], &[0.0; 2]), 0);
    assert_eq!(fixed(&[WHOLE, FREE], &[&[3.0, -2.0]], &[0.0; 2]), 1);
    let mixed = presolved(&model(&[FREE, WHOLE], &[&[2.0, -3.0]], &[0.0; 2]));
    assert_eq!(mixed.postsolve.columns(), [0], "the integral column is fixed");
}

#[test]
fn bounds_on_one_side_are_met_on_the_way_back() {
    let columns = [(true, 7.0, INF), (false, -INF, INF), (true, -3.0, INF)];
    let rows: [&[f64]; 2] = [&[1.0, -1.0, 0.0], &[0.0, 1.0, -1.0]];
    let found = presolved(&model(&columns, &rows, &[0.0; 3]));
    assert_eq!(found.program.column_count(), 2);
    assert!(found.program.lower.iter().all(|lower| lower.is_infinite()));
    let point = found.postsolve.point(&[0.25, -0.5]);
    let step = point[found.postsolve.columns()[0]] - 0.25;
    assert_eq!(step, step.round());
    assert!(point[0] >= 7.0 && point[2] >= -3.0);
    // Bounds on both sides of the direction are noticed.
    assert_eq!(fixed(&[(true, 7.0, INF), (true, -INF, 3.0)], &[&[1.0, -1.0]], &[0.0; 2]), 0);
    assert_eq!(fixed(&[(true, 7.0, INF), (true, -INF, 3.0)], &[&[1.0, 1.0]], &[0.0; 2]), 1);
}

#[test]
fn curvature_notices() {
    for weight in [1.0, 2.0] {
        let mut model = Model::new("curved");
        let [x, y] = ["x", "y"].map(|name| model.continuous(name, -INF, INF).unwrap());
        model.minimize((weight * x - y).square()).unwrap();
        // (x - y)^2 sees the difference; (2 x - y)^2 does not see the direction (1, 2).
        assert_eq!(presolved(&model).program.column_count(), 1);
    }
    let mut model = Model::new("curved");
    let [x, y] = ["x", "y"].map(|name| model.continuous(name, -INF, INF).unwrap());
    model.add("row", (x - y).le(1.0)).unwrap();
    model.minimize(x.square()).unwrap();
    assert_eq!(presolved(&model).program.column_count(), 2);
}
