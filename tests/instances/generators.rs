//! Hybrid control programs as other solvers get them: plain rows with big-Ms from interval bounds,
//! quadratic costs, and nothing that tells a solver where they come from.

use std::f64::consts::{FRAC_PI_2, PI};

use carom::prelude::*;

use super::riccati::{Matrix, riccati};

const INF: f64 = f64::INFINITY;

/// A model under construction; terms are pairs of variable and coefficient.
struct Rows {
    model: Model,
    cost: Quadratic,
    rows: usize,
}

type Terms = Vec<(Variable, f64)>;

impl Rows {
    fn new(name: &str) -> Self {
        Rows { model: Model::new(name), cost: Quadratic::zero(), rows: 0 }
    }

    fn family(&mut self, name: &str, count: usize, lower: f64, upper: f64) -> Vec<Variable> {
        self.model.continuous_family(name, count, lower, upper).unwrap().iter().collect()
    }

    fn binaries(&mut self, name: &str, count: usize) -> Vec<Variable> {
        self.model.binary_family(name, count).unwrap().iter().collect()
    }

    fn fix(&mut self, variable: Variable, value: f64) {
        self.model.fix(variable, value).unwrap();
    }

    /// The state at the first sample: given, or measured, a parameter for each entry.
    fn begin<const N: usize>(&mut self, first: [Variable; N], start: Option<[f64; N]>) {
        for (k, variable) in first.into_iter().enumerate() {
            if let Some(start) = start {
                self.fix(variable, start[k]);
                continue;
            }
            let range = self.model.variable_ref(variable).unwrap().bounds();
            let measured =
                self.model.parameter(("measured", k), 0.0, range.lower, range.upper).unwrap();
            self.row(&[(variable, 1.0), (measured, -1.0)], 0.0, 0.0);
        }
    }

    fn row(&mut self, terms: &[(Variable, f64)], lower: f64, upper: f64) {
        let sum = affine(terms);
        self.model.add(("row", self.rows), sum.within(lower, upper)).unwrap();
        self.rows += 1;
    }

    /// `z = on` implies `lower <= terms <= upper`, by big-Ms from the present bounds.
    fn implies(
        &mut self,
        z: Variable,
        on: bool,
        terms: &[(Variable, f64)],
        lower: f64,
        upper: f64,
    ) {
        let range = self.model.range(&affine(terms)).unwrap();
        let with = |m: f64| [terms, &[(z, m)]].concat();
        if upper < INF && range.upper > upper {
            let m = range.upper - upper;
            let (m, limit) = if on { (m, upper + m) } else { (-m, upper) };
            self.row(&with(m), -INF, limit);
        }
        if lower > -INF && range.lower < lower {
            let m = lower - range.lower;
            let (m, limit) = if on { (-m, lower - m) } else { (m, lower) };
            self.row(&with(m), limit, INF);
        }
    }

    /// Adds `1/2 x'Qx` for a symmetric matrix.
    fn quadratic(&mut self, x: &[Variable], q: &Matrix) {
        for i in 0..x.len() {
            self.cost.add_product(0.5 * q[i][i], x[i], x[i]);
            (0..i).for_each(|j| self.cost.add_product(q[i][j], x[i], x[j]));
        }
    }

    fn finish(mut self) -> Model {
        self.model.minimize(self.cost).unwrap();
        self.model
    }
}

fn affine(terms: &[(Variable, f64)]) -> Affine {
    terms.iter().map(|&(variable, a)| a * variable).sum()
}

fn scaled(terms: &[(Variable, f64)], factor: f64) -> Terms {
    terms.iter().map(|&(variable, a)| (variable, factor * a)).collect()
}

