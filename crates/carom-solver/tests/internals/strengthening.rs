//! What is added to a program, or taken out of it, before the search keeps what it must keep.
//!
//! Random programs of binaries and small integers, made of the rows that the pieces look for
//! (sides of disjunctions, covering rows, knapsacks), are enumerated completely. Tightened
//! coefficients keep every whole point, and a projection keeps every point of the relaxation.

use crate::common::config;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{
    Domain, Reduced, project, reduce, tighten_big_ms, tighten_by_disjunctions, tighten_coefficients,
};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::Prover;
use proptest::prelude::*;

const REGRESSIONS: &str = "tests/regressions/strengthening.txt";

/// Binaries come first, then two integers within `0..=TOP`.
const BINARIES: usize = 6;
const OTHERS: usize = 2;
const TOP: i64 = 3;

/// What rows may be missed by through rounding.
const SLACK: f64 = 1e-7;

/// Excluding the case `a` decides for `c`, so the bound of `t` in the case `b` does not hold.
#[test]
fn an_excluded_case_that_decides_for_another_ends_the_hull() {
    let mut model = Model::new("decided");
    let [a, b, c] = ["a", "b", "c"].map(|name| model.binary(name).unwrap());
    let [t, w] = ["t", "w"].map(|name| model.continuous(name, 0.0, 1.0).unwrap());
    model.add("cover", (a + b + c).ge(1.0)).unwrap();
    model.add("low", (w - a).ge(0.0)).unwrap();
    model.add("high", (w + a).le(1.0)).unwrap();
    model.add("decides", (3.0 * a + 7.0 * b + 8.0 * c).ge(8.0)).unwrap();
    model.add("narrow", (t + 0.8 * b).le(1.0)).unwrap();
    model.maximize(t).unwrap();
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_by_disjunctions(&program, &StopToken::default());
    let upper = tight.map_or(program.upper[3], |tight| tight.upper[3]);
    assert_eq!(upper, 1.0);
    assert_eq!(BranchAndBound::default().solve(&model).unwrap().objective(), Some(1.0));
}

