//! Programs in which some columns can be shifted together: tours with potentials, schedules with
//! start times, random programs. The answer does not depend on the bounds of these columns, and no
//! point far away is accepted because its rows have large terms.

use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use carom::prelude::*;
use carom::solution::{Outcome, Point, ViolationKind};
use carom::tolerance;
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;
const REGRESSIONS: &str = "tests/regressions/free_shifts.txt";

/// All orders of `0..n`.
fn orders(n: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![Vec::new()];
    }
    let shorter = orders(n - 1);
    let places = |order: Vec<usize>| {
        (0..n).map(move |k| {
            let mut order = order.clone();
            order.insert(k, n - 1);
            order
        })
    };
    shorter.into_iter().flat_map(places).collect()
}

/// A tour through cities 0, 1, ..: arcs, and potentials of all cities but the first, which grow by
/// 1 along each arc (Miller, Tucker, Zemlin), in a given range.
fn tour(lengths: &[Vec<f64>], lower: f64, upper: f64) -> Model {
    let n = lengths.len();
    let mut model = Model::new("tour");
    let potentials: Vec<Variable> =
        (1..n).map(|i| model.integer(("u", i), lower, upper).unwrap()).collect();
    let mut arcs = vec![vec![None; n]; n];
    let mut length = Affine::zero();
    for i in 0..n {
        for j in (0..n).filter(|&j| j != i) {
            let arc = model.binary(format!("arc_{i}_{j}")).unwrap();
            arcs[i][j] = Some(arc);
            length += lengths[i][j] * arc;
        }
    }
    for i in 0..n {
        let leaving: Affine = arcs[i].iter().flatten().copied().sum();
        let entering: Affine = arcs.iter().filter_map(|from| from[i]).sum();
        model.add(("leave", i), leaving.equals(1.0)).unwrap();
        model.add(("enter", i), entering.equals(1.0)).unwrap();
        for j in (1..n).filter(|&j| i > 0 && j != i) {
            let (big, arc) = (n as f64 - 1.0, arcs[i][j].unwrap());
            let rise = potentials[j - 1] - potentials[i - 1] - big * arc;
            model.add(format!("rise_{i}_{j}"), rise.ge(1.0 - big)).unwrap();
        }
    }
    model.minimize(length).unwrap();
    model
}

fn shortest_tour(lengths: &[Vec<f64>]) -> f64 {
    let n = lengths.len();
    let length = |order: Vec<usize>| {
        let stops: Vec<usize> = [0].into_iter().chain(order.iter().map(|i| i + 1)).collect();
        (0..n).map(|k| lengths[stops[k]][stops[(k + 1) % n]]).sum::<f64>()
    };
    orders(n - 1).into_iter().map(length).fold(INF, f64::min)
}

/// Jobs on one machine, one after the other with some time between; the time from the first start
/// to the last end is minimised, and what each order of two jobs costs. Start times may be anything
/// in a range.
fn schedule(times: &[f64], changes: &[Vec<f64>], lower: f64, upper: f64) -> Model {
    let n = times.len();
    let mut model = Model::new("schedule");
    let starts: Vec<Variable> =
        (0..n).map(|i| model.continuous(("start", i), lower, upper).unwrap()).collect();
    let span = model.continuous("span", 0.0, INF).unwrap();
    let horizon: f64 = times.iter().sum::<f64>() + changes.iter().flatten().sum::<f64>();
    let mut cost = Affine::from(span);
    for i in 0..n {
        for j in 0..n {
            let row = span - (starts[j] + times[j] - starts[i]);
            model.add(format!("span_{i}_{j}"), row.ge(0.0)).unwrap();
        }
        for j in i + 1..n {
            let first = model.binary(format!("first_{i}_{j}")).unwrap();
            cost += 0.5 * changes[j][i] * first;
            let [gap, other] = [(i, j), (j, i)].map(|(a, b)| times[a] + changes[a][b]);
            // Free start times have no bounds for a big-M of an indicator; the horizon is one.
            let after = starts[j] - starts[i] - horizon * 2.0 * first;
            model.add(format!("after_{i}_{j}"), after.ge(gap - horizon * 2.0)).unwrap();
            let before = starts[i] - starts[j] + horizon * 2.0 * first;
            model.add(format!("after_{j}_{i}"), before.ge(other)).unwrap();
        }
    }
    model.minimize(cost).unwrap();
    model
}

