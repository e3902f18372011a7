//! Cuts and implications keep every whole point.
//!
//! Random programs are enumerated: integers over all their values, continuous columns over halves. No
//! point that satisfies the rows may violate a cut, wherever the relaxed point is taken to be; and
//! a program with cuts has the optimum that it had without.

use carom::prelude::*;
use carom::presolve::{Domain, Implications, Propagator};
use carom::program::Program;
use carom::search::cuts::{Cut, implied_bound_cuts, mixed_integer_rounding_cuts};
use carom::solver::Deadline;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/cuts.txt";

/// Columns: binaries, then an integer, then two continuous ones in steps of a half.
const BINARIES: usize = 4;
const COLUMNS: usize = BINARIES + 3;
const TOP: f64 = 3.0;

/// What a whole point may violate a cut by through rounding.
const SLACK: f64 = 1e-7;

#[derive(Debug, Clone)]
struct Case {
    rows: Vec<(Vec<i8>, Option<i8>, Option<i8>)>,
    cost: Vec<i8>,
    /// Where the relaxed point is taken to be, as a fraction of each column's range.
    relaxed: Vec<f64>,
}

fn case() -> impl Strategy<Value = Case> {
    let general = (prop::collection::vec(-4i8..=5, COLUMNS), -3i8..=9, any::<bool>());
    let general = general.prop_map(|(row, limit, below)| {
        if below { (row, None, Some(limit)) } else { (row, Some(limit - 6), None) }
    });
    // x <= m z: a variable bound.
    let switch = (0..BINARIES, BINARIES..COLUMNS, 1i8..=3).prop_map(|(z, x, m)| {
        let mut row = vec![0; COLUMNS];
        (row[x], row[z]) = (1, -m);
        (row, None, Some(0))
    });
    let balance = (prop::collection::vec(-1i8..=1, COLUMNS), -1i8..=2)
        .prop_map(|(row, at)| (row, Some(at), Some(at)));
    let packing = prop::collection::vec(0i8..=1, BINARIES).prop_map(|mut row| {
        row.resize(COLUMNS, 0);
        (row, None, Some(1))
    });
    let row = prop_oneof![3 => general, 2 => switch, 1 => balance, 1 => packing];
    let rows = prop::collection::vec(row, 1..6);
    let fraction = prop_oneof![2 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(0.5)];
    let cost = prop::collection::vec(-3i8..=3, COLUMNS);
    (rows, cost, prop::collection::vec(fraction, COLUMNS)).prop_map(|(rows, cost, relaxed)| Case {
        rows: rows.into_iter().filter(|(row, ..)| row.iter().any(|a| *a != 0)).collect(),
        cost,
        relaxed,
    })
}

impl Case {
    fn model(&self) -> Model {
        let mut model = Model::new("cuts");
        let mut variables = Vec::new();
        for j in 0..COLUMNS {
            let name = format!("v{j}");
            variables.push(match j {
                j if j < BINARIES => model.binary(name).unwrap(),
                BINARIES => model.integer(name, 0.0, TOP).unwrap(),
                _ => model.continuous(name, 0.0, TOP).unwrap(),
            });
        }
        let sum = |row: &[i8]| -> Affine {
            variables.iter().zip(row).map(|(&v, &a)| f64::from(a) * v).sum()
        };
        for (i, (row, lower, upper)) in self.rows.iter().enumerate() {
            let lower = lower.map_or(f64::NEG_INFINITY, f64::from);
            let upper = upper.map_or(f64::INFINITY, f64::from);
            model.add(format!("r{i}"), sum(row).within(lower, upper)).unwrap();
        }
        model.minimize(sum(&self.cost)).unwrap();
        model
    }

    /// The grid points that satisfy the rows.
    fn points(&self) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new()];
        for j in 0..COLUMNS {
            let (top, step) = match j {
                j if j < BINARIES => (1.0, 1.0),
                BINARIES => (TOP, 1.0),
                _ => (TOP, 0.5),
            };
            let values = (0..=(top / step) as u32).map(|k| f64::from(k) * step);
            let values: Vec<f64> = values.collect();
            points = points
                .into_iter()
                .flat_map(|p| values.iter().map(move |&v| [&p[..], &[v]].concat()))
                .collect();
        }
        points.retain(|p| {
            self.rows.iter().all(|(row, lower, upper)| {
                let sum: f64 = row.iter().zip(p).map(|(&a, v)| f64::from(a) * v).sum();
                lower.is_none_or(|l| f64::from(l) <= sum)
                    && upper.is_none_or(|u| sum <= f64::from(u))
            })
        });
        points
    }

    fn relaxed(&self, program: &Program) -> Vec<f64> {
        let at =
            |j: usize| program.lower[j] + self.relaxed[j] * (program.upper[j] - program.lower[j]);
        (0..COLUMNS).map(at).collect()
    }
}

fn cut_off<'a>(cuts: &[Cut], points: &'a [Vec<f64>]) -> Option<&'a Vec<f64>> {
    points.iter().find(|point| cuts.iter().any(|cut| cut.room(point) < -SLACK))
}

