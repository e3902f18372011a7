//! Differential equations, stated for the crate and once more in numbers, and methods in numbers.

use carom::hybrid::{Discretization, Input, State};
use carom::model::Nonlinear;
use carom::prelude::*;

/// All methods, with their orders.
pub(super) const METHODS: [(Discretization, f64); 5] = [
    (Discretization::Euler, 1.0),
    (Discretization::ImplicitEuler, 1.0),
    (Discretization::Midpoint, 2.0),
    (Discretization::RungeKutta4, 4.0),
    (Discretization::HermiteSimpson, 4.0),
];

/// The number of fields.
pub(super) const FIELDS: usize = 4;

/// The numbers of states of each field.
pub(super) const STATES: [usize; FIELDS] = [2, 3, 1, 2];

/// A system with a field, its states and its input.
pub(super) struct Stated {
    pub(super) system: HybridSystem,
    pub(super) states: Vec<State>,
    pub(super) input: Input,
}

/// A system with one mode.
pub(super) fn stated(field: usize, step: f64, method: Discretization) -> Stated {
    let mut own = declared(field, step, method);
    let rates = rates(field, &own.states, own.input);
    own.system.mode("only").unwrap().rates(rates).unwrap();
    own
}

/// A system without modes.
pub(super) fn declared(field: usize, step: f64, method: Discretization) -> Stated {
    let mut system = HybridSystem::new(step);
    let names = ["a", "b", "c"];
    let states = names[..STATES[field]].iter().map(|name| system.state(name, -6.0, 6.0).unwrap());
    let states: Vec<State> = states.collect();
    let input = system.input("u", -1.0, 1.0).unwrap();
    system.discretization(method).unwrap();
    Stated { system, states, input }
}

/// The rates of a field.
pub(super) fn rates(field: usize, x: &[State], u: Input) -> Vec<(State, Nonlinear)> {
    match field {
        // A pendulum with drag.
        0 => vec![x[0].is(x[1]), x[1].is(u - 2.0 * x[0].sin() - 0.1 * x[1] * x[1].abs())],
        // A car.
        1 => vec![x[0].is(1.5 * x[2].cos()), x[1].is(1.5 * x[2].sin()), x[2].is(u)],
        // A population.
        2 => vec![x[0].is(u * x[0] / (1.0 + x[0].square()) - 0.3 * (-0.5 * x[0]).exp())],
        // A van der Pol oscillator with a hyperbolic tangent.
        _ => vec![x[0].is(x[1]), x[1].is(0.4 * (1.0 - x[0].square()) * x[1] - x[0] + u.tanh())],
    }
}

/// The rates of a field in numbers.
pub(super) fn value(field: usize, x: &[f64], u: f64) -> Vec<f64> {
    match field {
        0 => vec![x[1], u - 2.0 * x[0].sin() - 0.1 * x[1] * x[1].abs()],
        1 => vec![1.5 * x[2].cos(), 1.5 * x[2].sin(), u],
        2 => vec![u * x[0] / (1.0 + x[0] * x[0]) - 0.3 * (-0.5 * x[0]).exp()],
        _ => vec![x[1], 0.4 * (1.0 - x[0] * x[0]) * x[1] - x[0] + u.tanh()],
    }
}

fn moved(x: &[f64], by: f64, rates: &[f64]) -> Vec<f64> {
    x.iter().zip(rates).map(|(x, r)| x + by * r).collect()
}

/// Where a method's equation says that a step leads, if it leads to `next`.
pub(super) fn step(
    method: Discretization,
    f: &dyn Fn(&[f64]) -> Vec<f64>,
    h: f64,
    x: &[f64],
    next: &[f64],
) -> Vec<f64> {
    let middle: Vec<f64> = x.iter().zip(next).map(|(a, b)| (a + b) / 2.0).collect();
    match method {
        Discretization::Euler => moved(x, h, &f(x)),
        Discretization::ImplicitEuler => moved(x, h, &f(next)),
        Discretization::Midpoint => moved(x, h, &f(&middle)),
        Discretization::RungeKutta4 => {
            let first = f(x);
            let second = f(&moved(x, h / 2.0, &first));
            let third = f(&moved(x, h / 2.0, &second));
            let fourth = f(&moved(x, h, &third));
            let mean = |i: usize| (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]) / 6.0;
            moved(x, h, &(0..x.len()).map(mean).collect::<Vec<f64>>())
        }
        Discretization::HermiteSimpson => {
            let (first, last) = (f(x), f(next));
            let bent = (0..x.len()).map(|i| middle[i] + h / 8.0 * (first[i] - last[i]));
            let inner = f(&bent.collect::<Vec<f64>>());
            let mean = |i: usize| (first[i] + 4.0 * inner[i] + last[i]) / 6.0;
            moved(x, h, &(0..x.len()).map(mean).collect::<Vec<f64>>())
        }
        _ => unreachable!("a method without a formula"),
    }
}

/// The step of a method, by repeating its equation, which contracts for short steps.
pub(super) fn lead(
    method: Discretization,
    f: &dyn Fn(&[f64]) -> Vec<f64>,
    h: f64,
    x: &[f64],
) -> Vec<f64> {
    let mut next = x.to_vec();
    for _ in 0..200 {
        next = step(method, f, h, x, &next);
    }
    next
}