fn least_cost(times: &[f64], changes: &[Vec<f64>]) -> f64 {
    let cost = |order: Vec<usize>| {
        let mut starts = vec![0.0_f64; times.len()];
        let mut cost = 0.0;
        for (k, &j) in order.iter().enumerate() {
            for &i in &order[..k] {
                starts[j] = starts[j].max(starts[i] + times[i] + changes[i][j]);
                cost += if i < j { 0.5 * changes[j][i] } else { 0.0 };
            }
        }
        // The first job starts at 0, and none before it.
        let ends = order.iter().map(|&j| starts[j] + times[j]);
        cost + ends.fold(0.0, f64::max)
    };
    orders(times.len()).into_iter().map(cost).fold(INF, f64::min)
}

fn matrix(n: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
    let entry = (0..=40_i32).prop_map(|v| f64::from(v) * 0.25);
    prop::collection::vec(prop::collection::vec(entry, n), n)
}

/// Times of so many jobs, and of the changes between them.
fn jobs(n: usize) -> impl Strategy<Value = (Vec<f64>, Vec<Vec<f64>>)> {
    let time = (1..=40_i32).prop_map(|v| f64::from(v) * 0.25);
    (prop::collection::vec(time, n), matrix(n))
}

/// Ranges that hold a shift of everything that `0..=width` holds.
fn ranges(width: f64) -> impl Strategy<Value = (f64, f64)> {
    let at = (-1_000_000..=1_000_000_i32).prop_map(f64::from);
    (at, 0..4_u8).prop_map(move |(at, kind)| match kind {
        0 => (-INF, INF),
        1 => (at, INF),
        2 => (-INF, at),
        _ => (at, at + width),
    })
}

proptest! {
    #![proptest_config(config(60, REGRESSIONS))]

    #[test]
    fn tours((lengths, (lower, upper)) in (3..=6_usize).prop_flat_map(|n| (matrix(n), ranges(n as f64)))) {
        let solution = BranchAndBound::default().solve(&tour(&lengths, lower, upper)).unwrap();
        prop_assert!(solution.is_optimal(), "{:?}", solution);
        let (found, shortest) = (solution.objective().unwrap(), shortest_tour(&lengths));
        prop_assert!((found - shortest).abs() <= 1e-5 * shortest.max(1.0), "{found}, not {shortest}");
    }

    #[test]
    fn schedules(
        (times, changes) in (2..=4_usize).prop_flat_map(jobs),
        (lower, upper) in ranges(1000.0),
    ) {
        let model = schedule(&times, &changes, lower, upper);
        let solution = BranchAndBound::default().solve(&model).unwrap();
        prop_assert!(solution.is_optimal(), "{:?}", solution);
        let (found, least) = (solution.objective().unwrap(), least_cost(&times, &changes));
        prop_assert!((found - least).abs() <= 1e-5 * least.max(1.0), "{found}, not {least}");
    }

    /// Columns `u = x + f s` for the columns `x` of a program, with factors `f` and a shift `s`
    /// that only these columns see; rows tie each two of them together. However they are bounded,
    /// the answer is that of the program.
    #[test]
    fn random_programs(
        case in case(Shape::BOUNDED),
        factors in prop::collection::vec(-2..=2_i32, 8),
        (lower, upper) in ranges(1e4),
    ) {
        let (mut model, variables) = case.build();
        let mut shifted: Vec<(Variable, Variable, f64)> = Vec::new();
        for (&variable, &factor) in variables.iter().zip(&factors).filter(|(_, f)| **f != 0) {
            let kind = model.variable_ref(variable).unwrap().kind();
            let kind = if kind == VariableKind::Continuous { kind } else { VariableKind::Integer };
            // A box that holds a shift of every point, whatever the factor.
            let size = f64::from(factor.abs());
            let (low, high) = if factor > 0 { (lower, upper) } else { (-upper, -lower) };
            let (low, high) = (size * low, size * high);
            let name = format!("copy_{}", variable.index());
            let copy = model.variable(name, kind, low, high).unwrap();
            shifted.push((variable, copy, f64::from(factor)));
        }
        for (k, pair) in shifted.windows(2).enumerate() {
            let [(x, u, f), (y, v, g)] = [pair[0], pair[1]];
            let row = (g * (u - x) - f * (v - y)).equals(0.0);
            model.add(("tied", k), row).unwrap();
        }
        let solution = BranchAndBound::default().solve(&model).unwrap();
        match optimum(&case) {
            Minimum::Attained { value, .. } => {
                prop_assert!(solution.is_optimal(), "{:?}", solution);
                let found = case.sign() * solution.objective().unwrap();
                prop_assert!((found - value).abs() <= 1e-5 * value.abs().max(1.0));
            }
            Minimum::Infeasible => prop_assert!(solution.is_infeasible(), "{:?}", solution),
            Minimum::Unbounded => prop_assert_eq!(solution.termination(), Termination::Unbounded),
        }
    }

    /// Without presolve the potentials may run away; what is said is true all the same.
    #[test]
    fn tours_without_presolve(lengths in (4..=5_usize).prop_flat_map(matrix)) {
        let options = Options::default().with_presolve(false).with_node_limit(300);
        let solution = BranchAndBound::new(options).solve(&tour(&lengths, -INF, INF)).unwrap();
        let shortest = shortest_tour(&lengths);
        let margin = 1e-5 * shortest.max(1.0);
        prop_assert!(!solution.is_infeasible());
        prop_assert!(solution.bound() <= shortest + margin);
        if let Some(objective) = solution.objective() {
            prop_assert!(objective >= shortest - margin, "{objective} beats {shortest}");
            prop_assert!(!solution.is_optimal() || objective <= shortest + margin);
        }
    }
}

