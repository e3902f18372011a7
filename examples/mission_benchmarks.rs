//! The scenarios of stlpy (Kurtz and Lin, arXiv:2204.06367) as missions, with optimum and seconds,
//! and ten robots with one mission.
//!
//! `cargo run --release --example mission_benchmarks [NAME | robots [COUNT]]`

use std::time::{Duration, Instant};

use carom::hybrid::Mission;
use carom::prelude::*;

#[path = "../tests/instances/missions.rs"]
mod missions;

use missions::{Point, SCENARIOS, Scenario};

type Done<T> = Result<T, Box<dyn std::error::Error>>;

/// Robots that cross the room to places of their own within 15 steps, and keep clear of the pillar
/// and of each other.
fn robots(count: usize) -> Done<()> {
    let steps = 15;
    let robots: Vec<Point> = (0..count).map(|_| Point::new()).collect::<Result<_, _>>()?;
    let mut program = robots[0].system.program(steps)?;
    for (k, robot) in robots.iter().enumerate().skip(1) {
        program.join(&format!("robot {k}"), &robot.system)?;
    }
    let mut parts = Vec::new();
    for (k, robot) in robots.iter().enumerate() {
        let column = |k: usize| 0.4 + k as f64;
        for (i, row) in robot.start([column(k), 0.5]).into_iter().enumerate() {
            program.require(&format!("start {k} {i}"), [row], When::At(0))?;
        }
        let target = column((3 * k + 2) % count);
        let place = robot.within(&format!("place {k}"), [target - 0.3, target + 0.3, 9.0, 10.0]);
        let pillar = robot.within(&format!("pillar {k}"), [4.0, 6.0, 4.0, 6.0]);
        parts.extend([place.eventually(0..), (!pillar).always(0..)]);
        for (j, other) in robots.iter().enumerate().skip(k + 1) {
            let ([x, y], [a, b]) = (robot.position, other.position);
            let near = [(x - a).within(-0.4, 0.4), (y - b).within(-0.4, 0.4)];
            parts.push((!Mission::holds(format!("near {k} {j}"), near)).always(0..));
        }
    }
    let mission = Mission::all(parts);
    program.require_mission("mission", &mission)?;
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
        return counts.into_iter().try_for_each(robots);
    }
    println!(
        "{:<20} {:>14} {:>14} {:>8} {:>9} {:>9} {:>11}",
        "scenario", "others", "objective", "nodes", "build/s", "solve/s", "robustness"
    );
    SCENARIOS.iter().filter(|own| own.name.contains(&wanted)).try_for_each(solve)
}
