//! Scenes that equal programs written by hand: same optimum, and the time that both take.
//!
//! * `cargo run --release --example scene_benchmarks`: boxes to avoid, and a puck on a table
//! * `cargo run --release --example scene_benchmarks -- paper`: the 16 rows of `paper --csv`
//! * `cargo run --release --example scene_benchmarks -- estimates`: shortest plans with both ways
//!   of counting what happens within a step
//!
//! Ctrl-C ends the solve at hand, and the exit status is 3.

#[path = "../tests/instances/mod.rs"]
mod instances;

#[macro_use]
#[path = "../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

use std::process::ExitCode;
use std::time::Instant;

use carom::collision_tolerant::{ContactLaw, Endpoint, Scenario};
use carom::hybrid::ImpactEstimate;
use carom::hybrid::scene::{DamageLimitOptions, DamageMeasure, DamageRule};
use carom::interval::Interval;
use carom::prelude::*;
use interrupts::{INTERRUPTED, Signals};

/// Left, right, below, above, in m; as in the instances `boxes_*`.
const BOXES: [[f64; 4]; 4] = [
    [4.355602058025833, 5.786257438377247, 6.343862620245817, 9.061701735665407],
    [2.608826637006559, 5.133150787119266, 3.6125993847401245, 5.467318002930782],
    [4.0947516390985115, 6.500372612978202, 1.1348400288829876, 3.195869330033833],
    [3.135834435561237, 4.820946162427869, 5.767773908985905, 7.6933705321549475],
];

fn room() -> Scene {
    let room = [0.0..=10.0, 0.0..=10.0];
    let point = Body::new("p", room, 2.0, 1.5)
        .with_start([0.5, 0.5, 0.0, 0.0])
        .with_goal([9.5, 9.5, 0.0, 0.0]);
    let scene = Scene::new(0.5).with_body(point).with_estimate(ImpactEstimate::EndOfStep);
    BOXES.iter().enumerate().fold(scene, |scene, (k, [left, right, below, above])| {
        let sides = [*left..=*right, *below..=*above];
        scene.with_obstacle(Solid::cuboid(format!("b{k}"), &sides, Surface::avoid()))
    })
}

fn puck() -> Result<Scene, Error> {
    let table = [0.0..=6.0, 0.0..=4.0];
    let puck = Body::new("puck", &table, 3.0, 0.8)
        .with_start([1.0, 3.0, -1.2, 0.6])
        .with_goal([5.0, 1.0, 0.0, 0.0]);
    let cushion = Surface::bounce(Restitution::new(0.7)?);
    let scene = Scene::new(0.2).with_body(puck).with_room("c", &table, cushion);
    Ok(scene.with_estimate(ImpactEstimate::EndOfStep).with_corners(true))
}

/// The median time of five solves, and the objective.
fn solve(model: &Model, interrupt: &Interrupt) -> Result<(f64, f64, u64), Error> {
    let mut times = Vec::new();
    let (mut objective, mut nodes) = (f64::NAN, 0);
    for _ in 0..5 {
        let start = Instant::now();
        let solution = BranchAndBound::default()
            .solve_with(model, &mut Control::default().with_interrupt(interrupt))?;
        times.push(start.elapsed().as_secs_f64());
        objective = solution.objective().unwrap_or(f64::NAN);
        nodes = solution.statistics().nodes;
    }
    times.sort_by(f64::total_cmp);
    Ok((times[2], objective, nodes))
}

fn compare(name: &str, by_hand: &Model, scene: &Model, interrupt: &Interrupt) -> Result<(), Error> {
    let ((t1, o1, n1), (t2, o2, n2)) = (solve(by_hand, interrupt)?, solve(scene, interrupt)?);
    if interrupt.is_triggered() {
        return Ok(());
    }
    println!(
        "{name}: by hand {o1:.6} in {t1:.3} s, {n1} nodes; scene {o2:.6} in {t2:.3} s, {n2} nodes"
    );
    Ok(())
}

fn programs(interrupt: &Interrupt) -> Result<(), Error> {
    for steps in [20, 30, 40] {
        let mut program = room().program(steps)?;
        let fuel = program.fuel()?;
        program.minimize(fuel)?;
        let by_hand = instances::generators::boxes(steps, 4, false);
        compare(&format!("boxes, {steps} steps"), &by_hand, program.model(), interrupt)?;
    }
    let mut program = puck()?.program(25)?;
    let effort = program.effort()?;
    program.minimize(5.0 * effort)?;
    let by_hand = instances::generators::puck(25, 0.2);
    compare("puck, 25 steps", &by_hand, program.model(), interrupt)?;
    Ok(())
}

/// How often each row of the paper is solved, by its planner and as a scene in turn.
const RUNS: usize = 10;

/// The 16 rows of `paper --csv`.
fn rows(interrupt: &Interrupt) -> Result<Vec<(String, Scenario)>, Error> {
    let paper = Scenario::paper();
    let mut rows = vec![("no collision".to_owned(), paper.clone().collision_free())];
    for e in [0.0, 0.025, 0.3, 0.5, 0.8, 1.0] {
        rows.push((format!("e = {e}"), paper.clone().with_restitution(e)?));
    }
    for e in [0.0, 0.025] {
        let open = paper.clone().with_restitution(e)?;
        let options = DamageLimitOptions::default().with_interrupt(interrupt);
        let found = open.damage_limit_range(478, &options, &mut BranchAndBound::default())?;
        if interrupt.is_triggered() {
            return Ok(rows);
        }
        let limit = found.middle().unwrap_or(found.lower.attained);
        let limited = open.with_damage(DamageRule::default().with_per_hit(limit));
        rows.push((format!("e = {e}, at most {limit:.3} m/s"), limited));
    }
    for goal in [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
        rows.push((format!("to {goal} m"), paper.clone().with_goal_position(goal)));
    }
    Ok(rows)
}

