//! A car parks between two others: the least number of steps, with a proof that fewer do not do.
//!
//! `cargo run --release --example parking [PICTURE.svg]`
//!
//! The car has a heading and a steering limit, so its motion has sines and cosines, and a gear. Plan and proof are about steps by the midpoint rule; the motion
//! of the same inputs by the differential equation is beside them.

use carom::hybrid::HybridRun;
use carom::picture::{AVOIDED, Chart, GOAL_COLOUR, WITHOUT_COLLISION};
use carom::prelude::*;

/// The largest speed (m/s), and the largest curvature of the way (1/m).
const FASTEST: f64 = 1.5;
const STEERING: f64 = 0.8;

/// Half the length and half the width of a car (m).
const HALF: [f64; 2] = [0.9, 0.4];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut car = HybridSystem::new(0.5); // s
    let x = car.state("x", -4.0, 4.0)?; // m along the road
    let y = car.state("y", 0.0, 3.0)?; // m aside
    let heading = car.state("heading", -1.2, 1.2)?; // rad
    let speed = car.input("speed", -FASTEST, FASTEST)?; // m/s
    let turn = car.input("turn", -FASTEST * STEERING, FASTEST * STEERING)?; // rad/s
    car.rates([x.is(speed * heading.cos()), y.is(speed * heading.sin()), heading.is(turn)])?;
    let [forward, backward] = car.modes("gear", ["forward", "backward"])?;
    for (from, to) in
        [(forward, forward), (backward, backward), (forward, backward), (backward, forward)]
    {
        let ahead = if to == forward { 1.0 } else { -1.0 };
        let step = if from == to { car.stay(from)? } else { car.switch(from, to)? };
        step.guard((ahead * speed).ge(0.0))?
            .guard((ahead * STEERING * speed - turn).ge(0.0))?
            .guard((ahead * STEERING * speed + turn).ge(0.0))?;
    }
    // Each step is in the lane or between the cars, at both ends.
    car.mode_of("place", "lane")?.invariant(y.ge(1.2))?;
    car.mode_of("place", "bay")?.invariant(x.within(-0.7, 0.7))?;

    let start = [x.equals(2.5), y.equals(2.0), heading.equals(0.0)];
    let goal = [x.equals(0.0), y.equals(0.4), heading.equals(0.0)];
    let found = car.shortest(start, goal, &mut BranchAndBound::default())?;
    println!("{found}");
    let Some(plan) = found.plan else { return Ok(()) };
    print!("{}", plan.run.to_csv());
    let (motion, proved) = (car.motion(&plan.run)?, car.enclose_motion(&plan.run)?);
    println!(
        "the motion leaves the samples by at most {:.3} m and {:.3} m, proved",
        proved.errors[0], proved.errors[1]
    );
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, picture(&plan.run, &motion.path)?)?;
    }
    Ok(())
}

/// The corners of a car.
fn corners(x: f64, y: f64, heading: f64) -> Vec<[f64; 2]> {
    let corner = |[ahead, aside]: [f64; 2]| {
        let [ahead, aside] = [ahead * HALF[0], aside * HALF[1]];
        let (sin, cos) = heading.sin_cos();
        [x + ahead * cos - aside * sin, y + ahead * sin + aside * cos]
    };
    [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]].map(corner).into()
}

fn picture(run: &HybridRun, path: &[(f64, Vec<f64>)]) -> Result<String, Error> {
    let mut chart = Chart::new("x (m)", "y (m)").with_equal_axes().with_size(760.0, 340.0);
    for parked in [-2.6, 2.6] {
        chart.area("", AVOIDED, 1.0, corners(parked, 0.4, 0.0));
    }
    chart.area("", GOAL_COLOUR, 0.3, corners(0.0, 0.4, 0.0));
    let [x, y, heading] = [run.state("x")?, run.state("y")?, run.state("heading")?];
    for ((x, y), heading) in x.iter().zip(y).zip(heading) {
        chart.area("", WITHOUT_COLLISION[0], 0.12, corners(*x, *y, *heading));
    }
    let way = path.iter().map(|(_, state)| [state[0], state[1]]);
    chart.line("motion of the centre", WITHOUT_COLLISION[0], way);
    chart.start("start", "black", [x[0], y[0]]);
    let title = format!(
        "A car parks in {} steps, and no plan has fewer\nThe steps are those of the midpoint rule with 0.5 s.",
        x.len() - 1
    );
    Ok(Chart::to_svg(&[chart], &title))
}
