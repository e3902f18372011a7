//! A car parks between two others: the least number of steps, with a proof that fewer do not do.
//!
//! `cargo run --release --example parking`
//!
//! The car has a heading and a steering limit, so its motion has sines and cosines, and it goes
//! forward or backward in each step. A step is one of Euler's: the plan and the proof are about
//! that.

use std::time::Instant;

use carom::model::Family;
use carom::prelude::*;

/// Length of a step (s).
const STEP: f64 = 0.5;

/// The largest speed (m/s), and the largest curvature of the way (1/m).
const FASTEST: f64 = 1.5;
const STEERING: f64 = 0.8;

/// The way of the car, by sample: position along the road and from the kerb (m), heading (rad).
struct Way {
    x: Family,
    y: Family,
    heading: Family,
}

/// The program of a number of steps.
fn program(steps: usize) -> Result<(Model, Way), Error> {
    let mut model = Model::new("parking");
    let x = model.continuous_family("x", steps + 1, -4.0, 4.0)?;
    let y = model.continuous_family("y", steps + 1, 0.0, 3.0)?;
    let heading = model.continuous_family("heading", steps + 1, -1.2, 1.2)?;
    for (sample, [at, from_kerb]) in [(0, [2.0, 2.0]), (steps, [0.0, 0.0])] {
        model.set_bounds(x[sample], at, at)?;
        model.set_bounds(y[sample], from_kerb, from_kerb)?;
        model.set_bounds(heading[sample], 0.0, 0.0)?;
    }
    for t in 0..steps {
        let speed = model.continuous(("speed", t), -FASTEST, FASTEST)?;
        let turn = model.continuous(("turn", t), -FASTEST * STEERING, FASTEST * STEERING)?;
        let (cos, sin) = (heading[t].cos(), heading[t].sin());
        model.add(("along", t), (x[t] + STEP * speed * cos).equals(x[t + 1]))?;
        model.add(("aside", t), (y[t] + STEP * speed * sin).equals(y[t + 1]))?;
        model.add(("turned", t), (heading[t] + STEP * turn).equals(heading[t + 1]))?;
        let limit = |way: Affine| {
            [way.ge(0.0), (STEERING * &way - turn).ge(0.0), (STEERING * way + turn).ge(0.0)]
        };
        model.add(("gear", t), either(limit(speed.into())).or(limit(-1.0 * speed)))?;
        // In the lane, or between the cars.
        model.add(("free", t), either(y[t].ge(1.0)).or(x[t].within(-1.0, 1.0)))?;
    }
    Ok((model, Way { x, y, heading }))
}

fn main() -> Result<(), Error> {
    let mut solver = BranchAndBound::default();
    for steps in 1..=12 {
        let began = Instant::now();
        let (model, way) = program(steps)?;
        let solution = solver.solve(&model)?;
        let (nodes, seconds) = (solution.statistics().nodes, began.elapsed().as_secs_f64());
        if solution.is_infeasible() {
            println!("{steps} steps: proved to be too few ({nodes} nodes, {seconds:.2} s)");
            continue;
        }
        println!("{steps} steps: enough ({nodes} nodes, {seconds:.2} s)");
        for t in 0..=steps {
            let at = |of: &Family| solution.value(of[t]);
            let (x, y, heading) = (at(&way.x)?, at(&way.y)?, at(&way.heading)?);
            println!(
                "  {t}: x {x:6.2} m, from the kerb {y:5.2} m, heading {:6.1}°",
                heading.to_degrees()
            );
        }
        break;
    }
    Ok(())
}
