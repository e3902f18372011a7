//! A puck that bounces off a wall of unknown restitution under gusts: a nominal plan, a tube around
//! a plan, and scenarios, flown through 10,000 simulated worlds each.
//!
//! `cargo run --release --example gusts [-- PICTURE.svg]`

use carom::hybrid::{Feedback, HybridRun};
use carom::picture::{AVOIDED, Chart, GOAL_COLOUR, SOLID, WITH_COLLISION};
use carom::prelude::*;

const STEPS: usize = 14;
const WORLDS: usize = 10_000;
/// By how much scenarios stay away from the ends of the goal, in m and m/s.
const MARGIN: f64 = 0.1;
/// In m and m/s.
const GOAL: [(f64, f64); 4] = [(1.5, 1.9), (0.85, 1.25), (-0.3, 0.3), (-0.3, 0.3)];

/// A table with a wall at its end whose restitution is within e ± spread, and a block in the way.
fn table(e: f64, spread: f64) -> Result<HybridSystem, Error> {
    let wall = Surface::bounce(Restitution::new(e)?).with_spread(spread);
    let gust = -0.012..=0.012; // m/s in each step
    let puck = Body::new("puck", [0.0..=2.6, 0.0..=1.6], 2.4, 0.8);
    Scene::new(0.25)
        .with_body(puck.with_pushes([gust.clone(), gust]))
        .with_obstacle(Solid::halfspace("wall", [-1.0, 0.0], -2.5, wall))
        .with_obstacle(Solid::cuboid("block", [1.0..=1.3, 0.6..=1.7], Surface::avoid()))
        .hybrid_system()
}

/// Positions of some runs, in m.
type Paths = Vec<Vec<[f64; 2]>>;

const NAMES: [&str; 4] = ["puck x", "puck y", "puck vx", "puck vy"];

/// Requires the start and the goal of a system in a program, the goal with a margin.
fn ends(
    program: &mut HybridProgram,
    system: &HybridSystem,
    name: &str,
    margin: f64,
) -> Result<(), Error> {
    let start = [0.3, 0.3, 1.8, 0.0];
    let states = NAMES.map(|name| system.state_named(name));
    for (k, state) in states.into_iter().enumerate() {
        let (state, (lower, upper)) = (state?, GOAL[k]);
        program.require(&format!("{name}start_{k}"), [state.equals(start[k])], When::At(0))?;
        let goal = [state.within(lower + margin, upper - margin)];
        program.require(&format!("{name}goal_{k}"), goal, When::At(STEPS))?;
    }
    Ok(())
}

/// The effort of a system's inputs in a program.
fn effort(program: &HybridProgram, system: &HybridSystem) -> Result<Quadratic, Error> {
    let [x, y] = ["puck ax", "puck ay"].map(|name| system.input_named(name));
    program.sum(x?.square() + y?.square())
}

/// Uniform numbers from 0 to 1.
fn unit(seed: &mut u64) -> f64 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}