proptest! {
    #![proptest_config(config(600, REGRESSIONS))]

    #[test]
    fn no_whole_point_is_cut_off(case in case()) {
        let program = Program::assemble(&case.model()).unwrap();
        let mut domain = Domain::new(&program);
        let points = case.points();
        let mut propagator = Propagator::new(&program);
        let conflict = propagator.propagate_all(&program, &mut domain).is_err();
        prop_assert!(!conflict || points.is_empty());
        prop_assume!(!conflict);
        let x = case.relaxed(&program);
        let mut cuts = mixed_integer_rounding_cuts(&program, &domain, &x, &Deadline::default());
        cuts.extend(implied_bound_cuts(&program, &mut domain, &mut propagator, &x));
        prop_assert_eq!(cut_off(&cuts, &points), None);
        for cut in &cuts {
            prop_assert!(cut.room(&x) < 0.0, "the relaxed point is not cut off");
        }
    }

    #[test]
    fn implications_hold_at_whole_points(case in case()) {
        let program = Program::assemble(&case.model()).unwrap();
        let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
        let points = case.points();
        let columns: Vec<usize> = program.integers.clone();
        let found = propagator.propagate_all(&program, &mut domain).and_then(|()| {
            let go_on = || true;
            Implications::probe(&program, &mut domain, &mut propagator, &columns, 100, &go_on)
        });
        let Ok(table) = found else {
            prop_assert!(points.is_empty());
            return Ok(());
        };
        let holds = |point: &[f64], l: usize| point[l / 2] == (l % 2) as f64;
        for point in &points {
            for j in 0..COLUMNS {
                prop_assert!(domain.lower(j) <= point[j] + SLACK, "{:?}", point);
                prop_assert!(domain.upper(j) >= point[j] - SLACK, "{:?}", point);
            }
            for literal in (0..2 * BINARIES).filter(|&l| holds(point, l)) {
                for &other in table.of(literal) {
                    prop_assert!(holds(point, other), "{literal} without {other}: {:?}", point);
                }
            }
        }
        // Propagation that follows the table loses no point either.
        propagator.set_implications(table);
        for point in &points {
            for j in 0..BINARIES {
                let mark = domain.mark();
                domain.apply(j, false, point[j]);
                domain.apply(j, true, point[j]);
                let kept = propagator.propagate_since(&program, &mut domain, mark).is_ok();
                let inside = (0..COLUMNS).all(|k| {
                    domain.lower(k) <= point[k] + SLACK && domain.upper(k) >= point[k] - SLACK
                });
                prop_assert!(kept && inside);
                domain.undo_to(mark);
            }
        }
    }

    #[test]
    fn optima_stay_the_same(case in case()) {
        let model = case.model();
        let solve = |cuts: bool| {
            BranchAndBound::new(Options::default().with_cuts(cuts)).solve(&model).unwrap()
        };
        let (with, without) = (solve(true), solve(false));
        prop_assert_eq!(with.termination(), without.termination());
        if let (Some(a), Some(b)) = (with.objective(), without.objective()) {
            prop_assert!((a - b).abs() <= 1e-5);
        }
    }
}

#[test]
fn the_fraction_of_a_knapsack_is_rounded() {
    let mut model = Model::new("knapsack");
    let x = model.integer("x", 0.0, 10.0).unwrap();
    model.add("r", (2.0 * x).le(5.0)).unwrap();
    model.maximize(x).unwrap();
    let program = Program::assemble(&model).unwrap();
    let cuts =
        mixed_integer_rounding_cuts(&program, &Domain::new(&program), &[2.5], &Deadline::default());
    assert_eq!(cuts.len(), 1);
    assert!((cuts[0].room(&[2.0])).abs() < 1e-6);
}

#[test]
fn what_both_values_of_a_binary_say_holds() {
    let mut model = Model::new("both");
    let z = model.binary("z").unwrap();
    let k = model.integer("k", 0.0, 9.0).unwrap();
    model.add("on", (k - 3.0 * z).ge(0.0)).unwrap();
    model.add("off", (k + 2.0 * z).ge(2.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
    Implications::probe(&program, &mut domain, &mut propagator, &[0], 10, &|| true).unwrap();
    assert_eq!(domain.lower(1), 2.0);
}

/// `x <= 10 z` by a chain: the file's rows say `x <= y` and `y <= 20 z`, and `x <= 10`.
#[test]
fn a_chain_of_rows_becomes_one() {
    let mut model = Model::new("chain");
    let z = model.binary("z").unwrap();
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let y = model.continuous("y", 0.0, 20.0).unwrap();
    model.add("first", x.le(y)).unwrap();
    model.add("second", y.le(20.0 * z)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
    propagator.propagate_all(&program, &mut domain).unwrap();
    let relaxed = [0.5, 10.0, 10.0];
    let cuts = implied_bound_cuts(&program, &mut domain, &mut propagator, &relaxed);
    assert_eq!(cuts.len(), 1);
    assert!((cuts[0].room(&[0.5, 5.0, 20.0])).abs() < 1e-6);
    assert!(cuts[0].room(&[1.0, 10.0, 10.0]) >= 0.0);
    assert_eq!(domain.bounds(0), [0.0, 1.0]);
}