/// A vehicle that may rebound from a wall at 0, from 10 m to 0.3 m, at rest at both ends. With
/// `fuel` the squared acceleration is minimised, else any plan will do.
pub(crate) fn wall(steps: usize, dt: f64, e: f64, fuel: bool) -> Model {
    let (far, fast, strong) = (20.0, 15.0, 6.0);
    let mut rows = Rows::new("wall");
    let x = rows.family("x", steps + 1, 0.0, far);
    let v = rows.family("v", steps + 1, -fast, fast);
    let a = rows.family("a", steps, -strong, strong);
    let z = rows.binaries("z", steps);
    for (variable, value) in
        [(x[0], 10.0), (x[steps], 0.3), (v[0], 0.0), (v[steps], 0.0), (a[0], 0.0)]
    {
        rows.fix(variable, value);
    }
    let through = dt * fast + 0.5 * dt * dt * strong;
    let away = far + through;
    let faster = (1.0 + e) * (fast + dt * strong);
    for t in 0..steps {
        let position = [(x[t], 1.0), (v[t], dt), (a[t], 0.5 * dt * dt)];
        let speed = [(v[t], 1.0), (a[t], dt)];
        let next = |now: Variable, of: &[(Variable, f64)], factor: f64, m: f64| {
            let mut terms = vec![(now, 1.0)];
            terms.extend(scaled(of, factor));
            if m != 0.0 {
                terms.push((z[t], m));
            }
            terms
        };
        let (x1, v1) = (x[t + 1], v[t + 1]);
        rows.row(&[&position[..], &[(z[t], through)]].concat(), 0.0, INF);
        rows.row(&[&position[..], &[(z[t], away)]].concat(), -INF, away);
        rows.row(&next(x1, &position, -1.0, 0.0), 0.0, INF);
        rows.row(&next(x1, &position, -1.0, -(1.0 + e) * through), -INF, 0.0);
        rows.row(&next(x1, &position, e, (1.0 + e) * away), -INF, (1.0 + e) * away);
        rows.row(&next(x1, &position, e, 0.0), 0.0, INF);
        rows.row(&next(v1, &speed, -1.0, -faster), -INF, 0.0);
        rows.row(&next(v1, &speed, -1.0, 0.0), 0.0, INF);
        rows.row(&next(v1, &speed, e, faster), -INF, faster);
        rows.row(&next(v1, &speed, e, -faster), -faster, INF);
        if fuel {
            rows.cost.add_product(dt, a[t], a[t]);
        }
    }
    rows.finish()
}

/// An inverted pendulum beside an elastic wall: two affine modes a step, by big-M or by the convex
/// hull of the modes. Without a start, the first state is measured.
pub(crate) fn pendulum(steps: usize, start: impl Into<Option<[f64; 2]>>, hull: bool) -> Model {
    let (h, gravity, stiffness, gap) = (0.01, 10.0, 100.0, 0.1);
    let free = [[1.0, h], [h * gravity, 1.0]];
    let touching = [[1.0, h], [h * (gravity - stiffness), 1.0]];
    let push = [0.0, h];
    let mut rows = Rows::new("pendulum");
    let ranges = [(-2.0 * gap, 2.0 * gap), (-1.5, 1.5), (-4.0, 4.0)];
    let angle = rows.family("angle", steps + 1, ranges[0].0, ranges[0].1);
    let rate = rows.family("rate", steps + 1, ranges[1].0, ranges[1].1);
    let u = rows.family("u", steps, ranges[2].0, ranges[2].1);
    let (z0, z1) = (rows.binaries("free", steps), rows.binaries("touching", steps));
    rows.begin([angle[0], rate[0]], start.into());
    for t in 0..steps {
        rows.row(&[(z0[t], 1.0), (z1[t], 1.0)], 1.0, 1.0);
        let (now, next) = ([angle[t], rate[t], u[t]], [angle[t + 1], rate[t + 1]]);
        let modes = [(z0[t], free, 0.0, 1.0), (z1[t], touching, h * stiffness * gap, -1.0)];
        if !hull {
            for (z, matrix, constant, side) in modes {
                for i in 0..2 {
                    let gain = [matrix[i][0], matrix[i][1], push[i]];
                    let mut terms = vec![(next[i], 1.0)];
                    terms.extend((0..3).map(|j| (now[j], -gain[j])));
                    terms.retain(|(_, a)| *a != 0.0);
                    let c = if i == 1 { constant } else { 0.0 };
                    rows.implies(z, true, &terms, c, c);
                }
                rows.implies(z, true, &[(angle[t], side)], -INF, side * gap);
            }
            continue;
        }
        // A copy of state and input for each mode, 0 in the other one.
        let mut copies = Vec::new();
        for k in 0..2 {
            let copy = |j: usize| (format!("part{k}{j}"), ranges[j]);
            let copy = [0, 1, 2].map(copy).map(|(name, (lower, upper))| {
                rows.model.continuous((&name[..], t), lower, upper).unwrap()
            });
            copies.push(copy);
        }
        for j in 0..3 {
            rows.row(&[(now[j], -1.0), (copies[0][j], 1.0), (copies[1][j], 1.0)], 0.0, 0.0);
        }
        for ((z, _, _, side), copy) in modes.iter().zip(&copies) {
            for (&part, &(lower, upper)) in copy.iter().zip(&ranges) {
                rows.row(&[(part, 1.0), (*z, -upper)], -INF, 0.0);
                rows.row(&[(part, 1.0), (*z, -lower)], 0.0, INF);
            }
            rows.row(&[(copy[0], *side), (*z, -side * gap)], -INF, 0.0);
        }
        for i in 0..2 {
            let mut terms = vec![(next[i], 1.0)];
            for ((z, matrix, constant, _), copy) in modes.iter().zip(&copies) {
                let gain = [matrix[i][0], matrix[i][1], push[i]];
                terms.extend((0..3).map(|j| (copy[j], -gain[j])));
                terms.push((*z, if i == 1 { -constant } else { 0.0 }));
            }
            terms.retain(|(_, a)| *a != 0.0);
            rows.row(&terms, 0.0, 0.0);
        }
    }
    let identity = [[1.0, 0.0], [0.0, 1.0]];
    let matrix = |m: [[f64; 2]; 2]| m.map(|row| row.to_vec()).to_vec();
    let push = vec![vec![push[0]], vec![push[1]]];
    let last = riccati(&matrix(free), &push, &matrix(identity), &vec![vec![1.0]]);
    for t in 0..=steps {
        let weight = if t == steps { &last } else { &matrix(identity) };
        rows.quadratic(&[angle[t], rate[t]], weight);
    }
    u.iter().for_each(|&u| rows.cost.add_product(0.5, u, u));
    rows.finish()
}

