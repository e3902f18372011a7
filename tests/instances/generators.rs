//! Hybrid control programs as other solvers get them: plain rows with big-Ms from interval bounds,
//! quadratic costs, and nothing that tells a solver where they come from.

use carom::prelude::*;

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
    fn quadratic<const N: usize>(&mut self, x: [Variable; N], q: &[[f64; N]; N]) {
        for i in 0..N {
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

/// The solution of the discrete algebraic Riccati equation for one input, by iteration.
fn riccati(a: [[f64; 2]; 2], b: [f64; 2], q: [[f64; 2]; 2], r: f64) -> [[f64; 2]; 2] {
    let product = |p: [[f64; 2]; 2], q: [[f64; 2]; 2]| {
        [0, 1].map(|i| [0, 1].map(|j| p[i][0] * q[0][j] + p[i][1] * q[1][j]))
    };
    let transposed = |p: [[f64; 2]; 2]| [[p[0][0], p[1][0]], [p[0][1], p[1][1]]];
    let mut p = q;
    for _ in 0..20_000 {
        let pa = product(p, a);
        let pb = [0, 1].map(|i| p[i][0] * b[0] + p[i][1] * b[1]);
        let bpa = [0, 1].map(|j| b[0] * pa[0][j] + b[1] * pa[1][j]);
        let weight = r + b[0] * pb[0] + b[1] * pb[1];
        let apa = product(transposed(a), pa);
        p = [0, 1].map(|i| [0, 1].map(|j| q[i][j] + apa[i][j] - bpa[i] * bpa[j] / weight));
    }
    p
}

/// An inverted pendulum beside an elastic wall: two affine modes a step, by big-M.
pub(crate) fn pendulum(steps: usize, start: [f64; 2]) -> Model {
    let (h, gravity, stiffness, gap) = (0.01, 10.0, 100.0, 0.1);
    let free = [[1.0, h], [h * gravity, 1.0]];
    let touching = [[1.0, h], [h * (gravity - stiffness), 1.0]];
    let push = [0.0, h];
    let mut rows = Rows::new("pendulum");
    let angle = rows.family("angle", steps + 1, -2.0 * gap, 2.0 * gap);
    let rate = rows.family("rate", steps + 1, -1.5, 1.5);
    let u = rows.family("u", steps, -4.0, 4.0);
    let (z0, z1) = (rows.binaries("free", steps), rows.binaries("touching", steps));
    rows.fix(angle[0], start[0]);
    rows.fix(rate[0], start[1]);
    for t in 0..steps {
        rows.row(&[(z0[t], 1.0), (z1[t], 1.0)], 1.0, 1.0);
        let now = [angle[t], rate[t]];
        let modes = [(z0[t], free, 0.0, 1.0), (z1[t], touching, h * stiffness * gap, -1.0)];
        for (z, matrix, constant, side) in modes {
            for (i, next) in [angle[t + 1], rate[t + 1]].into_iter().enumerate() {
                let mut terms = vec![(next, 1.0)];
                terms.extend((0..2).map(|j| (now[j], -matrix[i][j])));
                terms.push((u[t], -push[i]));
                terms.retain(|(_, a)| *a != 0.0);
                let c = if i == 1 { constant } else { 0.0 };
                rows.implies(z, true, &terms, c, c);
            }
            rows.implies(z, true, &[(angle[t], side)], -INF, side * gap);
        }
    }
    let identity = [[1.0, 0.0], [0.0, 1.0]];
    let last = riccati(free, push, identity, 1.0);
    for t in 0..=steps {
        rows.quadratic([angle[t], rate[t]], if t == steps { &last } else { &identity });
    }
    u.iter().for_each(|&u| rows.cost.add_product(0.5, u, u));
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
        for (b, [left, right, below, above]) in BOXES.into_iter().take(count).enumerate() {
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
