//! A puck that banks off two cushions to be sooner at its goal than without them.
//!
//! `cargo run --release --example bank_shot [-- [--proof FOLDER] [PICTURE.svg [ANIMATION.svg]]]`
//!
//! * `--proof FOLDER`: write a log for each horizon of both searches, which `carom-proof check`
//!   reads

#[path = "common/proofs.rs"]
mod proofs;

use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (folder, paths) = proofs::arguments()?;
    let table = [0.0..=2.0, 0.0..=1.0]; // m
    // At most 3 m/s and 3 m/s² along each axis; it starts towards the far corner.
    let puck = Body::new("puck", &table, 3.0, 3.0)
        .with_start([1.2, 0.2, 2.0, 2.0])
        .with_goal([0.4, 0.2, 0.0, 0.0]);
    let mut solver = BranchAndBound::default();
    let bounce = Surface::bounce(Restitution::new(0.9)?);
    let mut plans = Vec::new();
    for (name, surface) in [("avoiding", Surface::avoid()), ("banking", bounce)] {
        let scene = Scene::new(0.05).with_body(puck.clone()).with_room("cushion", &table, surface);
        solver.options_mut().proof = folder.as_ref().map(|folder| folder.join(name));
        let found = scene.shortest(&mut solver)?;
        let (solves, logged) = (
            found.solves(),
            folder.as_ref().map(|folder| proofs::line(&found, &folder.join(name))),
        );
        let Some(plan) = found.plan else {
            return Err(format!("{name}: {}", found.status).into());
        };
        println!(
            "{name}: {} steps, {:.2} s; every smaller horizon refuted, {solves} solves in all",
            plan.steps(),
            plan.duration()
        );
        for hit in &plan.hits {
            let (contact, time, speed, damage) = (&hit.contact, hit.time, hit.speed, hit.damage);
            println!("  {contact} at {time:.3} s with {speed:.3} m/s, counted as {damage:.3} m/s");
        }
        let certificate = &plan.certificate;
        println!(
            "  samples replayed to {:.1e}; located impacts differ by up to {:.1e} m in their step",
            certificate.drift, certificate.step_error
        );
        if let Some(logged) = logged {
            println!("  {logged}");
        }
        plans.push((scene, plan));
    }
    let [(_, braking), (scene, banking)] = &plans[..] else { return Ok(()) };
    let title = format!(
        "{:.1} s against {:.1} s, proved\nA puck, moving away from its goal, brakes or is turned around by \
         two cushions.",
        braking.duration(),
        banking.duration()
    );
    let picture = banking.picture(scene)?.with_name("two cushions").with_title(title);
    let picture = picture.with_rival("no collision", braking)?;
    let mut paths = paths.into_iter();
    if let Some(path) = paths.next() {
        std::fs::write(path, picture.to_svg())?;
    }
    if let Some(path) = paths.next() {
        std::fs::write(path, picture.to_animation()?)?;
    }
    Ok(())
}
