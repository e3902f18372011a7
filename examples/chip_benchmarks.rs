//! Four controllers with modes, solved beforehand for every state: sizes, and times beside solves.
//!
//! `cargo run --release --example chip_benchmarks -- [STATES] [FOLDER]`
//!
//! At STATES random states (100 by default) of each system, the program is solved online, from its
//! last tree. Where the table has an input, the online optimum with that input must be within the
//! loss; where it says that there is no plan, there must be none. FOLDER gets certificates for
//! `carom-proof table`.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::{Duration, Instant};

use carom::explicit::{ExplicitProgram, ExplicitTable, LookupAnswer};
use carom::hybrid::HybridProgram;
use carom::prelude::*;

/// A program with a first input, the axes of its table, and the table.
struct System {
    program: HybridProgram,
    axes: Vec<Variable>,
    input: Affine,
    table: ExplicitTable,
}

/// A cart on a rail with a soft wall at 0.5 m that pushes it back.
fn wall() -> Result<System, Error> {
    let step = 0.2;
    let mut cart = HybridSystem::new(step);
    let x = cart.state("x", -2.0, 1.0)?; // m
    let v = cart.state("v", -2.0, 2.0)?; // m/s
    let u = cart.input("u", -1.0, 1.0)?; // m/s²
    let flow = |push: Affine| [(x, x + step * v), (v, v + step * (u + push))];
    cart.mode("free")?.next(flow(0.0.into()))?.guard(x.le(0.5))?;
    cart.mode("pushed")?.next(flow(20.0 * (0.5 - x)))?.guard(x.ge(0.5))?;
    let mut program = cart.program(4)?;
    let cost = program.sum(x.square() + 0.5 * v.square() + 0.2 * u.square())?;
    program.minimize(cost + 4.0 * program.end(x.square() + v.square())?)?;
    let axes = program.open_start([(x, -1.0..=0.7), (v, -1.0..=1.0)])?;
    let input = program.at(u, 0)?;
    let table = ExplicitProgram::new(program.model(), axes.clone(), [input.clone()])?
        .with_loss(0.02, 0.02)?
        .build();
    Ok(System { program, axes, input, table })
}

/// A buck converter: a switch connects the coil to the source or not.
fn converter() -> Result<System, Error> {
    let mut buck = HybridSystem::new(1.0);
    let current = buck.state("i", -1.0, 4.0)?; // A
    let voltage = buck.state("v", -1.0, 3.0)?; // V
    let flow = |source: f64| {
        let next = current + 0.25 * (source - voltage) - 0.05 * current;
        [(current, next), (voltage, voltage + 0.25 * (current - voltage))]
    };
    let on = buck.mode("on")?.next(flow(3.0))?.taken();
    buck.mode("off")?.next(flow(0.0))?;
    let mut program = buck.program(4)?;
    let cost = program.sum((voltage - 1.5).square() + 0.2 * (current - 1.5).square())?;
    program.minimize(cost + 4.0 * program.end((voltage - 1.5).square())?)?;
    let axes = program.open_start([(current, 0.0..=3.0), (voltage, 0.0..=2.5)])?;
    let input = program.at(on, 0)?;
    let table = ExplicitProgram::new(program.model(), axes.clone(), [input.clone()])?
        .with_loss(0.02, 0.05)?
        .build();
    Ok(System { program, axes, input, table })
}

