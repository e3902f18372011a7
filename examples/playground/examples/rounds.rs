//! The program that the page shows for a task.

use carom::prelude::*;

/// The scene, with surfaces to avoid or to bounce off.
fn scene(surface: Surface) -> Result<Scene, Error> {
    let room = [0.0..=6.0, 0.0..=4.0]; // m
    let mut scene = Scene::new(1.0); // s
    let body = Body::new("robot", &room, 2.0, 0.6) // m/s, m/s²
        .with_mass(1.0) // kg
        .with_start([1.0, 0.6, 0.0, 0.0]);
    scene.body(body)?;
    let wall = Solid::halfspace("left wall", [1.0, 0.0], 0.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("right wall", [-1.0, 0.0], -6.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("lower wall", [0.0, 1.0], 0.0, surface);
    scene.obstacle(wall)?;
    let wall = Solid::halfspace("upper wall", [0.0, -1.0], -4.0, surface);
    scene.obstacle(wall)?;
    Ok(scene)
}

fn main() -> Result<(), Error> {
    let options = ShortestOptions::default().with_max_steps(20);
    let bounce = Surface::bounce(Restitution::new(0.3)?);
    for (name, surface) in [("without collisions", Surface::avoid()), ("with collisions", bounce)] {
        let scene = scene(surface)?;
        let body = scene.body_named("robot")?;
        let [x, y] = [body.position(0), body.position(1)];
        let places = [
            Mission::holds("in A", [x.within(0.4, 1.2), y.within(2.6, 3.4)]), // m
            Mission::holds("in B", [x.within(4.8, 5.6), y.within(2.8, 3.6)]), // m
        ];
        let mission = Mission::parse("F in A & F in B", places)?;
        let options = options.clone().with_mission("mission", &mission);
        let found = scene.shortest_with(&options, &mut BranchAndBound::default())?;
        println!("{name}: {found}");
    }
    Ok(())
}
