//! A cart between soft walls, solved beforehand for all states, as a table for a chip.
//!
//! `cargo run --release --example chip -- [PICTURE.svg] [FOLDER]`
//!
//! PICTURE gets the partition, coloured by the modes of the plan. FOLDER gets the table in C99 and
//! Rust, and its certificate for `carom-proof table`.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use carom::explicit::{ExplicitProgram, ExplicitTable, LookupAnswer};
use carom::interval::Interval;
use carom::picture::{COLOURS, Chart, SOLID};
use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let step = 0.2;
    let mut cart = HybridSystem::new(step);
    let x = cart.state("x", -2.0, 2.0)?; // m
    let v = cart.state("v", -2.0, 2.0)?; // m/s
    let u = cart.input("u", -1.0, 1.0)?; // m/s²
    let flow = |push: Affine| [(x, x + step * v), (v, v + step * (u + push))];
    cart.mode("free")?.next(flow(0.0.into()))?.guard(x.within(-0.5, 0.5))?;
    cart.mode("left")?.next(flow(10.0 * (-0.5 - x)))?.guard(x.le(-0.5))?;
    cart.mode("right")?.next(flow(10.0 * (0.5 - x)))?.guard(x.ge(0.5))?;

    let mut program = cart.program(4)?;
    let cost = program.sum(x.square() + 0.5 * v.square() + 0.2 * u.square())?;
    program.minimize(cost + 4.0 * program.end(x.square() + v.square())?)?;
    let start = program.open_start([(x, -0.8..=0.8), (v, -1.0..=1.0)])?;
    let input = program.at(u, 0)?;

    // At most 0.05 or 2 % dearer than the best plan, whatever the state.
    let explicit = ExplicitProgram::new(program.model(), start, [input])?.with_loss(0.05, 0.02)?;
    let table = explicit.with_finest(1.0 / 64.0)?.build();
    let (report, single) = (table.report(), table.single());
    println!("{} cells, {} bytes, {} comparisons", report.cells, single.bytes(), report.depth);
    println!("{:.1} % within the loss", 100.0 * report.proved);
    // Less memory for more time: the chip solves a program for the inputs.
    let solving = table.single_solving();
    let (before, after) = (single.operations().products, solving.operations().products);
    println!("or {} bytes, with {after} products instead of {before}", solving.bytes());

    // As on the chip: 32 bits, no allocator.
    let mut input = [0.0];
    match single.view().evaluate(&[0.6, 0.3], &mut input) {
        LookupAnswer::Plan { loss } => println!("push {:.3} m/s², loss {loss:.3}", input[0]),
        other => println!("no input: {other:?}"),
    }

    let mut files = std::env::args().skip(1);
    if let Some(picture) = files.next() {
        fs::write(picture, draw(&table))?;
    }
    if let Some(folder) = files.next() {
        let path = |name: &str| Path::new(&folder).join(name);
        let [header, source] = single.c_source("cart")?;
        fs::write(path("cart.h"), header)?;
        fs::write(path("cart.c"), source)?;
        fs::write(path("cart.rs"), single.rust_source("CART")?)?;
        table.write_certificate(BufWriter::new(File::create(path("cart.table"))?))?;
    }
    Ok(())
}

/// The cells in the plane, a colour for each sequence of modes.
fn draw(table: &ExplicitTable) -> String {
    let mut chart = Chart::new("position (m)", "velocity (m/s)").with_size(720.0, 520.0);
    chart = chart.with_ranges(Interval::new(-0.8, 0.8), Interval::new(-1.0, 1.0));
    let mut colours = BTreeMap::new();
    for cell in table.cells() {
        let (colour, opacity) = match cell.answer {
            LookupAnswer::Plan { .. } => {
                let modes: Vec<i64> = cell.integers.iter().map(|k| *k as i64).collect();
                let next = colours.len() % COLOURS.len();
                (COLOURS[*colours.entry(modes).or_insert(next)], 0.6)
            }
            LookupAnswer::NoPlan => (SOLID, 0.6),
            _ => (SOLID, 0.2),
        };
        chart.area("", colour, opacity, cell.corners.iter().map(|at| [at[0], at[1]]));
    }
    let modes = colours.len();
    let title = format!(
        "A cart between soft walls: {} cells\nEach colour is one of {modes} sequences of modes over \
         four steps. Grey: no plan, or the border of it.",
        table.report().cells
    );
    Chart::to_svg(&[chart], &title)
}
