//! Tasks as Rust programs: what a visitor copies compiles as it stands.

use crate::scene_task::{BodyTask, Place, SceneTask, WALLS};
use crate::task::Task;

/// The program of a vehicle beside a wall.
pub fn of_wall(task: &Task) -> String {
    let limit = task.impact_limit.map(|most| {
        format!("\n        .with_damage(DamageRule::default().with_per_hit({most:?})) // m/s")
    });
    let import = match limit {
        Some(_) => "use carom::hybrid::scene::DamageRule;\n",
        None => "",
    };
    format!(
        r#"use carom::collision_tolerant::{{Endpoint, Scenario}};
{import}use carom::prelude::*;

fn main() -> Result<(), Error> {{
    // Plans begin and end without acceleration.
    let at = |position: f64| Endpoint::at_rest(position).with_acceleration(0.0);
    let scenario = Scenario::paper()
        .with_start(at({start:?}).with_velocity({velocity:?})) // m, m/s
        .with_goal(at({goal:?})) // m
        .with_acceleration(-{acceleration:?}..={acceleration:?}) // m/s²
        .with_max_speed({speed:?}) // m/s
        .with_time_step({time_step:?}) // s{limit}
        .with_restitution({restitution:?})?;
    let options = ShortestOptions::default().with_max_steps({max_steps});
    let plans = scenario.compare(&options, &mut BranchAndBound::default())?;
    println!("without collisions: {{}}", plans.free);
    println!("with collisions: {{}}", plans.tolerant);
    Ok(())
}}
"#,
        start = task.start,
        velocity = task.velocity,
        goal = task.goal,
        acceleration = task.max_acceleration,
        speed = task.max_speed,
        time_step = task.time_step,
        limit = limit.unwrap_or_default(),
        restitution = task.restitution,
        max_steps = task.max_steps(),
    )
}

/// The program of a scene.
pub fn of_scene(task: &SceneTask) -> String {
    let mut lines = Vec::new();
    for (k, body) in task.bodies.iter().enumerate() {
        if !task.walls {
            let [[left, right], [low, high]] = task.range(body);
            lines.push(format!(
                "let room = [{left:?}..={right:?}, {low:?}..={high:?}]; // m, of its middle"
            ));
        }
        lines.extend(of_body(k, body, task.bodies.len() > 1));
    }
    if task.walls {
        for (name, normal, end) in WALLS {
            let along = usize::from(normal[0] == 0.0);
            let at = task.room[along][end] * normal[along];
            lines.push(format!(
                "let wall = Solid::halfspace({name:?}, {normal:?}, {at:?}, surface);"
            ));
            lines.push("scene.obstacle(wall)?;".into());
        }
    }
    for first in 0..task.bodies.len() {
        for second in first + 1..task.bodies.len() {
            lines.push(format!("scene.pair(body_{first}, body_{second}, surface)?;"));
        }
    }
    for obstacle in &task.obstacles {
        let [[left, right], [low, high]] = obstacle.sides;
        lines.push(format!("let sides = [{left:?}..={right:?}, {low:?}..={high:?}]; // m"));
        let surface = if task.is_robust() { "Surface::avoid()" } else { "surface" };
        lines.push(format!(
            "scene.obstacle(Solid::cuboid({:?}, &sides, {surface}))?;",
            obstacle.name
        ));
    }
    if let Some(most) = task.impulse_limit {
        lines.push("if surface.restitution().is_some() {".into());
        lines.push(
            "    let rule = DamageRule::new(\"impulse\", DamageMeasure::NormalImpulse);".into(),
        );
        lines.push(format!("    scene = scene.with_rule(rule.with_per_hit({most:?})); // N s"));
        lines.push("}".into());
    }
    let import = match task.impulse_limit {
        Some(_) => "use carom::hybrid::scene::{DamageMeasure, DamageRule};\n",
        None => "",
    };
    let body = lines.iter().map(|line| format!("    {line}\n")).collect::<String>();
    let [[left, right], [low, high]] = task.room;
    let room = match task.walls {
        true => format!("    let room = [{left:?}..={right:?}, {low:?}..={high:?}]; // m\n"),
        false => String::new(),
    };
    format!(
        r#"{import}use carom::prelude::*;

/// The scene, with surfaces to avoid or to bounce off.
fn scene(surface: Surface) -> Result<Scene, Error> {{
{room}    let mut scene = Scene::new({time_step:?}); // s
{body}    Ok(scene)
}}

fn main() -> Result<(), Error> {{
    let options = ShortestOptions::default().with_max_steps({max_steps});
    let bounce = Surface::bounce(Restitution::new({restitution:?})?){spread};
    for (name, surface) in [("without collisions", Surface::avoid()), ("with collisions", bounce)] {{
        {search}
        println!("{{name}}: {{found}}");
    }}
    Ok(())
}}
"#,
        time_step = task.time_step,
        max_steps = task.max_steps(),
        restitution = task.restitution,
        spread = match task.spread {
            0.0 => String::new(),
            spread => format!(".with_spread({spread:?})"),
        },
        search = search(task).join("\n        "),
    )
}

