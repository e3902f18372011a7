//! The geometry and the motion of a scene in numbers, without its hybrid system.

use faer::Mat;

use crate::hybrid::scene::body::{Body, Shape};
use crate::hybrid::scene::geometry::{dot, length};
use crate::hybrid::scene::statement::Scene;
use crate::hybrid::scene::surface::{Surface, Tangential};
use crate::tolerance::margin_scale;

/// Number of Runge-Kutta steps in a step of a body with springs or drag, while that is short beside
/// the times of its motion.
const SUBSTEPS: f64 = 64.0;

/// Positions, velocities and spins of all bodies.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) x: Vec<Vec<f64>>,
    pub(super) v: Vec<Vec<f64>>,
    /// In rad/s; 0 of bodies without spin.
    pub(super) w: Vec<f64>,
    /// In rad; 0 of bodies without heading.
    pub(super) heading: Vec<f64>,
}

impl State {
    /// The kinetic energy of a body, in J.
    pub(super) fn energy(&self, body: &Body, b: usize) -> f64 {
        let turning = body.spin.map_or(0.0, |spin| spin.inertia * self.w[b] * self.w[b]);
        0.5 * (body.mass * dot(&self.v[b], &self.v[b]) + turning)
    }
}

/// A body and an obstacle, or two bodies, that may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Touch {
    Obstacle(usize, usize),
    /// The number of the pair.
    Pair(usize),
}

/// A scene, asked for gaps and motions.
pub(super) struct World<'a> {
    pub(super) scene: &'a Scene,
}

