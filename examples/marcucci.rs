//! A cart-pole between two soft walls, planned again after every step: the closed loop of T.
//! Marcucci and R. Tedrake, "Warm start of mixed-integer programs for model predictive control of
//! hybrid systems" (arXiv:1910.08251), without disturbances.
//!
//! `cargo run --release --example marcucci -- [STEPS] [--each]`
//! `cargo run --release --example marcucci -- [STEPS] --budget MS`
//!
//! Solves the programs of STEPS (50) steps three times: from nothing; prepared, without anything
//! from the step before; and prepared and warm, beginning with the shifted plan and the last tree.
//! Prints the mean nodes, relaxations and times (of this thread, where the system tells it) beside
//! the published ones (another machine); with `--each`, also a line per step. The exit status tells whether all optima agree within the gaps.
//! With `--budget`, a controller under noise takes at most so many milliseconds a search, and the
//! summary says where its inputs came from, how many plans were proved optimal, and how many inputs
//! violate a limit in a simulation of the next step. Ctrl-C ends the loop with the means so far,
//! and the exit status 3.

#[macro_use]
#[path = "../crates/carom-cli/src/output.rs"]
mod output;
#[path = "common/clock.rs"]
mod clock;
#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::Duration;

use carom::hybrid::{Lqr, Matrix, MoveSource, TerminalOptions, TerminalSet};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Halfspace, Transition};
use clock::Clock;
use interrupts::{INTERRUPTED, Signals};

const T: usize = 20;
const H: f64 = 0.05;
const WALL: f64 = 0.5;
const STIFFNESS: f64 = 100.0;
const DAMPING: f64 = 10.0;
/// Limits of the position of the cart, the angle, and their rates.
const MOST: [f64; 4] = [WALL, std::f64::consts::PI / 10.0, 1.0, 1.0];
const START: [f64; 4] = [0.0, 0.0, 1.0, 0.0];

/// The dynamics under the force on the cart and those of the walls on the pole's tip.
fn dynamics() -> Result<LinearSystem, Error> {
    let a = [
        [1.0, 0.0, H, 0.0],
        [0.0, 1.0, 0.0, H],
        [0.0, 10.0 * H, 1.0, 0.0],
        [0.0, 20.0 * H, 0.0, 1.0],
    ];
    let b = [[0.0; 3], [0.0; 3], [H, 0.0, 0.0], [H, -H, H]];
    LinearSystem::new(a, b, [0.0; 4])
}

struct CartPole {
    model: Model,
    start: [Variable; 4],
    state: [Family; 4],
    /// The force on the cart, and those of the walls on the pole's tip.
    force: [Family; 3],
    end: TerminalSet,
}

fn cart_pole() -> Result<CartPole, Error> {
    let mut model = Model::new("cart_pole");
    let names = ["q", "angle", "v", "rate"];
    let mut state = Vec::new();
    for (name, most) in names.iter().zip(MOST) {
        state.push(model.continuous_family(name, T + 1, -most, most)?);
    }
    let state: [Family; 4] = state.try_into().expect("four states");
    // How far the tip can be in a wall and how fast it can go there, and the force that follows.
    let (deep, fast) = (MOST[0] + MOST[1] - WALL, MOST[2] + MOST[3]);
    let (far, most) = (-MOST[0] - MOST[1] - WALL, STIFFNESS * deep + DAMPING * fast);
    let least = STIFFNESS * far - DAMPING * fast;
    let force = [
        model.continuous_family("push", T, -1.0, 1.0)?,
        model.continuous_family("left", T, 0.0, most)?,
        model.continuous_family("right", T, 0.0, most)?,
    ];
    let mut contact = Vec::new();
    for name in ["left_near", "left_pressed", "right_near", "right_pressed"] {
        contact.push(model.binary_family(name, T)?);
    }
    let contact: [Family; 4] = contact.try_into().expect("four binaries");
    let mut start = Vec::new();
    for (i, name) in ["q0", "angle0", "v0", "rate0"].into_iter().enumerate() {
        start.push(model.parameter(name, START[i], -MOST[i], MOST[i])?);
        model.add(("start", i), (state[i][0] - start[i]).equals(0.0))?;
    }
    let system = dynamics()?;
    for t in 0..T {
        let now = [0, 1, 2, 3].map(|i| state[i][t]);
        let inputs = [0, 1, 2].map(|i| force[i][t]);
        for (i, next) in system.predict(&now, &inputs)?.into_iter().enumerate() {
            model.add(
                (["move_q", "move_angle", "move_v", "move_rate"][i], t),
                (state[i][t + 1] - next).equals(0.0),
            )?;
        }
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let depth = sign * (state[0][t] - state[1][t]) - WALL;
            let spring = STIFFNESS * sign * (state[0][t] - state[1][t])
                + DAMPING * sign * (state[2][t] - state[3][t]);
            let spring: Affine = spring - STIFFNESS * WALL;
            let (near, pressed) = (contact[2 * side][t], contact[2 * side + 1][t]);
            let f = force[1 + side][t];
            let name = |what: &str| (format!("{}_{what}", ["left", "right"][side]), t);
            model.add(name("is_near"), (far - depth.clone() - far * near).le(0.0))?;
            model.add(name("is_far"), (depth - deep * near).le(0.0))?;
            model.add(name("pulls"), (least - spring.clone() - least * pressed).le(0.0))?;
            model.add(name("pushes"), (spring.clone() - most * pressed).le(0.0))?;
            model.add(name("off"), (f - most * near).le(0.0))?;
            model.add(name("free"), (f - most * pressed).le(0.0))?;
            model.add(
                name("least"),
                (spring.clone() + DAMPING * fast * near - f).le(DAMPING * fast),
            )?;
            model.add(name("most"), (f - spring - least * pressed).le(-least))?;
        }
    }
    let force_only = LinearSystem::new(
        system.a().clone(),
        Matrix::from_fn(4, 1, |i, _| system.b()[(i, 0)]),
        [0.0; 4],
    )?;
    let h2 = H * H;
    let q = Matrix::from_fn(4, 4, |i, j| if i == j { h2 } else { 0.0 });
    let lqr = Lqr::new(&force_only, q, [[h2]])?;
    let end = [0, 1, 2, 3].map(|i| state[i][T]);
    let set = terminal_set(force_only, &lqr)?;
    set.region.add(&mut model, "end", &end)?;
    let cost = |t: usize| {
        let square = |i: usize| state[i][t].square();
        h2 * (square(0) + square(1) + square(2) + square(3) + force[0][t].square())
    };
    let mut objective: Quadratic = (0..T).map(cost).sum();
    for i in 0..4 {
        for j in 0..4 {
            objective += lqr.cost[(i, j)] * (state[i][T] * state[j][T]);
        }
    }
    model.minimize(objective)?;
    let start = start.try_into().expect("four parameters");
    Ok(CartPole { model, start, state, force, end: set })
}

