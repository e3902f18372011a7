//! The tree search from outside: threads, deterministic rounds, limits, pools of points, seeds,
//! events, statistics, blocks, switches.

mod blocks;
mod deterministic;
mod events;
pub(crate) mod facets;
mod heuristics;
mod limits;
mod pool;
mod shared_tree;
mod starts;
mod statistics;
mod switches;

use carom::prelude::*;

/// A program with a long tree: no sum of even numbers is odd.
pub(crate) fn parity(columns: usize) -> Model {
    let mut model = Model::new("parity");
    let v = model.binary_family("v", columns).unwrap();
    let slack = model.continuous("slack", 0.0, 1.0).unwrap();
    let sum: Affine = v.iter().map(|v| 2.0 * v).sum();
    model
        .add("odd", (sum + slack).equals(columns as f64 + f64::from(columns.is_multiple_of(2))))
        .unwrap();
    model.minimize(slack).unwrap();
    model
}

/// A knapsack of some size, from a simple generator of numbers.
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
