//! Programs that sets have tightened have the optimum of those that they have not.

use carom::hybrid::scene::{Body, Scene, Shape, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;

use super::seeded_numbers::Numbers;

fn bounce(e: f64) -> Surface {
    Surface::bounce(Restitution::new(e).unwrap())
}

/// A puck in a room, with a pillar or without.
fn random(numbers: &mut Numbers) -> Scene {
    let room = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.5)];
    let mut place = || {
        let x = numbers.within(0.1, 0.5);
        vec![x, numbers.within(0.1, 1.4)]
    };
    let (from, to) = (place(), place());
    let speed = [numbers.within(-2.0, 2.0), numbers.within(-2.0, 2.0)];
    let body = Body::new("p", room, 3.0, 3.0)
        .with_start(Region::point([from[0], from[1], speed[0], speed[1]]))
        .with_goal(Region::point([to[0] + 0.8, to[1], 0.0, 0.0]));
    let scene = Scene::new(0.2)
        .with_body(body)
        .with_room("side", room, bounce(numbers.within(0.2, 1.0)))
        .with_corners(numbers.within(0.0, 1.0) < 0.5);
    let scene = match numbers.within(0.0, 1.0) < 0.5 {
        true => scene.with_estimate(ImpactEstimate::EndOfStep),
        false => scene,
    };
    let pillar = [Interval::new(0.6, 0.75), Interval::new(0.3, 1.1)];
    match numbers.within(0.0, 3.0) as usize {
        0 => scene,
        1 => scene.with_obstacle(Solid::cuboid("pillar", pillar, Surface::avoid())),
        _ => scene.with_obstacle(Solid::cuboid("pillar", pillar, bounce(0.6))),
    }
}

/// Whether there is a plan, with sets and without.
fn has_same_optimum(scene: &Scene, steps: usize) -> bool {
    let mut found = Vec::new();
    for mut program in [scene.program(steps).unwrap(), scene.plain_program(steps).unwrap()] {
        let effort = program.effort().unwrap();
        program.minimize(effort).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        if solution.point().is_some() {
            program.plan(&solution).unwrap();
        }
        found.push((solution.termination(), solution.objective()));
    }
    match (found[0], found[1]) {
        ((_, Some(a)), (_, Some(b))) => {
            assert!((a - b).abs() <= 1e-4 * (1.0 + b.abs()), "{a} and {b}");
            true
        }
        (a, b) => {
            assert_eq!(a, (Termination::Infeasible, None), "{a:?} and {b:?}");
            assert_eq!(a, b);
            false
        }
    }
}

#[test]
fn no_plan_is_lost() {
    let mut numbers = Numbers(17);
    let (mut feasible, mut refuted) = (0, 0);
    for _ in 0..12 {
        let scene = random(&mut numbers);
        let steps = 5 + (numbers.within(0.0, 3.0) as usize);
        match has_same_optimum(&scene, steps) {
            true => feasible += 1,
            false => refuted += 1,
        }
    }
    assert!(feasible > 2 && refuted > 2, "{feasible} feasible, {refuted} refuted");
}

#[test]
fn a_refuted_program_says_so_at_once() {
    let lane = [Interval::new(0.0, 9.0)];
    let body = Body::new("p", lane, 4.0, 1.0)
        .with_start(Region::point([1.0, 0.0]))
        .with_goal(Region::point([8.0, 0.0]));
    let scene = Scene::new(0.1).with_body(body).with_room("end", lane, bounce(0.5));
    let program = scene.program(30).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert_eq!(solution.termination(), Termination::Infeasible);
    assert_eq!(solution.statistics().relaxations, 0);
    assert!(scene.reach_sets().unwrap().explain(30).unwrap().is_some());
}