/// The states from which the regulator keeps all limits for ever without touching a wall.
fn terminal_set(flow: LinearSystem, lqr: &Lqr) -> Result<TerminalSet, Error> {
    let mut system = HybridSystem::new(1.0).with_input("push", Interval::new(-1.0, 1.0));
    for (name, most) in ["q", "angle", "v", "rate"].into_iter().zip(MOST) {
        system = system.with_state(name, Interval::new(-most, most));
    }
    for (name, sign) in [("left", -1.0), ("right", 1.0)] {
        let spring = [STIFFNESS, -STIFFNESS, DAMPING, -DAMPING].map(|k| sign * k);
        let normal = [sign, -sign, 0.0, 0.0];
        system = system
            .with_limit(Halfspace::new(format!("{name}_far"), normal, WALL))
            .with_limit(Halfspace::new(format!("{name}_free"), spring, STIFFNESS * WALL));
    }
    let system = system.with_transition(Transition::new("free", flow));
    let (target, options) = ([0.0; 4], TerminalOptions::default());
    TerminalSet::new(&system, &["free"], lqr, &target, &options, &mut BranchAndBound::default())
}

/// The ways in which every program is solved.
const NAMES: [&str; 3] = ["from nothing", "prepared", "prepared and warm"];

/// Nodes, relaxations and milliseconds of a solve.
#[derive(Debug, Clone, Copy, Default)]
struct Effort([f64; 3]);

impl Effort {
    fn add(&mut self, other: Effort) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, value)| *sum += value);
    }
}

/// A solution, and what it took.
fn timed(solve: impl FnOnce() -> Result<Solution, Error>) -> Result<(Solution, Effort), Error> {
    let clock = Clock::start();
    let solution = solve()?;
    let (counts, time) = (solution.statistics(), clock.spent());
    let effort = Effort([counts.nodes as f64, counts.relaxations as f64, time]);
    Ok((solution, effort))
}

/// A closed loop with noise, at most so many milliseconds a search. After a plan that was not found
/// in time, the rest of the last one is applied; without any, the regulator's force.
fn run_with_budget(steps: usize, milliseconds: f64) -> Result<ExitCode, Error> {
    let CartPole { model, start, state, force, end } = cart_pole()?;
    let mut solver = BranchAndBound::default();
    let mut noise = Disturbance::new([0.002, 0.002, 0.02, 0.02].map(|w| -w..=w), 1);
    let regulator = |x: &[f64]| vec![end.feedback(x).map_or(0.0, |u| u[0].clamp(-1.0, 1.0))];
    let within = |x: &[f64]| x.iter().zip(MOST).all(|(x, most)| x.abs() <= most + 1e-6);
    let check = |x: &[f64], inputs: &[Vec<f64>]| {
        let mut x = x.to_vec();
        inputs.iter().all(|input| match after(&x, input[0]) {
            Ok(next) => {
                x = next;
                within(&x)
            }
            Err(_) => false,
        })
    };
    let mut controller = RecedingHorizon::of_model(&model, &start, &state, &force, &mut solver)?
        .with_fallback(regulator)
        .with_check(check);
    let mut plant = |x: &[f64], next: &ControlMove| -> Result<Vec<f64>, Error> {
        let after = after(x, next.input[0])?.into_iter().zip(noise.next_value());
        Ok(after.zip(MOST).map(|((x, w), most)| (x + w).clamp(-most, most)).collect())
    };
    // The first plan, made before the loop begins, has all the time it wants.
    let first = controller.step(&START)?;
    let second = plant(&START, &first)?;
    let mut controller = controller.with_budget(Duration::from_secs_f64(1e-3 * milliseconds));
    let run = controller.run(&second, steps, plant)?;
    println!("{run}");
    let proved = run.moves.iter().filter(|next| next.source == MoveSource::Optimal).count();
    let bad = run.moves.iter().filter(|next| next.is_admissible != Some(true)).count();
    println!(
        "proved: {:.1} %, inputs that no simulation admits: {bad}",
        100.0 * proved as f64 / steps as f64
    );
    let mut reasons = BTreeMap::new();
    for reason in run.moves.iter().filter_map(|next| next.reason.as_deref()) {
        *reasons.entry(reason).or_insert(0) += 1;
    }
    for (reason, count) in reasons {
        println!("without a plan: {count} times, {reason}");
    }
    Ok(ExitCode::SUCCESS)
}

