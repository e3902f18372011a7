//! Cuts and implications keep every whole point.
//!
//! Random programs are enumerated: integers over all their values, continuous columns over halves.
//! No point that satisfies the rows may violate a cut, wherever the relaxed point is taken to be;
//! and a program with cuts has the optimum that it had without.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Domain, Propagator, probe_implications};
use carom_solver::internals::program::Program;
use carom_solver::internals::search::cuts::{
    Cut, MOST_ROWS, cut_set_cuts, gomory_cuts, mixed_integer_rounding_cuts,
};
use proptest::prelude::*;

use super::grid::{Grid, balance, columns, general, grid, some_binaries};
use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/cuts.txt";

const BINARIES: usize = 4;
const COLUMNS: usize = columns(BINARIES);

/// What a whole point may violate a cut by through rounding.
const SLACK: f64 = 1e-7;

#[derive(Debug, Clone)]
struct Case {
    grid: Grid,
    /// Where the relaxed point is taken to be, as a fraction of each column's range.
    relaxed: Vec<f64>,
}

fn case() -> impl Strategy<Value = Case> {
    // x <= m z: a variable bound, which may be much wider than x.
    let width = prop_oneof![3 => 1i8..=3, 1 => Just(100i8)];
    let switch = (0..BINARIES, BINARIES..COLUMNS, width).prop_map(|(z, x, m)| {
        let mut row = vec![0; COLUMNS];
        (row[x], row[z]) = (1, -m);
        (row, None, Some(0))
    });
    let packing = some_binaries(BINARIES).prop_map(|row| (row, None, Some(1)));
    let row = prop_oneof![
        3 => general(BINARIES),
        2 => switch,
        1 => balance(BINARIES),
        1 => packing,
    ];
    let grid = grid(BINARIES, prop::collection::vec(row, 1..6));
    let fraction = prop_oneof![2 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(0.5)];
    (grid, prop::collection::vec(fraction, COLUMNS))
        .prop_map(|(grid, relaxed)| Case { grid, relaxed })
}

impl Case {
    fn relaxed(&self, program: &Program) -> Vec<f64> {
        let at =
            |j: usize| program.lower[j] + self.relaxed[j] * (program.upper[j] - program.lower[j]);
        (0..COLUMNS).map(at).collect()
    }
}

fn cut_off<'a>(cuts: &[Cut], points: &'a [Vec<f64>]) -> Option<&'a Vec<f64>> {
    points.iter().find(|point| cuts.iter().any(|cut| cut.room(point) < -SLACK))
}

/// The largest of what the bounds allow of a sum of columns.
fn most(domain: &Domain, sum: &[f64]) -> f64 {
    let end = |(j, a): (usize, &f64)| (a * domain.lower(j)).max(a * domain.upper(j));
    sum.iter().enumerate().filter(|(_, a)| **a != 0.0).map(end).sum()
}

