//! Bodies that come to rest at a surface, in rows, sets, simulations and replays alike.

use super::seeded_numbers::Numbers;
use crate::rows::wall::transitions;
use carom::ErrorKind;
use carom::collision_tolerant::Wall;
use carom::hybrid::scene::{Body, Scene, SceneError, ScenePlan, Solid, Surface};
use carom::hybrid::{
    HybridSystem, ImpactEstimate, Region, Restitution, ShortestOptions, ShortestStatus,
};
use carom::interval::Interval;
use carom::model::Affine;
use carom::prelude::*;

fn bounce(e: f64) -> Surface {
    Surface::bounce(Restitution::new(e).unwrap())
}

/// A ball falls from 1 m, without input, and shall lie on the floor.
fn ball(surface: Surface, time_step: f64, goal: Region) -> Scene {
    let ball = Body::new("ball", [Interval::new(0.0, 2.0)], 10.0, 1.0)
        .with_acceleration([Interval::point(0.0)])
        .with_gravity([-9.81])
        .with_start(Region::point([1.0, 0.0]))
        .with_goal(goal);
    let floor = Solid::halfspace("floor", [1.0], 0.0, surface);
    Scene::new(time_step).with_body(ball).with_obstacle(floor)
}

fn shortest(scene: &Scene, options: &ShortestOptions) -> Option<ScenePlan> {
    scene.shortest_with(options, &mut BranchAndBound::default()).unwrap().plan
}

/// The law, written down once more: the positions and velocities that the ball may have by step.
/// Where a flight ends at the floor, it may hit or fly on.
fn fall(e: f64, time_step: f64, steps: usize) -> Vec<Vec<(f64, f64)>> {
    let mut all = vec![vec![(1.0, 0.0)]];
    for t in 0..steps {
        let mut next: Vec<(f64, f64)> = Vec::new();
        for &(x, v) in &all[t] {
            let p = x + time_step * v - 0.5 * 9.81 * time_step * time_step;
            if p < 1e-9 {
                next.push((0.0, e * f64::max(-v, 0.0)));
            }
            if p > -1e-9 {
                next.push((p, v - 9.81 * time_step));
            }
        }
        all.push(next);
    }
    all
}

#[test]
fn a_bouncing_ball_comes_to_rest() {
    let near = || Region::from([Interval::new(0.0, 0.05), Interval::new(-0.3, 0.3)]);
    let options = ShortestOptions::default();
    // Mirrored, what each step adds keeps it bouncing.
    let mirrored = ball(bounce(0.8), 0.05, near());
    let found = mirrored.shortest_with(&options, &mut BranchAndBound::default()).unwrap();
    assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 10_000 });
    for e in [0.0, 0.5, 0.8] {
        for (time_step, goal) in [(0.05, near()), (0.05, Region::point([0.0, 0.0]))] {
            let scene = ball(bounce(e).with_rest(), time_step, goal.clone());
            let plan = shortest(&scene, &options).unwrap();
            let law = fall(e, time_step, plan.steps() + 5);
            let reaches = |(x, v): &(f64, f64)| goal.contains(&[*x, *v], 1e-9).unwrap();
            let first = law.iter().position(|states| states.iter().any(reaches));
            assert_eq!(first, Some(plan.steps()), "e = {e}");
            for (t, states) in law.iter().enumerate().take(plan.steps() + 1) {
                let (place, speed) = (plan.bodies[0].position[t][0], plan.bodies[0].velocity[t][0]);
                let is_it =
                    |(x, v): &(f64, f64)| (place - x).abs() < 1e-6 && (speed - v).abs() < 1e-6;
                assert!(states.iter().any(is_it), "e = {e}, {t}");
            }
            let gain = plan.certificate.stepped_gain;
            // Hops of less than a step lose more than the law knows.
            assert!(gain < 2e-3, "e = {e}: {gain}");
            let without = options.clone().with_reach_sets(false).with_max_steps(plan.steps());
            assert_eq!(shortest(&scene, &without).map(|p| p.steps()), Some(plan.steps()));
        }
    }
    // It stays where it lies, and nothing hits any more.
    let scene = ball(bounce(0.8).with_rest(), 0.05, Region::point([0.0, 0.0]));
    let program = scene.program(70).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    let last = plan.hits.iter().map(|hit| hit.step).max();
    assert!(last < Some(60), "{last:?}");
    let replayed = scene.replay(&plan).unwrap();
    assert_eq!(replayed.certificate, plan.certificate);
}

