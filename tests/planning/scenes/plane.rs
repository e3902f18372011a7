//! Plans in the plane.

use carom::hybrid::scene::{
    Body, DamageMeasure, DamageRule, Scene, ScenePlan, Shape, Solid, Surface,
};
use carom::hybrid::{ImpactEstimate, Region, Restitution, ShortestOptions};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;

fn bounce(e: f64) -> Surface {
    Surface::bounce(Restitution::new(e).unwrap())
}

fn shortest(scene: &Scene) -> Option<ScenePlan> {
    let options = ShortestOptions::default().with_max_steps(80);
    let found = scene.shortest_with(&options, &mut BranchAndBound::default()).unwrap();
    found.plan
}

fn table(surface: Surface) -> Scene {
    let sides = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)];
    let puck = Body::new("puck", sides, 3.0, 3.0)
        .with_start(Region::point([1.2, 0.3, 2.0, 1.5]))
        .with_goal(Region::point([0.4, 0.3, 0.0, 0.0]));
    Scene::new(0.05).with_body(puck).with_room("cushion", sides, surface)
}

#[test]
fn a_cushion_makes_a_puck_sooner() {
    let (avoiding, bouncing) = (shortest(&table(Surface::avoid())), shortest(&table(bounce(0.9))));
    let (avoiding, bouncing) = (avoiding.unwrap(), bouncing.unwrap());
    assert!(avoiding.hits.is_empty());
    assert!(bouncing.steps() + 10 < avoiding.steps());
    let hit = &bouncing.hits[0];
    assert!(hit.damage >= hit.speed - 1e-6 && hit.energy > 0.0);
    assert!(bouncing.certificate.largest_residual < 1e-6);
}

#[test]
fn friction_stays_in_its_cone() {
    // Thrown along the floor, which it must hit: it ends as slow as friction allows.
    let sides = [Interval::new(0.0, 4.0), Interval::new(0.0, 2.0)];
    let mut last = f64::INFINITY;
    for coefficient in [0.0, 0.1, 0.3, 2.0] {
        let floor = bounce(0.5).with_friction(coefficient);
        let ball = Body::new("ball", sides, 8.0, 0.0)
            .with_gravity([0.0, -9.81])
            .with_start(Region::point([0.2, 0.5, 2.0, 0.0]));
        let floor = Solid::halfspace("floor", [0.0, 1.0], 0.0, floor);
        let scene = Scene::new(0.05).with_body(ball).with_obstacle(floor);
        let mut program = scene.program(8).unwrap();
        let speed = program.program().variables().state("ball vx").unwrap()[8];
        program.minimize(speed).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        let plan = program.plan(&solution).unwrap();
        assert_eq!(plan.hits.len(), 1);
        assert!(plan.certificate.cone_excess < 1e-6 && plan.certificate.energy_gain < 1e-6);
        let speed = plan.bodies[0].velocity[8][0];
        // The impulse is μ (1 + e) f, or what stops the ball.
        let expected = (2.0 - coefficient * 1.5 * plan.hits[0].end_speed).max(0.0);
        assert!((speed - expected).abs() < 1e-6 && speed < last);
        last = speed;
    }
}

#[test]
fn a_disc_goes_around_a_pillar_without_cutting_its_corners() {
    let room = [Interval::new(0.0, 4.0), Interval::new(0.0, 3.0)];
    let pillar = [Interval::new(1.6, 2.2), Interval::new(0.8, 2.0)];
    let drone = Body::new("drone", room, 2.0, 2.0)
        .with_shape(Shape::Ball(0.1))
        .with_start(Region::point([0.5, 1.4, 0.0, 0.0]))
        .with_goal(Region::point([3.5, 1.4, 0.0, 0.0]));
    let scene = Scene::new(0.25).with_body(drone).with_obstacle(Solid::cuboid(
        "pillar",
        pillar,
        Surface::avoid(),
    ));
    let plan = shortest(&scene).unwrap();
    assert!(plan.certificate.dip < 1e-5);
    // Only the ends of the steps: sooner, through the corners.
    let coarse = shortest(&scene.clone().with_estimate(ImpactEstimate::EndOfStep)).unwrap();
    assert!(coarse.certificate.dip > 1e-3 && coarse.steps() <= plan.steps());
    // A bouncy pillar is no worse than one that must be avoided.
    let pillar = Solid::cuboid("pillar", pillar, bounce(0.5));
    let mut bouncy = scene;
    bouncy.obstacles = vec![pillar];
    assert!(shortest(&bouncy).unwrap().steps() <= plan.steps());
}

#[test]
fn two_discs_exchange_momentum() {
    let lane = [Interval::new(0.0, 3.0), Interval::new(0.0, 1.0)];
    // The left one starts fast and the right one at rest; both cannot push.
    let body = |name: &str, mass| {
        Body::new(name, lane, 3.0, 0.0).with_mass(mass).with_shape(Shape::Ball(0.1))
    };
    let mut scene = Scene::new(0.125);
    let a = scene.body(body("a", 1.0).with_start([0.5, 0.5, 1.0, 0.0])).unwrap();
    let b = scene.body(body("b", 1.0).with_start([1.5, 0.5, 0.0, 0.0])).unwrap();
    scene.pair(a, b, bounce(1.0)).unwrap();
    let mut program = scene.program(16).unwrap();
    let hits = program.hits();
    program.minimize(hits).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    assert_eq!(plan.hits.len(), 1);
    let end = |name| plan.body(name).unwrap().velocity.last().unwrap().clone();
    assert!((end("b")[0] - 1.0).abs() < 1e-6 && end("a")[0].abs() < 1e-6);
    assert!(plan.certificate.momentum_error < 1e-6);
}

/// A carrier at rest, and a cart in its way to a goal at 3 m.
fn carrier_and_cart(count: Option<usize>) -> Scene {
    let lane = [Interval::new(0.0, 6.0), Interval::new(0.0, 1.0)];
    let body = |name: &str, mass, half: [f64; 2]| {
        Body::new(name, lane, 3.0, 1.0).with_mass(mass).with_shape(Shape::Box(half.to_vec()))
    };
    let carrier = body("carrier", 2.0, [0.3, 0.2])
        .with_start([0.5, 0.5, 0.0, 0.0])
        .with_goal([3.0, 0.5, 0.0, 0.0]);
    let mut scene = Scene::new(0.25);
    let carrier = scene.body(carrier).unwrap();
    let cart = body("cart", 1.0, [0.2, 0.2]).with_start([2.2, 0.5, 0.0, 0.0]);
    let cart = scene.body(cart).unwrap();
    scene.pair(carrier, cart, bounce(0.8)).unwrap();
    let rule = DamageRule::new("bumper", DamageMeasure::NormalImpulse).with_per_hit(4.0);
    scene.with_rule(count.into_iter().fold(rule, DamageRule::with_count))
}

#[test]
fn sets_know_how_many_hits_of_two_bodies_are_allowed() {
    let options = ShortestOptions::default().with_max_steps(40);
    let known = |count| {
        let found = carrier_and_cart(count)
            .shortest_with(&options, &mut BranchAndBound::default())
            .unwrap();
        // Without sets and without an eye on the number of hits, it takes some hundred nodes.
        assert!(found.nodes() <= 120, "{} nodes", found.nodes());
        assert_eq!((found.steps, found.refuted_steps), (Some(11), Some(10)));
        *found.sets.unwrap().system().parts().most_events
    };
    assert_eq!(known(None), None);
    assert_eq!(known(Some(1)), Some(1));
}