/// A room with a heater that stays on or off for two steps, and a price of its energy.
fn thermostat() -> Result<System, Error> {
    let mut room = HybridSystem::new(900.0);
    let warm = room.state("warm", 10.0, 30.0)?; // °C
    let [off, on] = room.modes("heater", ["off", "on"])?;
    let flow = |heat: f64| [(warm, warm + 0.1 * (10.0 - warm) + heat)];
    room.stay(off)?.next(flow(0.0))?;
    room.stay(on)?.next(flow(2.0))?;
    room.switch(off, on)?;
    room.switch(on, off)?;
    room.dwell(on, 2, None)?;
    room.dwell(off, 2, None)?;
    let heats = room.acting(on)?;
    let mut program = room.program(5)?;
    program.start([off.equals(1.0)])?;
    let mut axes = program.open_start([(warm, 14.0..=26.0)])?;
    let price = program.model_mut().parameter("price", 1.0, 0.0, 2.0)?;
    let mut cost: Quadratic = program.sum((warm - 20.0).square())?;
    for t in 0..5 {
        cost += program.at(heats, t)? * price;
    }
    program.minimize(cost)?;
    let input = program.at(heats, 0)?;
    axes.push(price);
    let table = ExplicitProgram::new(program.model(), axes.clone(), [input.clone()])?
        .with_loss(0.1, 0.03)?
        .build();
    Ok(System { program, axes, input, table })
}

/// A pole on a cart between soft walls, linearised (arXiv 1910.08251), with a short horizon.
fn pole() -> Result<System, Error> {
    let get = |n: &str, d: f64| std::env::var(n).ok().and_then(|s| s.parse().ok()).unwrap_or(d);
    let step = get("STEP", 0.1);
    let mut cart = HybridSystem::new(step);
    let tip = cart.state("tip", -1.0, 1.0)?; // m
    let w = cart.state("w", -3.0, 3.0)?; // m/s
    let angle = cart.state("angle", -0.7, 0.7)?; // rad
    let rate = cart.state("rate", -4.0, 4.0)?; // rad/s
    let u = cart.input("u", -3.0, 3.0)?; // N
    let flow = |push: Affine| {
        [
            (tip, tip + step * w),
            (w, w - step * (10.0 * angle + push.clone())),
            (angle, angle + step * rate),
            (rate, rate + step * (20.0 * angle + u + push)),
        ]
    };
    cart.mode("free")?.next(flow(0.0.into()))?.guard(tip.le(0.5))?.guard(tip.ge(-0.5))?;
    cart.mode("right")?.next(flow(50.0 * (tip - 0.5)))?.guard(tip.ge(0.5))?;
    cart.mode("left")?.next(flow(50.0 * (tip + 0.5)))?.guard(tip.le(-0.5))?;
    let mut program = cart.program(get("N", 2.0) as usize)?;
    let (x, v) = (tip + angle, w + rate);
    let cost = program.sum(x.clone().square() + angle.square() + 0.1 * u.square())?;
    program.minimize(
        cost + program.end(x.square() + v.square() + 5.0 * angle.square() + rate.square())?,
    )?;
    let axes = program.open_start([
        (tip, get("T0", -2.0 / 3.0)..=get("T1", 2.0 / 3.0)),
        (w, -get("W", 0.2)..=get("W", 0.2)),
        (angle, -get("A", 0.1)..=get("A", 0.1)),
        (rate, -get("R", 0.2)..=get("R", 0.2)),
    ])?;
    let input = program.at(u, 0)?;
    let table = ExplicitProgram::new(program.model(), axes.clone(), [input.clone()])?
        .with_loss(get("EA", 0.2), get("ER", 0.1))?
        .with_finest(get("F", 1.0 / 16.0))?
        .with_cell_limit(get("C", 100_000.0) as usize)
        .build();
    Ok(System { program, axes, input, table })
}

/// Random states of the box.
struct States(u64);