/// Flies the plan that `choose` gives for a restitution through all worlds: how many runs arrive,
/// and some of their paths.
fn fly<'a>(
    name: &str,
    world: &HybridSystem,
    feedback: &Feedback,
    choose: impl Fn(f64) -> &'a HybridRun,
) -> Result<(usize, Paths), Error> {
    let mut seed = 0x9e37_79b9_7f4a_7c15;
    let (mut kept, mut arrived, mut paths) = (0, 0, Vec::new());
    for k in 0..WORLDS {
        // Every third world has the extremes alone.
        let extreme = k % 3 == 0;
        let off = 0.2 * unit(&mut seed) - 0.1;
        let off = if extreme { 0.1_f64.copysign(off) } else { off };
        let run = world.fly(choose(0.3 + off), feedback.gain(), &mut |range| {
            let share = unit(&mut seed);
            let share = if extreme { share.round() } else { share };
            // The restitution stays the same in a world.
            if range.upper > 0.05 { off } else { range.lower + share * range.width() }
        })?;
        let states = NAMES.map(|name| run.run.state(name));
        let ends = states.into_iter().zip(GOAL).map(|(values, (lower, upper))| {
            let end = values?.last().copied().unwrap_or(f64::NAN);
            Ok(lower - 2e-6 <= end && end <= upper + 2e-6)
        });
        let ends = ends.collect::<Result<Vec<bool>, Error>>()?;
        let whole = run.run.state(NAMES[0])?.len() == STEPS + 1;
        kept += usize::from(run.kept);
        arrived += usize::from(run.kept && whole && ends.iter().all(|is_in| *is_in));
        if k < 60 {
            let (x, y) = (run.run.state(NAMES[0])?, run.run.state(NAMES[1])?);
            paths.push(x.iter().zip(y).map(|(x, y)| [*x, *y]).collect());
        }
    }
    println!("{name}: {kept} of {WORLDS} runs keep the plan, {arrived} of them arrive");
    Ok((arrived, paths))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut solver = BranchAndBound::default();
    let world = table(0.3, 0.1)?;
    let feedback = Feedback::regulator(&world)?;
    let mut program = world.program(STEPS)?;
    ends(&mut program, &world, "", 0.0)?;
    program.minimize(effort(&program, &world)?)?;

    let nominal = program.solve(&mut solver)?;
    let start = std::time::Instant::now();
    let tube = program.robust(&feedback)?.solve(&mut solver)?;
    eprintln!("the tube took {:.1} s", start.elapsed().as_secs_f64());
    let promise = tube.to_string();
    println!("{}", promise.lines().next().unwrap_or_default());
    println!("the promise costs {:.3} m²/s⁴", tube.price(&nominal).unwrap_or(f64::NAN));

    // Restitutions of 0.2, 0.3 and 0.4, which the first hit tells apart.
    let hit = nominal.run.transitions("puck at wall")?.iter().position(|name| name == "hit");
    let until = hit.map_or(STEPS, |hit| hit + 1);
    let cases = [table(0.3, 0.0)?, table(0.2, 0.0)?, table(0.4, 0.0)?];
    let mut program = cases[0].program(STEPS)?;
    for (case, name) in cases.iter().zip(["", "soft", "hard"]) {
        if !name.is_empty() {
            program.add_case(name, case, until)?;
        }
        // They know of no gust, so that a margin has to be guessed.
        ends(&mut program, case, name, MARGIN)?;
    }
    let costs = cases.iter().map(|case| effort(&program, case));
    let mean = costs.collect::<Result<Vec<_>, Error>>()?.into_iter().sum::<Quadratic>();
    program.minimize((1.0 / 3.0) * mean)?;
    let tree = program.solve(&mut solver)?;
    println!("scenarios share their inputs in {until} steps");
    for (name, plan) in [("nominal plan", &nominal), ("tube", &tube.plan), ("scenarios", &tree)] {
        println!("effort of the {name}: {:.3}", plan.solution.objective().unwrap_or(f64::NAN));
    }
    let case = |e: f64| match e {
        e if e < 0.25 => tree.joined("soft").map_or(&tree.run, |(run, _)| run),
        e if e > 0.35 => tree.joined("hard").map_or(&tree.run, |(run, _)| run),
        _ => &tree.run,
    };

    let flown = [
        ("nominal plan", fly("nominal plan", &world, &feedback, |_| &nominal.run)?),
        ("tube", fly("tube", &world, &feedback, |_| &tube.plan.run)?),
        ("three scenarios", fly("scenarios", &world, &feedback, case)?),
    ];
    if let Some(path) = std::env::args().nth(1) {
        let mut charts = Vec::new();
        for (k, (name, (arrived, paths))) in flown.into_iter().enumerate() {
            let share = 100.0 * arrived as f64 / WORLDS as f64;
            let across = if k == 2 { "x (m)" } else { "" };
            let mut chart = Chart::new(across, "y (m)").with_equal_axes().with_size(760.0, 330.0);
            chart = chart.with_ranges((0.0..=2.7).into(), (0.0..=1.6).into());
            chart = chart.with_heading(format!("{name}: {share:.1} % arrive"));
            chart.rectangles(AVOIDED, [[[1.0, 0.6], [1.3, 1.6]]]);
            chart.rectangles(SOLID, [[[2.5, 0.0], [2.7, 1.6]]]);
            chart.label("block", "black", [1.02, 1.3]);
            chart.label("wall", "black", [2.6, 1.3]);
            let [(left, right), (low, high), ..] = GOAL;
            let goal = [[left, low], [right, low], [right, high], [left, high]];
            chart.area("", GOAL_COLOUR, 0.3, goal);
            chart.label("goal", GOAL_COLOUR, [0.5 * (left + right), high]);
            for path in paths {
                chart.line_of_width(0.6, "", WITH_COLLISION[0], path);
            }
            chart.start("start", "black", [0.3, 0.3]);
            charts.push(chart);
        }
        let title = "A puck under gusts, and a wall with a restitution from 0.2 to 0.4\nEach plan is \
                     flown through 10,000 worlds; 60 of them are drawn. The tube promises all.";
        std::fs::write(path, Chart::to_svg(&charts, title))?;
    }
    Ok(())
}
