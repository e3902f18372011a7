//! A cart-pole between soft walls that move, planned at several rates: the closed loop of X. Lin,
//! "Accelerating hybrid model predictive control using warm-started generalized Benders
//! decomposition" (arXiv:2406.00780).
//!
//! `cargo run --release --example moving_walls -- [RATE...] [--steps N] [--seed S] [--noise F]
//! [--horizon N] [--record FILE] [--compare] [--each]`
//!
//! * `RATE...`: plans in a second; 20, 50, 100 and 1000 by default
//! * `--steps N`: plans of a loop, 1000 by default
//! * `--seed S`: of the disturbances, 1 by default
//! * `--noise F`: a factor of all disturbances, 1 by default
//! * `--horizon N`: steps of a plan, of 0.02 s, 10 by default
//! * `--record FILE`: disturbances to take instead, a line for 5 ms: the torque on the pole (N m),
//!   and by how much the left and the right wall are farther from the middle (m)
//! * `--compare`: each program is also solved from nothing, and the optima must agree
//! * `--each`: a line per plan as well
//!
//! Walls and state are measured before each plan, and the first force acts on a plant with sines and
//! cosines until the next one. The plans are those of one prepared model on one thread. Times are
//! processor time where the system tells it, from the state to the proof and from the state to the
//! first plan; "contact" are plans that touch a wall. A state without a plan begins the loop again
//! in the middle. Ctrl-C ends the loop at hand, with the exit status 3.

#[macro_use]
#[path = "../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

#[path = "common/clock.rs"]
mod clock;
#[path = "../tests/instances/mod.rs"]
mod instances;

use std::ops::ControlFlow;
use std::process::ExitCode;

use carom::prelude::*;
use clock::Clock;
use instances::moving_walls::{self, GUST, Gust, Gusts, HORIZON, MovingWalls, STEP};
use interrupts::{INTERRUPTED, Signals};

type Failure = Box<dyn std::error::Error>;

/// How loops are run.
struct Settings {
    steps: usize,
    seed: u64,
    noise: f64,
    horizon: usize,
    record: Vec<Gust>,
    compares: bool,
    each: bool,
}

/// The effort of a plan.
struct Effort {
    milliseconds: f64,
    /// From the state to the first plan.
    first: f64,
    nodes: f64,
    relaxations: f64,
    touches: bool,
    is_optimal: bool,
}

impl Effort {
    /// # Arguments
    ///
    /// * `binaries`: those of contacts.
    fn of(
        solution: &Solution,
        binaries: &[Variable],
        [milliseconds, first]: [f64; 2],
    ) -> Result<Self, Error> {
        let counts = solution.statistics();
        let mut touches = false;
        for &binary in binaries {
            touches |= solution.value(binary)? > 0.5;
        }
        Ok(Effort {
            milliseconds,
            first,
            nodes: counts.nodes as f64,
            relaxations: counts.relaxations as f64,
            touches,
            is_optimal: solution.is_optimal(),
        })
    }
}

/// A loop: its plans, the states without one, and whether the optima agree.
struct Run {
    efforts: Vec<Effort>,
    without: usize,
    agrees: bool,
}