/// A scenario of the paper as a scene.
fn on_a_line(scenario: &Scenario) -> Scene {
    let domain = scenario.domain.unwrap_or(Interval::new(0.0, 25.0));
    let end = |end: Endpoint| [end.position, end.velocity];
    let car = Body::new("car", [domain], scenario.max_speed, 0.0)
        .with_acceleration([scenario.acceleration])
        .with_start(end(scenario.start))
        .with_goal(end(scenario.goal));
    let car = match scenario.start.acceleration {
        Some(first) => car.with_first_acceleration([first]),
        None => car,
    };
    let surface = match scenario.law {
        ContactLaw::Forbidden => Surface::avoid(),
        _ => Surface::bounce(scenario.restitution),
    };
    let scene = Scene::new(scenario.time_step)
        .with_body(car)
        .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, surface))
        .with_estimate(ImpactEstimate::EndOfStep);
    match scenario.damage.per_hit {
        Some(most) => {
            scene.with_rule(DamageRule::new("limit", DamageMeasure::ImpactSpeed).with_per_hit(most))
        }
        None => scene,
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    0.5 * (times[(times.len() - 1) / 2] + times[times.len() / 2])
}

fn paper(interrupt: &Interrupt) -> Result<(), Error> {
    let search = ShortestOptions::default().with_interrupt(interrupt);
    let (mut by_hand, mut as_scene, mut differ) = (0.0, 0.0, 0);
    for (name, scenario) in rows(interrupt)? {
        let scene = on_a_line(&scenario);
        let mut solver = BranchAndBound::default();
        let (mut times, mut steps) = ([Vec::new(), Vec::new()], [None, None]);
        for _ in 0..RUNS {
            let start = Instant::now();
            steps[0] = scenario.shortest_with(&search, &mut solver)?.steps;
            let middle = Instant::now();
            let found = scene.shortest_with(&search, &mut solver)?;
            steps[1] = found.steps;
            times[0].push((middle - start).as_secs_f64());
            times[1].push(middle.elapsed().as_secs_f64());
            if interrupt.is_triggered() {
                return Ok(());
            }
        }
        let [a, b] = times.map(median);
        by_hand += a;
        as_scene += b;
        differ += usize::from(steps[0] != steps[1]);
        let [n, m] = steps.map(|steps| steps.map_or("none".to_owned(), |n| n.to_string()));
        println!("{name}: {n} steps in {a:.3} s; scene {m} in {b:.3} s");
    }
    println!("sum: {by_hand:.3} s; scene {as_scene:.3} s, ratio {:.2}", as_scene / by_hand);
    println!("rows with other numbers of steps: {differ}");
    Ok(())
}

/// A puck that is sooner at its goal by two cushions.
fn bank_shot(time_step: f64) -> Result<Scene, Error> {
    let table = [0.0..=2.0, 0.0..=1.0];
    let puck = Body::new("puck", &table, 3.0, 3.0)
        .with_start([1.2, 0.2, 2.0, 2.0])
        .with_goal([0.4, 0.2, 0.0, 0.0]);
    let cushion = Surface::bounce(Restitution::new(0.9)?);
    Ok(Scene::new(time_step).with_body(puck).with_room("cushion", &table, cushion))
}

fn estimates(interrupt: &Interrupt) -> Result<(), Error> {
    let wall = |time_step| -> Result<Scene, Error> {
        let scenario = Scenario::paper().with_restitution(0.5)?.with_time_step(time_step);
        Ok(on_a_line(&scenario))
    };
    let scenes = [
        ("bank shot, Δt = 0.05 s", bank_shot(0.05)?),
        ("bank shot, Δt = 0.1 s", bank_shot(0.1)?),
        ("the paper's wall, e = 0.5, Δt = 0.02 s", wall(0.02)?),
        ("the paper's wall, e = 0.5, Δt = 0.05 s", wall(0.05)?),
        ("four boxes, Δt = 0.5 s", room()),
    ];
    println!("| scene | counted | steps | worst damage (m/s) | above it (m/s) | dip (m) |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (name, scene) in scenes {
        for (word, estimate) in
            [("sound", ImpactEstimate::Sound), ("end of step", ImpactEstimate::EndOfStep)]
        {
            let scene = scene.clone().with_estimate(estimate);
            let mut solver = BranchAndBound::default();
            let options = ShortestOptions::default().with_interrupt(interrupt);
            let found = scene.shortest_with(&options, &mut solver)?;
            if interrupt.is_triggered() {
                return Ok(());
            }
            let Some(plan) = found.plan else { continue };
            let worst = plan.hits.iter().map(|hit| hit.damage).fold(0.0, f64::max);
            let (above, dip) = (plan.certificate.unreported, plan.certificate.dip);
            let steps = plan.steps();
            println!("| {name} | {word} | {steps} | {worst:.3} | {above:.3} | {dip:.3} |");
        }
    }
    Ok(())
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    match std::env::args().nth(1).as_deref() {
        None => programs(&interrupt)?,
        Some("paper") => paper(&interrupt)?,
        Some("estimates") => estimates(&interrupt)?,
        Some(other) => {
            return Err(
                format!("unknown argument `{other}`; say `paper`, `estimates` or nothing").into()
            );
        }
    }
    Ok(if signals.came() { INTERRUPTED.into() } else { ExitCode::SUCCESS })
}