/// A row with many binaries, of which one switches it off, and points that show that the others do
/// not.
#[test]
fn a_big_m_among_many_binaries_becomes_what_a_linked_row_allows() {
    let mut model = Model::new("dense");
    let [x, y] = ["x", "y"].map(|name| model.continuous(name, 0.0, 10.0).unwrap());
    let [z, a, b] = ["z", "a", "b"].map(|name| model.binary(name).unwrap());
    model.add("off", (x + y - 50.0 * z + 0.1 * a + 0.1 * b).le(1.0)).unwrap();
    model.add("linked", (x + y + 0.1 * a + 0.1 * b).le(6.0)).unwrap();
    model.add("other", (x - y + 0.3 * z - 0.2 * a + 0.4 * b).le(3.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_big_ms(&program, &StopToken::default()).expect("a smaller M");
    let (columns, values) = tight.row(0);
    let at = columns.iter().position(|&j| j == z.index()).unwrap();
    assert!(
        (values[at] + 5.0).abs() < 1e-6 && (tight.row_upper[0] - 1.0).abs() < 1e-6,
        "{values:?}"
    );
}

#[derive(Debug, Clone)]
struct Case {
    /// Coefficients of all columns, lower limit, upper limit.
    rows: Vec<(Vec<i64>, Option<i64>, Option<i64>)>,
    cost: Vec<i64>,
}

fn case() -> impl Strategy<Value = Case> {
    let column = 0..BINARIES;
    let other = 0..OTHERS;
    let side =
        (column, other, any::<bool>(), 0..=TOP, 1..=TOP + 1).prop_map(|(z, x, down, at, m)| {
            let mut row = vec![0; BINARIES + OTHERS];
            let sign = if down { -1 } else { 1 };
            (row[z], row[BINARIES + x]) = (m, sign);
            (row, None, Some(sign * at + m))
        });
    let cover = (prop::collection::vec(0..=1i64, BINARIES), any::<bool>());
    let cover = cover.prop_map(|(mut row, exactly)| {
        row.extend([0; OTHERS]);
        (row, Some(1), exactly.then_some(1))
    });
    let knapsack = (prop::collection::vec(-4..=6i64, BINARIES + OTHERS), -2..=12i64, any::<bool>());
    let knapsack = knapsack.prop_map(|(row, limit, below)| {
        if below { (row, None, Some(limit)) } else { (row, Some(limit - 8), None) }
    });
    let row = prop_oneof![3 => side, 1 => cover, 2 => knapsack];
    let cost = prop::collection::vec(prop_oneof![Just(0i64), -3..=3i64], BINARIES + OTHERS);
    (prop::collection::vec(row, 1..8), cost).prop_map(|(rows, cost)| Case { rows, cost })
}

impl Case {
    fn program(&self, whole: bool) -> Program {
        Program::assemble(&self.model(whole)).unwrap()
    }

    /// The model; the last columns are integers, or continuous.
    fn model(&self, whole: bool) -> Model {
        let mut model = Model::new("case");
        let mut variables = Vec::new();
        for j in 0..BINARIES {
            variables.push(model.binary(format!("z{j}")).unwrap());
        }
        for j in 0..OTHERS {
            let name = format!("x{j}");
            variables.push(if whole {
                model.integer(name, 0.0, TOP as f64).unwrap()
            } else {
                model.continuous(name, 0.0, TOP as f64).unwrap()
            });
        }
        let sum = |row: &[i64]| {
            let mut sum = Affine::default();
            for (&v, &a) in variables.iter().zip(row).filter(|(_, a)| **a != 0) {
                sum += a as f64 * v;
            }
            sum
        };
        for (i, (row, lower, upper)) in self.rows.iter().enumerate() {
            if row.iter().all(|&a| a == 0) {
                continue;
            }
            let lower = lower.map_or(f64::NEG_INFINITY, |l| l as f64);
            let upper = upper.map_or(f64::INFINITY, |u| u as f64);
            model.add(format!("r{i}"), sum(row).within(lower, upper)).unwrap();
        }
        model.minimize(sum(&self.cost)).unwrap();
        model
    }

    /// All points in whole numbers that satisfy the rows.
    fn points(&self) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new()];
        for j in 0..BINARIES + OTHERS {
            let top = if j < BINARIES { 1 } else { TOP };
            points = points
                .into_iter()
                .flat_map(|p| (0..=top).map(move |v| [&p[..], &[v]].concat()))
                .collect();
        }
        points.retain(|p| {
            self.rows.iter().all(|(row, lower, upper)| {
                let sum: i64 = row.iter().zip(p).map(|(a, v)| a * v).sum();
                row.iter().all(|&a| a == 0)
                    || (lower.is_none_or(|l| l <= sum) && upper.is_none_or(|u| sum <= u))
            })
        });
        points.into_iter().map(|p| p.into_iter().map(|v| v as f64).collect()).collect()
    }
}

/// One step of a system in two modes: `next = a x + b u + c` on either side of `x = guard`, written
/// with big-Ms that are too large.
#[derive(Debug, Clone)]
struct System {
    /// Slope, gain of the input, constant, by mode.
    modes: [[f64; 3]; 2],
    guard: f64,
    /// By how much the Ms are larger than need be, and what each row is multiplied by.
    slack: f64,
    scale: Vec<f64>,
}

fn system() -> impl Strategy<Value = System> {
    let number = || prop_oneof![-2.0..2.0f64, Just(0.0), Just(1.0)];
    let mode = || [number(), number(), number()];
    let scale = prop::collection::vec(prop_oneof![Just(1.0), 1e-3..1e3f64], 6);
    ([mode(), mode()], -0.9..0.9f64, 0.0..50.0f64, scale)
        .prop_map(|(modes, guard, slack, scale)| System { modes, guard, slack, scale })
}

/// Bound of the next state and of what a mode says it is.
const NEXT: f64 = 10.0;

impl System {
    fn model(&self) -> Model {
        let mut model = Model::new("system");
        let x = model.continuous("x", -1.0, 1.0).unwrap();
        let u = model.continuous("u", -1.0, 1.0).unwrap();
        let next = model.continuous("next", -NEXT, NEXT).unwrap();
        let on = [model.binary("low").unwrap(), model.binary("high").unwrap()];
        model.add("one", (on[0] + on[1]).equals(1.0)).unwrap();
        for (k, &[a, b, c]) in self.modes.iter().enumerate() {
            let m = NEXT + a.abs() + b.abs() + c.abs() + self.slack;
            let [above, below, side] = [0, 1, 2].map(|i| self.scale[3 * k + i]);
            let miss = next - a * x - b * u - c;
            model
                .add(format!("above{k}"), (above * (miss.clone() + m * on[k])).le(above * m))
                .unwrap();
            model.add(format!("below{k}"), (below * (miss - m * on[k])).ge(-below * m)).unwrap();
            let beyond = if k == 0 { x - self.guard } else { self.guard - x };
            let m = 2.0 + self.slack;
            model.add(format!("side{k}"), (side * (beyond + m * on[k])).le(side * m)).unwrap();
        }
        model
    }

