//! No-goods exclude no whole point, whatever led to them.
//!
//! Random programs are enumerated: integers over all their values, continuous columns over halves.
//! A random walk of decisions, undone to where they came from or not, with probing, cutoffs that
//! fall and a table of implications, learns no-goods; every one is tried on every point.

use carom::internals::presolve::{Domain, Literal, Propagator, probe, probe_implications};
use carom::internals::program::Program;
use carom::prelude::*;
use carom::solver::StopToken;
use proptest::prelude::*;

use super::grid::{Grid, GridRow, TOP, balance, columns, general, grid, some_binaries};
use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/conflicts.txt";

const BINARIES: usize = 6;
const COLUMNS: usize = columns(BINARIES);

/// What bounds of continuous columns may be missed by through rounding.
const SLACK: f64 = 1e-7;

#[derive(Debug, Clone)]
struct Case {
    grid: Grid,
    walk: Vec<Step>,
    implications: bool,
}

/// One move: back to some length of the path, then a decision.
#[derive(Debug, Clone)]
struct Step {
    back: usize,
    column: usize,
    is_upper: bool,
    value: u8,
    probes: usize,
    /// The cutoff goes down to the objective of this point, counted from the worst one.
    cutoff: Option<prop::sample::Index>,
}

fn row() -> impl Strategy<Value = GridRow> {
    // Where a binary is on, a row of two other columns must hold: an indicator with its big-M.
    let indicator = (0..BINARIES, 0..COLUMNS, 0..COLUMNS, -2i8..=2, -2i8..=3);
    let indicator = indicator.prop_map(|(z, x, y, a, limit)| {
        let mut row = vec![0; COLUMNS];
        row[x] += 1;
        row[y] += a;
        let big_m = 12;
        row[z] += big_m;
        (row, None, Some(limit + big_m))
    });
    let covering = some_binaries(BINARIES).prop_map(|row| (row, Some(1), None));
    prop_oneof![2 => general(BINARIES), 4 => indicator, 1 => balance(BINARIES), 2 => covering]
}

fn case() -> impl Strategy<Value = Case> {
    let step = (
        0usize..5,
        0..=BINARIES,
        any::<bool>(),
        0u8..=2,
        prop_oneof![2 => Just(0usize), 1 => 1usize..12],
        prop::option::weighted(0.1, any::<prop::sample::Index>()),
    );
    let step = step.prop_map(|(back, column, is_upper, value, probes, cutoff)| Step {
        back,
        column,
        is_upper,
        value,
        probes,
        cutoff,
    });
    let grid = grid(BINARIES, prop::collection::vec(row(), 2..9));
    (grid, prop::collection::vec(step, 1..40), any::<bool>())
        .prop_map(|(grid, walk, implications)| Case { grid, walk, implications })
}

/// Whether a point satisfies a bound.
fn satisfies(point: &[f64], literal: &Literal) -> bool {
    literal.holds([point[literal.column]; 2])
}

/// How much a walk has learned.
#[derive(Default)]
struct Counts {
    learned: u64,
    fixed: u64,
}