#[test]
fn axes_that_are_independent_are_solved_one_after_the_other() {
    // No row about all hits links the axes of a puck.
    let table = [Interval::new(0.0, 6.0), Interval::new(0.0, 4.0)];
    let puck = Body::new("puck", table, 3.0, 0.8)
        .with_start(Region::point([1.0, 3.0, -1.2, 0.6]))
        .with_goal(Region::point([5.0, 1.0, 0.0, 0.0]));
    let scene = Scene::new(0.33)
        .with_body(puck)
        .with_room("c", table, bounce(0.7))
        .with_estimate(ImpactEstimate::EndOfStep)
        .with_corners(true);
    let mut found = Vec::new();
    for mut program in [scene.program(15).unwrap(), scene.plain_program(15).unwrap()] {
        let effort = program.effort().unwrap();
        program.minimize(effort).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        assert_eq!(solution.statistics().blocks, 2);
        found.push((solution.objective().unwrap(), solution.statistics().nodes));
    }
    assert!((found[0].0 - found[1].0).abs() < 1e-5 && found[0].1 < found[1].1, "{found:?}");
}

#[test]
fn a_pillar_to_bounce_off_is_followed_by_the_sets_of_a_room() {
    // Four walls and a pillar exclude each other, so that every horizon is refuted by sets.
    let room = [Interval::new(0.0, 4.0), Interval::new(0.0, 3.0)];
    let pillar = [Interval::new(1.7, 2.3), Interval::new(0.9, 2.2)];
    let steps = |surface: Surface| {
        let robot = Body::new("robot", room, 0.5, 0.15)
            .with_start(Region::point([0.8, 1.5, 0.4, 0.3]))
            .with_goal(Region::point([0.8, 2.6, 0.0, 0.0]));
        let scene = Scene::new(0.5)
            .with_body(robot)
            .with_room("wall", room, surface)
            .with_obstacle(Solid::cuboid("pillar", pillar, surface));
        let found = scene.shortest(&mut BranchAndBound::default()).unwrap();
        let solves = found.attempts.iter().filter(|a| a.is_solve()).count();
        assert!(solves <= 3, "{solves}");
        let plan = found.plan.unwrap();
        let hits: Vec<String> = plan.hits.iter().map(|hit| hit.contact.clone()).collect();
        (plan.steps(), hits)
    };
    let (avoid, bouncing) = (steps(Surface::avoid()), steps(bounce(0.6)));
    assert!(avoid.1.is_empty() && bouncing.0 < avoid.0);
    assert_eq!(bouncing.1, ["robot at pillar"]);
}

/// A quadrotor among three boxes, none of which it may touch.
fn quadrotor() -> Scene {
    let room = [Interval::new(0.0, 6.0), Interval::new(0.0, 4.0)];
    let quadrotor = Body::new("quadrotor", room, 1.2, 2.0)
        .with_start(Region::point([0.4, 0.5, 1.2, 0.0]))
        .with_goal(Region::point([5.5, 3.5, 0.0, 0.0]));
    let boxes = [[1.2, 1.9, 0.0, 2.2], [2.8, 3.4, 1.4, 4.0], [4.3, 4.9, 0.6, 2.6]];
    boxes.iter().enumerate().fold(Scene::new(0.2).with_body(quadrotor), |scene, (k, sides)| {
        let sides = [Interval::new(sides[0], sides[1]), Interval::new(sides[2], sides[3])];
        scene.with_obstacle(Solid::cuboid(format!("box {k}"), sides, Surface::avoid()))
    })
}

/// Without sets, a step less than the shortest takes thousands of nodes.
#[test]
fn programs_in_which_all_is_avoided_know_what_sets_say() {
    let scene = quadrotor();
    let (too_few, enough) = (scene.program(28).unwrap(), scene.program(29).unwrap());
    let mut solver = BranchAndBound::default();
    solver.options_mut().node_limit = Some(100);
    let solution = solver.solve(too_few.model()).unwrap();
    assert_eq!(solution.termination(), Termination::Infeasible);
    assert!(solution.statistics().nodes <= 20, "{}", solution.statistics().nodes);
    let solution = solver.solve(enough.model()).unwrap();
    enough.plan(&solution).unwrap();
    // Sets fix binaries of faces that lie behind.
    let open = |model: &Model| model.variables().filter(|v| v.bounds().width() > 0.0).count();
    let plain = scene.plain_program(29).unwrap();
    assert!(open(enough.model()) + 100 < open(plain.model()));
}