    /// What the system does in a mode, from shares of what state and input can be.
    fn point(&self, x: f64, u: f64, mode: usize) -> Option<Vec<f64>> {
        let [low, high] = if mode == 0 { [-1.0, self.guard] } else { [self.guard, 1.0] };
        let (x, u) = (low + x * (high - low), 2.0 * u - 1.0);
        let [a, b, c] = self.modes[mode];
        let next = a * x + b * u + c;
        let one = |k: usize| if mode == k { 1.0 } else { 0.0 };
        (next.abs() <= NEXT).then(|| vec![x, u, next, one(0), one(1)])
    }
}

/// The first row of a program that a point misses.
fn missed(program: &Program, point: &[f64]) -> Option<usize> {
    (0..program.row_count()).find(|&row| {
        let (columns, values) = program.row(row);
        let sum: f64 = columns.iter().zip(values).map(|(&j, a)| a * point[j]).sum();
        sum < program.row_lower[row] - SLACK || sum > program.row_upper[row] + SLACK
    })
}

/// The first row of a reduced program that a point misses.
fn missed_in(reduced: &Reduced, x: &[f64]) -> Option<usize> {
    (0..reduced.rows.len()).find(|&row| {
        let (columns, values) = reduced.rows.vector(row);
        let sum: f64 = columns.iter().zip(values).map(|(&k, a)| a * x[k]).sum();
        sum < reduced.row_lower[row] - SLACK || sum > reduced.row_upper[row] + SLACK
    })
}

fn restricted(reduced: &Reduced, point: &[f64]) -> Vec<f64> {
    reduced.columns.iter().map(|&j| point[j]).collect()
}