/// A cart with a pole between two soft walls that push back in proportion to how far they are
/// pressed in; the pole's tip touches them. Without a start, the first state is measured.
pub(crate) fn cartpole(steps: usize, start: impl Into<Option<[f64; 4]>>) -> Model {
    let (cart, pole, length, gravity, dt) = (1.0, 0.4, 0.6, 9.81, 0.02);
    let (left, right, stiffness): (f64, f64, f64) = (0.4, 0.35, 50.0);
    let a = vec![
        vec![1.0, 0.0, dt, 0.0],
        vec![0.0, 1.0, 0.0, dt],
        vec![0.0, dt * gravity * pole / cart, 1.0, 0.0],
        vec![0.0, dt * gravity * (cart + pole) / (length * cart), 0.0, 1.0],
    ];
    let turn = dt / (length * pole);
    let b = vec![
        vec![0.0; 3],
        vec![0.0; 3],
        vec![dt / cart, 0.0, 0.0],
        vec![dt / (length * cart), turn, -turn],
    ];
    let diagonal = |entries: &[f64]| -> Matrix {
        let row = |i: usize| (0..entries.len()).map(move |j| if i == j { entries[i] } else { 0.0 });
        (0..entries.len()).map(|i| row(i).collect()).collect()
    };
    let (q, r) = (diagonal(&[1.0, 50.0, 1.0, 50.0]), diagonal(&[0.1; 3]));
    let last = riccati(&a, &b, &q, &r);
    let far = [0.6, FRAC_PI_2, 2.0 * 0.6 / 0.1, PI / 0.1];
    let force = 30.0;
    let mut rows = Rows::new("cartpole");
    let x: Vec<Vec<Variable>> =
        (0..4).map(|i| rows.family(&format!("x{i}"), steps + 1, -far[i], far[i])).collect();
    let push = rows.family("u", steps, -20.0, 20.0);
    let walls = [rows.family("right", steps, 0.0, force), rows.family("left", steps, 0.0, force)];
    let touch = [rows.binaries("at_right", steps), rows.binaries("at_left", steps)];
    rows.begin([0, 1, 2, 3].map(|i| x[i][0]), start.into());
    for t in 0..steps {
        for i in 0..4 {
            let mut terms = vec![(x[i][t + 1], 1.0)];
            terms.extend((0..4).map(|j| (x[j][t], -a[i][j])));
            let inputs = [push[t], walls[0][t], walls[1][t]];
            terms.extend((0..3).map(|j| (inputs[j], -b[i][j])));
            terms.retain(|(_, a)| *a != 0.0);
            rows.row(&terms, 0.0, 0.0);
        }
        for (side, (sign, gap)) in [(1.0, right), (-1.0, left)].into_iter().enumerate() {
            let (wall, z) = (walls[side][t], touch[side][t]);
            rows.row(&[(wall, 1.0), (z, -force)], -INF, 0.0);
            // Force over stiffness is at least how far the tip is in, and exactly that in contact.
            let excess = [(x[0][t], -sign), (x[1][t], sign * length), (wall, 1.0 / stiffness)];
            rows.row(&excess, -gap, INF);
            rows.implies(z, true, &excess, -INF, -gap);
        }
    }
    for t in 0..=steps {
        let state: Vec<Variable> = x.iter().map(|family| family[t]).collect();
        rows.quadratic(&state, if t == steps { &last } else { &q });
    }
    for input in push.iter().chain(walls.iter().flatten()) {
        rows.cost.add_product(0.05, *input, *input);
    }
    rows.finish()
}