/// A drone or two that avoid slanted faces and each other.
fn random_avoiding(numbers: &mut Numbers) -> Scene {
    let room = [Interval::new(0.0, 3.0), Interval::new(0.0, 2.0)];
    let slanted = numbers.within(0.0, 1.0) < 0.6;
    let pair = !slanted || numbers.within(0.0, 1.0) < 0.4;
    let mut place = |low: f64| vec![numbers.within(low, low + 0.4), numbers.within(0.2, 1.8)];
    let [from, to] = [[place(0.1), vec![0.0, 0.0]].concat(), [place(2.5), vec![0.0, 0.0]].concat()];
    let drone = |name: &str, from: &[f64], to: &[f64]| {
        Body::new(name, room, 1.5 + 0.5 * from[1], 2.0)
            .with_shape(Shape::Ball(0.08))
            .with_start(Region::point(from))
            .with_goal(Region::point(to))
    };
    let mut scene = Scene::new(0.25).with_body(drone("a", &from, &to));
    if pair {
        let (a, b) = (scene.body_named("a").unwrap(), scene.body(drone("b", &to, &from)).unwrap());
        scene.pair(a, b, Surface::avoid()).unwrap();
    }
    let (x, y) = (numbers.within(1.2, 1.8), numbers.within(0.5, 1.5));
    let mut faces = |count: usize| {
        let turn = numbers.within(0.1, 1.0);
        (0..count).map(move |k| {
            let angle = turn + std::f64::consts::TAU * k as f64 / count as f64;
            let normal = [angle.cos(), angle.sin()];
            (normal, normal[0] * x + normal[1] * y + 0.3)
        })
    };
    match slanted {
        true => scene.with_obstacle(Solid::polytope("pillar", faces(5), Surface::avoid())),
        false => {
            let sides = [Interval::new(x - 0.2, x + 0.2), Interval::new(y - 0.3, y + 0.3)];
            scene.with_obstacle(Solid::cuboid("pillar", sides, Surface::avoid()))
        }
    }
}

#[test]
fn no_plan_is_lost_where_all_is_avoided() {
    let mut numbers = Numbers(5);
    let (mut feasible, mut refuted) = (0, 0);
    for _ in 0..14 {
        let scene = random_avoiding(&mut numbers);
        let steps = 6 + (numbers.within(0.0, 5.0) as usize);
        match has_same_optimum(&scene, steps) {
            true => feasible += 1,
            false => refuted += 1,
        }
    }
    assert!(feasible > 2 && refuted > 2, "{feasible} feasible, {refuted} refuted");
}

/// Slanted faces couple axes, but what they leave to each axis, and how far one comes in time, do
/// not.
#[test]
fn slanted_faces_leave_sets_of_each_axis() {
    let room = [Interval::new(0.0, 6.0), Interval::new(0.0, 4.0)];
    let body = Body::new("p", room, 1.2, 2.0)
        .with_start(Region::point([0.4, 0.5, 1.2, 0.0]))
        .with_goal(Region::point([5.5, 3.5, 0.0, 0.0]));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let diamond = |x: f64, y: f64, size: f64| {
        [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[a, b]| {
            let normal = [a * half, b * half];
            (normal, normal[0] * x + normal[1] * y + size)
        })
    };
    let scene = [(1.5, 1.0, 0.7), (3.2, 2.8, 0.8), (4.6, 1.8, 0.6)].into_iter().enumerate().fold(
        Scene::new(0.2).with_body(body),
        |scene, (k, (x, y, size))| {
            let name = format!("diamond {k}");
            scene.with_obstacle(Solid::polytope(name, diamond(x, y, size), Surface::avoid()))
        },
    );
    // Too far for the time.
    let program = scene.program(20).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert_eq!(solution.termination(), Termination::Infeasible);
    assert_eq!(solution.statistics().relaxations, 0);
    let widths = |model: &Model| model.variables().map(|v| v.bounds().width()).sum::<f64>();
    let (program, plain) = (scene.program(26).unwrap(), scene.plain_program(26).unwrap());
    assert!(widths(program.model()) < 0.8 * widths(plain.model()));
}
