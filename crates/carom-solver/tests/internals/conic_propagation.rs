//! Propagation through cones cuts off no point of theirs, and says what there is to say.

use carom::model::norm;
use carom::prelude::*;
use carom_solver::internals::presolve::{Domain, Propagator};
use carom_solver::internals::program::{Cone, ConeRole, ConeShape, Program};
use proptest::prelude::*;
use proptest::sample::Index;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/conic_propagation.txt";

const COLUMNS: usize = 6;

/// Columns with a value, whether it is whole, and the distances of its bounds; cones over them.
#[derive(Debug, Clone)]
struct Case {
    columns: Vec<(f64, bool, f64, f64)>,
    cones: Vec<(bool, Vec<Index>)>,
    scale: f64,
    /// By how much the head exceeds what the tail asks for, relative.
    room: f64,
}

fn distance() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(0.0), 1 => Just(1e-9), 1 => Just(1e-4), 2 => 0.0..2.0, 1 => Just(f64::INFINITY)]
}

fn case() -> impl Strategy<Value = Case> {
    let value = prop_oneof![1 => Just(0.0), 1 => Just(1e-7), 3 => -2.0..2.0, 1 => Just(1e-3)];
    let column = (value, prop::bool::weighted(0.3), distance(), distance());
    let cone = (any::<bool>(), prop::collection::vec(any::<Index>(), 2..=5));
    let scale = prop_oneof![3 => Just(1.0), 1 => Just(1e3), 1 => Just(1e6), 1 => Just(1e-3)];
    (
        prop::collection::vec(column, COLUMNS),
        prop::collection::vec(cone, 1..=3),
        scale,
        prop_oneof![3 => Just(0.0), 1 => Just(1e-6), 1 => 0.0..0.5],
    )
        .prop_map(|(columns, cones, scale, room)| Case { columns, cones, scale, room })
}

/// A program with these cones, and a point of it.
fn build(case: &Case) -> (Program, Vec<f64>) {
    let mut x: Vec<f64> = case.columns.iter().map(|c| c.0 * case.scale).collect();
    for (x, column) in x.iter_mut().zip(&case.columns) {
        *x = if column.1 { x.round() } else { *x };
    }
    let mut whole: Vec<bool> = case.columns.iter().map(|c| c.1).collect();
    let mut distances: Vec<[f64; 2]> = case.columns.iter().map(|c| [c.2, c.3]).collect();
    let mut cones = Vec::new();
    for (rotated, picks) in &case.cones {
        let shape = if *rotated { ConeShape::Rotated } else { ConeShape::Norm };
        let mut tail: Vec<usize> = picks.iter().map(|pick| pick.index(COLUMNS)).collect();
        tail.sort_unstable();
        tail.dedup();
        // Heads are columns of their own, as large as the tail asks for.
        let square: f64 = tail.iter().map(|&j| x[j] * x[j]).sum();
        let first = x.len();
        match shape {
            ConeShape::Norm => x.push(square.sqrt() * (1.0 + case.room)),
            ConeShape::Rotated => {
                let y = case.columns[0].0.abs() * case.scale.sqrt() + 0.1;
                x.extend([square / y * (1.0 + case.room), y]);
            }
        }
        whole.resize(x.len(), false);
        for _ in first..x.len() {
            let [below, above] = distances[picks[0].index(COLUMNS)];
            distances.push([below, above]);
        }
        let columns = (first..x.len()).chain(tail).collect();
        cones.push(Cone { shape, columns, role: ConeRole::Single });
    }
    let mut model = Model::new("cones");
    for j in 0..x.len() {
        let [below, above] = distances[j];
        let (mut lower, mut upper) = (x[j] - below, x[j] + above);
        if j >= COLUMNS {
            lower = lower.max(0.0);
        }
        if whole[j] {
            (lower, upper) = (lower.ceil(), upper.floor());
            model.integer(("x", j), lower.min(x[j]), upper.max(x[j])).unwrap();
        } else {
            model.continuous(("x", j), lower, upper).unwrap();
        }
    }
    let mut program = Program::assemble(&model).unwrap();
    program.cones = cones;
    (program, x)
}

