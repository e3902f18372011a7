//! Surfaces that move, and motion that is not free: against closed forms.

use carom::hybrid::scene::{Body, Scene, ScenePlan, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;

fn bounce(e: f64) -> Surface {
    Surface::bounce(Restitution::new(e).unwrap())
}

fn solved(scene: &Scene, steps: usize) -> ScenePlan {
    let mut program = scene.program(steps).unwrap();
    let hits = program.hits();
    program.minimize(hits).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    program.plan(&solution).unwrap()
}

#[test]
fn a_paddle_throws_a_ball() {
    // A body at rest, hit by a wall at 1.5 m/s, leaves with (1 + e) times that.
    for (e, estimate) in [(0.0, ImpactEstimate::Sound), (0.6, ImpactEstimate::EndOfStep)] {
        let body = Body::new("p", [Interval::new(0.0, 4.0)], 4.0, 0.0)
            .with_mass(2.0)
            .with_start(Region::point([0.4, 0.0]));
        let paddle = Solid::halfspace("paddle", [1.0], 0.0, bounce(e));
        let course = (0..=8).map(|t| [0.15 * f64::from(t)]);
        let scene = Scene::new(0.1)
            .with_body(body)
            .with_obstacle(paddle.with_course(course))
            .with_estimate(estimate);
        let plan = solved(&scene, 4);
        assert_eq!(plan.hits.len(), 1);
        let hit = &plan.hits[0];
        let leaves = plan.bodies[0].velocity[4][0];
        assert!((leaves - 1.5 * (1.0 + e)).abs() < 1e-6 && (hit.damage - 1.5).abs() < 1e-6);
        assert!((hit.impulse[0] - 2.0 * 1.5 * (1.0 + e)).abs() < 1e-5);
        // Located where the paddle is then: 0.4 m at 0.4/1.5 s.
        assert!((hit.time - 0.4 / 1.5).abs() < 1e-6 && (hit.speed - 1.5).abs() < 1e-6);
        assert!(plan.certificate.energy_gain < 1e-6);
    }
}

#[test]
fn a_box_that_drives_past_is_hit_at_its_front_only() {
    // A box comes from the right at 1 m/s; a body at rest can only be hit by its left face.
    let room = [Interval::new(-2.0, 2.0); 2];
    let body = Body::new("p", room, 3.0, 0.0).with_start(Region::point([0.0, 0.0, 0.0, 0.0]));
    let sides = [Interval::new(0.35, 0.75), Interval::new(-0.3, 0.3)];
    let block = Solid::cuboid("block", sides, bounce(1.0));
    let course = (0..=6).map(|t| [-0.1 * f64::from(t), 0.0]);
    let scene = Scene::new(0.1).with_body(body).with_obstacle(block.with_course(course));
    let plan = solved(&scene, 6);
    assert_eq!((plan.hits.len(), plan.hits[0].face), (1, 0));
    let v = plan.bodies[0].velocity.last().unwrap();
    assert!((v[0] + 2.0).abs() < 1e-6 && v[1].abs() < 1e-9);
}

#[test]
fn drag_and_a_spring_follow_their_closed_forms() {
    // dv/dt = -2 v, and a swing with 3 rad/s, in one body with two axes.
    let room = [Interval::new(-3.0, 3.0); 2];
    let body = Body::new("p", room, 9.0, 0.0)
        .with_dynamics([[0.0, 0.0], [0.0, -9.0]], [[-2.0, 0.0], [0.0, 0.0]])
        .with_start(Region::point([0.0, 1.0, 2.0, 0.0]));
    // Far away; and one with long steps, as the series of the motion must be.
    let wall = Solid::halfspace("wall", [1.0, 0.0], -2.0, bounce(0.5));
    for (time_step, steps) in [(0.1, 10), (1.0, 3)] {
        let scene = Scene::new(time_step)
            .with_body(body.clone())
            .with_obstacle(wall.clone())
            .with_estimate(ImpactEstimate::EndOfStep);
        let plan = solved(&scene, steps);
        for (k, x) in plan.bodies[0].position.iter().enumerate() {
            let t = k as f64 * time_step;
            assert!((x[0] - (1.0 - (-2.0 * t).exp())).abs() < 1e-6);
            assert!((x[1] - (3.0 * t).cos()).abs() < 1e-6);
        }
    }
}

#[test]
fn stiff_springs_and_long_steps_replay() {
    // 20 rad/s in steps of half a second: the replay's own integration keeps up.
    let body = Body::new("p", [Interval::new(-1.0, 1.0)], 30.0, 1.0)
        .with_dynamics([[-400.0]], [[-3.0]])
        .with_start(Region::point([0.5, 0.0]));
    let wall = Solid::halfspace("wall", [1.0], -0.9, bounce(0.5));
    let scene = Scene::new(0.5)
        .with_body(body)
        .with_obstacle(wall)
        .with_estimate(ImpactEstimate::EndOfStep);
    let plan = solved(&scene, 3);
    assert!(plan.certificate.largest_residual < 1e-6);
}
