//! A mission in words of time: a puck visits A within 10 s, then B or C, never D, and stays two
//! seconds in E. It may bounce off the cushions.
//!
//! `cargo run --release --example mission [-- PICTURE.svg]`

use carom::hybrid::Mission;
use carom::prelude::*;

const TIME_STEP: f64 = 0.5; // s
const STEPS: usize = 32;

/// A place by its name and its left, right, lower and upper side, in m.
type Place = (&'static str, [f64; 4]);

const PLACES: [Place; 5] = [
    ("A", [0.4, 1.2, 2.6, 3.4]),
    ("B", [4.8, 5.6, 2.8, 3.6]),
    ("C", [2.6, 3.4, 0.2, 0.8]),
    ("D", [2.4, 3.6, 1.4, 2.6]),
    ("E", [4.8, 5.6, 0.4, 1.2]),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = [0.0..=6.0, 0.0..=4.0];
    let puck = Body::new("puck", &table, 2.0, 0.6).with_start([1.0, 0.6, 0.0, 0.0]);
    let mut scene =
        Scene::new(TIME_STEP).with_room("cushion", &table, Surface::bounce(Restitution::new(0.7)?));
    let puck = scene.body(puck)?;
    let [x, y] = [puck.position(0), puck.position(1)];
    let places = PLACES.map(|(name, [left, right, low, high])| {
        Mission::holds(format!("in {name}"), [x.within(left, right), y.within(low, high)])
    });

    let text = "F[0,10s](in A & F[0,6s](in B | in C)) & G !in D & F G[0,2s] in E";
    let mission = Mission::parse(text, places.clone())?;
    println!("mission: {mission}");

    let solver = &mut BranchAndBound::default();
    let mut program = scene.program(STEPS)?;
    program.require_mission("mission", &mission)?;
    let plan = program.solve(solver)?;
    let hits = plan.hits.len();
    let robustness = program.system().robustness(&mission, &plan.run)?;
    println!("{:.1} s, {hits} hits, robustness {robustness:.3} m", plan.duration());

    // Twice as fast cannot be: which part of the mission says so?
    let hurry = Mission::parse("F[0,2s](in A & F[0,1.5s] in B) & G !in D", places)?;
    let bare = scene.program(STEPS)?;
    if let Some(parts) = bare.program().mission_conflict(&hurry, solver)? {
        let parts: Vec<String> = parts.iter().map(Mission::to_string).collect();
        println!("no plan for: {hurry}\nbecause of: {}", parts.join(" and "));
    }

    if let Some(path) = std::env::args().nth(1) {
        // The same scene with the places drawn: they are no obstacles.
        let drawn = PLACES.iter().fold(scene.clone(), |scene, (name, [left, right, low, high])| {
            let sides = [*left..=*right, *low..=*high];
            scene.with_obstacle(Solid::cuboid(*name, &sides, Surface::avoid()))
        });
        let title =
            format!("A within 10 s, then B or C, never D, two seconds in E\n{hits} bounces.");
        std::fs::write(path, plan.picture(&drawn)?.with_title(title).to_svg())?;
    }
    Ok(())
}