impl World<'_> {
    pub(super) fn touches(&self) -> Vec<Touch> {
        let Scene { bodies, obstacles, pairs, .. } = self.scene;
        let obstacles = 0..obstacles.len();
        let of = |o: usize| (0..bodies.len()).map(move |b| Touch::Obstacle(b, o));
        obstacles.flat_map(of).chain((0..pairs.len()).map(Touch::Pair)).collect()
    }

    /// The name of the thing that a body touches, as plans give it.
    pub(super) fn name(&self, touch: Touch) -> String {
        let scene = self.scene;
        match touch {
            Touch::Obstacle(b, o) => {
                format!("{} at {}", scene.bodies[b].name, scene.obstacles[o].name)
            }
            Touch::Pair(p) => {
                let pair = &scene.pairs[p];
                format!("{} and {}", scene.bodies[pair.first].name, scene.bodies[pair.second].name)
            }
        }
    }

    pub(super) fn faces(&self, touch: Touch) -> usize {
        match touch {
            Touch::Obstacle(_, o) => self.scene.obstacles[o].faces.len(),
            Touch::Pair(p) => self.scene.pairs[p].normals.len(),
        }
    }

    pub(super) fn normal(&self, touch: Touch, face: usize) -> &[f64] {
        match touch {
            Touch::Obstacle(_, o) => &self.scene.obstacles[o].faces[face].normal,
            Touch::Pair(p) => &self.scene.pairs[p].normals[face],
        }
    }

    pub(super) fn surface(&self, touch: Touch, face: usize) -> Surface {
        match touch {
            Touch::Obstacle(_, o) => self.scene.obstacles[o].faces[face].surface,
            Touch::Pair(p) => self.scene.pairs[p].surface,
        }
    }

    /// The bodies with the share of the velocity's change that each takes, with its sign.
    pub(super) fn shares(&self, touch: Touch) -> Vec<(usize, f64)> {
        match touch {
            Touch::Obstacle(b, _) => vec![(b, 1.0)],
            Touch::Pair(p) => {
                let pair = &self.scene.pairs[p];
                let [a, b] = [pair.first, pair.second].map(|b| self.scene.bodies[b].mass);
                vec![(pair.first, b / (a + b)), (pair.second, -a / (a + b))]
            }
        }
    }

    /// The mass that a hit moves, in kg.
    pub(super) fn mass(&self, touch: Touch) -> f64 {
        let (body, share) = self.shares(touch)[0];
        self.scene.bodies[body].mass * share
    }

    /// The bodies of a contact whose spins change in it: their numbers, the way from their centres
    /// to the surface (m), and their inertias (kg m²).
    pub(super) fn spins(&self, touch: Touch) -> Vec<(usize, f64, f64)> {
        let of = |(b, _): (usize, f64)| {
            let Body { shape: Shape::Ball(radius), spin: Some(spin), .. } = &self.scene.bodies[b]
            else {
                return None;
            };
            Some((b, *radius, spin.inertia))
        };
        self.shares(touch).into_iter().filter_map(of).collect()
    }

    /// Adds the change of the relative velocity in a hit to the bodies: along the surface, its
    /// impulse turns them too.
    pub(super) fn strike(&self, touch: Touch, face: usize, change: &[f64], state: &mut State) {
        for (body, share) in self.shares(touch) {
            let v = state.v[body].iter_mut().zip(change);
            v.for_each(|(v, change)| *v += share * change);
        }
        for (body, lever, inertia) in self.spins(touch) {
            let impulse = self.mass(touch) * turned(self.normal(touch, face), change);
            state.w[body] -= lever * impulse / inertia;
        }
    }

    /// The kinetic energy that a change of the relative velocity takes from a state, in J.
    pub(super) fn lost(
        &self,
        (touch, face): (Touch, usize),
        step: usize,
        state: &State,
        change: &[f64],
    ) -> f64 {
        let mut struck = state.clone();
        self.strike(touch, face, change, &mut struck);
        let relative = |state: &State| {
            let r = self.relative(touch, &state.v, step);
            let turning = |(b, _, inertia)| inertia * state.w[b] * state.w[b];
            self.mass(touch) * dot(&r, &r) + self.spins(touch).into_iter().map(turning).sum::<f64>()
        };
        0.5 * (relative(state) - relative(&struck))
    }

    /// The largest change of the angular momentum of a body about the point at which it touches a
    /// face, in kg m²/s.
    pub(super) fn turned_about(
        &self,
        (touch, face): (Touch, usize),
        [before, after]: [&State; 2],
    ) -> f64 {
        let of = |(b, lever, inertia): (usize, f64, f64)| {
            let pushed = after.v[b].iter().zip(&before.v[b]).map(|(v, before)| v - before);
            let pushed = turned(self.normal(touch, face), &pushed.collect::<Vec<f64>>());
            let turn = inertia * (after.w[b] - before.w[b]);
            (turn + lever * self.scene.bodies[b].mass * pushed).abs()
        };
        self.spins(touch).into_iter().map(of).fold(0.0, f64::max)
    }

    /// Gap to a face, `part` of the way through a step, in m.
    pub(super) fn gap(
        &self,
        touch: Touch,
        face: usize,
        x: &[Vec<f64>],
        step: usize,
        part: f64,
    ) -> f64 {
        let n = self.normal(touch, face);
        match touch {
            Touch::Obstacle(b, o) => {
                let obstacle = &self.scene.obstacles[o];
                let axes = n.len();
                let (from, to) =
                    (obstacle.displacement(step, axes), obstacle.displacement(step + 1, axes));
                let place: Vec<f64> =
                    from.iter().zip(&to).map(|(a, b)| a + part * (b - a)).collect();
                let reach = self.scene.bodies[b].shape.reach(n);
                dot(n, &x[b]) - dot(n, &place) - obstacle.faces[face].offset - reach
            }
            Touch::Pair(p) => {
                let pair = &self.scene.pairs[p];
                let reach = self.scene.bodies[pair.first].shape.reach(n)
                    + self.scene.bodies[pair.second].shape.reach(n);
                dot(n, &x[pair.first]) - dot(n, &x[pair.second]) - reach
            }
        }
    }

    /// The largest gap over the faces: negative inside.
    pub(super) fn clearance(
        &self,
        touch: Touch,
        x: &[Vec<f64>],
        step: usize,
        part: f64,
    ) -> (f64, usize) {
        let gaps = (0..self.faces(touch)).map(|k| (self.gap(touch, k, x, step, part), k));
        gaps.fold((f64::NEG_INFINITY, 0), |best, own| if own.0 > best.0 { own } else { best })
    }

    /// The velocity relative to what is touched, in m/s.
    pub(super) fn relative(&self, touch: Touch, v: &[Vec<f64>], step: usize) -> Vec<f64> {
        match touch {
            Touch::Obstacle(b, o) => {
                let axes = self.scene.axes();
                let obstacle = &self.scene.obstacles[o];
                let (from, to) =
                    (obstacle.displacement(step, axes), obstacle.displacement(step + 1, axes));
                (0..axes).map(|i| v[b][i] - (to[i] - from[i]) / self.scene.time_step).collect()
            }
            Touch::Pair(p) => {
                let pair = &self.scene.pairs[p];
                v[pair.first].iter().zip(&v[pair.second]).map(|(a, b)| a - b).collect()
            }
        }
    }

    /// The inputs of a step with what functions of the motion make of them.
    pub(super) fn held(&self, from: &State, stated: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let axes = self.scene.axes();
        let middle = self.fly(from, stated, 0.5 * self.scene.time_step).heading;
        let of = |(b, body): (usize, &Body)| {
            let (u, torque) = stated[b].split_at(axes);
            let mut held = body.held(&from.x[b], &from.v[b], middle[b], u);
            held.extend(torque);
            held
        };
        self.scene.bodies.iter().enumerate().map(of).collect()
    }

    /// Free flight for a time (s) under the inputs of a step: accelerations, and last a torque.
    pub(super) fn fly(&self, from: &State, inputs: &[Vec<f64>], time: f64) -> State {
        let mut to = from.clone();
        for (b, body) in self.scene.bodies.iter().enumerate() {
            let (x, v) = self.fly_body(body, &from.x[b], &from.v[b], &inputs[b], time);
            (to.x[b], to.v[b]) = (x, v);
            if let (Some(spin), Some(torque)) = (&body.spin, inputs[b].get(self.scene.axes())) {
                if body.heading.is_some() {
                    to.heading[b] += time * (to.w[b] + 0.5 * time * torque / spin.inertia);
                }
                to.w[b] += time * torque / spin.inertia;
            }
        }
        to
    }

    fn fly_body(
        &self,
        body: &Body,
        x: &[f64],
        v: &[f64],
        u: &[f64],
        time: f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let axes = x.len();
        let Some((k, d)) = &body.dynamics else {
            let a: Vec<f64> = u.iter().zip(&body.gravity).map(|(u, g)| u + g).collect();
            let x = (0..axes).map(|i| x[i] + time * v[i] + 0.5 * time * time * a[i]);
            return (x.collect(), (0..axes).map(|i| v[i] + time * a[i]).collect());
        };
        let force = |x: &[f64], v: &[f64]| -> Vec<f64> {
            let row = |i: usize| {
                let terms = (0..axes).map(|j| k[(i, j)] * x[j] + d[(i, j)] * v[j]);
                u[i] + body.gravity[i] + terms.sum::<f64>()
            };
            (0..axes).map(row).collect()
        };
        let plus = |a: &[f64], h: f64, b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| a + h * b).collect()
        };
        // The local error is of the fifth order in the fastest rate of the motion times a step.
        let largest = |m: &Mat<f64>| {
            let rows = (0..axes).map(|i| (0..axes).map(|j| m[(i, j)].abs()).sum::<f64>());
            rows.fold(0.0, f64::max)
        };
        let rate = largest(d) + largest(k).sqrt();
        let finer = (rate * self.scene.time_step).max(1.0).powf(1.25);
        let count = (SUBSTEPS * finer * time / self.scene.time_step).ceil().max(1.0);
        let h = time / count;
        let (mut x, mut v) = (x.to_vec(), v.to_vec());
        for _ in 0..count as usize {
            let a1 = force(&x, &v);
            let (x2, v2) = (plus(&x, 0.5 * h, &v), plus(&v, 0.5 * h, &a1));
            let a2 = force(&x2, &v2);
            let (x3, v3) = (plus(&x, 0.5 * h, &v2), plus(&v, 0.5 * h, &a2));
            let a3 = force(&x3, &v3);
            let (x4, v4) = (plus(&x, h, &v3), plus(&v, h, &a3));
            let a4 = force(&x4, &v4);
            for i in 0..axes {
                x[i] += h / 6.0 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
                v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
            }
        }
        (x, v)
    }

    /// By how many times the gap at the end of a step a hit moves the body.
    pub(super) fn lift(&self, touch: Touch, face: usize) -> f64 {
        let surface = self.surface(touch, face);
        if surface.rests { 1.0 } else { 1.0 + surface.restitution.map_or(0.0, |e| e.value()) }
    }

    /// The changes that a hit may make to the relative velocity at the end of its step: one
    /// possibility, or, where friction may act in several directions, one for each that its law
    /// allows up to `slack` (m/s). At a surface with rest the relative velocity at the start of the
    /// step decides about the rebound.
    pub(super) fn changes(
        &self,
        touch: Touch,
        face: usize,
        step: usize,
        [start, end]: [&State; 2],
        slack: f64,
    ) -> Vec<Vec<f64>> {
        let [before, r] = [start, end].map(|state| self.relative(touch, &state.v, step));
        let (before, r) = (&before[..], &r[..]);
        let surface = self.surface(touch, face);
        let n = self.normal(touch, face);
        let e = surface.restitution.map_or(0.0, |e| e.value());
        let along_normal = dot(n, r);
        let total = match surface.rests {
            true => -along_normal + e * (-dot(n, before)).max(0.0),
            false => -(1.0 + e) * along_normal,
        };
        let normal: Vec<f64> = n.iter().map(|n| total * n).collect();
        // The touching points slide by what their centres do, and by spin; impulses along the
        // surface change that by `mobility` times as much.
        let mut sliding: Vec<f64> = r.iter().zip(n).map(|(r, n)| r - along_normal * n).collect();
        let mut mobility = 1.0;
        for (body, lever, inertia) in self.spins(touch) {
            mobility += self.mass(touch) * lever * lever / inertia;
            sliding[0] += lever * end.w[body] * n[1];
            sliding[1] -= lever * end.w[body] * n[0];
        }
        let speed = length(&sliding);
        let with = |factor: f64, direction: &[f64]| -> Vec<f64> {
            normal.iter().zip(direction).map(|(a, d)| a + factor * d).collect()
        };
        match surface.tangential {
            Tangential::Frictionless => vec![normal],
            Tangential::Linear { keep, from_normal } => {
                let mut change = with((keep - 1.0) / mobility, &sliding);
                if let [x, y] = n {
                    change[0] += from_normal * along_normal * y / mobility;
                    change[1] -= from_normal * along_normal * x / mobility;
                }
                vec![change]
            }
            Tangential::Coulomb { coefficient, directions } => {
                let most = coefficient * total.max(0.0);
                if n.len() < 3 {
                    let sticks = speed <= mobility * most;
                    let part = if sticks { 1.0 / mobility } else { most / speed };
                    return vec![with(-part, &sliding)];
                }
                let sticks = most;
                let most = most * (std::f64::consts::PI / directions as f64).cos();
                let ways = directions_along(n, directions);
                let shares: Vec<f64> = ways.iter().map(|d| dot(d, r)).collect();
                let largest = shares.iter().copied().fold(0.0, f64::max);
                // Rows compare neighbouring directions, which are closer to each other the more
                // there are.
                let slack = slack * margin_scale(length(r), 0.0);
                let nearest = 2.0 * (std::f64::consts::PI / directions as f64).sin();
                let sector = slack / nearest.min(1.0);
                let mut all = Vec::new();
                if speed <= sticks + slack {
                    all.push(with(-1.0, &sliding));
                }
                for (way, share) in ways.iter().zip(&shares) {
                    if *share >= largest - sector && *share >= most - slack {
                        all.push(with(-most, way));
                    }
                }
                all
            }
        }
    }
}

/// The entry of a vector in the plane along the normal turned left; 0 on a line and in space.
fn turned(n: &[f64], vector: &[f64]) -> f64 {
    match (n, vector) {
        ([x, y], [a, b]) => x * b - y * a,
        _ => 0.0,
    }
}

/// Directions across a normal in space, the first one in the plane of the axis that is least along
/// the normal.
fn directions_along(n: &[f64], count: usize) -> Vec<Vec<f64>> {
    let least = (0..3).fold(0, |best, i| if n[i].abs() < n[best].abs() { i } else { best });
    let mut first: Vec<f64> = n.iter().map(|a| -n[least] * a).collect();
    first[least] += 1.0;
    let size = length(&first);
    first.iter_mut().for_each(|a| *a /= size);
    let second = [
        n[1] * first[2] - n[2] * first[1],
        n[2] * first[0] - n[0] * first[2],
        n[0] * first[1] - n[1] * first[0],
    ];
    let way = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / count as f64;
        (0..3).map(|i| angle.cos() * first[i] + angle.sin() * second[i]).collect()
    };
    (0..count).map(way).collect()
}
