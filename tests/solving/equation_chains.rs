//! Chains of equations `x+ = A x + B u` as plain models: each multiplies what is missed in the ones
//! before, so answers are compared with runs in rational numbers.

#![expect(clippy::needless_range_loop, reason = "matrices and samples share their indices")]

use crate::torture::complementarity::double;
use crate::torture::generator::Random;
use carom::model::lp;
use carom::prelude::*;
use num_rational::BigRational;

type Rational = BigRational;

/// How far an accepted point may be from the run that follows from its start, absolute and
/// relative: equations that multiply errors by less than 100 in all keep the tolerances of methods.
const CLOSE: [f64; 2] = [1e-7, 1e-9];

fn exact(value: f64) -> Rational {
    Rational::from_float(value).expect("a finite number")
}

fn zero() -> Rational {
    exact(0.0)
}

fn size(value: &Rational) -> Rational {
    if *value < zero() { -value.clone() } else { value.clone() }
}

/// Solves a small square system; `None` where it is singular.
fn solved(mut rows: Vec<Vec<Rational>>) -> Option<Vec<Rational>> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).find(|&i| rows[i][k] != zero())?;
        rows.swap(k, pivot);
        for i in 0..n {
            if i != k && rows[i][k] != zero() {
                let factor = rows[i][k].clone() / rows[k][k].clone();
                for j in k..=n {
                    let part = factor.clone() * rows[k][j].clone();
                    rows[i][j] -= part;
                }
            }
        }
    }
    Some((0..n).map(|k| rows[k][n].clone() / rows[k][k].clone()).collect())
}

/// A decimal of one or two digits.
fn decimal(r: &mut Random, most: i32) -> f64 {
    f64::from(r.within(-10 * most, 10 * most)) / 10.0
}

/// A model over `steps + 1` copies of `states` columns in random order.
struct Chain {
    model: Model,
    x: Vec<Vec<Variable>>,
}

/// A chain without inputs, and its run.
///
/// # Arguments
///
/// * `far`: the bounds of states after the start, infinite for none.
struct Free {
    matrix: Vec<Vec<f64>>,
    ends: Vec<f64>,
    /// Whether the last state is given, rather than the first.
    backward: bool,
    steps: usize,
    far: f64,
    goal: Option<f64>,
}

impl Free {
    fn random(r: &mut Random) -> Free {
        let (states, steps) = (1 + r.below(3), 1 + r.below(60));
        let gain = [1, 2, 5, 10][r.below(4)];
        let matrix = (0..states).map(|i| {
            (0..states)
                .map(|j| match i == j {
                    true => f64::from(r.within(-10 * gain, 10 * gain)) / 10.0,
                    false if r.chance(0.5) => decimal(r, 2),
                    false => 0.0,
                })
                .collect()
        });
        let matrix: Vec<Vec<f64>> = matrix.collect();
        let at_rest = r.chance(0.5);
        let ends = (0..states)
            .map(|_| if at_rest || r.chance(0.3) { 0.0 } else { decimal(r, 1) })
            .collect();
        let far = [f64::INFINITY, 10.0, 1e6][r.below(3)];
        let goal = r.chance(0.5).then(|| [1.0, -0.5, 1e-3, 100.0, 0.0][r.below(5)]);
        Free { matrix, ends, backward: r.chance(0.3), steps, far, goal }
    }

    /// The states from the start to the end; `None` if there is not one run.
    fn run(&self) -> Option<Vec<Vec<Rational>>> {
        let n = self.ends.len();
        let mut run = vec![self.ends.iter().map(|&v| exact(v)).collect::<Vec<_>>()];
        for _ in 0..self.steps {
            let last = run.last()?;
            let next = if self.backward {
                let row = |i: usize| {
                    let own = self.matrix[i].iter().map(|&a| exact(a));
                    own.chain([last[i].clone()]).collect()
                };
                solved((0..n).map(row).collect())?
            } else {
                let sum = |i: usize| {
                    (0..n).fold(zero(), |sum, j| sum + exact(self.matrix[i][j]) * last[j].clone())
                };
                (0..n).map(sum).collect()
            };
            run.push(next);
        }
        if self.backward {
            run.reverse();
        }
        Some(run)
    }

