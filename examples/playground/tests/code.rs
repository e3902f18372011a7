//! The Rust programs of tasks compile: they are the examples of this package.
//!
//! `UPDATE=1 cargo test` writes them anew.

use std::path::Path;

use carom_playground::{plan_scene_with, plan_with};
use serde_json::{Value, json};

fn code(answer: &str) -> String {
    let answer: Value = serde_json::from_str(answer).unwrap();
    assert_eq!(answer["error"], Value::Null);
    answer["code"].as_str().unwrap().to_owned()
}

fn check(name: &str, code: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    let text = format!("//! The program that the page shows for a task.\n\n{code}");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "{}", path.display());
}

fn wall(limit: Value) -> Value {
    json!({
        "start": 4, "velocity": -10, "goal": 0.3, "restitution": 0.3, "impactLimit": limit,
        "maxSpeed": 15, "maxAcceleration": 6, "timeStep": 0.05,
    })
}

fn pillar() -> Value {
    json!({
        "timeStep": 2, "longest": 30, "room": [[0, 4], [0, 3]], "walls": true,
        "restitution": 0.6, "impulseLimit": null,
        "bodies": [{ "name": "robot", "mass": 10, "radius": 0.16, "start": [0.8, 1.5, -0.0, 0.0],
            "goal": [3.5, 1.2, 0, 0], "maxSpeed": 0.5, "maxAcceleration": 0.15 }],
        "obstacles": [{ "name": "pillar", "sides": [[1.7, 2.3], [0.9, 2.2]] }],
    })
}

fn vehicles() -> Value {
    let vehicle = |name: &str, mass: f64, half: Value, start: Value, goal: Value| {
        json!({ "name": name, "mass": mass, "half": half, "start": start, "goal": goal,
            "maxSpeed": 3, "maxAcceleration": 1 })
    };
    let at_rest = json!([2, 0.7, 0, 0]);
    json!({
        "timeStep": 0.5, "longest": 10, "room": [[0, 6], [0, 1.4]], "walls": false,
        "restitution": 0.8, "impulseLimit": 4,
        "bodies": [
            vehicle("carrier", 2.0, json!([0.3, 0.2]), json!([0.5, 0.7, 2, 0]), at_rest),
            vehicle("cart", 1.0, json!([0.2, 0.2]), json!([2.2, 0.7, 0, 0]), Value::Null),
        ],
        "obstacles": [],
    })
}

/// A flyer whose limits are on the lengths of velocity and acceleration.
fn thruster() -> Value {
    let mut task = pillar();
    task["timeStep"] = json!(2);
    task["bodies"][0]["isRound"] = json!(true);
    task
}

fn rounds() -> Value {
    let place = |name: &str, sides: Value| json!({ "name": name, "sides": sides });
    json!({
        "timeStep": 1, "longest": 20, "room": [[0, 6], [0, 4]], "walls": true,
        "restitution": 0.3, "impulseLimit": null,
        "bodies": [{ "name": "robot", "mass": 1, "start": [1, 0.6, 0, 0], "goal": null,
            "maxSpeed": 2, "maxAcceleration": 0.6 }],
        "obstacles": [],
        "places": [place("A", json!([[0.4, 1.2], [2.6, 3.4]])), place("B", json!([[4.8, 5.6], [2.8, 3.6]]))],
        "mission": "F in A & F in B",
    })
}

fn gusts() -> Value {
    json!({
        "timeStep": 0.25, "longest": 10, "room": [[0, 2.5], [0, 1.5]], "walls": true,
        "restitution": 0.3, "spread": 0.1, "impulseLimit": null,
        "bodies": [{ "name": "puck", "mass": 1, "start": [0.3, 0.3, 1.8, 0], "goal": [1.7, 1.05, 0, 0],
            "goalHalf": [0.25, 0.25, 0.5, 0.5], "maxSpeed": 2.4, "maxAcceleration": 0.8, "gusts": 0.01 }],
        "obstacles": [{ "name": "block", "sides": [[1.0, 1.3], [0.6, 1.5]] }],
    })
}

#[test]
fn code_of_tasks_is_that_of_the_examples() {
    let wall = |limit| code(&plan_with(&wall(limit).to_string(), |_| {}));
    check("wall.rs", &wall(Value::Null));
    check("gentle_hits.rs", &wall(json!(9.5)));
    let scene = |task: Value| code(&plan_scene_with(&task.to_string(), |_| {}));
    check("pillar.rs", &scene(pillar()));
    check("two_vehicles.rs", &scene(vehicles()));
    check("thruster.rs", &scene(thruster()));
    check("rounds.rs", &scene(rounds()));
    check("gusts.rs", &scene(gusts()));
}
