//! A cart-pole between two soft walls that move: the constants and costs of X. Lin, "Accelerating
//! hybrid model predictive control using warm-started generalized Benders decomposition"
//! (arXiv:2406.00780), as a system whose walls are states that do not change, and as a program
//! in which the measured state and the walls are parameters; a plant; and disturbances from a seed,
//! distributed as the published ones.

use carom::hybrid::{Lqr, Matrix};
use carom::prelude::*;

use super::random_miqp::Random;

/// Steps of the published horizon.
pub(crate) const HORIZON: usize = 10;
/// The time of a planned step, in s.
pub(crate) const STEP: f64 = 0.02;
/// Masses of cart and pole, in kg; length of the pole, in m; stiffness of the walls, in N/m.
const CART: f64 = 1.0;
const POLE: f64 = 0.4;
const LENGTH: f64 = 0.6;
const STIFFNESS: f64 = 50.0;
const GRAVITY: f64 = 9.81;
/// Where the walls are while they do not move, left and right of the middle, in m.
const WALLS: [f64; 2] = [0.40, 0.35];
/// Between which distances from the middle a wall moves, in m.
const NEAREST: f64 = 0.2;
const FARTHEST: f64 = 0.6;
/// Limits of position, angle and their rates, of the force on the cart and of those of the walls.
const MOST: [f64; 4] = [0.6, std::f64::consts::FRAC_PI_2, 1.2 / STEP, std::f64::consts::PI / STEP];
const MOST_PUSH: f64 = 20.0;
const MOST_CONTACT: f64 = 30.0;
/// Squared states and forces cost so much.
const STATE_COSTS: [f64; 4] = [1.0, 50.0, 1.0, 50.0];
const FORCE_COST: f64 = 0.1;
/// The time for which a disturbance lasts, in s.
pub(crate) const GUST: f64 = 0.005;

/// A model of so many steps, and its first force. The parameters are, in this order, position,
/// angle, their rates, and the distances of the left and of the right wall from the middle.
pub(crate) struct MovingWalls {
    pub(crate) model: Model,
    pub(crate) push: Affine,
}

impl MovingWalls {
    pub(crate) fn new(steps: usize) -> Result<Self, Error> {
        let mut cart = HybridSystem::new(STEP);
        let x = cart.state("x", -MOST[0], MOST[0])?;
        let angle = cart.state("angle", -MOST[1], MOST[1])?;
        let v = cart.state("v", -MOST[2], MOST[2])?;
        let rate = cart.state("rate", -MOST[3], MOST[3])?;
        let walls = [
            cart.state("left_wall", NEAREST, FARTHEST)?,
            cart.state("right_wall", NEAREST, FARTHEST)?,
        ];
        let push = cart.input("push", -MOST_PUSH, MOST_PUSH)?;
        let right = cart.input("right", 0.0, MOST_CONTACT)?;
        let left = cart.input("left", 0.0, MOST_CONTACT)?;
        // The linear motion about the upright pole, by Euler's method.
        let turn = (GRAVITY * (CART + POLE) / (LENGTH * CART)) * angle
            + (1.0 / (LENGTH * CART)) * push
            + (1.0 / (LENGTH * POLE)) * (right - left);
        let run = (GRAVITY * POLE / CART) * angle + (1.0 / CART) * push;
        cart.next([
            x.is(x + STEP * v),
            angle.is(angle + STEP * rate),
            v.is(v + STEP * run),
            rate.is(rate + STEP * turn),
        ])?;
        let tip = x - LENGTH * angle;
        let press = 1.0 / STIFFNESS;
        cart.complementarity("right", right, press * right + walls[1] - tip.clone())?;
        cart.complementarity("left", left, press * left + walls[0] + tip)?;

        let mut program = cart.program(steps)?;
        let states = [x, angle, v, rate];
        let mut cost: Quadratic = FORCE_COST * (push.square() + right.square() + left.square());
        for (state, each) in states.iter().zip(STATE_COSTS) {
            cost += each * state.square();
        }
        let mut total = program.sum(cost)?;
        let to_go = cost_to_go()?;
        let mut rest = Quadratic::zero();
        for i in 0..4 {
            for j in 0..4 {
                rest += to_go.cost[(i, j)] * (states[i] * states[j]);
            }
        }
        total += program.end(rest)?;
        program.minimize(total)?;
        let ranges = MOST.map(|most| -most..=most);
        program.open_start(states.into_iter().zip(ranges))?;
        program.open_start(walls.map(|wall| (wall, NEAREST..=FARTHEST)))?;
        let push = program.at(push, 0)?;
        Ok(MovingWalls { push, model: program.model().clone() })
    }
}