proptest! {
    #![proptest_config(config(200, REGRESSIONS))]

    #[test]
    fn tightened_coefficients_keep_whole_points(case in case()) {
        let program = case.program(false);
        let Some(mut reduced) = reduce(&program, &Domain::new(&program)) else {
            prop_assert!(case.points().is_empty());
            return Ok(());
        };
        tighten_coefficients(&mut reduced, &program.integral);
        for point in case.points() {
            let row = missed_in(&reduced, &restricted(&reduced, &point));
            prop_assert!(row.is_none(), "row {:?} at {:?}: {:?}", row, point, reduced);
        }
    }

    #[test]
    fn what_holds_in_every_case_keeps_whole_points(case in case()) {
        let program = case.program(false);
        if let Some(tight) = tighten_by_disjunctions(&program, &StopToken::default()) {
            for point in case.points() {
                let row = missed(&tight, &point);
                prop_assert!(row.is_none(), "row {:?} at {:?}: {:?}", row, point, tight);
                let outside = (0..point.len())
                    .find(|&j| point[j] < tight.lower[j] - SLACK || point[j] > tight.upper[j] + SLACK);
                prop_assert!(outside.is_none(), "column {:?} at {:?}: {:?}", outside, point, tight);
            }
        }
    }

    #[test]
    fn partners_keep_whole_points(case in case()) {
        let program = case.program(false);
        if let Some(tight) = tighten_big_ms(&program, &StopToken::default()) {
            for point in case.points() {
                let row = missed(&tight, &point);
                prop_assert!(row.is_none(), "row {:?} at {:?}: {:?}", row, point, tight);
            }
        }
    }

    /// Points of every mode, whatever the Ms and the scale of the rows.
    #[test]
    fn partners_keep_what_a_system_can_do(
        system in system(),
        at in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64, 0..2usize), 20),
    ) {
        let model = system.model();
        let program = Program::assemble(&model).unwrap();
        let tight = tighten_big_ms(&program, &StopToken::default());
        for (x, u, mode) in at {
            let Some(point) = system.point(x, u, mode) else { continue };
            prop_assert_eq!(missed(&program, &point), None);
            if let Some(tight) = &tight {
                let row = missed(tight, &point);
                prop_assert!(row.is_none(), "row {:?} at {:?}\n{}", row, point, model);
            }
        }
    }

    #[test]
    fn projections_keep_the_relaxation(case in case(), weights in prop::collection::vec(0.0..1.0, 3)) {
        let program = case.program(false);
        let points = case.points();
        let Some(reduced) = reduce(&program, &Domain::new(&program)) else {
            prop_assert!(points.is_empty());
            return Ok(());
        };
        let projection = project(reduced, &program.integral);
        for (k, point) in points.iter().enumerate() {
            // Means of points are points of the relaxation.
            let other = &points[(7 * k + 3) % points.len()];
            let share = weights[k % weights.len()];
            let mean: Vec<f64> =
                point.iter().zip(other).map(|(a, b)| share * a + (1.0 - share) * b).collect();
            for point in [point, &mean] {
                let x = restricted(&projection.reduced, point);
                let row = missed_in(&projection.reduced, &x);
                prop_assert!(row.is_none(), "row {:?} at {:?}: {:?}", row, point, projection);
                // The way back is a point of the relaxation where nothing is rounded to idle.
                let lifted = projection.lift(&x);
                for &j in &projection.reduced.columns {
                    prop_assert_eq!(lifted[j], point[j]);
                }
                let whole = lifted.iter().all(|v| v.fract() == 0.0);
                if whole {
                    let row = missed(&program, &lifted);
                    prop_assert!(row.is_none(), "row {:?} at {:?}: {:?}", row, lifted, projection);
                }
            }
        }
    }

    /// Splits into sides, whole values of relaxed points and all the rest together.
    #[test]
    fn disjunctions_have_the_optimum_of_an_enumeration(case in case(), threads in 1usize..=2) {
        let model = case.model(true);
        let mut solver = BranchAndBound::new(Options::default().with_threads(threads));
        let solution = solver.solve(&model).expect("a solvable model");
        let program = case.program(true);
        let values = case.points().into_iter().map(|p| program.objective(&p));
        let best = values.fold(f64::INFINITY, f64::min);
        if best == f64::INFINITY {
            prop_assert_eq!(solution.termination(), Termination::Infeasible, "{}", model);
        } else {
            prop_assert_eq!(solution.termination(), Termination::Optimal, "{}", model);
            let value = solution.objective().expect("a point");
            prop_assert!((value - best).abs() <= 1e-6, "{} instead of {}\n{}", value, best, model);
            prop_assert!(solution.bound() <= best + 1e-9, "{}\n{}", solution.bound(), model);
        }
    }

    /// Any point and any multipliers prove something; what they prove holds at every whole point.
    #[test]
    fn reduced_costs_hold_at_whole_points(
        case in case(),
        point in prop::collection::vec(-1.0..4.0f64, BINARIES + OTHERS),
        multipliers in prop::collection::vec(-3.0..3.0f64, 8),
    ) {
        let program = case.program(true);
        let Some(reduced) = reduce(&program, &Domain::new(&program)) else {
            return Ok(());
        };
        let (x, y) = (restricted(&reduced, &point), &multipliers[..reduced.rows.len()]);
        let mut prover = Prover::default();
        let (bound, slopes) = prover.reduced_costs(&reduced, &x, y);
        for point in case.points() {
            let x = restricted(&reduced, &point);
            for (k, &slope) in slopes.iter().enumerate() {
                let from = if slope > 0.0 { reduced.lower[k] } else { reduced.upper[k] };
                let least = bound + slope * (x[k] - from);
                prop_assert!(reduced.objective(&x) >= least - SLACK, "column {k}: {least}");
            }
        }
    }
}

/// The shapes that the pieces were written for are found.
#[test]
fn a_disjunction_of_two_sides() {
    let mut model = Model::new("disjunction");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let (left, right) = (model.binary("left").unwrap(), model.binary("right").unwrap());
    model.add("l", (x + 6.0 * left).le(10.0)).unwrap();
    model.add("r", (x - 7.0 * right).ge(0.0)).unwrap();
    model.add("one", (left + right).ge(1.0)).unwrap();
    model.minimize((x - 5.0).square()).unwrap();
    let program = Program::assemble(&model).unwrap();

    let Some(reduced) = reduce(&program, &Domain::new(&program)) else {
        panic!("feasible");
    };
    let projection = project(reduced, &program.integral);
    assert_eq!(projection.reduced.columns, [0], "{projection:?}");
    // Inside the gap both sides stay fractional, the nearer one larger; outside they are whole.
    let inside = projection.lift(&[5.0]);
    assert!(inside[1] > inside[2] && inside[2] > 0.5 && inside[1] < 1.0, "{inside:?}");
    assert_eq!(projection.lift(&[3.0]), [3.0, 1.0, 0.0]);
    assert_eq!(projection.lift(&[8.0]), [8.0, 0.0, 1.0]);
}

