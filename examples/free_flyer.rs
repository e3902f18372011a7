//! A free-flyer in a room with a pillar: avoid walls and pillar, or bounce off them. Time, effort
//! and impulse of two flights.
//!
//! `cargo run --release --example free_flyer [-- PICTURE.svg [PICTURE.svg]]`

use carom::hybrid::scene::ScenePlan;
use carom::prelude::*;

const TIME_STEP: f64 = 0.5; // s

/// A name, where the robot starts, and where it must come to rest.
const FLIGHTS: [(&str, [f64; 4], [f64; 2]); 2] = [
    ("behind the pillar", [0.8, 1.5, -0.4, 0.3], [3.5, 1.2]),
    ("into the corner", [0.8, 1.5, 0.4, 0.3], [0.8, 2.6]),
];

/// A robot of 10 kg and 0.16 m of radius in a room of 4 m by 3 m.
fn scene(start: [f64; 4], [x, y]: [f64; 2], surface: Surface) -> Scene {
    let room = [0.0..=4.0, 0.0..=3.0];
    let pillar = [1.7..=2.3, 0.9..=2.2];
    let robot = Body::new("robot", &room, 0.5, 0.15)
        .with_mass(10.0)
        .with_shape(Shape::Ball(0.16))
        .with_start(start)
        .with_goal([x, y, 0.0, 0.0]);
    Scene::new(TIME_STEP)
        .with_body(robot)
        .with_room("wall", &room, surface)
        .with_obstacle(Solid::cuboid("pillar", &pillar, surface))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut solver = BranchAndBound::default();
    let bumper = Surface::bounce(Restitution::new(0.6)?);
    let mut pictures = std::env::args().skip(1);
    println!("flight             surfaces  time (s)  effort (m²/s³)  impulse (N s)  hits");
    for (flight, start, goal) in FLIGHTS {
        let mut avoiding: Option<ScenePlan> = None;
        for (name, surface) in [("avoid", Surface::avoid()), ("bounce", bumper)] {
            let scene = scene(start, goal, surface);
            let found = scene.shortest(&mut solver)?;
            let steps = found.steps.ok_or("no horizon found")?;
            // The least effort in the shortest time.
            let mut program = scene.program(steps)?;
            let effort = program.effort()?;
            program.minimize(effort)?;
            let solution = solver.solve(program.model())?;
            let plan = program.plan(&solution)?;
            let size = |j: &Vec<f64>| j.iter().map(|j| j * j).sum::<f64>().sqrt();
            // An empty sum is -0.
            let impulse = plan.hits.iter().map(|hit| size(&hit.impulse)).sum::<f64>().abs();
            let effort = solution.objective().unwrap_or(f64::NAN);
            let hits: Vec<&str> =
                plan.hits.iter().filter_map(|hit| hit.contact.split(" at ").last()).collect();
            let (time, hits) = (plan.duration(), hits.join(", "));
            println!("{flight:18} {name:8} {time:9.1} {effort:15.4} {impulse:14.2}  {hits}");
            let Some(avoiding) = &avoiding else {
                avoiding = Some(plan);
                continue;
            };
            if let Some(path) = pictures.next() {
                let (faster, slower) = (plan.duration(), avoiding.duration());
                let title = format!(
                    "A free-flyer, {flight}\n{faster:.1} s off the walls against {slower:.1} s \
                     without, both proved."
                );
                let picture = plan.picture(&scene)?.with_title(title).with_name("off the walls");
                let picture = picture.with_rival("no collision", avoiding)?;
                std::fs::write(path, picture.to_svg())?;
            }
        }
    }
    Ok(())
}
