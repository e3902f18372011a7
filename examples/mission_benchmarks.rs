//! The scenarios of stlpy (Kurtz and Lin, arXiv:2204.06367) as missions, with optimum and seconds,
//! and ten robots with one mission.
//!
//! `cargo run --release --example mission_benchmarks [NAME | robots [COUNT]]`

use std::time::{Duration, Instant};

use carom::prelude::*;

#[path = "../tests/instances/missions.rs"]
mod missions;
#[path = "common/robots.rs"]
mod robots;

use missions::{Point, SCENARIOS, Scenario};
use robots::robots;

type Done<T> = Result<T, Box<dyn std::error::Error>>;

/// Solves the mission of so many robots, and prints its line.
fn solve_robots(count: usize) -> Done<()> {
    let (program, mission) = robots(count)?;
    let options = Options::default().with_time_limit(Duration::from_secs(120));
    let begin = Instant::now();
    let solution = BranchAndBound::new(options).solve(program.model())?;
    let seconds = begin.elapsed().as_secs_f64();
    print!(
        "{count} robots: {}, {seconds:.2} s, {} nodes",
        solution.termination(),
        solution.statistics().nodes
    );
    match solution.point() {
        None => println!(),
        Some(_) => println!(", robustness {:.3} m", program.plan(&solution)?.robustness(&mission)?),
    }
    Ok(())
}

/// Solves a scenario, and prints its line.
fn solve(scenario: &Scenario) -> Done<()> {
    let point = Point::new()?;
    let begin = Instant::now();
    let (program, mission, _) = scenario.program(&point)?;
    let built = begin.elapsed();
    let begin = Instant::now();
    let solution = BranchAndBound::default().solve(program.model())?;
    let solved = begin.elapsed();
    println!(
        "{:<20} {:>14.9} {:>14.9} {:>8} {:>9.4} {:>9.4} {:>11.6}",
        scenario.name,
        scenario.optimum,
        solution.objective().unwrap_or(f64::NAN),
        solution.statistics().nodes,
        built.as_secs_f64(),
        solved.as_secs_f64(),
        program.plan(&solution)?.robustness(&mission)?,
    );
    Ok(())
}

fn main() -> Done<()> {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    if wanted == "robots" {
        let counts = match std::env::args().nth(2) {
            Some(count) => vec![count.parse::<usize>()?],
            None => vec![2, 5, 10],
        };
        return counts.into_iter().try_for_each(solve_robots);
    }
    println!(
        "{:<20} {:>14} {:>14} {:>8} {:>9} {:>9} {:>11}",
        "scenario", "others", "objective", "nodes", "build/s", "solve/s", "robustness"
    );
    SCENARIOS.iter().filter(|own| own.name.contains(&wanted)).try_for_each(solve)
}
