//! The program that the page shows for a task.

use carom::prelude::*;

/// The scene, with surfaces to avoid or to bounce off.
fn scene(surface: Surface) -> Result<Scene, Error> {
    let room = [0.0..=2.5, 0.0..=1.5]; // m
    let mut scene = Scene::new(0.25); // s
    let body = Body::new("puck", &room, 2.4, 0.8) // m/s, m/s²
        .with_mass(1.0) // kg
        .with_start([0.3, 0.3, 1.8, 0.0])
        .with_pushes([-0.01..=0.01, -0.01..=0.01]) // m/s
        .with_goal(Region::from([1.45..=1.95, 0.8..=1.3, -0.5..=0.5, -0.5..=0.5]));
    scene.body(body)?;
    let wall = Solid::halfspace("left wall", [1.0, 0.0], 0.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("right wall", [-1.0, 0.0], -2.5, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("lower wall", [0.0, 1.0], 0.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("upper wall", [0.0, -1.0], -1.5, surface);
    scene.obstacle(wall)?;
    let sides = [1.0..=1.3, 0.6..=1.5]; // m
    scene.obstacle(Solid::cuboid("block", &sides, Surface::avoid()))?;
    Ok(scene)
}

fn main() -> Result<(), Error> {
    let options = ShortestOptions::default().with_max_steps(40);
    let bounce = Surface::bounce(Restitution::new(0.3)?).with_spread(0.1);
    for (name, surface) in [("without collisions", Surface::avoid()), ("with collisions", bounce)] {
        let scene = scene(surface)?;
        let feedback = Feedback::regulator(&scene.hybrid_system()?)?;
        let solver = &mut BranchAndBound::default();
        let found = scene.shortest_robust(&feedback, &options, solver)?;
        println!("{name}: {found}");
    }
    Ok(())
}
