//! Scenes whose obstacles and rooms may be entered and left at a price.

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, SceneProgram, Shape, Solid, Surface};
use carom::hybrid::{ControlMove, HybridProgram, MoveSource, RecedingHorizon, Region};
use carom::interval::Interval;
use carom::prelude::*;

const PRICE: f64 = 1000.0;

fn wide(name: &str) -> Body {
    let domain = [Interval::new(-1.0, 5.0), Interval::new(-1.0, 3.0)];
    Body::new(name, domain, 2.0, 2.0).with_shape(Shape::Ball(0.1))
}

fn pillar() -> Solid {
    let sides = [Interval::new(1.5, 2.0), Interval::new(-1.2, 1.2)];
    Solid::cuboid("pillar", sides, Surface::avoid())
}

fn least(program: &mut SceneProgram, depth: Affine) -> (f64, f64) {
    let effort = program.effort().unwrap();
    program.minimize(effort + PRICE * depth.clone()).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    program.plan(&solution).unwrap();
    (solution.objective().unwrap(), solution.value(&depth).unwrap())
}

#[test]
fn what_can_be_avoided_is_avoided_as_if_it_had_to_be() {
    let body = wide("drone")
        .with_start(Region::point([0.5, 0.5, 0.0, 0.0]))
        .with_goal(Region::point([3.5, 0.5, 0.0, 0.0]));
    let scene = Scene::new(0.25).with_body(body);
    let mut soft = scene.program(18).unwrap();
    let depth = soft.soften_obstacle(&pillar()).unwrap();
    let (own, depth) = least(&mut soft, depth);
    assert!(depth < 1e-6, "{depth}");
    let mut hard = scene.with_obstacle(pillar()).program(18).unwrap();
    let (best, _) = least(&mut hard, Affine::zero());
    assert!((own - best).abs() < 1e-4 * best, "{own}, {best}");
}

#[test]
fn a_start_inside_costs_its_depth() {
    // 0.03 m behind the face, and 0.1 m of the body.
    let body = wide("drone").with_start(Region::point([1.53, 0.5, 0.0, 0.0]));
    let mut program = Scene::new(0.25).with_body(body).program(8).unwrap();
    let depth = program.soften_obstacle(&pillar()).unwrap();
    let (_, depth) = least(&mut program, depth);
    // It is inside at the start of the first step and out again at its end if it can be.
    assert!((0.13..0.4).contains(&depth), "{depth}");
}

/// A controller that holds a place in a room.
fn holds(scene: &Scene) -> Result<HybridProgram, Error> {
    let mut program = scene.program(8)?;
    let room = [Interval::new(0.0, 4.0), Interval::new(0.0, 2.0)];
    let outside = program.soften_room("room", room)? + program.soften_obstacle(&pillar())?;
    let mut program = HybridProgram::from(program);
    let system = program.system();
    let [x, y] = [system.state_named("drone x")?, system.state_named("drone y")?];
    let [vx, vy] = [system.state_named("drone vx")?, system.state_named("drone vy")?];
    let [ax, ay] = [system.input_named("drone ax")?, system.input_named("drone ay")?];
    let miss = (x - 0.3).square() + (y - 1.0).square();
    let speed = 0.1 * (vx.square() + vy.square());
    let cost = program.sum(miss + speed + 0.1 * (ax.square() + ay.square()))?;
    program.minimize(cost + PRICE * outside)?;
    Ok(program)
}

#[test]
fn a_state_just_outside_a_room_recovers() {
    let scene = Scene::new(0.25).with_body(wide("drone"));
    let program = holds(&scene).unwrap();
    let mut solver = BranchAndBound::default();
    let system = program.system().clone();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let plant = |state: &[f64], next: &ControlMove| {
        let after = system.simulate(state, &[&next.input])?.last().to_vec();
        // A gust pushes it through the wall once.
        let gust = if next.step == 6 { 0.5 } else { 0.0 };
        Ok(vec![after[0] - gust, after[1], after[2] - gust, after[3]])
    };
    let run = controller.run(&[-0.05, 1.0, -0.4, 0.0], 16, plant).unwrap();
    assert_eq!(run.count(MoveSource::Optimal), 16, "{run}");
    assert!(run.states[7][0] < 0.0, "{:?}", run.states[7]);
    let is_inside = |state: &Vec<f64>| state[0] > 0.1 - 1e-4 && state[0] < 1.4 + 1e-4;
    assert!(run.states[4..7].iter().all(is_inside), "{:?}", run.states);
    assert!(run.states[12..].iter().all(is_inside), "{:?}", run.states);
}

#[test]
fn soft_obstacles_move_along_their_course() {
    let gate = |steps: usize| {
        let course = (0..=steps).map(|t| [0.0, if t < 6 { 0.0 } else { 2.6 }]);
        pillar().with_course(course)
    };
    let start = Region::point([0.5, 0.5, 0.0, 0.0]);
    let scene = Scene::new(0.25).with_body(wide("drone").with_start(start));
    // Once the gate is open there is nothing in the way.
    let reach = |from: usize| {
        let mut program = scene.program(6).unwrap();
        let depth = program.soften_obstacle(&gate(20).from_step(from)).unwrap();
        let end = program.program().variables().states()[0][6];
        program.minimize(PRICE * depth - end).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        solution.value(end).unwrap()
    };
    assert!(reach(0) < 1.4 + 1e-4 && reach(9) > 2.0, "{}, {}", reach(0), reach(9));
    let mut program = scene.program(6).unwrap();
    program.soften_obstacle(&gate(20)).unwrap();
    let mut solver = BranchAndBound::default();
    let error = RecedingHorizon::new(program, &mut solver).unwrap_err();
    assert!(error.to_string().contains("the course of `pillar`"), "{error}");
}

#[test]
fn bad_soft_obstacles_are_refused() {
    let scene = Scene::new(0.25).with_body(wide("drone"));
    let mut program = scene.clone().with_obstacle(pillar()).program(4).unwrap();
    let count = program.model().variables().count();
    let error = program.soften_obstacle(&pillar()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }), "{error}");
    let short = Solid::cuboid("other", [Interval::new(0.0, 1.0); 2], Surface::avoid());
    let error =
        program.soften_obstacle(&short.clone().with_course([[0.0, 0.0], [0.1, 0.0]])).unwrap_err();
    assert!(error.to_string().contains("other"), "{error}");
    let error = program
        .soften_obstacle(&Solid::halfspace("line", [1.0], 0.0, Surface::avoid()))
        .unwrap_err();
    assert!(error.to_string().contains("line"), "{error}");
    assert_eq!(program.model().variables().count(), count);
    program.soften_obstacle(&short).unwrap();
    let error = program.soften_obstacle(&short).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }), "{error}");
}
