//! A simulation of rank 0 and its workers, with measured node times: the share of time in which
//! ranks have a node, for 16 to 4,096 ranks and three protocols.
//!
//! `cargo run --release --no-default-features --example simulate [-- --out FILE] [--measure]`
//!
//! * `--out FILE`: where the picture goes, `../docs/images/cluster.svg` by default
//! * `--measure`: measure node times again, on this machine, and write `examples/node_times.txt`
//!
//! The tree is random: a node has two children or none, so that about so many nodes a rank are
//! searched as are given below. A message takes a latency, and rank 0 handles messages one after
//! the other.

#[path = "../../tests/instances/mod.rs"]
mod instances;
mod simulation;

use std::error::Error;
use std::time::Instant;

use carom::picture::{COLOURS, Chart};
use carom::prelude::*;
use carom::solver::{TreeExchange, TreePart};
use simulation::{Protocol, Setting, efficiency};

const TIMES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/node_times.txt");
const PICTURE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/images/cluster.svg");

/// Quantiles of the node times that are kept.
const QUANTILES: usize = 200;

/// Notes when nodes end.
struct Watch {
    last: Instant,
    seconds: Vec<f64>,
}

impl TreeExchange for Watch {
    fn begin(&mut self, _: u64, _: bool) -> bool {
        self.last = Instant::now();
        true
    }

    fn meet(&mut self, _: &mut dyn TreePart, is_idle: bool) -> bool {
        let now = Instant::now();
        if !is_idle {
            self.seconds.push((now - self.last).as_secs_f64());
        }
        self.last = now;
        false
    }
}

/// The time that this thread had a processor, in s, as Linux counts it.
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}

/// The times of the first nodes of a tree, in s, in order of size. Where others use the machine as
/// well, all of them are shortened alike.
fn measure() -> Result<Vec<f64>, Box<dyn Error>> {
    let mut watch = Watch { last: Instant::now(), seconds: Vec::new() };
    let model = instances::generators::puck(20, 0.33);
    // As one tree.
    let options = Options::default().with_blocks(false).with_node_limit(1000);
    let (began, processor) = (Instant::now(), processor_time());
    let mut control = Control::default().with_exchange(&mut watch);
    let solution = BranchAndBound::new(options).solve_with(&model, &mut control)?;
    drop(control);
    let own = processor.zip(processor_time()).map(|(before, after)| after - before);
    let share = own.map_or(1.0, |own| own / began.elapsed().as_secs_f64());
    watch.seconds.iter_mut().for_each(|seconds| *seconds *= share);
    println!("{}: {} nodes", solution.termination(), watch.seconds.len());
    watch.seconds.sort_by(f64::total_cmp);
    Ok(watch.seconds)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut path = PICTURE.to_owned();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--out" => path = words.next().ok_or("--out needs a file")?,
            "--measure" => {
                let times = measure()?;
                let at = |k: usize| times[(2 * k + 1) * times.len() / (2 * QUANTILES)];
                let lines: String = (0..QUANTILES).map(|k| format!("{:.6}\n", at(k))).collect();
                std::fs::write(TIMES, lines)?;
            }
            _ => return Err(format!("unexpected `{word}`").into()),
        }
    }
    let times = std::fs::read_to_string(TIMES)?;
    let times = times.lines().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    println!("node times: {:.2} ms on average", 1e3 * mean);

    let protocols = [
        ("every node by rank 0", Protocol::NodeByNode),
        ("batches, asked for early", Protocol::Batches),
        ("two levels of 64", Protocol::TwoLevels),
    ];
    let mut chart = Chart::new("ranks", "time with a node at hand (%)")
        .with_size(640.0, 360.0)
        .with_horizontal_logarithm();
    for ((name, protocol), colour) in protocols.into_iter().zip(COLOURS) {
        let mut points = Vec::new();
        for ranks in [16, 64, 256, 1024, 4096] {
            let setting = Setting { protocol, ranks, times: &times };
            let share = 100.0 * efficiency(setting);
            println!("{name}, {ranks} ranks: {share:.1} %");
            points.push([ranks as f64, share]);
        }
        chart.dots("", colour, 3.0, points.iter().copied());
        chart.line(name, colour, points);
    }
    std::fs::write(&path, Chart::to_svg(&[chart], "Where rank 0 saturates"))?;
    println!("wrote {path}");
    Ok(())
}