/// The cost from the end of the horizon on: that of a regulator which steers by all three forces,
/// as published.
fn cost_to_go() -> Result<Lqr, Error> {
    let (fall, lever) = (STEP * GRAVITY, STEP / LENGTH);
    let a = [
        [1.0, 0.0, STEP, 0.0],
        [0.0, 1.0, 0.0, STEP],
        [0.0, fall * POLE / CART, 1.0, 0.0],
        [0.0, fall * (CART + POLE) / (LENGTH * CART), 0.0, 1.0],
    ];
    let b =
        [[0.0; 3], [0.0; 3], [STEP / CART, 0.0, 0.0], [lever / CART, lever / POLE, -lever / POLE]];
    let system = LinearSystem::new(a, b, [0.0; 4])?;
    let q = Matrix::from_fn(4, 4, |i, j| if i == j { STATE_COSTS[i] } else { 0.0 });
    let r = Matrix::from_fn(3, 3, |i, j| if i == j { FORCE_COST } else { 0.0 });
    Lqr::new(&system, q, r)
}

/// What acts on the plant for the time of a gust: a torque on the pole (N m), and where the left
/// and the right wall are (m).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gust {
    pub(crate) torque: f64,
    pub(crate) walls: [f64; 2],
}

impl Gust {
    /// Nothing acts, and the walls are where they are while they do not move.
    pub(crate) const CALM: Gust = Gust { torque: 0.0, walls: WALLS };

    /// # Arguments
    ///
    /// * `shift`: by how much the left and the right wall are farther from the middle.
    pub(crate) fn new(torque: f64, shift: [f64; 2]) -> Self {
        let walls = [WALLS[0] + shift[0], WALLS[1] + shift[1]];
        Gust { torque, walls: walls.map(|wall| wall.clamp(NEAREST, FARTHEST)) }
    }
}

/// Disturbances from a seed: normal torques of 4 N m, and walls on a sine of 1 cm and a random walk.
/// They are distributed as those of the published run of 100 s.
pub(crate) struct Gusts {
    random: Random,
    factor: f64,
    count: usize,
    walk: [f64; 2],
}

impl Gusts {
    /// # Arguments
    ///
    /// * `factor`: of the torques and of the motion of the walls.
    pub(crate) fn new(seed: u64, factor: f64) -> Self {
        Gusts { random: Random(seed), factor, count: 0, walk: [0.0; 2] }
    }
}

impl Iterator for Gusts {
    type Item = Gust;

    fn next(&mut self) -> Option<Gust> {
        for walk in &mut self.walk {
            *walk += 0.05 * GUST * self.random.normal();
        }
        let sine = 0.01 * (0.01 * std::f64::consts::PI * self.count as f64).sin();
        self.count += 1;
        let shift = self.walk.map(|walk| self.factor * (sine + walk));
        let torque = 4.0 * self.factor * self.random.normal();
        Some(Gust::new(torque, shift))
    }
}

/// The cart and the pole, a point mass on a rod, with springs as walls: position, angle (to the
/// left) and their rates after a time under one force and one gust.
pub(crate) fn after(state: [f64; 4], push: f64, gust: &Gust, seconds: f64) -> [f64; 4] {
    const FINE: f64 = 1e-4;
    let [mut x, mut angle, mut v, mut rate] = state;
    for _ in 0..(seconds / FINE).round() as usize {
        let (sine, cosine) = angle.sin_cos();
        let tip = x - LENGTH * sine;
        let [left, right] = gust.walls;
        let contact = STIFFNESS * ((-left - tip).max(0.0) - (tip - right).max(0.0));
        let lever = LENGTH * cosine;
        let twist = gust.torque - lever * contact;
        let pull = POLE * cosine * (GRAVITY * sine + twist / (POLE * LENGTH));
        let force = push + contact - POLE * LENGTH * sine * rate * rate + pull;
        let run = force / (CART + POLE * sine * sine);
        let turn = (run * cosine + GRAVITY * sine) / LENGTH + twist / (POLE * LENGTH * LENGTH);
        (v, rate) = (v + FINE * run, rate + FINE * turn);
        (x, angle) = (x + FINE * v, angle + FINE * rate);
    }
    [x, angle, v, rate]
}