/// A side of the form of a cut on which the sum of the negated cut, the form and its rows is no
/// contradiction.
fn unproved<'a>(program: &Program, domain: &Domain, cuts: &'a [Cut]) -> Option<(&'a Cut, usize)> {
    let forms = cuts.iter().filter_map(|cut| Some((cut, cut.form.as_ref()?)));
    forms.flat_map(|(cut, form)| [(cut, form, 0), (cut, form, 1)]).find_map(|(cut, form, k)| {
        let side = &form.sides[k];
        let (mut sum, mut limit) = (vec![0.0; program.column_count()], cut.limit);
        let mut add = |terms: &mut dyn Iterator<Item = (usize, f64)>, y: f64| {
            terms.for_each(|(j, a)| sum[j] += a * y);
        };
        add(&mut cut.terms.iter().copied(), 1.0);
        add(&mut form.terms.iter().copied(), side.form);
        limit += side.form * (form.value + k as f64);
        let is_right = if k == 0 { side.form <= 0.0 } else { side.form >= 0.0 };
        for &(row, y) in &side.rows {
            let (columns, values) = program.row(row);
            add(&mut columns.iter().copied().zip(values.iter().copied()), y);
            limit += y * if y > 0.0 { program.row_lower[row] } else { program.row_upper[row] };
        }
        sum.iter_mut().filter(|a| a.abs() < 1e-9).for_each(|a| *a = 0.0);
        let is_proved = is_right && most(domain, &sum) <= limit + SLACK;
        (!is_proved).then_some((cut, k))
    })
}

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    #[test]
    fn no_whole_point_is_cut_off(case in case()) {
        let program = Program::assemble(&case.grid.model()).unwrap();
        let mut domain = Domain::new(&program);
        let points = case.grid.points();
        let mut propagator = Propagator::new(&program);
        let conflict = propagator.propagate_all(&program, &mut domain).is_err();
        prop_assert!(!conflict || points.is_empty());
        prop_assume!(!conflict);
        let x = case.relaxed(&program);
        let cuts = mixed_integer_rounding_cuts(&program, &domain, &x, MOST_ROWS, &StopToken::default());
        prop_assert_eq!(cut_off(&cuts, &points), None);
        prop_assert_eq!(unproved(&program, &domain, &cuts), None);
        let sets = cut_set_cuts(&program, &domain, &x, &StopToken::default());
        prop_assert_eq!(cut_off(&sets, &points), None);
        prop_assert_eq!(unproved(&program, &domain, &sets), None);
        for cut in &cuts {
            prop_assert!(cut.room(&x) < 0.0, "the relaxed point is not cut off");
        }
        // Cuts from cuts.
        let mut model = case.grid.model();
        let columns: Vec<_> = model.variables().map(|v| v.id()).collect();
        for (k, cut) in cuts.iter().enumerate() {
            let sum: Affine = cut.terms.iter().map(|&(j, a)| a * columns[j]).sum();
            model.add(format!("cut{k}"), sum.le(cut.limit)).unwrap();
        }
        let more = Program::assemble(&model).unwrap();
        let middle: Vec<f64> = x.iter().zip(&program.lower).map(|(x, l)| 0.5 * (x + l)).collect();
        let next =
            mixed_integer_rounding_cuts(&more, &domain, &middle, MOST_ROWS, &StopToken::default());
        prop_assert_eq!(cut_off(&next, &points), None);
        prop_assert_eq!(unproved(&more, &domain, &next), None);
    }

    // Whatever the multipliers are: a basis may be wrong.
    #[test]
    fn sums_of_rows_cut_no_whole_point_off(
        case in case(),
        sums in prop::collection::vec(prop::collection::vec(-2.0..=2.0_f64, 6), 1..6),
    ) {
        let program = Program::assemble(&case.grid.model()).unwrap();
        let domain = Domain::new(&program);
        let rows = program.row_count();
        let sums: Vec<Vec<(usize, f64)>> =
            sums.into_iter().map(|sum| sum.into_iter().take(rows).enumerate().collect()).collect();
        let x = case.relaxed(&program);
        let cuts = gomory_cuts(&program, &domain, &x, &sums, &StopToken::default());
        let points = case.grid.points();
        prop_assert_eq!(cut_off(&cuts, &points), None);
        prop_assert_eq!(unproved(&program, &domain, &cuts), None);
    }

    #[test]
    fn implications_hold_at_whole_points(case in case()) {
        let program = Program::assemble(&case.grid.model()).unwrap();
        let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
        let points = case.grid.points();
        let columns: Vec<usize> = program.integers.clone();
        let found = propagator.propagate_all(&program, &mut domain).and_then(|()| {
            let token = &StopToken::default();
            probe_implications(&program, &mut domain, &mut propagator, &columns, 100, token)
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
        let model = case.grid.model();
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
    let cuts = mixed_integer_rounding_cuts(
        &program,
        &Domain::new(&program),
        &[2.5],
        MOST_ROWS,
        &StopToken::default(),
    );
    assert_eq!(cuts.len(), 1);
    assert!((cuts[0].room(&[2.0])).abs() < 1e-6);
}

/// A place takes 5 from two arcs of width 1000, and passes on what else comes: whatever is open
/// must be so by more than 5 in 1000.
#[test]
fn a_small_part_of_a_wide_arc_is_rounded() {
    let mut model = Model::new("place");
    let x = model.continuous_family("x", 3, 0.0, 1000.0).unwrap();
    let z = model.binary_family("z", 2).unwrap();
    model.add("place", (x[0] + x[1] - x[2]).equals(5.0)).unwrap();
    for k in 0..2 {
        model.add(format!("arc_{k}"), x[k].le(1000.0 * z[k])).unwrap();
    }
    let program = Program::assemble(&model).unwrap();
    let (domain, token) = (Domain::new(&program), StopToken::default());
    let point = [5.0, 0.0, 0.0, 0.005, 0.0];
    let cuts = mixed_integer_rounding_cuts(&program, &domain, &point, MOST_ROWS, &token);
    let whole = [[5.0, 0.0, 0.0, 1.0, 0.0], [0.0, 1000.0, 995.0, 0.0, 1.0]];
    assert!(!cuts.is_empty());
    for cut in &cuts {
        assert!(cut.room(&point) < -1e-3);
        assert!(whole.iter().all(|point| cut.room(point) >= -1e-9));
    }
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
    probe_implications(&program, &mut domain, &mut propagator, &[0], 10, &StopToken::default())
        .unwrap();
    assert_eq!(domain.lower(1), 2.0);
}