/// The lines that search the shortest plan of a scene with a surface.
fn search(task: &SceneTask) -> Vec<String> {
    if task.is_robust() {
        return vec![
            "let scene = scene(surface)?;".into(),
            "let feedback = Feedback::regulator(&scene.hybrid_system()?)?;".into(),
            "let solver = &mut BranchAndBound::default();".into(),
            "let found = scene.shortest_robust(&feedback, &options, solver)?;".into(),
        ];
    }
    let (Some(mission), Some(body)) = (&task.mission, task.bodies.first()) else {
        return vec![
            "let found = scene(surface)?.shortest_with(&options, &mut BranchAndBound::default())?;"
                .into(),
        ];
    };
    let mut lines = vec![
        "let scene = scene(surface)?;".into(),
        format!("let body = scene.body_named({:?})?;", body.name),
        "let [x, y] = [body.position(0), body.position(1)];".into(),
        "let places = [".into(),
    ];
    for Place { name, sides: [[left, right], [low, high]] } in &task.places {
        let place = format!("[x.within({left:?}, {right:?}), y.within({low:?}, {high:?})]");
        lines.push(format!("    Mission::holds({:?}, {place}), // m", format!("in {name}")));
    }
    lines.extend([
        "];".into(),
        format!("let mission = Mission::parse({mission:?}, places)?;"),
        "let options = options.clone().with_mission(\"mission\", &mission);".into(),
        "let found = scene.shortest_with(&options, &mut BranchAndBound::default())?;".into(),
    ]);
    lines
}

fn of_body(number: usize, body: &BodyTask, is_used: bool) -> Vec<String> {
    let BodyTask { name, max_speed, max_acceleration, .. } = body;
    let [x, y, vx, vy] = body.start;
    let mut calls = vec![format!(".with_mass({:?}) // kg", body.mass)];
    match body.half {
        Some([w, h]) => calls.push(format!(".with_shape(Shape::Box(vec![{w:?}, {h:?}])) // m")),
        None if body.radius > 0.0 => {
            calls.push(format!(".with_shape(Shape::Ball({:?})) // m", body.radius));
        }
        None => {}
    }
    calls.push(format!(".with_start([{x:?}, {y:?}, {vx:?}, {vy:?}])"));
    if body.is_round {
        calls.push(format!(".with_speed_ball({max_speed:?}) // m/s"));
        calls.push(format!(".with_acceleration_ball({max_acceleration:?}) // m/s²"));
    }
    if body.gusts > 0.0 {
        let gusts = format!("{0:?}..={1:?}", -body.gusts, body.gusts);
        calls.push(format!(".with_pushes([{gusts}, {gusts}]) // m/s"));
    }
    calls.extend(body.goal_ranges().map(|goal| match body.goal {
        Some(goal) if body.goal_half == [0.0; 4] => format!(".with_goal({goal:?})"),
        _ => {
            let ends = goal.iter().map(|end| format!("{:?}..={:?}", end.lower, end.upper));
            format!(".with_goal(Region::from([{}]))", ends.collect::<Vec<_>>().join(", "))
        }
    }));
    if let Some(last) = calls.last_mut() {
        last.push(';');
    }
    let stated = format!(
        "let body = Body::new({name:?}, &room, {max_speed:?}, {max_acceleration:?}) // m/s, m/s²"
    );
    let declared = match is_used {
        true => format!("let body_{number} = scene.body(body)?;"),
        false => "scene.body(body)?;".into(),
    };
    let calls = calls.into_iter().map(|call| format!("    {call}"));
    [stated].into_iter().chain(calls).chain([declared]).collect()
}
