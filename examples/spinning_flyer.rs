//! A free-flyer with spin: what a hit does to it as one linear map, and how torque before a hit
//! steers the rebound.
//!
//! `cargo run --release --example spinning_flyer [-- PICTURE.svg]`

use carom::hybrid::scene::ScenePlan;
use carom::prelude::*;

const MASS: f64 = 10.0; // kg
const RADIUS: f64 = 0.16; // m
const INERTIA: f64 = 0.128; // kg m², of a solid disc
const RESTITUTION: f64 = 0.6;
/// The touching points slide back with this part of their speed.
const TANGENTIAL: f64 = 0.4;

/// What a hit does to the velocity along the normal, that along the normal turned left, and the
/// spin.
fn map() -> [[f64; 3]; 3] {
    // An impulse along the surface changes the velocity of the touching points k times as much as
    // that of the centre.
    let k = 1.0 + MASS * RADIUS * RADIUS / INERTIA;
    let push = (1.0 + TANGENTIAL) / k;
    let turn = MASS * RADIUS / INERTIA * push;
    [[-RESTITUTION, 0.0, 0.0], [0.0, 1.0 - push, push * RADIUS], [0.0, turn, 1.0 - turn * RADIUS]]
}

/// A robot with hardly any thrust left drifts towards a wall, off which it bounces, and must get to
/// the right.
fn scene(max_torque: f64) -> Result<Scene, carom::Error> {
    let bumper = Surface::bounce(Restitution::new(RESTITUTION)?).with_linear_map(-TANGENTIAL, 0.0);
    let robot = Body::new("robot", [0.0..=4.0, 0.0..=3.0], 0.6, 0.005)
        .with_mass(MASS)
        .with_shape(Shape::Ball(RADIUS))
        .with_spin(INERTIA, 6.0, max_torque)
        .with_start([1.0, 1.6, 0.0, -0.3, 0.0])
        .with_goal([2.6..=3.0, 0.8..=2.8, -0.6..=0.6, -0.6..=0.6]);
    Ok(Scene::new(0.5).with_body(robot).with_obstacle(Solid::halfspace(
        "wall",
        [0.0, 1.0],
        0.0,
        bumper,
    )))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("(normal, along, spin) after a hit, of those before, in m/s and rad/s:");
    for row in map() {
        println!("{:8.3} {:8.3} {:8.3}", row[0], row[1], row[2]);
    }
    println!("torque (N m)  time (s)  largest spin (rad/s)  hits");
    let mut plans: Vec<ScenePlan> = Vec::new();
    for torque in [0.0, 0.2] {
        let found = scene(torque)?.shortest(&mut BranchAndBound::default())?;
        let plan = found.plan.ok_or("no plan found")?;
        let spin = plan.bodies[0].spin.iter().map(|w| w.abs()).fold(0.0, f64::max);
        let hits: Vec<&str> =
            plan.hits.iter().filter_map(|hit| hit.contact.split(" at ").last()).collect();
        println!("{torque:12.1} {:9.1} {spin:21.2}  {}", plan.duration(), hits.join(", "));
        plans.push(plan);
    }
    if let Some(path) = std::env::args().nth(1) {
        let [without, with] = &plans[..] else { return Ok(()) };
        let title = format!(
            "A free-flyer with hardly any thrust\nTorque before the hit steers it off the wall: {:.1} s \
             against {:.1} s, both proved.",
            with.duration(),
            without.duration()
        );
        let picture = with.picture(&scene(0.2)?)?.with_title(title).with_name("with torque");
        let picture = picture.with_rival("without", without)?;
        std::fs::write(path, picture.to_svg())?;
    }
    Ok(())
}
