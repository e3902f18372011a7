//! Controllers with modes, solved beforehand for every state: sizes, and times beside solves.
//!
//! `cargo run --release --example chip_benchmarks -- [STATES] [DAMAGES] [FOLDER] [NAME]`
//!
//! At STATES random states (100 by default) of each system, and at as many corners of cells, the
//! program is solved online, from its last tree. Where a table has an input, the online optimum
//! with that input must be within the loss; where it says that there is no plan, there must be
//! none. There are two tables: the first line of a system is that with explicit laws, and the
//! second one that in which devices solve programs. Of a table of at most 300 cells, DAMAGES
//! certificates (10 by default) with something wrong are made, which the checker must reject.
//! FOLDER gets certificates for `carom-proof table`, and the states with their optima for
//! `benches/chip_daqp.py`. With NAME, there is one system alone.

mod damage;
mod systems;

use std::collections::BTreeSet;
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use carom::explicit::{ExplicitTable, LookupAnswer, LookupArrays, LookupProgram};
use carom::prelude::*;
use systems::System;

/// Random numbers: Xorshift, by George Marsaglia.
struct Random(u64);

impl Random {
    fn new() -> Self {
        Random(88172645463325252)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// A state of the box.
    fn state(&mut self, table: &ExplicitTable) -> Vec<f64> {
        let view = table.double().view();
        let within = |(lower, upper): (&f64, &f64)| {
            lower + (upper - lower) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
        };
        view.lower.iter().zip(view.upper).map(within).collect()
    }
}

/// The first corners of cells, each once.
fn corners(table: &ExplicitTable, count: usize) -> Vec<Vec<f64>> {
    let mut known = BTreeSet::new();
    let mut all = Vec::new();
    for corner in table.cells().flat_map(|cell| cell.corners) {
        let bits: Vec<u64> = corner.iter().map(|x| x.to_bits()).collect();
        if all.len() < count && known.insert(bits) {
            all.push(corner);
        }
    }
    all
}

/// Times and optima of online solves.
struct Online {
    times: Vec<Duration>,
    /// No cost where there is no plan.
    costs: Vec<Option<f64>>,
}

/// Solves at states; errors if the table is wrong.
fn compare(
    system: &System,
    laws: &[&LookupArrays<f64>],
    states: &[Vec<f64>],
) -> Result<Online, Box<dyn Error>> {
    let System { program, axes, input, .. } = system;
    // What the table says is given.
    let mut held = program.model().clone();
    let given = held.parameter("given", 0.0, -1e3, 1e3)?;
    held.add("given_row", (input.clone() - given).equals(0.0))?;
    let (mut solver, mut other) = (BranchAndBound::default(), BranchAndBound::default());
    let mut online = solver.prepare(program.model())?;
    let mut held = other.prepare(&held)?;
    let mut found = Online { times: Vec::new(), costs: Vec::new() };
    for state in states {
        let mut values: Vec<(Variable, f64)> = axes.iter().copied().zip(state.clone()).collect();
        let began = Instant::now();
        let best = online.solve(&values, &mut Control::default())?;
        found.times.push(began.elapsed());
        found.costs.push(best.objective());
        for law in laws {
            let (mut inputs, mut work) = (vec![0.0; law.inputs()], vec![0.0; law.work()]);
            match law.view().solve(state, &mut inputs, &mut work) {
                LookupAnswer::Plan { loss } => {
                    values.push((given, inputs[0]));
                    let own = held.solve(&values, &mut Control::default())?;
                    values.pop();
                    let Some(costs) = own.objective().zip(best.objective()) else {
                        return Err(format!("{state:?}: a law is infeasible online").into());
                    };
                    if costs.0 > costs.1 + loss + 1e-4 * (1.0 + costs.1.abs()) {
                        return Err(format!("{state:?}: {costs:?}, and a loss of {loss}").into());
                    }
                }
                LookupAnswer::NoPlan if !best.is_infeasible() => {
                    return Err(format!("{state:?} has a plan").into());
                }
                LookupAnswer::Damaged => return Err(format!("{state:?}: damaged").into()),
                _ => {}
            }
        }
    }
    Ok(found)
}

/// The mean time of a look-up in 32 bits at random states, and the longest of a thousand means.
fn look_up(table: &ExplicitTable, single: &LookupArrays<f32>) -> [Duration; 2] {
    let (view, mut input) = (single.view(), vec![0.0; single.inputs()]);
    let mut work = vec![0.0; single.work()];
    let mut random = Random::new();
    let (mut sum, mut longest, mut total) = (Duration::ZERO, Duration::ZERO, 0.0);
    for _ in 0..1000 {
        let state: Vec<f32> = random.state(table).iter().map(|x| *x as f32).collect();
        let began = Instant::now();
        for _ in 0..100 {
            let answer = view.solve(std::hint::black_box(&state), &mut input, &mut work);
            total += f32::from(u8::from(answer.has_inputs()));
        }
        let time = began.elapsed() / 100;
        (sum, longest) = (sum + time, longest.max(time));
    }
    std::hint::black_box(total);
    [sum / 1000, longest]
}

/// A line of `benches/chip_daqp.py` for each state: its entries, and the least cost.
fn write_states(file: &Path, states: &[Vec<f64>], online: &Online) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(file)?);
    for (state, cost) in states.iter().zip(&online.costs) {
        let words: Vec<String> = state.iter().map(|x| format!("{x:?}")).collect();
        let cost = cost.map_or("none".to_owned(), |cost| format!("{cost:?}"));
        writeln!(out, "{} {cost}", words.join(" "))?;
    }
    out.flush()
}