#[test]
fn the_stepped_law_says_what_it_adds() {
    let near = Region::from([Interval::new(0.0, 0.05), Interval::new(-0.3, 0.3)]);
    let gain = |time_step: f64| {
        let plan =
            shortest(&ball(bounce(0.5), time_step, near.clone()), &ShortestOptions::default());
        let certificate = plan.unwrap().certificate;
        assert_eq!(certificate.time_step, time_step);
        certificate.stepped_gain
    };
    let (coarse, fine) = (gain(0.05), gain(0.01));
    // e (1 + e) m g h, where h is how far the flight ends behind the floor.
    assert!(coarse > 1.0 && fine < 0.5 * coarse, "{coarse}, {fine}");
}

#[test]
fn systems_come_to_rest_as_scenes_do() {
    let with_rest = |wall, e, time_step| {
        let names = ["flight", "impact", "settle", "rest"];
        transitions(wall, bounce(e).with_rest(), time_step, None, names)
    };
    let mut system = HybridSystem::new(0.05)
        .with_state("x", Interval::new(0.0, 2.0))
        .with_state("v", Interval::new(-10.0, 10.0))
        .with_input("a", Interval::point(-9.81));
    for transition in with_rest(Wall::default(), 0.8, 0.05) {
        system = system.with_transition(transition);
    }
    let (start, rest) = (Region::point([1.0, 0.0]), Region::point([0.0, 0.0]));
    let steps = |sets: bool| {
        let options = ShortestOptions::default().with_reach_sets(sets).with_max_steps(80);
        let mut solver = BranchAndBound::default();
        system.shortest_with(&start, &rest, &options, &mut solver).unwrap().steps
    };
    let law = fall(0.8, 0.05, 80);
    let expected = law.iter().position(|states| states.contains(&(0.0, 0.0)));
    assert_eq!((steps(true), steps(false)), (expected, expected));
    // A ceiling holds what is pushed against it.
    let [.., settle, held] = with_rest(Wall::below(0.0).unwrap(), 0.5, 0.1);
    assert!(settle.is_event && !held.is_event);
}

#[test]
fn what_rests_slides_until_friction_stops_it_and_hits_walls() {
    // A crate slides on the floor towards a wall. Resting is no hit, so that it may hit the wall in
    // the same step.
    let crate_ = Body::new("crate", [Interval::new(0.0, 4.0), Interval::new(0.0, 2.0)], 6.0, 0.0)
        .with_gravity([0.0, -10.0])
        .with_start(Region::point([0.45, 0.0, -2.0, 0.0]));
    let scene = Scene::new(0.1)
        .with_body(crate_)
        .with_obstacle(Solid::halfspace(
            "floor",
            [0.0, 1.0],
            0.0,
            bounce(0.3).with_friction(0.2).with_rest(),
        ))
        .with_obstacle(Solid::halfspace("wall", [1.0, 0.0], 0.0, bounce(0.5)));
    let mut program = scene.program(10).unwrap();
    let hits = program.hits();
    program.minimize(hits).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    let names: Vec<&str> = plan.hits.iter().map(|hit| &hit.contact[..]).collect();
    assert_eq!(names, ["crate at wall"]);
    let speeds: Vec<f64> = plan.bodies[0].velocity.iter().map(|v| v[0]).collect();
    // 0.2 m/s a step, as long as it slides; the wall sees the speed without friction.
    let hit = plan.hits[0].step;
    for t in 0..hit {
        assert!((speeds[t] - (-2.0 + 0.2 * t as f64)).abs() < 1e-6, "{speeds:?}");
    }
    assert!(speeds[10].abs() < 1e-6, "{speeds:?}");
    assert!(plan.bodies[0].position.iter().all(|x| x[1].abs() < 1e-6));
}

