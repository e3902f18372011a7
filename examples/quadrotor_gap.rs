//! A quadrotor in a plane tilts through a gap in a wall, in the least number of steps.
//!
//! `cargo run --release --example quadrotor_gap [PICTURE.svg]`
//!
//! Thrust acts along the body, so accelerations are products of thrust with the sine and the cosine
//! of the tilt.

use carom::picture::{AVOIDED, Chart, WITHOUT_COLLISION};
use carom::prelude::*;

/// Where the wall is (m along), and where its gap is (m above the floor).
const WALL: [f64; 2] = [1.8, 2.2];
const GAP: [f64; 2] = [1.5, 1.8];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut quadrotor = HybridSystem::new(0.2); // s
    let x = quadrotor.state("x", 0.0, 4.0)?; // m
    let z = quadrotor.state("z", 0.0, 3.0)?; // m
    let vx = quadrotor.state("vx", -4.0, 4.0)?; // m/s
    let vz = quadrotor.state("vz", -3.0, 3.0)?; // m/s
    let tilt = quadrotor.state("tilt", -0.7, 0.7)?; // rad
    let thrust = quadrotor.input("thrust", 4.0, 16.0)?; // m/s²
    let turn = quadrotor.input("turn", -3.0, 3.0)?; // rad/s
    quadrotor.rates([
        x.is(vx),
        z.is(vz),
        vx.is(thrust * tilt.sin()),
        vz.is(thrust * tilt.cos() - 9.81),
        tilt.is(turn),
    ])?;
    // Each step keeps to one place, at both ends.
    quadrotor.mode("before the wall")?.invariant(x.le(WALL[0]))?;
    quadrotor.mode("in the gap")?.invariant(z.within(GAP[0], GAP[1]))?;
    quadrotor.mode("behind the wall")?.invariant(x.ge(WALL[1]))?;

    let rest = |along: f64, above: f64| {
        let still = [vx.equals(0.0), vz.equals(0.0), tilt.equals(0.0)];
        [&[x.equals(along), z.equals(above)][..], &still].concat()
    };
    let found =
        quadrotor.shortest(rest(0.5, 0.8), rest(3.5, 0.8), &mut BranchAndBound::default())?;
    println!("{found}");
    let Some(plan) = found.plan else { return Ok(()) };
    print!("{}", plan.run.to_csv());
    let (motion, proved) = (quadrotor.motion(&plan.run)?, quadrotor.enclose_motion(&plan.run)?);
    println!(
        "the motion leaves the samples by at most {:.3} m and {:.3} m, proved",
        proved.errors[0], proved.errors[1]
    );
    let Some(path) = std::env::args().nth(1) else { return Ok(()) };

    let mut chart = Chart::new("x (m)", "z (m)").with_equal_axes().with_size(760.0, 420.0);
    chart.rectangles(
        AVOIDED,
        [[[WALL[0], 0.0], [WALL[1], GAP[0]]], [[WALL[0], GAP[1]], [WALL[1], 3.0]]],
    );
    let [xs, zs, tilts] = [plan.run.state("x")?, plan.run.state("z")?, plan.run.state("tilt")?];
    for ((x, z), tilt) in xs.iter().zip(zs).zip(tilts) {
        let (sin, cos) = (0.25 * tilt.sin(), 0.25 * tilt.cos());
        let arms = [[x - cos, z + sin], [x + cos, z - sin]];
        chart.line_of_width(3.0, "", WITHOUT_COLLISION[0], arms);
    }
    let way = motion.path.iter().map(|(_, state)| [state[0], state[1]]);
    chart.line("motion", WITHOUT_COLLISION[1], way);
    let steps = xs.len() - 1;
    let title =
        format!("Through the gap in {steps} steps of 0.2 s, from rest to rest; no plan has fewer");
    std::fs::write(path, Chart::to_svg(&[chart], &title))?;
    Ok(())
}