proptest! {
    #![proptest_config(config(2000, REGRESSIONS))]

    #[test]
    fn no_point_of_the_cones_is_cut_off(case in case(), order in prop::collection::vec(any::<Index>(), 3)) {
        let (program, x) = build(&case);
        let mut propagator = Propagator::new(&program);
        let mut domain = Domain::new(&program);
        let inside = |domain: &Domain| (0..x.len()).find(|&j| domain.lower(j) > x[j] || domain.upper(j) < x[j]);
        let result = propagator.propagate_all(&program, &mut domain);
        prop_assert!(result.is_ok(), "{:?} in spite of {:?}", result, x);
        prop_assert_eq!(inside(&domain), None, "{:?} lost {:?}", domain, x);
        // One column after the other comes closer to the point.
        for index in order {
            let (j, mark) = (index.index(x.len()), domain.mark());
            domain.apply(j, true, x[j]);
            domain.apply(j, false, x[j]);
            let result = propagator.propagate_since(&program, &mut domain, mark);
            prop_assert!(result.is_ok(), "{:?} in spite of {:?}", result, x);
            prop_assert_eq!(inside(&domain), None, "{:?} lost {:?}", domain, x);
        }
    }
}

/// Propagates the model of some columns with bounds, and one cone.
fn propagated(bounds: &[[f64; 2]], shape: ConeShape) -> Result<Vec<[f64; 2]>, String> {
    let mut model = Model::new("cone");
    for (j, &[lower, upper]) in bounds.iter().enumerate() {
        model.continuous(("x", j), lower, upper).unwrap();
    }
    let mut program = Program::assemble(&model).unwrap();
    program.cones =
        vec![Cone { shape, columns: (0..bounds.len()).collect(), role: ConeRole::Single }];
    let mut domain = Domain::new(&program);
    let result = Propagator::new(&program).propagate_all(&program, &mut domain);
    result.map_err(|conflict| format!("{conflict:?}"))?;
    Ok((0..bounds.len()).map(|j| domain.bounds(j)).collect())
}

#[track_caller]
fn assert_near(found: &[f64; 2], wanted: [f64; 2]) {
    let near = found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near, "{found:?} instead of {wanted:?}");
}

#[test]
fn the_head_bounds_the_tail_and_the_tail_the_head() {
    let open = [f64::NEG_INFINITY, f64::INFINITY];
    let found = propagated(&[[0.0, 5.0], [3.0, 9.0], open], ConeShape::Norm).unwrap();
    assert_near(&found[0], [3.0, 5.0]);
    assert_near(&found[1], [3.0, 5.0]);
    assert_near(&found[2], [-4.0, 4.0]);
    let found =
        propagated(&[[0.0, f64::INFINITY], [0.0, 2.0], [4.0, 4.0], open], ConeShape::Rotated);
    assert_near(&[found.as_ref().unwrap()[0][0], 2.0], [8.0, 2.0]);
    let found = propagated(&[[0.0, 5.0], [0.0, 5.0], [-9.0, -3.0], open], ConeShape::Rotated);
    let found = found.unwrap();
    assert_near(&found[0], [1.8, 5.0]);
    assert_near(&found[2], [-5.0, -3.0]);
    assert_near(&found[3], [-4.0, 4.0]);
}

#[test]
fn a_head_of_zero_leaves_nothing() {
    let open = [f64::NEG_INFINITY, f64::INFINITY];
    let found = propagated(&[[0.0, 0.0], [0.0, f64::INFINITY], open], ConeShape::Rotated).unwrap();
    assert!(found[2][0].abs() < 1e-8 && found[2][1].abs() < 1e-8, "{found:?}");
}

#[test]
fn tails_longer_than_the_head_contradict() {
    let miss = propagated(&[[0.0, 5.0], [3.0, 9.0], [4.1, 9.0]], ConeShape::Norm);
    assert_eq!(miss, Err("Cone(0)".into()));
    let miss = propagated(&[[0.0, 2.0], [0.0, 2.0], [2.1, 9.0]], ConeShape::Rotated);
    assert_eq!(miss, Err("Cone(0)".into()));
    // Within rounding there is no contradiction.
    assert!(propagated(&[[0.0, 5.0], [3.0, 3.0], [4.0 + 1e-9, 9.0]], ConeShape::Norm).is_ok());
}

/// A long norm is split; its parts and the whole agree.
#[test]
fn parts_and_wholes_propagate() {
    let mut model = Model::new("long");
    let x = model.continuous_family("x", 4, -9.0, 9.0).unwrap();
    let length = model.continuous("length", 0.0, 6.0).unwrap();
    model.add("length_of", norm(x.iter()).le(length)).unwrap();
    for j in 1..4 {
        model.add(("least", j), x[j].ge(3.0)).unwrap();
    }
    let program = Program::assemble(&model).unwrap();
    assert_eq!(program.cones.len(), 5);
    let mut domain = Domain::new(&program);
    Propagator::new(&program).propagate_all(&program, &mut domain).unwrap();
    assert_near(&domain.bounds(0), [-3.0, 3.0]);
    assert_near(&domain.bounds(4), [27.0_f64.sqrt(), 6.0]);
}