fn run(rate: f64, settings: &Settings, interrupt: &Interrupt) -> Result<Run, Error> {
    let MovingWalls { mut model, push } = MovingWalls::new(settings.horizon)?;
    let measured: Vec<Variable> = model.parameters().collect();
    let binaries: Vec<Variable> = model
        .variables()
        .filter(|v| v.name().family().contains("pressed"))
        .map(|v| v.id())
        .collect();
    let [mut cold, mut solver] = [(); 2].map(|()| BranchAndBound::default());
    let mut prepared = solver.prepare(&model)?;
    let mut gusts: Box<dyn Iterator<Item = Gust>> = match settings.record.is_empty() {
        true => Box::new(Gusts::new(settings.seed, settings.noise)),
        false => Box::new(settings.record.iter().copied().cycle()),
    };
    let mut gust = gusts.next().unwrap_or(Gust::CALM);
    let mut result = Run { efforts: Vec::new(), without: 0, agrees: true };
    // Ticks of 1 ms; a plan's step is 20 of them.
    let ticks = |seconds: f64| (1e3 * seconds).round() as usize;
    let (hold, gust_ticks, step) = (ticks(1.0 / rate), ticks(GUST), ticks(STEP));
    let (mut state, mut now, mut passed) = ([0.0; 4], 0, 0);
    for number in 0..settings.steps {
        let values = state.into_iter().chain(gust.walls);
        let values: Vec<(Variable, f64)> = measured.iter().copied().zip(values).collect();
        let mut first = None;
        let clock = Clock::start();
        let mut note = |_: &Incumbent<'_>| {
            first.get_or_insert_with(|| clock.waited());
            ControlFlow::Continue(())
        };
        let mut control = Control::default()
            .with_interrupt(interrupt)
            .with_steps_passed(passed)
            .with_incumbent(&mut note);
        let solution = prepared.solve(&values, &mut control)?;
        let milliseconds = clock.spent();
        if interrupt.is_triggered() {
            break;
        }
        if settings.compares {
            model.set_parameters(&values)?;
            let one = cold.solve(&model)?;
            result.agrees &= match (one.objective(), solution.objective()) {
                (Some(best), Some(own)) => (best - own).abs() <= 3e-6 * best.abs() + 3e-7,
                (best, own) => best.is_none() && own.is_none(),
            };
        }
        let force = match solution.point() {
            Some(point) => point.value(&push)?,
            None => {
                (result.without, state) = (result.without + 1, [0.0; 4]);
                continue;
            }
        };
        let effort = Effort::of(&solution, &binaries, [milliseconds, first.unwrap_or(f64::NAN)])?;
        if settings.each {
            println!(
                "{number:>4} {state:.3?} force {force:.3}: {milliseconds:.3} ms, first {:.3} ms, \
                 {} nodes, {} relaxations, cost {:.6}",
                effort.first,
                effort.nodes,
                effort.relaxations,
                solution.objective().unwrap_or(f64::NAN)
            );
        }
        result.efforts.push(effort);
        passed = (now + hold) / step - now / step;
        for _ in 0..hold {
            state = moving_walls::after(state, force, &gust, 1e-3);
            now += 1;
            if now % gust_ticks == 0 {
                gust = gusts.next().unwrap_or(Gust::CALM);
            }
        }
    }
    Ok(result)
}

/// The value that a part of all values does not exceed.
fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((part * last as f64).ceil() as usize).copied().unwrap_or(f64::NAN)
}

fn read_record(path: &str) -> Result<Vec<Gust>, Failure> {
    let text = std::fs::read_to_string(path)?;
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines
        .map(|line| {
            let numbers =
                line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let [torque, left, right] = numbers[..] else {
                return Err(format!("`{line}` has {} numbers and not 3", numbers.len()).into());
            };
            Ok(Gust::new(torque, [left, right]))
        })
        .collect()
}

fn main() -> Result<ExitCode, Failure> {
    let (mut rates, mut words) = (Vec::new(), std::env::args().skip(1));
    let mut settings = Settings {
        steps: 1000,
        seed: 1,
        noise: 1.0,
        horizon: HORIZON,
        record: Vec::new(),
        compares: false,
        each: false,
    };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--each" => settings.each = true,
            "--compare" => settings.compares = true,
            "--steps" => settings.steps = value()?.parse()?,
            "--seed" => settings.seed = value()?.parse()?,
            "--noise" => settings.noise = value()?.parse()?,
            "--horizon" => settings.horizon = value()?.parse()?,
            "--record" => settings.record = read_record(&value()?)?,
            rate => rates.push(rate.parse::<f64>().map_err(|_| format!("{rate} is no rate"))?),
        }
    }
    if rates.is_empty() {
        rates = vec![20.0, 50.0, 100.0, 1000.0];
    }
    println!(
        "| rate / Hz | plans | contact | median / ms | 99 % / ms | worst / ms | first plan / ms | \
         nodes | most nodes | relaxations | without |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let mut is_right = true;
    for rate in rates {
        let Run { efforts, without, agrees } = run(rate, &settings, &interrupt)?;
        is_right &= agrees && efforts.iter().all(|effort| effort.is_optimal);
        let all = |of: fn(&Effort) -> f64| efforts.iter().map(of).collect::<Vec<_>>();
        let mean = |of: fn(&Effort) -> f64| all(of).iter().sum::<f64>() / efforts.len() as f64;
        let time = |part: f64| quantile(all(|effort| effort.milliseconds), part);
        println!(
            "| {rate} | {} | {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {} | {:.1} | {without} |",
            efforts.len(),
            efforts.iter().filter(|effort| effort.touches).count(),
            time(0.5),
            time(0.99),
            time(1.0),
            quantile(all(|effort| effort.first), 0.5),
            mean(|effort| effort.nodes),
            quantile(all(|effort| effort.nodes), 1.0),
            mean(|effort| effort.relaxations),
        );
        if signals.came() {
            return Ok(INTERRUPTED.into());
        }
    }
    if settings.compares {
        println!("optima agree: {is_right}");
    }
    Ok(if is_right { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
