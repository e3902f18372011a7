//! The program that the page shows for a task.

use carom::prelude::*;

/// The scene, with surfaces to avoid or to bounce off.
fn scene(surface: Surface) -> Result<Scene, Error> {
    let room = [0.0..=4.0, 0.0..=3.0]; // m
    let mut scene = Scene::new(2.0); // s
    let body = Body::new("robot", &room, 0.5, 0.15) // m/s, m/s²
        .with_mass(10.0) // kg
        .with_shape(Shape::Ball(0.16)) // m
        .with_start([0.8, 1.5, -0.0, 0.0])
        .with_goal([3.5, 1.2, 0.0, 0.0]);
    scene.body(body)?;
    let wall = Solid::halfspace("left wall", [1.0, 0.0], 0.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("right wall", [-1.0, 0.0], -4.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("lower wall", [0.0, 1.0], 0.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("upper wall", [0.0, -1.0], -3.0, surface);
    scene.obstacle(wall)?;
    let sides = [1.7..=2.3, 0.9..=2.2]; // m
    scene.obstacle(Solid::cuboid("pillar", &sides, surface))?;
    Ok(scene)
}

fn main() -> Result<(), Error> {
    let options = ShortestOptions::default().with_max_steps(15);
    let bounce = Surface::bounce(Restitution::new(0.6)?);
    for (name, surface) in [("without collisions", Surface::avoid()), ("with collisions", bounce)] {
        let found = scene(surface)?.shortest_with(&options, &mut BranchAndBound::default())?;
        println!("{name}: {found}");
    }
    Ok(())
}
