//! A gate that moves: the drone waits for it, and every shorter flight is refuted, one by one.
//!
//! `cargo run --release --example moving_gate [-- [--proof FOLDER]
//! [PICTURE.svg [ANIMATION.svg [PROGRAM.mps]]]]`
//!
//! * `--proof FOLDER`: write a log for each horizon, which `carom-proof check` reads

#[path = "common/proofs.rs"]
mod proofs;

use carom::model::mps;
use carom::prelude::*;

const TIME_STEP: f64 = 0.2; // s

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (folder, paths) = proofs::arguments()?;
    let room = [0.0..=4.0, 0.0..=2.0];
    let drone = Body::new("drone", &room, 1.5, 2.0)
        .with_shape(Shape::Ball(0.1))
        .with_start([0.5, 1.0, 0.0, 0.0])
        .with_goal([3.5, 1.0, 0.0, 0.0]);
    // A door across the whole room that slides up from 1 s on, at 0.5 m/s.
    let door = [1.9..=2.1, -0.5..=2.5];
    let course = (0..=40).map(|t| {
        let time = f64::from(t) * TIME_STEP;
        [0.0, 0.5 * (time - 1.0).clamp(0.0, 4.0)]
    });
    let door = Solid::cuboid("door", &door, Surface::avoid()).with_course(course);
    let scene = Scene::new(TIME_STEP)
        .with_body(drone)
        .with_room("wall", &room, Surface::avoid())
        .with_obstacle(door);
    let mut solver = BranchAndBound::default();
    solver.options_mut().proof.clone_from(&folder);
    let found = scene.shortest(&mut solver)?;
    println!("waiting: {}", found.monotonicity.reason());
    let Some(plan) = &found.plan else { return Err(format!("{}", found.status).into()) };
    let solves = found.solves();
    println!(
        "{} steps ({:.1} s); {} refuted one by one, {} attempts with {solves} solves, {:.2} s",
        plan.steps(),
        plan.duration(),
        plan.steps() - 1,
        found.attempts.len(),
        found.time.as_secs_f64()
    );
    if let Some(folder) = &folder {
        println!("{}", proofs::line(&found, folder));
    }
    let title = format!(
        "A drone dives under a door that slides up\n{:.1} s; all {} shorter horizons are refuted.",
        plan.duration(),
        plan.steps() - 1
    );
    let picture = plan.picture(&scene)?.with_title(title);
    let mut paths = paths.into_iter();
    if let Some(path) = paths.next() {
        std::fs::write(path, picture.to_svg())?;
    }
    if let Some(path) = paths.next() {
        std::fs::write(path, picture.to_animation()?)?;
    }
    if let Some(path) = paths.next() {
        for steps in [plan.steps() - 1, plan.steps()] {
            let program = scene.plain_program(steps)?;
            let lowered = carom::reformulate::lower(program.model())?;
            std::fs::write(format!("{path}.{steps}.mps"), mps::write(lowered.model())?)?;
        }
    }
    Ok(())
}
