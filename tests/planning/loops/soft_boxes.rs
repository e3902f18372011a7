//! A controller among boxes that may be entered at a price, with noise and hardly any nodes, from a
//! cold start.

use carom::hybrid::{ControlMove, Disturbance, RecedingHorizon};
use carom::interval::Interval;
use carom::prelude::*;

const H: f64 = 0.2; // s
const STEPS: usize = 10;
const ROOM: [f64; 2] = [6.0, 4.0]; // m
/// Left, right, below, above, in m.
const BOXES: [[f64; 4]; 3] = [[1.2, 1.9, 0.0, 2.2], [2.8, 3.4, 1.4, 4.0], [4.3, 4.9, 0.6, 2.6]];
/// By how much plans stay away from boxes, in m.
const MARGIN: f64 = 0.05;
/// Of positions (m) and speeds (m/s), in each step.
const NOISE: f64 = 0.01;

/// The program, the measured state, and the families of states, inputs and depths.
struct Controlled {
    model: Model,
    measured: Vec<Variable>,
    states: Vec<Family>,
    inputs: Vec<Family>,
    depth: Family,
}

fn controlled() -> Result<Controlled, Error> {
    let mut model = Model::new("boxes");
    let (n, most) = (STEPS, [7.0, 5.0]);
    let mut states = Vec::new();
    for (name, upper) in ["x", "y"].into_iter().zip(most) {
        states.push(model.continuous_family(name, n + 1, -1.0, upper)?);
    }
    for name in ["vx", "vy"] {
        states.push(model.continuous_family(name, n + 1, -3.0, 3.0)?);
    }
    let inputs = vec![
        model.continuous_family("ux", n, -2.0, 2.0)?,
        model.continuous_family("uy", n, -2.0, 2.0)?,
    ];
    let depth = model.continuous_family("depth", n + 1, 0.0, 3.0)?;
    let mut measured = Vec::new();
    for (k, family) in states.iter().enumerate() {
        let (lower, upper) = if k < 2 { (-1.0, most[k]) } else { (-3.0, 3.0) };
        let now = model.parameter(("now", k), 0.5, lower, upper)?;
        model.add(("start", k), (family[0] - now).equals(0.0))?;
        measured.push(now);
    }
    let mut cost = Quadratic::zero();
    for t in 0..n {
        let next = t + 1;
        for axis in 0..2 {
            let (x, v, u) = (&states[axis], &states[axis + 2], &inputs[axis]);
            let flow = x[next] - x[t] - H * v[t] - 0.5 * H * H * u[t];
            model.add((format!("position_{axis}"), t), flow.equals(0.0))?;
            model.add((format!("speed_{axis}"), t), (v[next] - v[t] - H * u[t]).equals(0.0))?;
            model.add((format!("room_{axis}"), next), x[next].within(0.0, ROOM[axis]))?;
        }
        let around = |pair: [Variable; 2], k: u32| -> Affine {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 8.0).sin_cos();
            cos * pair[0] + sin * pair[1]
        };
        for k in 0..8 {
            let push = around([inputs[0][t], inputs[1][t]], k);
            model.add((format!("thrust_{k}"), t), push.le(1.847))?;
            let speed = around([states[2][next], states[3][next]], k);
            model.add((format!("slow_{k}"), next), speed.le(1.385))?;
        }
        for (b, [left, right, below, above]) in BOXES.into_iter().enumerate() {
            let beyond = |family: &Family, limit: f64, sign: f64| {
                let row = |at: usize| (sign * family[at] + depth[next]).ge(sign * limit + MARGIN);
                vec![row(t), row(next)]
            };
            let (x, y) = (&states[0], &states[1]);
            let sides = Either::of([
                beyond(x, left, -1.0),
                beyond(x, right, 1.0),
                beyond(y, below, -1.0),
                beyond(y, above, 1.0),
            ]);
            model.add((format!("box_{b}"), next), sides)?;
        }
        let weight = if next == n { 10.0 } else { 1.0 };
        let miss = (states[0][next] - 5.5).square() + (states[1][next] - 3.5).square();
        let fast = states[2][next].square() + states[3][next].square();
        cost += weight * (miss + 0.1 * fast);
        cost += 0.1 * (inputs[0][t].square() + inputs[1][t].square()) + 500.0 * depth[next];
    }
    model.minimize(cost)?;
    Ok(Controlled { model, measured, states, inputs, depth })
}

/// By how much a position is inside a box, in m; negative outside.
fn inside([left, right, below, above]: [f64; 4], state: &[f64]) -> f64 {
    let sides = [state[0] - left, right - state[0], state[1] - below, above - state[1]];
    sides.into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn a_controller_with_a_budget_of_a_node_has_plans_from_a_cold_start() {
    let own = controlled().unwrap();
    // Without cuts a step of a test takes a tenth of the time.
    let mut solver = BranchAndBound::new(Options::default().with_node_limit(1).with_cuts(false));
    let depth: Affine = own.depth.iter().skip(1).map(Affine::from).sum();
    let controller =
        RecedingHorizon::of_model(&own.model, &own.measured, &own.states, &own.inputs, &mut solver);
    let mut controller = controller.unwrap().with_excess(depth);
    let mut noise = Disturbance::new(vec![Interval::new(-NOISE, NOISE); 4], 3);
    let plant = |z: &[f64], next: &ControlMove| {
        let (u, w) = (&next.input, noise.next_value());
        let place = |i: usize| z[i] + H * z[i + 2] + 0.5 * H * H * u[i] + w[i];
        Ok(vec![place(0), place(1), z[2] + H * u[0] + w[2], z[3] + H * u[1] + w[3]])
    };
    let run = controller.run(&[0.4, 0.5, 0.0, 0.0], 60, plant).unwrap();
    let planned = run.moves.iter().filter(|next| !next.states.is_empty()).count();
    assert!(planned >= 57, "{run}");
    // The margin of a plan is more than the noise of a step.
    let deepest = run.states.iter().flat_map(|state| BOXES.map(|sides| inside(sides, state)));
    assert!(deepest.fold(f64::NEG_INFINITY, f64::max) < NOISE, "{:?}", run.states);
    // With so short a horizon it stops behind the second box, but not before.
    let end = run.states.last().unwrap();
    assert!(end[0] > 2.6 && end[1] > 3.3, "{end:?}");
}
