//! Programs so large that single steps of a solve take long: for limits.

use carom::collision_tolerant::{Objective, Scenario};
use carom::prelude::*;

use super::generators::{puck, wall};
use super::random_miqp::Random;

/// Large programs, or those whose name has one of the parts.
pub(crate) fn large(parts: &[String]) -> Vec<(&'static str, Model)> {
    type Entry = (&'static str, fn() -> Model);
    let all: [Entry; 8] = [
        ("puck_150", || puck(150, 5.0 / 150.0)),
        ("puck_600", || puck(600, 5.0 / 600.0)),
        ("wall_dt0005_e5_4840", || wall(4840, 0.0005, 0.5, false)),
        ("wall_fuel_2400", || wall(2400, 0.00125, 0.5, true)),
        ("tolerant_5000", || tolerant(5000, Objective::Feasibility)),
        ("tolerant_20000", || tolerant(20_000, Objective::Effort)),
        ("milp_5000", || random_milp(5000, 2500)),
        ("milp_20000", || random_milp(20_000, 10_000)),
    ];
    let wanted = |name: &str| parts.is_empty() || parts.iter().any(|part| name.contains(part));
    let chosen = all.into_iter().filter(|(name, ..)| wanted(name));
    chosen.map(|(name, model)| (name, model())).collect()
}

/// The scenario of the paper with shorter steps: 2.285 s in all.
fn tolerant(steps: usize, objective: Objective) -> Model {
    let scenario = Scenario::paper().with_time_step(2.285 / steps as f64);
    scenario.program(steps, objective).unwrap().model().clone()
}

/// `rows` sparse rows over `columns` columns, every other one binary, with a point that satisfies
/// them.
fn random_milp(rows: usize, columns: usize) -> Model {
    let random = &mut Random(1);
    let mut model = Model::new("milp");
    let (mut x, mut known, mut cost) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..columns {
        let (kind, upper) = match j % 2 {
            0 => (VariableKind::Binary, 1.0),
            _ => (VariableKind::Continuous, 10.0),
        };
        x.push(model.variable(("x", j), kind, 0.0, upper).unwrap());
        known.push(if j % 2 == 0 { random.uniform().round() } else { 10.0 * random.uniform() });
        cost.push(random.normal());
    }
    for i in 0..rows {
        let mut terms: Vec<(usize, f64)> = Vec::new();
        for _ in 0..5 {
            // Not too far apart, or the factors of relaxations fill up.
            let near = i * columns / rows + (60.0 * random.uniform()) as usize;
            terms.push((near % columns, random.normal()));
        }
        let sum: Affine = terms.iter().map(|&(j, a)| a * x[j]).sum();
        let value: f64 = terms.iter().map(|&(j, a)| a * known[j]).sum();
        model.add(("row", i), sum.le(value + random.uniform())).unwrap();
    }
    let cost: Affine = cost.iter().zip(&x).map(|(&c, &x)| c * x).sum();
    model.minimize(cost).unwrap();
    model
}
