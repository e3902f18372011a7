//! A boat crosses a river whose current is a table, and lands where it started, as soon as it can.
//!
//! `cargo run --release --example boat [PICTURE.svg]`
//!
//! Between the places of the table the current is interpolated. If it is as curved as a parabola
//! between them, the table errs by at most an eighth of its second difference, which the program
//! prints.

use carom::hybrid::Discretization;
use carom::model::{Nonlinear, PiecewiseAffine};
use carom::picture::{Chart, GOAL_COLOUR, WITHOUT_COLLISION};
use carom::prelude::*;

/// The current (m/s) at places across the river (m).
const CURRENT: [(f64, f64); 8] = [
    (-0.5, 0.1),
    (0.0, 0.1),
    (1.0, 0.7),
    (2.0, 1.2),
    (3.0, 1.3),
    (4.0, 0.9),
    (5.0, 0.1),
    (5.5, 0.1),
];

/// The speed of the boat in the water (m/s), and the length of a step (s).
const SPEED: f64 = 1.3;
const STEP: f64 = 0.5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let current = PiecewiseAffine::new(CURRENT)?;
    let mut boat = HybridSystem::new(STEP);
    let x = boat.state("x", -8.0, 8.0)?; // m downstream
    let y = boat.state("y", 0.0, 5.0)?; // m across
    let heading = boat.input("heading", -3.2, 3.2)?; // rad, 0 is downstream
    boat.discretization(Discretization::Midpoint)?;
    boat.mode("motor")?.rates([
        x.is(SPEED * heading.cos() + Nonlinear::table(&current, y)),
        y.is(SPEED * heading.sin()),
    ])?;
    let start = [x.equals(0.0), y.equals(0.0)];
    let goal = [x.within(-0.2, 0.2), y.equals(5.0)];
    let found = boat.shortest(start, goal, &mut BranchAndBound::default())?;
    println!("{found}");
    let Some(plan) = found.plan else { return Ok(()) };
    print!("{}", plan.run.to_csv());
    let (motion, proved) = (boat.motion(&plan.run)?, boat.enclose_motion(&plan.run)?);
    let bend = |list: &[(f64, f64)]| (list[0].1 - 2.0 * list[1].1 + list[2].1).abs() / 8.0;
    let table = CURRENT[1..7].windows(3).map(bend).fold(0.0, f64::max);
    println!(
        "the motion leaves the samples by at most {:.3} m; the table errs by {table:.3} m/s",
        proved.errors[0]
    );
    let Some(path) = std::env::args().nth(1) else { return Ok(()) };

    let mut chart = Chart::new("x (m)", "y (m)").with_equal_axes().with_size(520.0, 560.0);
    for (y, current) in &CURRENT[1..7] {
        chart.arrow("grey", [-3.5, *y], [-3.5 + current, *y]);
    }
    let way = motion.path.iter().map(|(_, state)| [state[0], state[1]]);
    chart.line("motion", WITHOUT_COLLISION[0], way);
    let samples = plan.run.state("x")?.iter().zip(plan.run.state("y")?).map(|(x, y)| [*x, *y]);
    chart.dots("", WITHOUT_COLLISION[0], 3.0, samples);
    chart.start("start", "black", [0.0, 0.0]);
    chart.goal("goal", GOAL_COLOUR, [0.0, 5.0]);
    let steps = plan.run.state("x")?.len() - 1;
    let title = format!(
        "Across the river in {steps} steps of 0.5 s; no plan has fewer\nArrows are the current."
    );
    std::fs::write(path, Chart::to_svg(&[chart], &title))?;
    Ok(())
}
