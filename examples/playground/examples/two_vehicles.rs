//! The program that the page shows for a task.

use carom::hybrid::scene::{DamageMeasure, DamageRule};
use carom::prelude::*;

/// The scene, with surfaces to avoid or to bounce off.
fn scene(surface: Surface) -> Result<Scene, Error> {
    let mut scene = Scene::new(0.5); // s
    let room = [0.3..=5.7, 0.2..=1.2]; // m, of its middle
    let body = Body::new("carrier", &room, 3.0, 1.0) // m/s, m/s²
        .with_mass(2.0) // kg
        .with_shape(Shape::Box(vec![0.3, 0.2])) // m
        .with_start([0.5, 0.7, 2.0, 0.0])
        .with_goal([2.0, 0.7, 0.0, 0.0]);
    let body_0 = scene.body(body)?;
    let room = [0.2..=5.8, 0.2..=1.2]; // m, of its middle
    let body = Body::new("cart", &room, 3.0, 1.0) // m/s, m/s²
        .with_mass(1.0) // kg
        .with_shape(Shape::Box(vec![0.2, 0.2])) // m
        .with_start([2.2, 0.7, 0.0, 0.0]);
    let body_1 = scene.body(body)?;
    scene.pair(body_0, body_1, surface)?;
    if surface.restitution().is_some() {
        let rule = DamageRule::new("impulse", DamageMeasure::NormalImpulse);
        scene = scene.with_rule(rule.with_per_hit(4.0)); // N s
    }
    Ok(scene)
}

fn main() -> Result<(), Error> {
    let options = ShortestOptions::default().with_max_steps(20);
    let bounce = Surface::bounce(Restitution::new(0.8)?);
    for (name, surface) in [("without collisions", Surface::avoid()), ("with collisions", bounce)] {
        let found = scene(surface)?.shortest_with(&options, &mut BranchAndBound::default())?;
        println!("{name}: {found}");
    }
    Ok(())
}