/// Boxes in the plane: left, right, below, above.
const BOXES: [[f64; 4]; 4] = [
    [4.355602058025833, 5.786257438377247, 6.343862620245817, 9.061701735665407],
    [2.608826637006559, 5.133150787119266, 3.6125993847401245, 5.467318002930782],
    [4.0947516390985115, 6.500372612978202, 1.1348400288829876, 3.195869330033833],
    [3.135834435561237, 4.820946162427869, 5.767773908985905, 7.6933705321549475],
];

/// A point mass among boxes, from one corner of a square to the other, with least squared effort
/// or least sum of magnitudes.
pub(crate) fn boxes(steps: usize, count: usize, squared: bool) -> Model {
    boxes_among(steps, &BOXES[..count], squared)
}

/// The same among other boxes, each by its left, right, lower and upper side.
pub(crate) fn boxes_among(steps: usize, obstacles: &[[f64; 4]], squared: bool) -> Model {
    let (dt, size, fast, strong) = (0.5, 10.0, 2.0, 1.5);
    let mut rows = Rows::new("boxes");
    let mut axes = Vec::new();
    for axis in ["x", "y"] {
        let x = rows.family(axis, steps + 1, 0.0, size);
        let v = rows.family(&format!("v{axis}"), steps + 1, -fast, fast);
        let a = rows.family(&format!("a{axis}"), steps, -strong, strong);
        for (variable, value) in [(x[0], 0.5), (v[0], 0.0), (x[steps], 9.5), (v[steps], 0.0)] {
            rows.fix(variable, value);
        }
        let effort = match squared {
            true => Vec::new(),
            false => rows.family(&format!("effort{axis}"), steps, 0.0, strong),
        };
        for t in 0..steps {
            let drift = [(x[t + 1], 1.0), (x[t], -1.0), (v[t], -dt), (a[t], -0.5 * dt * dt)];
            rows.row(&drift, 0.0, 0.0);
            rows.row(&[(v[t + 1], 1.0), (v[t], -1.0), (a[t], -dt)], 0.0, 0.0);
            match effort.get(t) {
                None => rows.cost.add_product(1.0, a[t], a[t]),
                Some(&w) => {
                    rows.cost += Quadratic::from(Affine::from(w));
                    rows.row(&[(w, 1.0), (a[t], -1.0)], 0.0, INF);
                    rows.row(&[(w, 1.0), (a[t], 1.0)], 0.0, INF);
                }
            }
        }
        axes.push(x);
    }
    let inner = axes[0].iter().zip(&axes[1]).enumerate().take(steps).skip(1);
    for (t, (&x, &y)) in inner {
        for (b, &[left, right, below, above]) in obstacles.iter().enumerate() {
            let z = rows.binaries(&format!("side{t}_{b}"), 4);
            rows.row(&z.iter().map(|&z| (z, 1.0)).collect::<Terms>(), 1.0, INF);
            let (x, y) = ([(x, 1.0)], [(y, 1.0)]);
            rows.implies(z[0], true, &x, -INF, left);
            rows.implies(z[1], true, &x, right, INF);
            rows.implies(z[2], true, &y, -INF, below);
            rows.implies(z[3], true, &y, above, INF);
        }
    }
    rows.finish()
}

