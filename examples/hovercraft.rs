//! A hovercraft that can only push forward, in air, around a pillar: it turns to steer and to brake,
//! and may brake at a cushioned wall instead.
//!
//! `cargo run --release --example hovercraft [PICTURE.svg]`

use carom::hybrid::Restitution;
use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Shape, Solid, Surface};
use carom::prelude::*;

/// The hovercraft, which may hit the wall at 4 m/s or less, or must not.
fn scene(may_hit: bool) -> Result<Scene, Error> {
    let craft = Body::new("craft", [0.0..=4.0, 0.0..=2.0], 3.0, 0.0)
        .with_acceleration([0.0..=2.5, 0.0..=0.0])
        .with_shape(Shape::Ball(0.15))
        .with_drag(0.1)
        .with_spin(0.01, 4.0, 0.15)
        .with_heading(-4.0..=4.0)
        .with_start([0.5, 0.4, 0.0, 0.0, 0.0, 0.0])
        .with_goal([3.6..=3.85, 0.2..=1.8, -0.4..=0.4, -0.4..=0.4]);
    let wall = match may_hit {
        true => Surface::bounce(Restitution::new(0.1)?),
        false => Surface::avoid(),
    };
    Ok(Scene::new(0.25)
        .with_body(craft)
        .with_obstacle(Solid::cuboid("pillar", [1.6..=2.0, 0.0..=0.6], Surface::avoid()))
        .with_obstacle(Solid::halfspace("wall", [-1.0, 0.0], -4.0, wall))
        .with_rule(DamageRule::new("softly", DamageMeasure::ImpactSpeed).with_per_hit(4.0)))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for may_hit in [false, true] {
        let scene = scene(may_hit)?;
        let found = scene.shortest(&mut BranchAndBound::default())?;
        println!("{}: {found}", if may_hit { "braking at the wall" } else { "without the wall" });
        let Some(plan) = found.plan else { continue };
        let path = &plan.bodies[0];
        for t in 0..=plan.steps() {
            let (x, v) = (&path.position[t], &path.velocity[t]);
            println!(
                "  {:.2} {:.2} m  {:.2} {:.2} m/s  {:.2} rad",
                x[0], x[1], v[0], v[1], path.heading[t]
            );
        }
        if let (true, Some(file)) = (may_hit, std::env::args().nth(1)) {
            std::fs::write(file, plan.picture(&scene)?.to_svg())?;
        }
    }
    Ok(())
}