/// Three steps of `x' = x / 2 + 1` or `x' = 1 - x / 2` from `x = 1`, each written with a big-M of
/// 200: `x` is within `[0.5, 1.5]`, then `[0.25, 1.75]`, `[0.125, 1.875]`.
#[test]
fn cases_bound_what_can_be_reached() {
    let mut model = Model::new("piecewise-affine");
    let x = model.continuous_family("x", 4, -100.0, 100.0).unwrap();
    model.add("start", x[0].equals(1.0)).unwrap();
    for t in 0..3 {
        let up = model.binary(format!("up{t}")).unwrap();
        let down = model.binary(format!("down{t}")).unwrap();
        model.add(format!("one{t}"), (up + down).equals(1.0)).unwrap();
        for (slope, mode, name) in [(0.5, up, "up"), (-0.5, down, "down")] {
            let miss = x[t + 1] - slope * x[t];
            let above = (miss.clone() + 200.0 * mode).le(201.0);
            model.add(format!("above_{name}{t}"), above).unwrap();
            model.add(format!("below_{name}{t}"), (miss - 200.0 * mode).ge(-199.0)).unwrap();
        }
    }
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_by_disjunctions(&program, &StopToken::default()).expect("there are cases");
    let column = |t: usize| model.variable_by_name(format!("x[{t}]")).unwrap().index();
    for (t, reach) in [(1, 0.5), (2, 0.75), (3, 0.875)] {
        let j = column(t);
        assert!((tight.lower[j] - (1.0 - reach)).abs() < 1e-6, "{t}: {}", tight.lower[j]);
        assert!((tight.upper[j] - (1.0 + reach)).abs() < 1e-6, "{t}: {}", tight.upper[j]);
    }
    // The rows of the first step say no more than the bounds of x[1] and stay as they are.
    let later = |columns: &[usize]| columns.contains(&column(2)) || columns.contains(&column(3));
    let largest = |program: &Program| {
        let rows = (0..program.row_count()).map(|row| program.row(row));
        let values = rows.filter(|row| later(row.0)).flat_map(|row| row.1);
        values.fold(0.0_f64, |most, a| most.max(a.abs()))
    };
    assert_eq!(largest(&program), 200.0);
    assert!(largest(&tight) < 2.0, "{}", largest(&tight));
}

/// A spring that pushes back beyond 0.1, as a mode with a big-M of 50: what the two modes have in
/// common is the hull of the step, so the force is at most 0 everywhere, and none where the spring
/// is off.
#[test]
fn partners_find_the_hull_of_a_step() {
    let mut model = Model::new("spring");
    let x = model.continuous("x", -0.2, 0.2).unwrap();
    let force = model.continuous("force", -20.0, 20.0).unwrap();
    let (free, pressed) = (model.binary("free").unwrap(), model.binary("pressed").unwrap());
    model.add("one", (free + pressed).equals(1.0)).unwrap();
    model.add("off_above", (force + 50.0 * free).le(50.0)).unwrap();
    model.add("off_below", (force - 50.0 * free).ge(-50.0)).unwrap();
    let spring = force + 100.0 * (x - 0.1);
    model.add("on_above", (spring.clone() + 50.0 * pressed).le(50.0)).unwrap();
    model.add("on_below", (spring - 50.0 * pressed).ge(-50.0)).unwrap();
    model.add("left", (x + 0.3 * free).le(0.4)).unwrap();
    model.add("right", (x - 0.3 * pressed).ge(-0.2)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_big_ms(&program, &StopToken::default()).expect("the Ms are too large");
    let [x, force, free, pressed] = [x, force, free, pressed].map(|v| v.index());
    let is_relaxed = |at: [f64; 3]| {
        let mut point = vec![0.0; program.column_count()];
        (point[x], point[force], point[pressed]) = (at[0], at[1], at[2]);
        point[free] = 1.0 - at[2];
        assert_eq!(missed(&program, &point), None);
        missed(&tight, &point).is_none()
    };
    // Half off at -0.2, half on at 0.2: on average x = 0 under a force of -5, the largest there.
    assert!(is_relaxed([0.0, -5.0, 0.5]));
    assert!(!is_relaxed([0.0, -5.1, 0.5]));
    assert!(!is_relaxed([0.0, 0.1, 0.5]));
    assert!(!is_relaxed([0.15, -4.9, 0.5]));
    assert!(is_relaxed([0.15, -5.0, 0.5]));
}
