//! Random systems with modes over a few steps, and points of them by simulation.
//!
//! In each step one of some modes holds. It shifts the states, allows inputs up to its own limit,
//! asks for a state on one side of a guard, and has a cost of its own. The rows of a mode are
//! relaxed by a large constant where another one holds.

use carom::prelude::*;

/// Pseudo-random numbers.
#[derive(Debug, Clone)]
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    /// A whole number from `least` to `most`.
    pub(crate) fn within(&mut self, least: i32, most: i32) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let count = (most - least + 1) as u64;
        f64::from(least) + ((self.0 >> 33) % count) as f64
    }
}

/// The states are within this distance of 0, and the inputs of any mode.
const FAR: f64 = 6.0;
const MOST_INPUT: f64 = 3.0;

/// The constant of relaxed rows.
const LARGE: f64 = 40.0;

#[derive(Debug, Clone)]
struct Mode {
    shift: Vec<f64>,
    /// How far an input moves each state.
    gain: Vec<f64>,
    most_input: f64,
    /// The state of the guard, its sign and its limit: sign times state is at most the limit.
    guard: (usize, f64, f64),
    /// The cost of a step, and of the input.
    cost: [f64; 2],
}

#[derive(Debug, Clone)]
pub(crate) struct ModeSteps {
    modes: Vec<Mode>,
    states: usize,
    pub(crate) horizon: usize,
    /// What the sum of the states at the end is at least.
    goal: f64,
}

/// The variables of a step: the states, the input, the cost, and whether each mode holds. The
/// states after the last step follow.
impl ModeSteps {
    /// A system of 2 to 5 modes with 1 or 2 states, so that a step has up to 4 variables.
    pub(crate) fn random(numbers: &mut Numbers, horizon: usize) -> Self {
        let states = numbers.within(1, 2) as usize;
        let count = numbers.within(2, 5) as usize;
        let mode = |numbers: &mut Numbers| Mode {
            shift: (0..states).map(|_| numbers.within(-2, 2)).collect(),
            gain: (0..states).map(|_| numbers.within(-1, 1)).collect(),
            most_input: numbers.within(0, MOST_INPUT as i32),
            guard: (
                numbers.within(1, states as i32) as usize - 1,
                2.0 * numbers.within(0, 1) - 1.0,
                numbers.within(0, 6),
            ),
            cost: [numbers.within(0, 9), numbers.within(-2, 2)],
        };
        let modes = (0..count).map(|_| mode(numbers)).collect();
        ModeSteps { modes, states, horizon, goal: numbers.within(-2, 4) }
    }

    /// The program; relaxed, its binaries are continuous.
    pub(crate) fn model(&self, is_relaxed: bool) -> Result<Model, Error> {
        let mut model = Model::new("steps");
        let mut cost = Affine::from(0.0);
        let mut before: Option<(Vec<Variable>, Variable, Vec<Variable>)> = None;
        for step in 0..=self.horizon {
            let state = |i: usize| format!("x[{step}][{i}]");
            let x: Vec<Variable> = (0..self.states)
                .map(|i| model.continuous(state(i), -FAR, FAR))
                .collect::<Result<_, _>>()?;
            if let Some((old, u, on)) = before {
                self.add_moves(&mut model, step, &old, u, &on, &x)?;
            }
            if step == self.horizon {
                model.add("goal", x.iter().map(|x| *x * 1.0).sum::<Affine>().ge(self.goal))?;
                break;
            }
            let u = model.continuous(format!("u[{step}]"), -MOST_INPUT, MOST_INPUT)?;
            let y = model.continuous(format!("y[{step}]"), 0.0, LARGE)?;
            let on: Vec<Variable> = (0..self.modes.len())
                .map(|k| match is_relaxed {
                    true => model.continuous(format!("on[{step}][{k}]"), 0.0, 1.0),
                    false => model.binary(format!("on[{step}][{k}]")),
                })
                .collect::<Result<_, _>>()?;
            model.add(
                format!("one[{step}]"),
                on.iter().map(|z| *z * 1.0).sum::<Affine>().equals(1.0),
            )?;
            for (k, (mode, z)) in self.modes.iter().zip(&on).enumerate() {
                let name = |what: &str| format!("{what}[{step}][{k}]");
                let slack = |large: f64| (1.0 - *z) * large;
                let (i, sign, limit) = mode.guard;
                model.add(name("guard"), (x[i] * sign - slack(LARGE)).le(limit))?;
                model.add(name("most"), (u * 1.0 - slack(LARGE)).le(mode.most_input))?;
                model.add(name("least"), (u * 1.0 + slack(LARGE)).ge(-mode.most_input))?;
                model.add(name("cost"), (y - u * mode.cost[1] + slack(LARGE)).ge(mode.cost[0]))?;
            }
            cost += y * 1.0;
            before = Some((x, u, on));
        }
        model.minimize(cost)?;
        Ok(model)
    }

    fn add_moves(
        &self,
        model: &mut Model,
        step: usize,
        old: &[Variable],
        u: Variable,
        on: &[Variable],
        new: &[Variable],
    ) -> Result<(), Error> {
        for (k, (mode, z)) in self.modes.iter().zip(on).enumerate() {
            for i in 0..self.states {
                let moved = new[i] - old[i] - u * mode.gain[i];
                let slack = (1.0 - *z) * LARGE;
                let name = |what: &str| format!("{what}[{step}][{k}][{i}]");
                model.add(name("up"), (moved.clone() - slack.clone()).le(mode.shift[i]))?;
                model.add(name("down"), (moved + slack).ge(mode.shift[i]))?;
            }
        }
        Ok(())
    }

    /// A point of the program by a random walk, or `None` if the walk is not allowed.
    pub(crate) fn walk(&self, numbers: &mut Numbers) -> Option<Vec<f64>> {
        let mut point = Vec::new();
        let halves = |numbers: &mut Numbers| 0.5 * numbers.within(-12, 12);
        let mut x: Vec<f64> = (0..self.states).map(|_| halves(numbers)).collect();
        for _ in 0..self.horizon {
            let k = numbers.within(1, self.modes.len() as i32) as usize - 1;
            let mode = &self.modes[k];
            let (i, sign, limit) = mode.guard;
            // Onto the guard, where vertices are, if the walk has just begun.
            if point.is_empty() && numbers.within(0, 1) > 0.0 {
                x[i] = sign * limit;
            }
            if sign * x[i] > limit {
                return None;
            }
            let u = match numbers.within(0, 3) as u32 {
                0 => mode.most_input,
                1 => -mode.most_input,
                _ => (0.5 * numbers.within(-6, 6)).clamp(-mode.most_input, mode.most_input),
            };
            let least = (mode.cost[0] + mode.cost[1] * u).max(0.0);
            point.extend_from_slice(&x);
            point.extend([u, if numbers.within(0, 3) > 0.0 { least } else { LARGE }]);
            point.extend((0..self.modes.len()).map(|other| f64::from(u8::from(other == k))));
            for (i, x) in x.iter_mut().enumerate() {
                *x += mode.shift[i] + mode.gain[i] * u;
            }
            if x.iter().any(|x| x.abs() > FAR) {
                return None;
            }
        }
        point.extend_from_slice(&x);
        (x.iter().sum::<f64>() >= self.goal).then_some(point)
    }
}
