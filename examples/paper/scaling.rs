//! Measures how the time of a search grows with finer steps, on one thread.

use std::error::Error;
use std::path::Path;

use carom::collision_tolerant::Scenario;
use carom::picture::{COLOURS, Chart};
use carom::prelude::*;
use indicatif::{ProgressBar, ProgressStyle};

const RESTITUTION: f64 = 0.5;

/// Lengths of a step, in s.
const TIME_STEPS: [f64; 8] = [0.05, 0.025, 0.0125, 0.01, 0.005, 0.0025, 0.002, 0.001];

/// Number of searches for each length of a step, whose median counts.
const REPEATS: usize = 3;

/// One length of a step.
struct Point {
    time_step: f64,
    steps: usize,
    seconds: f64,
}

/// Measures, prints the table (or its CSV rows) and writes the picture.
///
/// After an interrupt, it has the lengths that are measured.
pub(crate) fn run(csv: bool, folder: &Path, interrupt: &Interrupt) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let bar = ProgressBar::new((TIME_STEPS.len() * REPEATS) as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} {elapsed} {msg}") {
        bar.set_style(style);
    }
    let mut points = Vec::new();
    for time_step in TIME_STEPS {
        match measure(time_step, interrupt, &bar) {
            _ if interrupt.is_triggered() => break,
            measured => points.push(measured?),
        }
    }
    bar.finish_and_clear();
    if points.is_empty() {
        return Ok(());
    }
    print(&points, csv);
    let path = folder.join("scaling.svg");
    draw(&points, &path)?;
    if !csv {
        println!("wrote {}", path.display());
    }
    Ok(())
}

fn measure(
    time_step: f64,
    interrupt: &Interrupt,
    bar: &ProgressBar,
) -> Result<Point, Box<dyn Error>> {
    let scenario = Scenario::paper().with_time_step(time_step).with_restitution(RESTITUTION)?;
    bar.set_message(format!("steps of {time_step} s"));
    let options = ShortestOptions::default().with_interrupt(interrupt);
    let (mut steps, mut times) = (None, Vec::new());
    for _ in 0..REPEATS {
        let mut solver = BranchAndBound::default();
        let shortest = scenario.shortest_with(&options, &mut solver)?;
        steps = shortest.steps.filter(|_| shortest.is_found());
        times.push(shortest.time.as_secs_f64());
        bar.inc(1);
    }
    let steps = steps.ok_or(format!("no proved plan with steps of {time_step} s"))?;
    times.sort_by(f64::total_cmp);
    Ok(Point { time_step, steps, seconds: times[REPEATS / 2] })
}

fn print(points: &[Point], csv: bool) {
    if csv {
        println!("dt,steps,seconds,seconds_per_step,ratio");
    } else {
        println!(
            "The whole search for the shortest plan, e = {RESTITUTION}, all shorter horizons \
             refuted; one thread, median of {REPEATS}:\n"
        );
        println!(
            "  {:>8} {:>6} {:>10} {:>14} {:>14} {:>14}",
            "dt", "steps", "time", "time per step", "time / first", "steps / first"
        );
    }
    for Point { time_step, steps, seconds } in points {
        let per_step = seconds / *steps as f64;
        let ratio = seconds / points[0].seconds;
        if csv {
            println!("{time_step},{steps},{seconds:.6},{per_step:.9},{ratio:.3}");
        } else {
            let more_steps = *steps as f64 / points[0].steps as f64;
            println!(
                "  {time_step:>6} s {steps:>6} {:>7.1} ms {:>11.1} µs {ratio:>14.2} {more_steps:>14.2}",
                1e3 * seconds,
                1e6 * per_step,
            );
        }
    }
    if !csv && points.len() > 1 {
        println!("\n  Fitted over all of them, the time grows as (1/dt)^{:.2}.", growth(points));
    }
}

/// The exponent of the power of 1/Δt that fits the times best: the slope between logarithms.
fn growth(points: &[Point]) -> f64 {
    let logarithms = || points.iter().map(|point| (-point.time_step.ln(), point.seconds.ln()));
    let count = points.len() as f64;
    let (x, y) = logarithms().fold((0.0, 0.0), |(x, y), (a, b)| (x + a / count, y + b / count));
    let covariance: f64 = logarithms().map(|(a, b)| (a - x) * (b - y)).sum();
    let variance: f64 = logarithms().map(|(a, _)| (a - x).powi(2)).sum();
    covariance / variance
}

/// Time over 1/Δt, both logarithmic, beside a straight line through the first point.
fn draw(points: &[Point], path: &Path) -> Result<(), Box<dyn Error>> {
    let rate = |point: &Point| 1.0 / point.time_step;
    let linear = |point: &Point| points[0].seconds * rate(point) / rate(&points[0]);
    let title = format!("Time of the whole search for the shortest plan, e = {RESTITUTION}");
    let mut chart =
        Chart::new("steps a second, 1/Δt (1/s)", "time of the search on one thread (s)")
            .with_size(640.0, 440.0)
            .with_logarithms();
    chart.line("linear in 1/Δt", COLOURS[6], points.iter().map(|p| [rate(p), linear(p)]));
    let measured = || points.iter().map(|point| [rate(point), point.seconds]);
    chart.line(format!("measured, median of {REPEATS}"), COLOURS[0], measured());
    chart.dots("", COLOURS[0], 4.0, measured());
    std::fs::write(path, Chart::to_svg(&[chart], &title))?;
    Ok(())
}