/// A puck in a box that bounces off four walls with restitution 0.7 and steers with little effort.
pub(crate) fn puck(steps: usize, dt: f64) -> Model {
    let (e, fast, strong) = (0.7, 3.0, 0.8);
    let mut rows = Rows::new("puck");
    for (axis, size, [x0, v0, goal]) in [("x", 6.0, [1.0, -1.2, 5.0]), ("y", 4.0, [3.0, 0.6, 1.0])]
    {
        let x = rows.family(axis, steps + 1, 0.0, size);
        let v = rows.family(&format!("v{axis}"), steps + 1, -fast, fast);
        let a = rows.family(&format!("a{axis}"), steps, -strong, strong);
        let reach = fast * dt + strong * dt * dt;
        let p = rows.family(&format!("p{axis}"), steps, -reach, size + reach);
        let w = rows.family(&format!("w{axis}"), steps, -fast - strong * dt, fast + strong * dt);
        let low = rows.binaries(&format!("low{axis}"), steps);
        let high = rows.binaries(&format!("high{axis}"), steps);
        for (variable, value) in [(x[0], x0), (v[0], v0), (x[steps], goal), (v[steps], 0.0)] {
            rows.fix(variable, value);
        }
        for t in 0..steps {
            let flight = [(p[t], 1.0), (x[t], -1.0), (v[t], -dt), (a[t], -0.5 * dt * dt)];
            rows.row(&flight, 0.0, 0.0);
            rows.row(&[(w[t], 1.0), (v[t], -1.0), (a[t], -dt)], 0.0, 0.0);
            rows.row(&[(low[t], 1.0), (high[t], 1.0)], -INF, 1.0);
            let (there, x1, v1) = ([(p[t], 1.0)], x[t + 1], v[t + 1]);
            rows.implies(low[t], true, &there, -INF, 0.0);
            rows.implies(low[t], false, &there, 0.0, INF);
            rows.implies(high[t], true, &there, size, INF);
            rows.implies(high[t], false, &there, -INF, size);
            let rebound = (1.0 + e) * size;
            rows.implies(low[t], true, &[(x1, 1.0), (p[t], e)], 0.0, 0.0);
            rows.implies(low[t], true, &[(v1, 1.0), (w[t], e)], 0.0, 0.0);
            rows.implies(high[t], true, &[(x1, 1.0), (p[t], e)], rebound, rebound);
            rows.implies(high[t], true, &[(v1, 1.0), (w[t], e)], 0.0, 0.0);
            for (next, free) in [(x1, p[t]), (v1, w[t])] {
                let same = [(next, 1.0), (free, -1.0)];
                let range = rows.model.range(&affine(&same)).unwrap();
                let with = |m: f64| [&same[..], &[(low[t], m), (high[t], m)]].concat();
                rows.row(&with(-range.upper), -INF, 0.0);
                rows.row(&with(-range.lower), 0.0, INF);
            }
            rows.cost.add_product(1.0, a[t], a[t]);
        }
    }
    rows.finish()
}

/// Programs beside each other: variables and rows of all of them, and the sum of their objectives.
pub(crate) fn beside(models: &[Model]) -> Model {
    let mut rows = Rows::new("beside");
    for (k, model) in models.iter().enumerate() {
        let mut copies = Vec::new();
        for variable in model.variables() {
            let (name, bounds) = (format!("part{k}"), variable.bounds());
            let name = (&name[..], copies.len());
            let copy = rows.model.variable(name, variable.kind(), bounds.lower, bounds.upper);
            copies.push(copy.unwrap());
        }
        for row in model.constraints() {
            let terms = row.terms().iter().map(|&(v, a)| (copies[v.index()], a));
            rows.row(&terms.collect::<Terms>(), row.limits().lower, row.limits().upper);
        }
        for (a, b, q) in model.objective().products() {
            rows.cost.add_product(q, copies[a.index()], copies[b.index()]);
        }
        let linear = model.objective().affine().terms().into_iter();
        let linear: Affine = linear.map(|(v, a)| a * copies[v.index()]).sum();
        rows.cost += Quadratic::from(linear + model.objective().affine().offset());
    }
    rows.finish()
}
