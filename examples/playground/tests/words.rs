//! What a visitor reads where there is no plan, and what comes with a plan.

use std::cell::RefCell;
use std::rc::Rc;

use carom_playground::{explain, explain_scene, less, plan_scene_with, plan_with};
use serde_json::{Value, json};

fn puck(start: [f64; 4], goal: [f64; 2], block: [[f64; 2]; 2]) -> Value {
    json!({
        "timeStep": 0.2, "longest": 5, "room": [[0, 2], [0, 1]], "walls": true,
        "restitution": 0.5, "impulseLimit": null,
        "bodies": [{ "name": "puck", "mass": 1, "start": start, "goal": [goal[0], goal[1], 0, 0],
            "maxSpeed": 3, "maxAcceleration": 3 }],
        "obstacles": [{ "name": "block", "sides": block }],
    })
}

const CORNER: [[f64; 2]; 2] = [[0.4, 0.6], [0.8, 1.0]];

fn scene(task: &Value) -> Value {
    serde_json::from_str(&plan_scene_with(&task.to_string(), |_| {})).unwrap()
}

fn wall(changed: &[(&str, f64)]) -> (Value, String) {
    let mut task = json!({
        "start": 10, "velocity": 0, "goal": 0.3, "restitution": 0, "impactLimit": null,
        "maxSpeed": 15, "maxAcceleration": 6, "timeStep": 0.05,
    });
    for (key, value) in changed {
        task[*key] = json!(value);
    }
    let text = task.to_string();
    (serde_json::from_str(&plan_with(&text, |_| {})).unwrap(), text)
}

#[test]
fn a_goal_in_an_obstacle_is_said_at_once() {
    let task = puck([1.2, 0.5, 0.0, 0.0], [0.5, 0.9], CORNER);
    assert_eq!(scene(&task)["error"], "`puck` ends inside `block`; move one of them.");
    let task = puck([-0.1, 0.5, 0.0, 0.0], [0.5, 0.2], CORNER);
    assert!(scene(&task)["error"].as_str().unwrap().contains("`puck` starts"), "{}", scene(&task));
    let (answer, _) = wall(&[("goal", -0.5)]);
    assert_eq!(answer["error"], "`vehicle` ends inside `wall`; move one of them.");
}

#[test]
fn where_no_plan_is_there_is_a_reason() {
    let (answer, _) = wall(&[("start", 4.0), ("velocity", -10.0), ("impactLimit", 4.0)]);
    // Remedies follow if there is time for them.
    let reason = answer["reason"].as_str().unwrap();
    // The reason with collisions has little time, and gives way to the one without.
    assert!(reason.to_lowercase().contains("no plan has 600 steps (30 s): after "), "{reason}");
    let task = puck([0.3, 0.5, -3.0, 0.0], [1.5, 0.5], CORNER);
    let answer = scene(&task);
    assert_eq!(
        answer["reason"],
        "Without collisions: no plan has 25 steps (5 s): after 1 step (0.2 s), puck cannot keep clear of left \
         wall: at least 0.24 m are missing."
    );
    let text = answer.to_string();
    for jargon in ["no dip", "clear and", "beyond 0", "ends in front"] {
        assert!(!text.contains(jargon), "{text}");
    }
}

#[test]
fn one_step_less_is_explained_and_drawn() {
    let (answer, task) = wall(&[]);
    let step_before = |side: &str| answer[side]["steps"].as_u64().unwrap() as usize - 1;
    let found = less(&task, step_before("free"), step_before("tolerant"));
    let less: Value = serde_json::from_str(&found).unwrap();
    let (side, steps) = (less["side"].as_str().unwrap(), less["steps"].as_u64().unwrap());
    assert_eq!((side, steps), ("tolerant", answer["tolerant"]["steps"].as_u64().unwrap() - 1));
    let samples = less["forward"].as_array().unwrap().len();
    assert_eq!(samples, less["backward"].as_array().unwrap().len());
    assert_eq!(samples as u64, steps + 1);
    let free = answer["free"]["steps"].as_u64().unwrap() as usize - 1;
    let why: Value = serde_json::from_str(&explain(&task, free, steps as usize)).unwrap();
    assert_eq!(
        why["free"]["words"],
        "no plan has 51 steps (2.55 s): at the end, where x of vehicle is 0.3 m, the velocity of vehicle \
         is at most -0.27 m/s, and 0 m/s is needed. It might be possible with twice the range of the \
         acceleration of vehicle"
    );

    let task = puck([1.2, 0.2, 2.0, 2.0], [0.4, 0.2], CORNER);
    let answer = scene(&task);
    let free = answer["free"]["steps"].as_u64().unwrap() as usize - 1;
    let why: Value = serde_json::from_str(&explain_scene(&task.to_string(), free, 0)).unwrap();
    assert_eq!(
        why["free"]["words"],
        "no plan has 10 steps (2 s): at the end, where x of puck is 0.4 m and y of puck is 0.2 m, the \
         velocity of puck along x is at most -0.23 m/s, and 0 m/s is needed. It might be possible with \
         twice the range of the acceleration of puck along x"
    );
}