    fn model(&self, r: &mut Random) -> Chain {
        let (n, steps) = (self.ends.len(), self.steps);
        let mut order: Vec<(usize, usize)> =
            (0..=steps).flat_map(|k| (0..n).map(move |i| (k, i))).collect();
        let mixed = r.chance(0.4);
        if mixed {
            shuffle(r, &mut order);
        }
        let mut model = Model::new("chain");
        let given = if self.backward { steps } else { 0 };
        let by_rows = r.chance(0.5);
        let mut handles = vec![vec![None; n]; steps + 1];
        for (k, i) in order {
            let (lower, upper) = match k == given {
                true if !by_rows => (self.ends[i], self.ends[i]),
                true => (f64::NEG_INFINITY, f64::INFINITY),
                false => (-self.far, self.far),
            };
            let x = model.continuous(format!("x{i}_{k}"), lower, upper).unwrap();
            handles[k][i] = Some(x);
        }
        let x: Vec<Vec<Variable>> =
            handles.into_iter().map(|row| row.into_iter().flatten().collect()).collect();
        let mut rows = Vec::new();
        for k in 0..steps {
            for i in 0..n {
                let mut row = Affine::from(x[k + 1][i]);
                for j in 0..n {
                    row += -self.matrix[i][j] * x[k][j];
                }
                rows.push((row, 0.0));
            }
        }
        if by_rows {
            for i in 0..n {
                rows.push((Affine::from(x[given][i]), self.ends[i]));
            }
        }
        if mixed {
            shuffle(r, &mut rows);
        }
        let scaled = r.chance(0.3);
        for (k, (mut row, right)) in rows.into_iter().enumerate() {
            // Powers of two leave the solution as it is.
            let factor = if scaled { f64::from(r.within(-12, 12)).exp2() } else { 1.0 };
            row *= factor;
            model.add(format!("r{k}"), row.equals(factor * right)).unwrap();
        }
        if let Some(goal) = self.goal {
            let row = Affine::from(x[steps - given][0]);
            model.add("goal", if goal >= 0.0 { row.ge(goal) } else { row.le(goal) }).unwrap();
        }
        Chain { model, x }
    }

    /// The largest violation of bounds and the goal by the run, relative; negative if there is
    /// none.
    fn excess(&self, run: &[Vec<Rational>]) -> f64 {
        let given = if self.backward { self.steps } else { 0 };
        let mut worst = -1.0_f64;
        let mut note = |value: &Rational, lower: f64, upper: f64| {
            let value = double(value);
            let unit = value.abs().max(1.0);
            worst = worst.max((lower - value) / unit).max((value - upper) / unit);
        };
        for (_, states) in run.iter().enumerate().filter(|(k, _)| *k != given) {
            states.iter().for_each(|value| note(value, -self.far, self.far));
        }
        if let Some(goal) = self.goal {
            let value = &run[self.steps - given][0];
            let infinite = f64::INFINITY;
            match goal >= 0.0 {
                true => note(value, goal, infinite),
                false => note(value, -infinite, goal),
            }
        }
        worst
    }
}

fn shuffle<T>(r: &mut Random, items: &mut [T]) {
    for i in (1..items.len()).rev() {
        items.swap(i, r.below(i + 1));
    }
}

fn ways() -> [Options; 3] {
    let plain = Options::default().with_presolve(false);
    let mut leaves = Options::default();
    leaves.parts_mut().keep_leaves = true;
    [Options::default(), plain, leaves]
}

/// Judges the answers to a chain without inputs: an error message, or whether it was solved.
pub(crate) fn judge_free(seed: u64) -> Result<bool, String> {
    let r = &mut Random::new(seed);
    let free = Free::random(r);
    let Some(run) = free.run() else { return Ok(true) };
    let Chain { mut model, x } = free.model(r);
    let excess = free.excess(&run);
    let (k, i) = (r.below(run.len()), r.below(run[0].len()));
    if r.chance(0.7) {
        let cost = Affine::from(x[k][i]);
        if r.chance(0.5) { model.minimize(cost) } else { model.maximize(cost) }.unwrap();
    }
    let largest = run.iter().flatten().map(|v| double(v).abs()).fold(0.0, f64::max);
    let mut is_solved = true;
    for options in ways() {
        let solution =
            BranchAndBound::new(options.clone()).solve(&model).map_err(|e| e.to_string())?;
        let fail = |what: &str| {
            Err(format!(
                "{what}: {:?} {:?}, bound {}; the run has {:e} there, excess {excess:e}, largest {largest:e}, presolve {}\n{}",
                solution.termination(),
                solution.objective(),
                solution.bound(),
                double(&run[k][i]),
                options.parts().reductions,
                lp::write(&model).unwrap_or_default()
            ))
        };
        let has_point = solution.point().is_some();
        if excess > 2e-6 {
            if has_point
                || solution.is_optimal()
                || solution.termination() == Termination::Unbounded
            {
                return fail("infeasible");
            }
            is_solved &= solution.is_infeasible();
            continue;
        }
        // Beyond this a search without bounds does not look; and between, a point within the
        // tolerance is one.
        if largest > 1e9 || excess > 0.0 {
            continue;
        }
        if solution.is_infeasible() || solution.termination() == Termination::Unbounded {
            return fail("feasible");
        }
        is_solved &= solution.is_optimal();
        let Some(point) = solution.point() else { continue };
        for (k, states) in run.iter().enumerate() {
            for (i, state) in states.iter().enumerate() {
                let (value, right) = (point.value(x[k][i]).unwrap(), double(state));
                if (value - right).abs() > CLOSE[0] + CLOSE[1] * right.abs() {
                    return fail(&format!("x{i}_{k} is {value:e} and not {right:e}"));
                }
            }
        }
        if solution.is_optimal()
            && (solution.bound() - solution.objective().unwrap_or(0.0)).abs()
                > 2e-6 * largest.max(1.0)
        {
            return fail("gap");
        }
    }
    Ok(is_solved)
}

