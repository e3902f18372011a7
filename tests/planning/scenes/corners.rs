//! Hits at corners in space with friction, against a law that is written down here once more: each
//! surface sees the flight without hits, and what all of them do adds.

use std::f64::consts::TAU;

use carom::hybrid::scene::{Body, Scene, ScenePlan, Shape, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::model::Affine;
use carom::prelude::*;

use super::seeded_numbers::Numbers;

const TIME_STEP: f64 = 0.1;

/// A wall in numbers.
struct Wall {
    normal: Vec<f64>,
    offset: f64,
    restitution: f64,
    friction: f64,
    directions: usize,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: &[f64], b: &[f64]) -> Vec<f64> {
    let of = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    vec![of(1, 2), of(2, 0), of(0, 1)]
}

/// The directions of friction at a wall: the first one in the plane of the normal and the axis that
/// is least along it, the others turned about the normal.
fn directions(wall: &Wall) -> Vec<Vec<f64>> {
    let n = &wall.normal;
    let size = n.iter().map(|a| a.abs()).fold(f64::INFINITY, f64::min);
    let least = n.iter().position(|a| a.abs() == size).unwrap();
    let mut first: Vec<f64> = (0..3).map(|i| -n[least] * n[i]).collect();
    first[least] += 1.0;
    let length = dot(&first, &first).sqrt();
    let first: Vec<f64> = first.iter().map(|a| a / length).collect();
    let second = cross(n, &first);
    let turn = |k: usize| -> Vec<f64> {
        let (sin, cos) = (TAU * k as f64 / wall.directions as f64).sin_cos();
        (0..3).map(|i| cos * first[i] + sin * second[i]).collect()
    };
    (0..wall.directions).map(turn).collect()
}

/// Every change of velocity that a hit with the velocity `r` may make.
fn changes(wall: &Wall, r: &[f64]) -> Vec<Vec<f64>> {
    let n = &wall.normal;
    let f = -dot(n, r);
    let sliding: Vec<f64> = (0..3).map(|i| r[i] + f * n[i]).collect();
    let with = |along: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (0..3).map(|i| (1.0 + wall.restitution) * f * n[i] + along(i)).collect()
    };
    let inside = (std::f64::consts::PI / wall.directions as f64).cos();
    let most = wall.friction * inside * (1.0 + wall.restitution) * f;
    let ways = directions(wall);
    let shares: Vec<f64> = ways.iter().map(|d| dot(d, r)).collect();
    let largest = shares.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let slack = 3e-6;
    let mut all = Vec::new();
    let along = dot(&sliding, &sliding).sqrt();
    if along <= wall.friction * (1.0 + wall.restitution) * f + slack {
        all.push(with(&|i| -sliding[i]));
    }
    for (d, share) in ways.iter().zip(&shares) {
        if *share >= largest - slack && largest >= most - slack {
            all.push(with(&|i| -most * d[i]));
        }
    }
    all
}

/// Checks the steps of a plan; returns how many hit several walls.
fn check(plan: &ScenePlan, walls: &[Wall]) -> usize {
    let body = &plan.bodies[0];
    let mut corners = 0;
    for step in 0..plan.steps() {
        let (x, v, u) = (&body.position[step], &body.velocity[step], &body.acceleration[step]);
        let fly = |i: usize| x[i] + TIME_STEP * v[i] + 0.5 * TIME_STEP * TIME_STEP * u[i];
        let flown: Vec<f64> = (0..3).map(fly).collect();
        let r: Vec<f64> = (0..3).map(|i| v[i] + TIME_STEP * u[i]).collect();
        let own: Vec<&Wall> = plan
            .hits
            .iter()
            .filter(|hit| hit.step == step)
            .map(|hit| &walls[hit.contact.rsplit(' ').next().unwrap().parse::<usize>().unwrap()])
            .collect();
        corners += usize::from(own.len() > 1);
        let mut place = flown.clone();
        let mut reached = vec![r.clone()];
        for wall in own {
            let gap = dot(&wall.normal, &flown) - wall.offset;
            assert!(gap <= 1e-5 && dot(&wall.normal, &r) <= 1e-5);
            let lift = -(1.0 + wall.restitution) * gap;
            place.iter_mut().zip(&wall.normal).for_each(|(x, n)| *x += lift * n);
            let add = |v: &Vec<f64>, c: &Vec<f64>| -> Vec<f64> {
                v.iter().zip(c).map(|(v, c)| v + c).collect()
            };
            let changes = changes(wall, &r);
            reached = reached.iter().flat_map(|v| changes.iter().map(move |c| add(v, c))).collect();
        }
        let apart =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart(&place, &body.position[step + 1]) <= 1e-5);
        let nearest = reached.iter().map(|v| apart(v, &body.velocity[step + 1]));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest <= 1e-5, "step {step}: {nearest}");
    }
    corners
}