/// Walks, and checks every bound and every no-good on the way.
fn walk(case: &Case) -> Result<Counts, TestCaseError> {
    let program = Program::assemble(&case.grid.model()).unwrap();
    let points: Vec<(Vec<f64>, f64)> =
        case.grid.points().into_iter().map(|p| (p.clone(), case.grid.cost_of(&p))).collect();
    let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
    let columns: Vec<usize> = program.integers.clone();
    let token = StopToken::default();
    if propagator.propagate_all(&program, &mut domain).is_err() {
        return Ok(Counts::default());
    }
    if case.implications {
        let half = &columns[..columns.len() / 2];
        let found = probe_implications(&program, &mut domain, &mut propagator, half, 100, &token);
        let Ok(table) = found else { return Ok(Counts::default()) };
        propagator.set_implications(table);
    }
    propagator.learn_conflicts(&domain);
    let root = domain.mark();
    let mut path: Vec<(usize, Literal)> = Vec::new();
    let mut cutoff = f64::INFINITY;
    for step in &case.walk {
        if let Some(index) = &step.cutoff
            && let Some(value) = (!points.is_empty()).then(|| points[index.index(points.len())].1)
        {
            cutoff = cutoff.min(value);
        }
        path.truncate(path.len().saturating_sub(step.back));
        domain.undo_to(root);
        let decisions: Vec<Literal> = path.iter().map(|(_, d)| *d).collect();
        path.clear();
        propagator.tidy_no_goods();
        propagator.set_cutoff(&program, cutoff);
        let (column, is_upper) = (step.column, step.is_upper);
        let top = if column < BINARIES { 0.0 } else { TOP - 1.0 };
        let value = f64::from(step.value).min(top) + if is_upper { 0.0 } else { 1.0 };
        let new = Literal { column, is_upper, value };
        for decision in decisions.into_iter().chain([new]) {
            let [lower, upper] = domain.bounds(decision.column);
            if decision.is_upper && decision.value >= upper
                || !decision.is_upper && decision.value <= lower
            {
                continue;
            }
            let mark = domain.mark();
            domain.apply(decision.column, decision.is_upper, decision.value);
            path.push((mark, decision));
            let mut result = propagator.propagate_since(&program, &mut domain, mark);
            if result.is_ok() && step.probes > 0 {
                let (domain, propagator) = (&mut domain, &mut propagator);
                result = probe(&program, domain, propagator, &columns, step.probes, &token);
            }
            let inside = |(p, objective): &&(Vec<f64>, f64)| {
                *objective <= cutoff && path.iter().all(|(_, d)| satisfies(p, d))
            };
            for (point, _) in points.iter().filter(inside) {
                prop_assert!(result.is_ok(), "{point:?} is refuted at {path:?}");
                for (j, value) in point.iter().enumerate() {
                    let [lower, upper] = domain.bounds(j);
                    let kept = lower <= value + SLACK && upper >= value - SLACK;
                    prop_assert!(kept, "{point:?} lost column {j} at {path:?}");
                }
            }
            if result.is_err() {
                domain.undo_to(mark);
                path.pop();
                break;
            }
        }
        for no_good in propagator.no_goods() {
            let hit = points.iter().find(|(p, objective)| {
                *objective <= no_good.cutoff && no_good.literals.iter().all(|l| satisfies(p, l))
            });
            prop_assert!(hit.is_none(), "{no_good:?} excludes {hit:?}");
        }
    }
    let counts = propagator.take_conflict_counts();
    Ok(Counts { learned: counts.learned, fixed: counts.fixed })
}

proptest! {
    #![proptest_config(config(150, REGRESSIONS))]

    #[test]
    fn no_goods_exclude_no_whole_point(case in case()) {
        walk(&case)?;
    }
}

/// Two indicators that contradict each other are learned at the first conflict, and used at the
/// next node. The domain afterwards is what it was.
#[test]
fn what_was_learned_is_used_elsewhere_and_undone() {
    let mut model = Model::new("two");
    let z = model.binary_family("z", 4).unwrap();
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let y = model.continuous("y", 0.0, 10.0).unwrap();
    // z0 makes x at least 6, z1 makes y at most 3; y >= x - 1.
    model.add("high", (x - 6.0 * z[0]).ge(0.0)).unwrap();
    model.add("low", (y + 7.0 * z[1]).le(10.0)).unwrap();
    model.add("link", (y - x).ge(-1.0)).unwrap();
    model.add("rest", (z[2] + z[3]).le(1.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let (mut domain, mut propagator) = (Domain::new(&program), Propagator::new(&program));
    propagator.propagate_all(&program, &mut domain).unwrap();
    propagator.learn_conflicts(&domain);
    let root = domain.mark();
    let before: Vec<[f64; 2]> = (0..program.column_count()).map(|j| domain.bounds(j)).collect();
    // Three decisions at once, one of which has nothing to do with it.
    for column in [0, 1, 2] {
        domain.apply(column, false, 1.0);
    }
    assert!(propagator.propagate_since(&program, &mut domain, root).is_err());
    domain.undo_to(root);
    let no_goods: Vec<_> = propagator.no_goods().cloned().collect();
    assert_eq!(no_goods.len(), 1);
    let mut columns: Vec<usize> = no_goods[0].literals.iter().map(|l| l.column).collect();
    columns.sort_unstable();
    assert_eq!((columns, no_goods[0].cutoff), (vec![0, 1], f64::INFINITY));
    for (decided, other) in [(0, 1), (1, 0)] {
        domain.apply(decided, false, 1.0);
        propagator.propagate_since(&program, &mut domain, root).unwrap();
        assert_eq!(domain.bounds(other), [0.0, 0.0]);
        domain.undo_to(root);
        let after: Vec<[f64; 2]> = (0..program.column_count()).map(|j| domain.bounds(j)).collect();
        assert_eq!(before, after);
    }
}

/// The random walks do learn, and what they learn moves bounds.
#[test]
fn walks_learn() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let mut sum = Counts::default();
    for _ in 0..100 {
        let case = case().new_tree(&mut runner).unwrap().current();
        let counts = walk(&case).unwrap();
        sum.learned += counts.learned;
        sum.fixed += counts.fixed;
    }
    assert!(sum.learned > 50 && sum.fixed > 20, "{} {}", sum.learned, sum.fixed);
}