/// `x+ = g x + b u` with one state between bounds, whose reachable values are an interval.
#[expect(clippy::too_many_lines, reason = "a program and what it is to answer, in their order")]
pub(crate) fn judge_driven(seed: u64) -> Result<bool, String> {
    let r = &mut Random::new(seed);
    let steps = 1 + r.below(60);
    let most = [2, 5, 10][r.below(3)];
    let gain = decimal(r, most);
    let far = [1.0, 10.0, 1000.0][r.below(3)];
    let push = [1.0, 0.1, 3.0][r.below(3)];
    let lower = if r.chance(0.5) { 0.0 } else { -f64::from(r.within(0, 10)) / 10.0 };
    let upper = if r.chance(0.1) { 0.0 } else { f64::from(r.within(0, 10)) / 10.0 };
    let start = if r.chance(0.5) { 0.0 } else { decimal(r, 1) };
    let whole = r.chance(0.3) && steps <= 8;
    let (lower, upper) = if whole { (0.0, f64::from(r.within(0, 2))) } else { (lower, upper) };
    let mut model = Model::new("driven");
    let mut x = vec![model.continuous("x0", start, start).unwrap()];
    let mut reached = vec![(exact(start), exact(start))];
    for k in 0..steps {
        let next = model.continuous(format!("x{}", k + 1), -far, far).unwrap();
        let u = match whole {
            true => model.integer(format!("u{k}"), lower, upper),
            false => model.continuous(format!("u{k}"), lower, upper),
        };
        let row = next - gain * x[k] - push * u.unwrap();
        model.add(format!("r{k}"), row.equals(0.0)).unwrap();
        x.push(next);
        if whole {
            // Every value apart.
            let mut all: Vec<Rational> = Vec::new();
            for (value, _) in &reached {
                for u in 0..=upper as i32 {
                    let value = exact(gain) * value.clone() + exact(push) * exact(f64::from(u));
                    if size(&value) <= exact(far) {
                        all.push(value);
                    }
                }
            }
            all.sort();
            all.dedup();
            reached = all.into_iter().map(|v| (v.clone(), v)).collect();
            continue;
        }
        let mut all = Vec::new();
        for (low, high) in &reached {
            let (low, high) = if gain < 0.0 { (high, low) } else { (low, high) };
            let low = exact(gain) * low.clone() + exact(push) * exact(lower);
            let high = exact(gain) * high.clone() + exact(push) * exact(upper);
            let (low, high) = (low.max(exact(-far)), high.min(exact(far)));
            if low <= high {
                all.push((low, high));
            }
        }
        reached = all;
    }
    let maximize = r.chance(0.5);
    let last = x[steps];
    let goal = r.chance(0.4).then(|| far * [0.5, 0.999, 1e-3, 0.11][r.below(4)]);
    if let Some(goal) = goal {
        model.add("goal", last.ge(goal)).unwrap();
        reached.retain(|(_, high)| *high >= exact(goal));
    }
    if maximize { model.maximize(Affine::from(last)) } else { model.minimize(Affine::from(last)) }
        .unwrap();
    let best = match maximize {
        true => reached.iter().map(|(_, high)| high).max().map(double),
        false => reached.iter().map(|(low, _)| low).min().map(double),
    };
    let best = best.map(|best| if maximize { best } else { best.max(goal.unwrap_or(-far)) });
    let mut is_solved = true;
    for options in ways() {
        let reductions = options.parts().reductions;
        let solution = BranchAndBound::new(options).solve(&model).map_err(|e| e.to_string())?;
        let fail = |what: &str| {
            Err(format!(
                "{what}: {:?} {:?} bound {}, right {best:?}, presolve {reductions}\n{}",
                solution.termination(),
                solution.objective(),
                solution.bound(),
                lp::write(&model).unwrap_or_default()
            ))
        };
        match best {
            None => {
                if solution.point().is_some() {
                    return fail("infeasible");
                }
                is_solved &= solution.is_infeasible();
            }
            Some(best) => {
                if solution.is_infeasible() {
                    return fail("feasible");
                }
                is_solved &= solution.is_optimal();
                if solution.is_optimal() {
                    let objective = solution.objective().unwrap_or(f64::NAN);
                    if (objective - best).abs() > 1e-5 * best.abs().max(1.0) {
                        return fail("objective");
                    }
                }
            }
        }
    }
    Ok(is_solved)
}

