//! Seven programs: two of them are infeasible, one has cones, and one two blocks.

// Each of the tests uses a part of this module.
#![allow(dead_code)]

#[path = "../../../tests/instances/mod.rs"]
pub(crate) mod instances;

use carom::prelude::*;
use instances::generators::boxes;

/// Selections whose sums are to be half of everything, in each row: with `slack`, as near as can
/// be.
pub(crate) fn market(rows: usize, columns: usize, slack: bool) -> Model {
    let mut state = 20_261_126_u64;
    let mut number = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % 100) as f64
    };
    let mut model = Model::new("market");
    let v = model.binary_family("v", columns).unwrap();
    let mut missed = Affine::from(0.0);
    for row in 0..rows {
        let shares: Vec<f64> = v.iter().map(|_| number()).collect();
        let half = (0.5 * shares.iter().sum::<f64>()).floor();
        let sum: Affine = v.iter().zip(&shares).map(|(v, &share)| share * v).sum();
        if slack {
            let [over, under] =
                ["over", "under"].map(|name| model.continuous((name, row), 0.0, 1000.0).unwrap());
            model.add(("half", row), (sum - over + under).equals(half)).unwrap();
            missed += over + under;
        } else {
            model.add(("half", row), sum.equals(half)).unwrap();
        }
    }
    if slack {
        model.minimize(missed).unwrap();
    } else {
        model.minimize(v.iter().map(|v| 1.0 * v).sum::<Affine>()).unwrap();
    }
    model
}

/// A knapsack of three rows.
pub(crate) fn knapsack(columns: usize, seed: u64) -> Model {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut number = |most: u64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut model = Model::new("knapsack");
    let v = model.binary_family("v", columns).unwrap();
    for row in 0..3 {
        let weights: Vec<f64> = v.iter().map(|_| 10.0 + number(40) as f64).collect();
        let limit = (weights.iter().sum::<f64>() / 3.0).floor();
        let load: Affine = v.iter().zip(&weights).map(|(v, &w)| w * v).sum();
        model.add(("load", row), load.le(limit)).unwrap();
    }
    let value: Affine = v.iter().map(|v| (20.0 + number(30) as f64) * v).sum();
    model.maximize(value).unwrap();
    model
}

/// Two knapsacks that have nothing in common.
fn two_knapsacks() -> Model {
    let mut model = Model::new("two knapsacks");
    let mut values = Affine::from(0.0);
    for (name, columns) in [("a", 40), ("b", 45)] {
        let v = model.binary_family(name, columns).unwrap();
        let number =
            |k: usize, row: usize| ((k * k * 31 + k * 17 * (row + 1) + row * 7) % 41) as f64;
        for row in 0..3 {
            let load: Affine = v.iter().enumerate().map(|(k, v)| (10.0 + number(k, row)) * v).sum();
            model.add((name, row), load.le(9.0 * columns as f64)).unwrap();
        }
        values += v.iter().enumerate().map(|(k, v)| (20.0 + number(k, 5)) * v).sum::<Affine>();
    }
    model.maximize(values).unwrap();
    model
}

/// Bins whose distance to a point is a norm.
fn cones(columns: usize) -> Model {
    let mut model = Model::new("cones");
    let v = model.binary_family("v", columns).unwrap();
    let far = model.continuous("far", 0.0, 1000.0).unwrap();
    let at = |turn: usize| -> Affine {
        let step = |k: usize| ((k * 7 + turn * 3) % 11) as f64 - 4.0;
        v.iter().enumerate().map(|(k, v)| step(k) * v).sum()
    };
    model.add("far", norm([at(0) - 5.3, at(1) - 2.7, at(2) + 1.9]).le(far)).unwrap();
    let some: Affine = v.iter().map(|v| 1.0 * v).sum();
    model.add("some", some.within(3.0, columns as f64 / 2.0)).unwrap();
    model.minimize(far).unwrap();
    model
}

pub(crate) fn programs() -> Vec<Model> {
    vec![
        knapsack(60, 5),
        market(4, 17, true),
        boxes(20, 4, false),
        market(4, 18, false),
        market(4, 20, false),
        cones(14),
        two_knapsacks(),
    ]
}
