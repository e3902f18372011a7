//! The scenarios of stlpy (Kurtz and Lin, arXiv:2204.06367) as missions, with optimum and seconds, and ten
//! robots with one mission.
//!
//! `cargo run --release --example mission_benchmarks [NAME]`

use std::time::{Duration, Instant};

use carom::hybrid::Mission;
use carom::prelude::*;

type Done<T> = Result<T, Box<dyn std::error::Error>>;

/// A point with velocities and accelerations of a step each, in a room of 10 m.
struct Point {
    system: HybridSystem,
    position: [State; 2],
    velocity: [State; 2],
    input: [Variable; 2],
}

impl Point {
    fn new(name: &str, side: f64) -> Result<Point, Error> {
        let mut system = HybridSystem::new(1.0);
        let mut state = |axis: &str, lower: f64, upper: f64| {
            system.state(&format!("{name}{axis}"), lower, upper)
        };
        let position = [state("x", 0.0, side)?, state("y", 0.0, side)?];
        let velocity = [state("vx", -1.0, 1.0)?, state("vy", -1.0, 1.0)?];
        let input = [
            system.input(&format!("{name}ux"), -0.5, 0.5)?,
            system.input(&format!("{name}uy"), -0.5, 0.5)?,
        ];
        let next = (0..2).flat_map(|k| {
            [position[k].is(position[k] + velocity[k]), velocity[k].is(velocity[k] + input[k])]
        });
        let next: Vec<_> = next.collect();
        system.mode("drift")?.next(next)?;
        Ok(Point { system, position, velocity, input })
    }

    fn within(&self, name: &str, [x0, x1, y0, y1]: [f64; 4]) -> Mission {
        let [x, y] = self.position;
        Mission::holds(name, [x.ge(x0), x.le(x1), y.ge(y0), y.le(y1)])
    }

    fn start(&self, [x, y]: [f64; 2]) -> [Row; 4] {
        let [px, py] = self.position;
        let [vx, vy] = self.velocity;
        [px.equals(x), py.equals(y), vx.equals(0.0), vy.equals(0.0)]
    }
}

fn reach_avoid(point: &Point) -> (usize, [f64; 2], Mission) {
    let goal = point.within("goal", [7.0, 8.0, 8.0, 9.0]);
    let obstacle = point.within("obstacle", [3.0, 5.0, 4.0, 6.0]);
    (10, [1.0, 2.0], (!obstacle).always(0..=10) & goal.eventually(0..=10))
}

fn either_or(point: &Point) -> (usize, [f64; 2], Mission) {
    let goal = point.within("goal", [7.0, 8.0, 8.0, 9.0]);
    let one = point.within("one", [1.0, 2.0, 6.0, 7.0]);
    let two = point.within("two", [7.0, 8.0, 4.5, 5.5]);
    let obstacle = point.within("obstacle", [3.0, 5.0, 4.0, 6.0]);
    let dwell = one.always(0..=5) | two.always(0..=5);
    let mission = dwell.eventually(0..=15) & (!obstacle).always(0..=20) & goal.eventually(0..=20);
    (20, [2.0, 2.0], mission)
}

fn narrow_passage(point: &Point) -> (usize, [f64; 2], Mission) {
    let goals =
        point.within("north", [7.0, 8.0, 8.0, 9.0]) | point.within("east", [9.5, 10.5, 1.5, 2.5]);
    let obstacles =
        [[2.0, 5.0, 4.0, 6.0], [5.5, 9.0, 3.8, 5.7], [4.6, 8.0, 0.5, 3.5], [2.2, 4.4, 6.4, 11.0]];
    let clear =
        obstacles.iter().zip(1..).map(|(sides, k)| !point.within(&format!("wall {k}"), *sides));
    (25, [3.0, 3.6], Mission::all(clear).always(0..=25) & goals.eventually(0..=25))
}

type Scenario = fn(&Point) -> (usize, [f64; 2], Mission);

/// Robots that cross the room to places of their own within 15 steps, and keep clear of the pillar and of each
/// other.
fn robots(count: usize) -> Done<()> {
    let steps = 15;
    let robots: Vec<Point> = (0..count).map(|_| Point::new("", 10.0)).collect::<Result<_, _>>()?;
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

fn main() -> Done<()> {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let scenarios: [(&str, Scenario); 3] = [
        ("reach_avoid", reach_avoid),
        ("either_or", either_or),
        ("narrow_passage", narrow_passage),
    ];
    // The weight of squares of inputs; that of squares of velocities is 0.1 in all.
    let weights = [0.1, 1.0, 0.1];
    println!(
        "{:<20} {:>14} {:>8} {:>9} {:>9}",
        "scenario", "objective", "nodes", "build/s", "solve/s"
    );
    for ((name, scenario), weight) in scenarios.into_iter().zip(weights) {
        for quadratic in [false, true] {
            let label = format!("{name}_{}", if quadratic { "q" } else { "l" });
            if !label.contains(&wanted) {
                continue;
            }
            let point = Point::new("", 10.0)?;
            let (steps, start, mission) = scenario(&point);
            let begin = Instant::now();
            let mut program = point.system.program(steps)?;
            program.start(point.start(start))?;
            let margin = program.mission_margin("margin", &mission, 0.0)?;
            let mut cost = Quadratic::from(-Affine::from(margin));
            if quadratic {
                for k in 0..=steps {
                    for axis in 0..2 {
                        let v = program.variable(point.velocity[axis], k)?;
                        cost += 0.1 * v.square();
                        if k < steps {
                            cost += weight * program.variable(point.input[axis], k)?.square();
                        }
                    }
                }
            }
            program.minimize(cost)?;
            let built = begin.elapsed();
            let solver = &mut BranchAndBound::default();
            let begin = Instant::now();
            let solution = solver.solve(program.model())?;
            let solved = begin.elapsed();
            let plan = program.plan(&solution)?;
            println!(
                "{label:<20} {:>14.9} {:>8} {:>9.4} {:>9.4}   robustness {:.6}",
                solution.objective().unwrap_or(f64::NAN),
                solution.statistics().nodes,
                built.as_secs_f64(),
                solved.as_secs_f64(),
                plan.robustness(&mission)?,
            );
        }
    }
    for count in [2, 5, 10] {
        if "robots".contains(&wanted) {
            robots(count)?;
        }
    }
    Ok(())
}