/// The line of a table with programs.
fn print_solving(table: &ExplicitTable, single: &LookupArrays<f32>, seconds: f64) {
    let ([mean, longest], view) = (look_up(table, single), single.view());
    let most = |of: fn(&LookupProgram<f32>) -> u32| view.programs.iter().map(of).max().unwrap_or(0);
    println!(
        "  programs   {:5}  {:7}  {:4}  {seconds:7.1}  {} programs, {} rows, {} exchanges, {} products, rows missed by \
         {:.1e}, inputs off by {:.1e}  {mean:>13.0?} {longest:>8.0?}",
        view.nodes.len() + view.roots.len(),
        single.bytes(),
        view.depth,
        view.programs.len(),
        most(|program| program.rows),
        most(|program| program.exchanges),
        single.operations().products,
        single.row_rounding(),
        single.input_rounding(),
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(100), |word| word.parse())?;
    let damages = arguments.next().map_or(Ok(10), |word| word.parse())?;
    let (folder, only) = (arguments.next(), arguments.next());
    type Build = fn() -> Result<System, carom::Error>;
    let systems: [(&str, Build); 8] = [
        ("wall", systems::wall),
        ("converter", systems::converter),
        ("heater_off", systems::heater_off),
        ("heater_on", systems::heater_on),
        ("just_off", systems::just_off),
        ("just_on", systems::just_on),
        ("pole", systems::pole_between),
        ("pole_beside", systems::pole_beside),
    ];
    println!(
        "system       cells    bytes  cuts  seconds  within  larger  no plan   open  look-up: mean, \
         longest  online: median, longest   corners  rejected  nodes"
    );
    for (name, build) in systems {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let system = build()?;
        let table = system.table(1_000_000)?;
        let (report, single) = (table.report(), table.single());
        let [mean, longest] = look_up(&table, &single);
        let began = Instant::now();
        let solving = table.single_solving();
        let (seconds, double) = (began.elapsed().as_secs_f64(), table.double_solving());
        let laws = [table.double(), &double];
        let mut random = Random::new();
        let states: Vec<Vec<f64>> = (0..count).map(|_| random.state(&table)).collect();
        let mut online = compare(&system, &laws, &states)?;
        let corners = corners(&table, count);
        compare(&system, &laws, &corners)?;
        if let Some(folder) = &folder {
            let folder = Path::new(folder);
            let file = BufWriter::new(File::create(folder.join(format!("{name}.table")))?);
            table.write_certificate(file)?;
            let file = folder.join(format!("{name}.states"));
            write_states(&file, &states, &online)?;
        }
        online.times.sort();
        let [median, last] = [count / 2, count - 1].map(|k| online.times[k]);
        let mut text = Vec::new();
        system.table(300)?.write_certificate(&mut text)?;
        damage::reject(&String::from_utf8(text)?, damages, &mut random)?;
        let percent = |share: f64| 100.0 * share;
        println!(
            "{name:11}  {:5}  {:7}  {:4}  {:7.1}  {:5.1}%  {:5.1}%   {:5.1}%  {:4.1}%  \
             {mean:>13.0?} {longest:>8.0?}   {median:>10.1?} {last:>9.1?}        {:6}    {damages:6}  {:5}",
            report.cells,
            single.bytes(),
            report.depth,
            report.duration.as_secs_f64(),
            percent(report.proved),
            percent(report.unproved),
            percent(report.refuted),
            percent(report.open),
            corners.len(),
            report.most_nodes,
        );
        print_solving(&table, &solving, seconds);
    }
    Ok(())
}
