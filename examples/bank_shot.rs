//! A puck that banks off two cushions to be sooner at its goal than without them.
//!
//! `cargo run --release --example bank_shot [-- PICTURE.svg]`

use std::error::Error as StdError;

use carom::hybrid::scene::{Body, Scene, Surface};
use carom::hybrid::{Region, Restitution, ShortestOptions};
use carom::interval::Interval;
use carom::prelude::*;

fn main() -> Result<(), Box<dyn StdError>> {
    let table = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)]; // m
    let puck = Body::new("puck", table, 3.0, 3.0)
        .with_start(Region::point([1.2, 0.3, 2.0, 1.5]))
        .with_goal(Region::point([0.4, 0.3, 0.0, 0.0]));
    let bounce = Surface::bounce(Restitution::new(0.9)?);
    let mut solver = BranchAndBound::default();
    for (name, surface) in [("avoid", Surface::avoid()), ("bounce", bounce)] {
        let scene = Scene::new(0.05).with_body(puck.clone()).with_room("cushion", &table, surface);
        let found = scene.shortest_plan(&ShortestOptions::default(), &mut solver)?;
        let Some(plan) = found.plan else {
            return Err(format!("{name}: {}", found.search.status).into());
        };
        println!(
            "{name}: {} steps ({:.2} s), {}, {} solves, {:.2} s of computing",
            plan.steps(),
            plan.duration(),
            found.search.status,
            found.search.attempts.iter().filter(|a| a.is_solve()).count(),
            found.search.time.as_secs_f64()
        );
        println!("  waiting: {}", found.waiting.reason());
        for hit in &plan.hits {
            println!(
                "  {} at {:.3} s: {:.3} m/s, counted {:.3} m/s, at the end of the step {:.3} m/s",
                hit.contact, hit.time, hit.speed, hit.damage, hit.end_speed
            );
        }
        println!("  {:?}", plan.certificate);
    }
    Ok(())
}