#[test]
fn it_leaves_as_soon_as_it_is_pulled_away() {
    let body = Body::new("b", [Interval::new(0.0, 2.0)], 5.0, 4.0)
        .with_gravity([-2.0])
        .with_start(Region::point([0.0, 0.0]))
        .with_goal(Region::point([0.5, 0.0]));
    let floor = Solid::halfspace("floor", [1.0], 0.0, bounce(0.5).with_rest());
    let scene = Scene::new(0.1).with_body(body).with_obstacle(floor);
    // 2 m/s² up and 6 m/s² down: the same as without a floor to rest at.
    let plan = shortest(&scene, &ShortestOptions::default()).unwrap();
    assert!(plan.hits.is_empty());
    assert_eq!(plan.steps(), 9);
}

#[test]
fn surfaces_at_which_nothing_can_rest() {
    let refused = |surface: Surface| {
        let error = ball(surface, 0.1, Region::point([0.0, 0.0])).program(2).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Scene(SceneError::Surface { .. })), "{error}");
        error.to_string()
    };
    assert!(refused(Surface::avoid().with_rest()).contains("nothing rests there"));
    let linear = bounce(0.5).with_linear_map(0.9, 0.0).with_rest();
    assert!(refused(linear).contains("drop `with_rest`"));
}

#[test]
fn random_plans_with_rest_are_lawful() {
    let mut numbers = Numbers(41);
    let (mut plans, mut rests) = (0, 0);
    for round in 0..45 {
        let axes = 1 + round % 3;
        let e = numbers.within(0.0, 1.0);
        let friction = if axes > 1 && round % 2 == 0 { numbers.within(0.0, 0.8) } else { 0.0 };
        let surface = match friction > 0.0 {
            true => bounce(e).with_friction_along(friction, 3).with_rest(),
            false => bounce(e).with_rest(),
        };
        let mut all =
            |low: f64, high: f64| (0..axes).map(|_| numbers.within(low, high)).collect::<Vec<_>>();
        let (mut place, mut speed, mut gravity) = (all(0.0, 0.2), all(-1.5, 1.5), all(-4.0, 4.0));
        let up = axes - 1;
        (speed[up], gravity[up]) = (-speed[up].abs(), -9.0);
        if round % 4 == 0 {
            (place[up], speed[up]) = (0.0, 0.0);
        }
        let body = Body::new("b", vec![Interval::new(-3.0, 3.0); axes], 8.0, 2.0)
            .with_gravity(gravity.clone())
            .with_start(Region::point([place, speed].concat()));
        let normal: Vec<f64> = (0..axes).map(|i| if i == up { 1.0 } else { 0.0 }).collect();
        let estimate =
            if round % 5 == 0 { ImpactEstimate::EndOfStep } else { ImpactEstimate::Sound };
        let scene = Scene::new(0.1)
            .with_body(body)
            .with_obstacle(Solid::halfspace("floor", normal, 0.0, surface))
            .with_estimate(estimate);
        let mut program = scene.program(4).unwrap();
        let states = program.program().variables().states().to_vec();
        let wish: Affine = states.iter().map(|s| numbers.within(-1.0, 1.0) * s[4]).sum();
        program.minimize(wish).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        if solution.point().is_none() {
            continue;
        }
        let plan = program.plan(&solution).unwrap();
        plans += 1;
        let path = &plan.bodies[0];
        for t in 0..plan.steps() {
            let (x, v) = (path.position[t][up], path.velocity[t][up]);
            let a = path.acceleration[t][up] + gravity[up];
            let (p, w) = (x + 0.1 * v + 0.005 * a, v + 0.1 * a);
            let (next, after) = (path.position[t + 1][up], path.velocity[t + 1][up]);
            let is_near = |x: f64, v: f64| (next - x).abs() < 1e-5 && (after - v).abs() < 1e-5;
            let touches = p <= 1e-5 && is_near(0.0, e * (-v).max(0.0));
            assert!(touches || p >= -1e-5 && is_near(p, w), "round {round}, step {t}");
            let hit = plan.hits.iter().any(|hit| hit.step == t);
            rests += usize::from(!hit && p < -1e-3);
            // The tangential impulse is within the cone of the normal one.
            let slides = (0..up).map(|i| {
                let free = path.velocity[t][i] + 0.1 * (path.acceleration[t][i] + gravity[i]);
                (path.velocity[t + 1][i] - free).powi(2)
            });
            let impulse = after - w;
            assert!(slides.sum::<f64>().sqrt() <= friction * impulse.max(0.0) + 1e-5);
        }
    }
    assert!(plans > 30 && rests > 15, "{plans} plans, {rests} steps at rest");
}