/// With integers near 5e10, a miss of 13 is no rounding.
#[test]
fn large_terms_excuse_nothing() {
    let mut model = Model::new("pair");
    let [u, v] = ["u", "v"].map(|name| model.integer(name, -INF, INF).unwrap());
    model.add("row", (u - v).le(24.0)).unwrap();
    let at = |difference: f64| vec![-4.9e10 + difference, -4.9e10];
    let check = |values: Vec<f64>| {
        let point = Point::new(&model, values).unwrap();
        Verification::of(&model, &point, tolerance::FEASIBILITY)
    };
    assert!(check(at(24.0)).holds());
    let missed = check(at(25.0));
    assert_eq!(missed.violations()[0].kind, ViolationKind::Row);
    assert_eq!(missed.violations()[0].amount, 1.0);
    let outcome = Outcome::new(Termination::Optimal, Some(at(37.0)), 0.0, Default::default());
    let solution = Solution::new(&model, outcome, tolerance::FEASIBILITY).unwrap();
    assert_eq!((solution.termination(), solution.point()), (Termination::Stalled, None));
}

/// Values beyond 2^53 leave out whole numbers; rows of integers are compared exactly all the same.
#[test]
fn integers_are_compared_exactly() {
    let mut model = Model::new("huge");
    let [u, v, w] = ["u", "v", "w"].map(|name| model.integer(name, -INF, INF).unwrap());
    model.add("row", (u - v - w).equals(0.0)).unwrap();
    let huge = 2.0_f64.powi(60);
    let holds = |values: [f64; 3]| {
        let point = Point::new(&model, values.to_vec()).unwrap();
        Verification::of(&model, &point, tolerance::FEASIBILITY).holds()
    };
    assert!(holds([huge, huge, 0.0]));
    assert!(!holds([huge, huge, 1.0]));
    assert!(holds([huge, huge - 256.0, 256.0]));
}

/// Rows of continuous variables may be missed by the tolerance and a few last digits of their
/// terms.
#[test]
fn rounding_is_forgiven() {
    let mut model = Model::new("sum");
    let [x, y] = ["x", "y"].map(|name| model.continuous(name, -INF, INF).unwrap());
    model.add("row", (x - y).equals(0.0)).unwrap();
    for (size, miss, expected) in [
        (1.0, 0.9e-6, true),
        (1.0, 1.1e-6, false),
        (1e6, 0.9e-6, true),
        (1e6, 1.1e-6, false),
        (1e9, 1.1e-6, true),
        (1e9, 5e-6, false),
        (1e12, 1e-3, true),
        (1e12, 1e-2, false),
    ] {
        let point = Point::new(&model, vec![size + miss, size]).unwrap();
        let verification = Verification::of(&model, &point, tolerance::FEASIBILITY);
        assert_eq!(verification.holds(), expected, "{size} {miss}");
    }
    for value in [INF, -INF, f64::NAN] {
        let point = Point::new(&model, vec![value, value]).unwrap();
        assert!(!Verification::of(&model, &point, tolerance::FEASIBILITY).holds());
    }
}
