//! Two vehicles that exchange momentum: the heavy one brakes against the light one.
//!
//! `cargo run --release --example momentum [-- PICTURE.svg]`

use carom::hybrid::scene::{DamageMeasure, DamageRule};
use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let vehicle = |name: &str, mass, half: [f64; 2]| {
        let lane = [0.0..=6.0, 0.0..=1.0]; // m
        Body::new(name, lane, 3.0, 1.0).with_mass(mass).with_shape(Shape::Box(half.to_vec()))
    };
    let mut solver = BranchAndBound::default();
    let bumper = Surface::bounce(Restitution::new(0.8)?);
    let mut alone = None;
    for (name, surface) in [("avoid", Surface::avoid()), ("bump", bumper)] {
        // The carrier arrives fast and must stop; the cart may go where it likes.
        let carrier = vehicle("carrier", 2.0, [0.3, 0.2]).with_start([0.5, 0.5, 2.0, 0.0]);
        let cart = vehicle("cart", 1.0, [0.2, 0.2]).with_start([2.2, 0.5, 0.0, 0.0]);
        let mut scene = Scene::new(0.25);
        let carrier = scene.body(carrier.with_goal([2.0, 0.5, 0.0, 0.0]))?;
        let cart = scene.body(cart)?;
        scene.pair(carrier, cart, surface)?;
        let bumper = DamageRule::new("bumper", DamageMeasure::NormalImpulse);
        let scene = scene.with_rule(bumper.with_pair(carrier, cart).with_per_hit(4.0));
        let options = ShortestOptions::default().with_max_steps(40);
        let found = scene.shortest_with(&options, &mut solver)?;
        let Some(plan) = found.plan else {
            println!("{name}: {}", found.status);
            continue;
        };
        println!("{name}: {:.2} s", plan.duration());
        for hit in &plan.hits {
            println!(
                "  {} at {:.2} s with {:.2} m/s: impulse {:.2} N s, {:.2} J lost",
                hit.contact, hit.time, hit.speed, hit.impulse[0], hit.energy
            );
        }
        let Some(alone) = alone.replace(plan.duration()) else { continue };
        if let Some(path) = std::env::args().nth(1) {
            let title = format!(
                "A carrier brakes against a cart\nIt stops in {:.1} s, proved; without a collision \
                 it takes {alone:.1} s.",
                plan.duration()
            );
            std::fs::write(path, plan.picture(&scene)?.with_title(title).to_svg())?;
        }
    }
    Ok(())
}