#[test]
fn claims_name_the_stepped_law_and_its_time_step() {
    let near = Region::from([Interval::new(0.0, 0.05), Interval::new(-0.3, 0.3)]);
    let options = ShortestOptions::default().with_max_steps(200);
    let mut solver = BranchAndBound::default();
    let refuted = ball(bounce(0.8), 0.05, near.clone());
    let refuted = refuted.shortest_with(&options, &mut solver).unwrap();
    assert_eq!(
        refuted.status.to_string(),
        "no feasible horizon up to 200 steps of the time-stepped law"
    );
    assert_eq!(
        refuted.to_string(),
        "no plan of up to 200 steps, 10 s, under the time-stepped law with Δt = 0.05 s; longer \
         ones were not looked for"
    );
    let scene = ball(bounce(0.8).with_rest(), 0.05, near);
    let found = scene.shortest_with(&options, &mut solver).unwrap();
    assert_eq!(
        found.to_string(),
        "52 steps at least, 2.6 s: fewer are refuted for the time-stepped law with Δt = 0.05 s"
    );
    let plan = found.plan.unwrap();
    assert_eq!((plan.certificate.time_step, found.time_step), (0.05, Some(0.05)));
    let words = plan.certificate.to_string();
    assert!(words.contains("the time-stepped law with Δt = 0.05 s"), "{words}");
    // One call from the plan: half the step, and the least step for as many steps.
    let both = plan.compare_half_steps(&scene, &options, &mut solver).unwrap();
    let halved = both.halved.plan.as_ref().unwrap();
    assert_eq!((halved.time_step, halved.steps()), (0.025, 113));
    assert!(both.to_string().contains("\nΔt = 0.025 s: 113 steps, 2.825000 s, "), "{both}");
    let grid = [0.03, 0.04, 0.05, 0.06];
    let least = plan.least_time_step(&scene, grid, &options, &mut solver).unwrap();
    let shortest: Vec<f64> = grid
        .into_iter()
        .filter(|&time_step| {
            let law = fall(0.8, time_step, 52);
            law[52].iter().any(|(x, v)| *x <= 0.05 + 1e-9 && v.abs() <= 0.3 + 1e-9)
        })
        .collect();
    assert_eq!(least.time_step, shortest.first().copied());
    assert!(least.is_proved && least.run.unwrap().time_step == least.time_step.unwrap());
    let empty = plan.least_time_step(&scene, [], &options, &mut solver).unwrap_err();
    assert!(matches!(empty.kind(), ErrorKind::OutOfRange { .. }), "{empty}");
}

#[test]
fn half_steps_keep_what_moves_where_it_was() {
    let door = Solid::halfspace("door", [1.0], -1.0, bounce(0.5));
    let body = Body::new("b", [Interval::new(-1.0, 2.0)], 3.0, 3.0)
        .with_start(Region::point([1.0, 0.0]))
        .with_goal(Region::point([0.5, 0.0]));
    let course = (0..20).map(|t| [0.02 * f64::from(t)]);
    let scene = Scene::new(0.1).with_body(body).with_obstacle(door.with_course(course));
    let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    let plan = scene.shortest_with(&options, &mut solver).unwrap().plan.unwrap();
    let both = plan.compare_half_steps(&scene, &options, &mut solver).unwrap();
    let halved = both.halved.plan.unwrap();
    assert!(halved.steps() <= 2 * plan.steps(), "{} {}", halved.steps(), plan.steps());
    let moved = plan.least_time_step(&scene, [0.1], &options, &mut solver).unwrap_err();
    assert!(moved.to_string().contains("`door`"), "{moved}");
}