/// The kinetic energy of a step's end above that of the flight without hits, for 1 kg.
fn gained(plan: &ScenePlan, step: usize) -> f64 {
    let body = &plan.bodies[0];
    let (v, u) = (&body.velocity[step], &body.acceleration[step]);
    let flown: Vec<f64> = v.iter().zip(u).map(|(v, u)| v + TIME_STEP * u).collect();
    let end = &body.velocity[step + 1];
    0.5 * (dot(end, end) - dot(&flown, &flown))
}

/// Two or three walls that meet in the origin, some of them slanted.
fn walls(numbers: &mut Numbers) -> Vec<Wall> {
    let slanted = numbers.within(0.0, 1.0) < 0.4;
    let count = if numbers.within(0.0, 1.0) < 0.5 { 2 } else { 3 };
    let wall = |k: usize| {
        let mut normal: Vec<f64> = (0..3).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
        if slanted {
            normal.iter_mut().for_each(|n| *n += numbers.within(-0.2, 0.2));
        }
        let length = dot(&normal, &normal).sqrt();
        normal.iter_mut().for_each(|n| *n /= length);
        let friction = numbers.within(0.0, 1.2);
        let directions = 3 + numbers.within(0.0, 8.0) as usize;
        Wall { normal, offset: 0.0, restitution: numbers.within(0.0, 1.0), friction, directions }
    };
    (0..count).map(wall).collect()
}

#[test]
fn lawful_hits_at_corners_in_space_are_certified() {
    let mut numbers = Numbers(29);
    let (mut plans, mut corners) = (0, 0);
    for _ in 0..120 {
        let walls = walls(&mut numbers);
        let is_slanted = walls[0].normal[0] != 1.0;
        // Towards the corner. Multiples of 1/2 m/s are often between two directions of friction.
        let round = |x: f64| if is_slanted { x } else { (2.0 * x).round() / 2.0 };
        let start: Vec<f64> = (0..3).map(|_| numbers.within(0.02, 0.3)).collect();
        let speed: Vec<f64> = (0..3).map(|_| round(numbers.within(-4.0, 0.5))).collect();
        let range = vec![Interval::new(-2.0, 3.0); 3];
        let mut body = Body::new("b", range, 8.0, numbers.within(0.0, 6.0))
            .with_start(Region::point([start, speed].concat()));
        body.shape = Shape::Point;
        let estimate = match numbers.within(0.0, 1.0) < 0.5 {
            true => ImpactEstimate::Sound,
            false => ImpactEstimate::EndOfStep,
        };
        let scene = Scene::new(TIME_STEP).with_corners(true).with_estimate(estimate);
        let mut scene = scene.with_body(body);
        for (k, wall) in walls.iter().enumerate() {
            let surface = Surface::bounce(Restitution::new(wall.restitution).unwrap())
                .with_friction_along(wall.friction, wall.directions);
            let solid = Solid::halfspace(format!("wall {k}"), wall.normal.clone(), 0.0, surface);
            scene = scene.with_obstacle(solid);
        }
        let Ok(mut program) = scene.program(2) else { continue };
        let states = program.program().variables().states().to_vec();
        let wish: Affine = states.iter().map(|s| numbers.within(-1.0, 1.0) * s[2]).sum();
        let wish = wish - 5.0 * program.hits();
        program.minimize(wish).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        if solution.point().is_none() {
            continue;
        }
        plans += 1;
        let plan = program.plan(&solution).unwrap();
        corners += check(&plan, &walls);
        let gain = (0..plan.steps()).map(|step| gained(&plan, step)).fold(0.0, f64::max);
        assert!((plan.certificate.energy_gain - gain).abs() <= 1e-5);
    }
    assert!(plans > 80 && corners > 40, "{plans} plans, {corners} corners");
}
