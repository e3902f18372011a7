//! Random single steps of sound scenes, against impacts that are located by other means: none is
//! faster than its damage, and none is missed.

use carom::hybrid::scene::{Body, Scene, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::model::Affine;
use carom::prelude::*;

use super::seeded_numbers::Numbers;

const TIME_STEP: f64 = 0.05;

/// Depth that is no impact, in m.
const DEPTH: f64 = 1e-9;

/// A body and what it may hit, in numbers.
struct Kind {
    name: &'static str,
    /// Unit normals out of the obstacle, and offsets.
    faces: Vec<(Vec<f64>, f64)>,
    /// The velocity of the obstacle, in m/s.
    moves: Vec<f64>,
    /// `dv/dt = -spring x - drag v + u` along every axis.
    spring: f64,
    drag: f64,
    /// Two bodies instead, which meet along the normals.
    is_pair: bool,
}

fn kind(name: &'static str, faces: Vec<(Vec<f64>, f64)>) -> Kind {
    let axes = faces[0].0.len();
    Kind { name, faces, moves: vec![0.0; axes], spring: 0.0, drag: 0.0, is_pair: false }
}

/// A regular polygon with its sides 0.1 m from the origin.
fn polygon(sides: usize) -> Vec<(Vec<f64>, f64)> {
    let angle = |k: usize| 0.3 + std::f64::consts::TAU * k as f64 / sides as f64;
    (0..sides).map(|k| (vec![angle(k).cos(), angle(k).sin()], 0.1)).collect()
}

fn cube() -> Vec<(Vec<f64>, f64)> {
    let unit = |i: usize, sign: f64| (0..3).map(|j| if i == j { sign } else { 0.0 }).collect();
    (0..3).flat_map(|i| [(unit(i, 1.0), 0.1), (unit(i, -1.0), 0.1)]).collect()
}

fn still() -> Vec<Kind> {
    vec![
        kind("a wall", vec![(vec![1.0], 0.0)]),
        kind("a triangle", polygon(3)),
        kind("a cube", cube()),
        Kind { spring: 9.0, drag: 2.0, ..kind("drag and a spring", vec![(vec![1.0], 0.0)]) },
        Kind { spring: 4.0, drag: 1.0, ..kind("drag beside a square", polygon(4)) },
    ]
}

fn moving() -> Vec<Kind> {
    vec![
        Kind { moves: vec![0.8], ..kind("a wall that comes", vec![(vec![1.0], 0.0)]) },
        Kind { moves: vec![0.5, -0.7], ..kind("a slanted wall", vec![(vec![0.6, 0.8], 0.0)]) },
        Kind { moves: vec![-0.9, 0.4], ..kind("a pentagon that drifts", polygon(5)) },
        Kind { is_pair: true, ..kind("two bodies", polygon(6)) },
    ]
}

impl Kind {
    fn scene(&self) -> Scene {
        let surface = Surface::bounce(Restitution::new(0.4).unwrap());
        let axes = self.moves.len();
        let body = |name: &str| {
            let body = Body::new(name, vec![Interval::new(-1.0, 1.0); axes], 4.0, 6.0);
            let entry = |i: usize, j: usize, value: f64| if i == j { -value } else { 0.0 };
            let matrix =
                |value| carom::hybrid::Matrix::from_fn(axes, axes, |i, j| entry(i, j, value));
            match self.spring + self.drag > 0.0 {
                true => body.with_dynamics(matrix(self.spring), matrix(self.drag)),
                false => body,
            }
        };
        let scene = Scene::new(TIME_STEP).with_body(body("p"));
        if self.is_pair {
            let normals = self.faces.iter().map(|(n, _)| n.clone());
            let radius = Shape::Ball(0.05);
            let mut scene = scene.with_body(body("q").with_mass(3.0).with_shape(radius.clone()));
            scene.bodies[0].shape = radius;
            let [p, q] = ["p", "q"].map(|name| scene.body_named(name).unwrap());
            scene.pair_along(p, q, surface, normals).unwrap();
            return scene;
        }
        let solid = Solid::polytope("s", self.faces.clone(), surface);
        let place = |t: f64| -> Vec<f64> { self.moves.iter().map(|w| w * TIME_STEP * t).collect() };
        scene.with_obstacle(match self.moves.iter().all(|w| *w == 0.0) {
            true => solid,
            false => solid.with_course([place(0.0), place(1.0)]),
        })
    }

    /// Position and velocity along an axis after a time, by the series of the motion.
    fn motion(&self, x: f64, v: f64, u: f64, time: f64) -> (f64, f64) {
        let (mut place, mut speed) = (x, v);
        let (mut rate, mut change) = (v, u - self.spring * x - self.drag * v);
        let mut factor = time;
        for k in 2..12 {
            place += factor * rate;
            speed += factor * change;
            (rate, change) = (change, -self.spring * rate - self.drag * change);
            factor *= time / f64::from(k);
        }
        (place, speed)
    }

    /// Gap and approach of each face after a time.
    fn gaps(&self, x: &[f64], v: &[f64], u: &[f64], time: f64) -> Vec<(f64, f64)> {
        let state: Vec<(f64, f64)> =
            (0..x.len()).map(|i| self.motion(x[i], v[i], u[i], time)).collect();
        let gap = |(n, b): &(Vec<f64>, f64)| {
            let sum = |f: &dyn Fn(usize) -> f64| (0..n.len()).map(|i| n[i] * f(i)).sum::<f64>();
            let place = sum(&|i| state[i].0 - self.moves[i] * time) - b;
            (place, -sum(&|i| state[i].1 - self.moves[i]))
        };
        self.faces.iter().map(gap).collect()
    }

    /// The speed of the first impact of a step, and its face.
    fn impact(&self, x: &[f64], v: &[f64], u: &[f64]) -> Option<(f64, usize)> {
        let outermost = |time: f64| {
            let gaps = self.gaps(x, v, u, time);
            (0..gaps.len()).map(|k| (gaps[k].0, gaps[k].1, k)).fold(
                (f64::NEG_INFINITY, 0.0, 0),
                |best, own| if own.0 > best.0 { own } else { best },
            )
        };
        let parts = 24;
        let inside = |time: f64| outermost(time).0 < -DEPTH;
        let first = (1..=parts).find(|&k| inside(TIME_STEP * k as f64 / parts as f64))?;
        let (mut low, mut high) = (0.0, TIME_STEP * first as f64 / parts as f64);
        for _ in 0..36 {
            let middle = 0.5 * (low + high);
            if inside(middle) { high = middle } else { low = middle }
        }
        let (_, speed, face) = outermost(low);
        Some((speed, face))
    }
}

#[test]
fn no_first_impact_is_faster_than_its_damage() {
    check(still());
}

#[test]
fn no_first_impact_is_faster_than_its_damage_where_things_move() {
    check(moving());
}

/// 6500 steps of each kind: 58,500 in both tests.
fn check(kinds: Vec<Kind>) {
    let mut numbers = Numbers(3);
    for kind in kinds {
        let system = kind.scene().hybrid_system().unwrap();
        let axes = kind.moves.len();
        let (mut hits, mut flights) = (0, 0);
        while hits + flights < 6_500 {
            let mut all =
                |low, high| -> Vec<f64> { (0..axes).map(|_| numbers.within(low, high)).collect() };
            let (x, v, u) = (all(-0.2, 0.2), all(-3.0, 3.0), all(-6.0, 6.0));
            // Of a pair, the other body drifts.
            let (y, w) = (all(-0.1, 0.1), all(-1.0, 1.0));
            let (state, inputs) = match kind.is_pair {
                false => ([x.clone(), v.clone()].concat(), u.clone()),
                true => {
                    let sum = |a: &[f64], b: &[f64]| -> Vec<f64> {
                        a.iter().zip(b).map(|(a, b)| a + b).collect()
                    };
                    let own = [sum(&x, &y), sum(&v, &w), y, w].concat();
                    (own, [u.clone(), vec![0.0; axes]].concat())
                }
            };
            let start = kind.gaps(&x, &v, &u, 0.0);
            if start.iter().all(|(gap, _)| *gap < 0.0) {
                continue;
            }
            let run = system.simulate(&state, &[inputs]).unwrap();
            if !run.is_complete() {
                continue;
            }
            let impact = kind.impact(&x, &v, &u);
            let taken = run.taken()[0][0].clone();
            let Some(face) = taken.strip_prefix("hit") else {
                flights += 1;
                assert!(impact.is_none(), "{}: {taken} from {state:?} by {u:?}", kind.name);
                continue;
            };
            hits += 1;
            let face: usize = face.trim().parse().unwrap_or(0);
            let Some((speed, own)) = impact else { continue };
            let end = kind.gaps(&x, &v, &u, TIME_STEP);
            // Stated bound for motion that is no parabola.
            let counted = start[face].1.max(end[face].1) + if kind.drag > 0.0 { 0.05 } else { 0.0 };
            assert!(
                own == face && speed <= counted + 1e-9,
                "{}: {speed} above {counted} from {state:?} by {u:?}, {own} for {taken}",
                kind.name
            );
        }
        assert!(hits > 200 && flights > 1_000, "{}: {hits}, {flights}", kind.name);
    }
}

#[test]
fn damage_covers_motion_that_is_no_parabola() {
    // Pulled to the wall by a spring, with every push: counted is at least the fastest approach.
    let kind = Kind { spring: 9.0, drag: 2.0, ..kind("a spring", vec![(vec![1.0], 0.0)]) };
    let mut numbers = Numbers(5);
    let mut hits = 0;
    for _ in 0..12 {
        let (x, v) = (numbers.within(0.02, 0.1), numbers.within(-3.0, -1.5));
        let mut scene = kind.scene();
        scene.bodies[0].start = Some(Region::point([x, v]));
        let mut program = scene.program(2).unwrap();
        let push = numbers.within(-1.0, 1.0);
        let inputs = program.program().variables().inputs()[0].clone();
        let wish: Affine = inputs.iter().map(|u| push * u).sum();
        program.minimize(wish).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        let plan = program.plan(&solution).unwrap();
        let path = &plan.bodies[0];
        for hit in &plan.hits {
            let t = hit.step;
            let (x, v) = (&path.position[t], &path.velocity[t]);
            let Some((speed, _)) = kind.impact(x, v, &path.acceleration[t]) else { continue };
            assert!(speed <= hit.damage && hit.damage <= speed + 1.0);
            assert!((speed - hit.speed).abs() < 1e-5);
            hits += 1;
        }
    }
    assert!(hits > 3, "{hits}");
}
