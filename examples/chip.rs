//! Four controllers with modes, solved beforehand for every state, as tables for a chip.
//!
//! `cargo run --release --example chip -- [FOLDER]`
//!
//! For each system, a table with its sizes and what is proved of it. FOLDER gets the tables in Rust
//! and C99, and certificates for `carom-proof table`.

use std::path::Path;

use carom::explicit::{ExplicitProgram, ExplicitTable};
use carom::prelude::*;

/// A cart on a rail with a soft wall at 0.5 m that pushes it back.
fn wall() -> Result<ExplicitTable, Error> {
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
    let start = program.open_start([(x, -1.0..=0.7), (v, -1.0..=1.0)])?;
    let input = program.at(u, 0)?;
    ExplicitProgram::new(program.model(), start, [input])?.with_loss(0.02, 0.02)?.build()
}

/// A buck converter: a switch connects the coil to the source or not.
fn converter() -> Result<ExplicitTable, Error> {
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
    let start = program.open_start([(current, 0.0..=3.0), (voltage, 0.0..=2.5)])?;
    let input = program.at(on, 0)?;
    ExplicitProgram::new(program.model(), start, [input])?.with_loss(0.02, 0.05)?.build()
}

/// A room with a heater that stays on or off for two steps, and a price of its energy.
fn thermostat() -> Result<ExplicitTable, Error> {
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
    let start = program.open_start([(warm, 14.0..=26.0)])?;
    let price = program.model_mut().parameter("price", 1.0, 0.0, 2.0)?;
    let mut cost: Quadratic = program.sum((warm - 20.0).square())?;
    for t in 0..5 {
        cost += program.at(heats, t)? * price;
    }
    program.minimize(cost)?;
    let input = program.at(heats, 0)?;
    let axes = start.into_iter().chain([price]);
    ExplicitProgram::new(program.model(), axes, [input])?.with_loss(0.1, 0.03)?.build()
}

/// A pole on a cart between soft walls, linearised (arXiv 1910.08251), with a short horizon.
fn pole(horizon: usize) -> Result<ExplicitTable, Error> {
    let step = 0.1;
    let mut cart = HybridSystem::new(step);
    let x = cart.state("x", -1.0, 1.0)?; // m, of the tip
    let v = cart.state("v", -3.0, 3.0)?; // m/s
    let angle = cart.state("angle", -0.7, 0.7)?; // rad
    let rate = cart.state("rate", -4.0, 4.0)?; // rad/s
    let u = cart.input("u", -3.0, 3.0)?; // N
    let flow = |push: Affine| {
        let turned = rate + step * (20.0 * angle + u + push);
        [
            (x, x + step * v),
            (v, v + step * (10.0 * angle + u)),
            (angle, angle + step * rate),
            (rate, turned),
        ]
    };
    let tip = x - angle;
    cart.mode("free")?
        .next(flow(0.0.into()))?
        .guard(tip.clone().le(0.5))?
        .guard(tip.clone().ge(-0.5))?;
    cart.mode("right")?.next(flow(50.0 * (tip.clone() - 0.5)))?.guard(tip.clone().ge(0.5))?;
    cart.mode("left")?.next(flow(50.0 * (tip.clone() + 0.5)))?.guard(tip.le(-0.5))?;
    let mut program = cart.program(horizon)?;
    let cost = program.sum(x.square() + angle.square() + 0.1 * u.square())?;
    program.minimize(
        cost + program.end(x.square() + v.square() + 5.0 * angle.square() + rate.square())?,
    )?;
    let start = program.open_start([
        (x, -0.6..=0.6),
        (v, -0.5..=0.5),
        (angle, -0.15..=0.15),
        (rate, -0.5..=0.5),
    ])?;
    let input = program.at(u, 0)?;
    ExplicitProgram::new(program.model(), start, [input])?
        .with_loss(0.2, 0.1)?
        .with_finest(1.0 / 16.0)?
        .with_cell_limit(100_000)
        .build()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1);
    let systems: [(&str, fn() -> Result<ExplicitTable, Error>); 4] = [
        ("wall", wall),
        ("converter", converter),
        ("thermostat", thermostat),
        ("pole", || pole(2)),
    ];
    println!("system      cells   bytes  depth  seconds  within ε  larger  no plan   open");
    for (name, build) in systems {
        let table = build()?;
        let (report, single) = (table.report(), table.single());
        let percent = |share: f64| 100.0 * share;
        println!(
            "{name:10}  {:5}  {:6}  {:5}  {:7.1}  {:6.1} %  {:4.1} %   {:4.1} %  {:4.1} %",
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
            let path = |end: &str| Path::new(folder).join(format!("{name}.{end}"));
            let [header, source] = single.c_source(name)?;
            std::fs::write(path("h"), header)?;
            std::fs::write(path("c"), source)?;
            std::fs::write(path("rs"), single.rust_source(&name.to_uppercase())?)?;
            table.write_certificate(std::io::BufWriter::new(std::fs::File::create(path(
                "table",
            ))?))?;
        }
    }
    Ok(())
}