#[test]
fn news_come_while_it_plans() {
    let told: Rc<RefCell<Vec<Value>>> = Rc::default();
    let task = puck([1.2, 0.2, 2.0, 2.0], [0.4, 0.2], CORNER);
    let listener = Rc::clone(&told);
    let tell = move |text: &str| listener.borrow_mut().push(serde_json::from_str(text).unwrap());
    plan_scene_with(&task.to_string(), tell);
    let news = told.borrow();
    let found = news.iter().position(|news| !news["found"].is_null()).unwrap();
    assert!(news[..found].iter().all(|news| news["side"] == "free"));
    assert!(
        news[..found]
            .windows(2)
            .all(|pair| pair[0]["refuted"].as_u64() <= pair[1]["refuted"].as_u64())
    );
    assert!(news[found]["found"]["plan"].is_object());
    assert!(news[found + 1..].iter().all(|news| news["side"] == "tolerant"));
}

#[test]
fn files_and_coarse_plans_are_asked_for() {
    let mut task = puck([1.2, 0.2, 2.0, 2.0], [0.4, 0.2], CORNER);
    assert_eq!(scene(&task)["mps"], Value::Null);
    task["files"] = json!(true);
    task["coarse"] = json!(true);
    let answer = scene(&task);
    assert_eq!(answer["error"], Value::Null);
    assert!(answer["mps"].as_str().is_some_and(|text| text.contains("ENDATA")), "{answer}");
    assert_eq!(answer["free"]["plan"]["timeStep"], 0.4);
}

#[test]
fn flights_through_gusts_stay_in_their_tube() {
    let mut task = puck([0.3, 0.3, 1.0, 0.0], [1.5, 0.4], CORNER);
    task["spread"] = json!(0.05);
    task["bodies"][0]["gusts"] = json!(0.02);
    task["bodies"][0]["goalHalf"] = json!([0.1, 0.1, 0.3, 0.3]);
    let answer = scene(&task);
    for side in ["free", "tolerant"] {
        assert_eq!(answer[side]["found"], true, "{answer}");
        let proof = answer[side]["proof"].as_str().unwrap();
        assert!(
            proof.contains("Of 100 flights through random gusts, 100 keep the plan"),
            "{proof}"
        );
        let plan = &answer[side]["plan"];
        let tube = plan["tube"].as_array().unwrap();
        assert_eq!(tube.len() as u64, answer[side]["steps"].as_u64().unwrap() + 1);
        let flights = plan["flights"].as_array().unwrap();
        assert_eq!(flights.len(), 100);
        // Samples and boxes are rounded to a tenth of a millimetre.
        let is_in = |place: &Value, sides: &Value| {
            (0..2).all(|k| {
                let at = place[k].as_f64().unwrap();
                sides[k][0].as_f64().unwrap() - 2e-4 <= at
                    && at <= sides[k][1].as_f64().unwrap() + 2e-4
            })
        };
        for flight in flights.iter().map(|flight| flight.as_array().unwrap()) {
            assert!(
                is_in(&flight[0], &tube[0]) && is_in(flight.last().unwrap(), tube.last().unwrap())
            );
            if plan["hits"].as_array().unwrap().is_empty() {
                assert!(flight.iter().zip(tube).all(|(place, sides)| is_in(place, sides)));
            }
        }
    }
}

#[test]
fn a_mission_that_no_plan_keeps_is_said() {
    let mut task = puck([0.3, 0.5, 0.0, 0.0], [0.0, 0.0], CORNER);
    task["bodies"][0]["goal"] = Value::Null;
    task["places"] = json!([{ "name": "A", "sides": [[1.5, 1.9], [0.2, 0.5]] },
        { "name": "B", "sides": [[1.0, 1.3], [0.0, 1.0]] }]);
    task["mission"] = json!("F in A & G !in B");
    // A step of 0.2 s passes through B at 3 m/s between two samples.
    assert_eq!(scene(&task)["tolerant"]["found"], true);
    task["bodies"][0]["maxSpeed"] = json!(1);
    task["longest"] = json!(2);
    let answer = scene(&task);
    assert_eq!(answer["tolerant"]["none"], true);
    let steps = answer["tolerant"]["refuted"].as_u64().unwrap() as usize;
    let why: Value = serde_json::from_str(&explain_scene(&task.to_string(), steps, steps)).unwrap();
    assert_eq!(
        why["tolerant"]["words"],
        "no plan of 10 steps keeps these parts of its mission together: `F in A`, `G[5,8] !in B`"
    );
}
