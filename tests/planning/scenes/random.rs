//! Random scenes, replayed by laws that are written down here once more: flights, hits, impulses.

use carom::hybrid::scene::{Body, BodyPath, Scene, ScenePlan, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::model::Affine;
use carom::prelude::*;

use super::seeded_numbers::Numbers;

const TIME_STEP: f64 = 0.1;
const STEPS: usize = 3;

/// What two things do to each other, in numbers.
struct Meeting {
    name: String,
    bodies: Vec<usize>,
    /// Unit normals and offsets, shapes included.
    faces: Vec<(Vec<f64>, f64)>,
    restitution: f64,
    /// The velocity of the obstacle, in m/s.
    moves: Vec<f64>,
}

struct Random {
    scene: Scene,
    meetings: Vec<Meeting>,
    masses: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(axes: usize, axis: usize, sign: f64) -> Vec<f64> {
    (0..axes).map(|i| if i == axis { sign } else { 0.0 }).collect()
}

/// A box around a place, and in the plane also a polygon.
fn solid(numbers: &mut Numbers, axes: usize) -> Vec<(Vec<f64>, f64)> {
    let place: Vec<f64> = (0..axes).map(|_| numbers.within(-0.4, 0.4)).collect();
    let size = numbers.within(0.05, 0.2);
    let normals: Vec<Vec<f64>> = if axes == 2 && numbers.within(0.0, 1.0) < 0.5 {
        let turn = numbers.within(0.0, 6.0);
        let angle = |k: usize| turn + std::f64::consts::TAU * k as f64 / 5.0;
        (0..5).map(|k| vec![angle(k).cos(), angle(k).sin()]).collect()
    } else {
        (0..axes).flat_map(|i| [unit(axes, i, 1.0), unit(axes, i, -1.0)]).collect()
    };
    normals.into_iter().map(|n| (n.clone(), dot(&n, &place) + size)).collect()
}

fn random(numbers: &mut Numbers) -> Random {
    let axes = 1 + (numbers.within(0.0, 3.0) as usize).min(2);
    let with_pair = axes < 3 && numbers.within(0.0, 1.0) < 0.5;
    let radius = 0.05;
    let mut found = Random { scene: Scene::new(TIME_STEP), meetings: Vec::new(), masses: vec![] };
    for b in 0..1 + usize::from(with_pair) {
        let mut all =
            |size: f64| -> Vec<f64> { (0..axes).map(|_| numbers.within(-size, size)).collect() };
        let (place, speed) = (all(0.8), all(1.0));
        // Towards the middle.
        let speed = speed.iter().zip(&place).map(|(v, x)| v - 2.5 * x).collect();
        let mass = numbers.within(0.3, 3.0);
        let body = Body::new(format!("b{b}"), vec![Interval::new(-1.5, 1.5); axes], 5.0, 4.0)
            .with_mass(mass)
            .with_shape(Shape::Ball(radius))
            .with_start(Region::point([place, speed].concat()));
        found.scene = found.scene.with_body(body);
        found.masses.push(mass);
    }
    let e = numbers.within(0.0, 1.0);
    let surface = Surface::bounce(Restitution::new(e).unwrap());
    let (faces, drift) = (solid(numbers, axes), numbers.within(-1.0, 1.0));
    let moves = if drift > 0.0 { vec![drift; axes] } else { vec![0.0; axes] };
    let place = |t: usize| moves.iter().map(|w| w * TIME_STEP * t as f64).collect::<Vec<f64>>();
    let wall = (unit(axes, 0, 1.0), -0.9);
    let moving = Solid::polytope("block", faces.clone(), surface);
    let still = vec![0.0; axes];
    found.scene = found
        .scene
        .with_obstacle(moving.with_course((0..=STEPS).map(place)))
        .with_obstacle(Solid::halfspace("wall", wall.0.clone(), wall.1, surface));
    let bodies = found.masses.len();
    for (name, faces, moves) in [("block", faces, moves), ("wall", vec![wall], still.clone())] {
        let faces: Vec<_> = faces.into_iter().map(|(n, b)| (n, b + radius)).collect();
        found.meetings.extend((0..bodies).map(|b| Meeting {
            name: format!("b{b} at {name}"),
            bodies: vec![b],
            faces: faces.clone(),
            restitution: e,
            moves: moves.clone(),
        }));
    }
    if with_pair {
        let normals: Vec<Vec<f64>> =
            (0..axes).flat_map(|i| [unit(axes, i, 1.0), unit(axes, i, -1.0)]).collect();
        let [first, second] = ["b0", "b1"].map(|name| found.scene.body_named(name).unwrap());
        found.scene.pair_along(first, second, surface, normals.clone()).unwrap();
        let faces = normals.into_iter().map(|n| (n, 2.0 * radius)).collect();
        let (name, bodies) = ("b0 and b1".to_owned(), vec![0, 1]);
        found.meetings.push(Meeting { name, bodies, faces, restitution: e, moves: still });
    }
    found
}

impl Meeting {
    /// Relative position and velocity, from those of all bodies after a time from the plan's start.
    fn relative(&self, states: &[(Vec<f64>, Vec<f64>)], time: f64) -> (Vec<f64>, Vec<f64>) {
        let (mut x, mut v) = states[self.bodies[0]].clone();
        for i in 0..x.len() {
            let (y, w) = match self.bodies.get(1) {
                Some(&other) => (states[other].0[i], states[other].1[i]),
                None => (self.moves[i] * time, self.moves[i]),
            };
            x[i] -= y;
            v[i] -= w;
        }
        (x, v)
    }

    /// The outermost face with its gap and the approach towards it.
    fn outermost(&self, states: &[(Vec<f64>, Vec<f64>)], time: f64) -> (f64, f64) {
        let (x, v) = self.relative(states, time);
        let gaps = self.faces.iter().map(|(n, b)| (dot(n, &x) - b, -dot(n, &v)));
        gaps.fold((f64::NEG_INFINITY, 0.0), |best, own| if own.0 > best.0 { own } else { best })
    }
}

/// All bodies some time into a step, without hits.
fn flown(plan: &ScenePlan, step: usize, time: f64) -> Vec<(Vec<f64>, Vec<f64>)> {
    let fly = |path: &BodyPath| {
        let (x, v, a) = (&path.position[step], &path.velocity[step], &path.acceleration[step]);
        let place = (0..x.len()).map(|i| x[i] + time * (v[i] + 0.5 * time * a[i])).collect();
        (place, (0..x.len()).map(|i| v[i] + time * a[i]).collect())
    };
    plan.bodies.iter().map(fly).collect()
}

/// Replays one step; returns its number of hits.
fn check(random: &Random, plan: &ScenePlan, step: usize) -> usize {
    let start = TIME_STEP * step as f64;
    let end = flown(plan, step, TIME_STEP);
    let mut next = end.clone();
    let mut hits = 0;
    for meeting in &random.meetings {
        let own = |hit: &&_| -> bool {
            let hit: &carom::hybrid::scene::SceneHit = hit;
            hit.step == step && hit.contact == meeting.name
        };
        let hit = plan.hits.iter().find(own);
        // The first impact of the step, by walking through it.
        let depth = 3e-6;
        let at = |k: usize| TIME_STEP * k as f64 / 200.0;
        let state = |time: f64| meeting.outermost(&flown(plan, step, time), start + time);
        let first = (0..=200).find(|&k| state(at(k)).0 < -depth);
        let Some(hit) = hit else {
            assert!(first.is_none(), "{} is missed in step {step}", meeting.name);
            continue;
        };
        hits += 1;
        if let Some(k) = first.filter(|&k| k > 0) {
            // Approach is linear in time, so both neighbours bound it.
            let speed = state(at(k - 1)).1.min(state(at(k)).1);
            assert!(speed <= hit.damage + 1e-5, "{speed} above {}", hit.damage);
        }
        let (n, b) = &meeting.faces[hit.face];
        let (x, v) = meeting.relative(&end, start + TIME_STEP);
        let (gap, f) = (dot(n, &x) - b, -dot(n, &v));
        assert!(gap < 1e-5 && f > -1e-5);
        let total: f64 = meeting.bodies.iter().map(|&b| 1.0 / random.masses[b]).sum();
        let bounce = 1.0 + meeting.restitution;
        for (k, &body) in meeting.bodies.iter().enumerate() {
            let share = [1.0, -1.0][k] / random.masses[body] / total;
            for (i, n) in n.iter().enumerate() {
                next[body].0[i] -= share * bounce * gap * n;
                next[body].1[i] += share * bounce * f * n;
                // The impulse of the first body.
                let impulse = bounce * f * n / total;
                assert!(k > 0 || (hit.impulse[i] - impulse).abs() < 1e-4);
            }
        }
        let lost = 0.5 * (1.0 - meeting.restitution.powi(2)) * f * f / total;
        assert!((hit.energy - lost).abs() < 1e-4, "{} instead of {lost}", hit.energy);
    }
    for (body, (x, v)) in plan.bodies.iter().zip(&next) {
        for i in 0..x.len() {
            assert!((body.position[step + 1][i] - x[i]).abs() <= 1e-6);
            assert!((body.velocity[step + 1][i] - v[i]).abs() <= 1e-5);
        }
    }
    hits
}

#[test]
fn random_scenes_do_what_their_laws_say() {
    let mut numbers = Numbers(11);
    let (mut plans, mut hits) = (0, 0);
    for _ in 0..30 {
        let random = random(&mut numbers);
        // Starts inside something are refused.
        let Ok(mut program) = random.scene.program(STEPS) else { continue };
        let states = program.program().variables().states().to_vec();
        let wish: Affine = states.iter().map(|s| numbers.within(-1.0, 1.0) * s[STEPS]).sum();
        let wish = wish - 3.0 * program.hits();
        program.minimize(wish).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        if solution.point().is_none() {
            continue;
        }
        let plan = program.plan(&solution).unwrap();
        assert!(plan.certificate.largest_residual <= 1e-6 && plan.certificate.drift <= 1e-5);
        assert!(plan.certificate.momentum_error <= 1e-5);
        hits += (0..STEPS).map(|step| check(&random, &plan, step)).sum::<usize>();
        plans += 1;
    }
    assert!(plans > 10 && hits > 10, "{plans} plans, {hits} hits");
}