/// The state after a step under a force on the cart, with the forces that the walls then have.
fn after(x: &[f64], push: f64) -> Result<Vec<f64>, Error> {
    let wall = |sign: f64| {
        let depth = sign * (x[0] - x[1]) - WALL;
        let spring = STIFFNESS * depth + DAMPING * sign * (x[2] - x[3]);
        if depth >= 0.0 { spring.max(0.0) } else { 0.0 }
    };
    dynamics()?.step(x, &[push, wall(-1.0), wall(1.0)])
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let steps = words.first().and_then(|word| word.parse().ok()).unwrap_or(50_usize);
    let each = words.iter().any(|word| word == "--each");
    let budget = words.iter().skip_while(|word| *word != "--budget").nth(1);
    if let Some(milliseconds) = budget.and_then(|word| word.parse().ok()) {
        return Ok(run_with_budget(steps, milliseconds)?);
    }
    let CartPole { mut model, start, state, .. } = cart_pole()?;
    let [mut cold, mut fresh, mut solver] = [(); 3].map(|()| BranchAndBound::default());
    let mut warm = solver.prepare(&model)?;
    let (mut now, mut sums, mut agree) = (START, [Effort::default(); 3], true);
    let (mut longest, mut done) = ([0.0_f64; 3], 0.0);
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let control = || Control::default().with_interrupt(&interrupt);
    for step in 0..steps {
        let values: Vec<(Variable, f64)> = start.into_iter().zip(now).collect();
        for &(variable, value) in &values {
            model.set_parameter(variable, value)?;
        }
        let (one, first) = timed(|| cold.solve_with(&model, &mut control()))?;
        let mut prepared = fresh.prepare(&model)?;
        let (two, second) = timed(|| prepared.solve(&values, &mut control()))?;
        let (three, third) = timed(|| warm.solve(&values, &mut control().with_steps_passed(1)))?;
        if signals.came() {
            break;
        }
        done += 1.0;
        let efforts = [first, second, third];
        for ((sum, longest), effort) in sums.iter_mut().zip(&mut longest).zip(efforts) {
            sum.add(effort);
            *longest = if step > 0 { longest.max(effort.0[2]) } else { 0.0 };
        }
        if each {
            let each = NAMES.iter().zip(efforts).map(|(name, of)| format!("{name} {:.2?}", of.0));
            println!("{step:>3} {}", each.collect::<Vec<_>>().join(", "));
        }
        let Some(best) = one.objective() else {
            println!("step {step}: {}, {}", one.termination(), three.termination());
            return Ok(ExitCode::FAILURE);
        };
        let is_best = |own: f64| (best - own).abs() <= 3e-6 * best.abs() + 3e-7;
        agree &= [&two, &three].iter().all(|own| own.objective().is_some_and(is_best));
        for (value, family) in now.iter_mut().zip(&state) {
            *value = one.value(family[1])?;
        }
    }
    println!("{:<44} {:>6} {:>12} {:>8}", "mean of a solve", "nodes", "relaxations", "ms");
    let ours = NAMES.into_iter().zip(sums).zip(longest);
    for ((name, Effort(sums)), longest) in ours {
        let [nodes, relaxations, time] = sums.map(|sum| sum / done);
        let most = format!("at most {longest:.1} from the second step on");
        println!("{name:<44} {nodes:>6.1} {relaxations:>12.1} {time:>8.1}  {most}");
    }
    println!("{:<44} {:>6.1} {:>12} {:>8.0}", "published, from nothing", 159.0, "-", 530.0);
    println!("{:<44} {:>6.1} {:>12} {:>8.0}", "published, warm-started", 15.6, "-", 47.0);
    println!(
        "{:<44} {:>6} {:>12} {:>8.0}",
        "published, Gurobi with the shifted plan", "-", "-", 20.0
    );
    println!("optima agree: {agree}");
    if signals.came() {
        println!("interrupted after {done} steps");
        return Ok(INTERRUPTED.into());
    }
    Ok(if agree { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