impl States {
    fn next_state(&mut self, table: &ExplicitTable) -> Vec<f64> {
        let view = table.double().view();
        let within = |(lower, upper): (&f64, &f64)| {
            // Xorshift, by George Marsaglia.
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            lower + (upper - lower) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        view.lower.iter().zip(view.upper).map(within).collect()
    }
}

/// The median and the longest time of online solves; errors if the table is wrong.
fn compare(system: &System, count: usize) -> Result<[Duration; 2], Box<dyn std::error::Error>> {
    let System { program, axes, input, table } = system;
    let mut states = States(88172645463325252);
    // What the table says is given, and then free.
    let mut held = program.model().clone();
    let given = held.parameter("given", 0.0, -1e3, 1e3)?;
    held.add("given_row", (input.clone() - given).equals(0.0))?;
    let (mut solver, mut other) = (BranchAndBound::default(), BranchAndBound::default());
    let mut online = solver.prepare(program.model())?;
    let mut held = other.prepare(&held)?;
    let mut times = Vec::new();
    for _ in 0..count {
        let state = states.next_state(table);
        let mut values: Vec<(Variable, f64)> = axes.iter().copied().zip(state.clone()).collect();
        let began = Instant::now();
        let best = online.solve(&values, &mut Control::default())?;
        times.push(began.elapsed());
        match table.evaluate(&state) {
            (LookupAnswer::Plan { loss }, inputs) => {
                values.push((given, inputs[0]));
                let own = held.solve(&values, &mut Control::default())?;
                let (own, best) = (own.objective(), best.objective());
                let costs = own.zip(best).ok_or("a law is infeasible online")?;
                if costs.0 > costs.1 + loss + 1e-4 * (1.0 + costs.1.abs()) {
                    return Err(format!("{state:?}: {costs:?}, and a loss of {loss}").into());
                }
            }
            (LookupAnswer::NoPlan, _) if !best.is_infeasible() => {
                return Err(format!("{state:?} has a plan").into());
            }
            _ => {}
        }
    }
    times.sort();
    Ok([times[count / 2], times[count - 1]])
}

/// The mean time of a look-up in 32 bits at random states, and the longest of a thousand means.
fn look_up(table: &ExplicitTable) -> [Duration; 2] {
    let single = table.single();
    let (view, mut input) = (single.view(), vec![0.0; single.inputs()]);
    let mut states = States(88172645463325252);
    let (mut sum, mut longest, mut total) = (Duration::ZERO, Duration::ZERO, 0.0);
    for _ in 0..1000 {
        let state: Vec<f32> = states.next_state(table).iter().map(|x| *x as f32).collect();
        let began = Instant::now();
        for _ in 0..100 {
            let answer = view.evaluate(std::hint::black_box(&state), &mut input);
            total += f32::from(u8::from(answer.has_inputs()));
        }
        let time = began.elapsed() / 100;
        (sum, longest) = (sum + time, longest.max(time));
    }
    std::hint::black_box(total);
    [sum / 1000, longest]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(100), |word| word.parse())?;
    let folder = arguments.next();
    type Build = fn() -> Result<System, Error>;
    let systems: [(&str, Build); 4] =
        [("wall", wall), ("converter", converter), ("thermostat", thermostat), ("pole", pole)];
    println!(
        "system      cells    bytes  depth  seconds  within  larger  no plan  open    \
         look-up: mean, longest   online: median, longest"
    );
    for (name, build) in systems {
        if std::env::var("ONLY").is_ok_and(|only| only != name) {
            continue;
        }
        let system = build()?;
        let (report, single) = (system.table.report(), system.table.single());
        let percent = |share: f64| 100.0 * share;
        let [mean, longest] = look_up(&system.table);
        let [median, last] = compare(&system, count)?;
        println!(
            "{name:10}  {:5}  {:7}  {:5}  {:7.1}  {:5.1}%  {:5.1}%   {:5.1}%  {:4.1}%   \
             {mean:>10.0?} {longest:>9.0?}        {median:>10.1?} {last:>9.1?}",
            report.cells,
            single.bytes(),
            report.depth,
            report.duration.as_secs_f64(),
            percent(report.proved),
            percent(report.unproved),
            percent(report.refuted),
            percent(report.open)
        );
        if let Some(folder) = &folder {
            let file = File::create(Path::new(folder).join(format!("{name}.table")))?;
            system.table.write_certificate(BufWriter::new(file))?;
        }
    }
    Ok(())
}