#[test]
fn chains_without_inputs_are_their_runs() {
    for seed in 0..60 {
        assert_eq!(judge_free(seed).err(), None, "seed {seed}");
    }
}

#[test]
fn chains_with_inputs_reach_what_they_can() {
    for seed in 0..120 {
        assert_eq!(judge_driven(seed).err(), None, "seed {seed}");
    }
}

fn answers(text: &str) -> Vec<Solution> {
    let model = lp::read(text).expect("a readable file").model;
    let solve = |options| BranchAndBound::new(options).solve(&model).expect("an answer");
    ways().into_iter().map(solve).collect()
}

/// Seven times 1000 makes 1 of 1e-21.
#[test]
fn what_follows_from_zero_is_zero() {
    let mut text = "Minimize\n a7\nSubject To\n s: a0 = 0\n".to_owned();
    for k in 0..7 {
        text += &format!(" c{k}: a{} - 1000 a{k} = 0\n", k + 1);
    }
    text += "Bounds\n";
    (0..8).for_each(|k| text += &format!(" a{k} free\n"));
    for solution in answers(&(text + "End\n")) {
        assert!(solution.is_optimal(), "{solution:?}");
        assert_eq!((solution.objective(), solution.bound()), (Some(0.0), 0.0));
    }
}

/// An inverted pendulum, upright and at rest, stays there.
#[test]
fn a_pendulum_at_rest_does_not_fall() {
    for bounded in [true, false] {
        let mut model = Model::new("pendulum");
        let far = |value: f64| if bounded { value } else { f64::INFINITY };
        let mut last: Option<[Variable; 2]> = None;
        for k in 0..=23 {
            let a = model.continuous(format!("a{k}"), -far(1.5), far(1.5)).unwrap();
            let w = model.continuous(format!("w{k}"), -far(9.0), far(9.0)).unwrap();
            if let Some([b, v]) = last {
                let angle = a - 2.498274772147942 * b - 0.7309508725618742 * v;
                let rate = w - 7.170628059831986 * b - 2.498274772147942 * v;
                model.add(format!("a_{k}"), angle.equals(0.0)).unwrap();
                model.add(format!("w_{k}"), rate.equals(0.0)).unwrap();
            } else {
                model.add("s", a.equals(0.0)).unwrap();
                model.add("r", w.equals(0.0)).unwrap();
            }
            last = Some([a, w]);
        }
        let [angle, _] = last.unwrap();
        model.add("g", angle.ge(1.0)).unwrap();
        for options in ways() {
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            assert!(solution.is_infeasible(), "{solution:?}");
        }
    }
}

/// Multipliers of equations that determine columns are restored: a start that is worth 10^4.
#[test]
fn prices_of_a_chain_are_known() {
    let mut model = Model::new("prices");
    let x: Vec<Variable> =
        (0..5).map(|k| model.continuous(format!("x{k}"), -1e9, 1e9).unwrap()).collect();
    let start = model.add("start", x[0].equals(0.5)).unwrap();
    for k in 0..4 {
        model.add(format!("step{k}"), (x[k + 1] - 10.0 * x[k]).equals(0.0)).unwrap();
    }
    model.minimize(Affine::from(x[4])).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert_eq!(solution.objective(), Some(5000.0));
    let multipliers = solution.multipliers().expect("multipliers");
    assert!((multipliers.shadow_price(start).unwrap() - 1e4).abs() < 1e-6, "{multipliers:?}");
}
