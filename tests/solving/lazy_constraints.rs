//! Rows that are found while a model is solved: the answer is that of the model with all of them.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::common::case::Case;
use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case, unusual_options};
use crate::common::judge::{is_right, is_right_pool};
use crate::common::quadratic_program::Minimum;
use crate::tour::{Tour, held_karp, lengths, places};
use carom::ErrorKind;
use carom::prelude::*;
use carom::solution::Point;
use carom::solver::{Heuristics, MipStart, PoolMode};

/// Looks at a point and returns the rows that it must satisfy.
type RowSource<'a> = dyn Fn(&Point) -> Result<Vec<Row>, Error> + Sync + 'a;
use proptest::prelude::*;

fn solve(model: &Model, options: Options, lazy: &RowSource<'_>) -> Result<Solution, Error> {
    let mut control = Control::default().with_lazy_constraints(lazy);
    BranchAndBound::new(options).solve_with(model, &mut control)
}

fn shortest(lengths: &[Vec<f64>], options: Options) -> Solution {
    let tour = Tour::new(lengths);
    let solution = solve(&tour.model, options, &|point| tour.subtours(point)).unwrap();
    for point in solution.pool().iter() {
        assert!(tour.subtours(point.point()).unwrap().is_empty(), "a subtour is left");
    }
    solution
}

/// The program without some of its rows, and those.
fn split(case: &Case, withheld: u32) -> (Model, Vec<Row>) {
    let is_withheld = |k: usize| withheld >> k & 1 == 1;
    let mut open = case.clone();
    let mut k = 0..;
    open.lines.retain(|_| !is_withheld(k.next().unwrap()));
    let (model, variables) = open.build();
    let rows = case.lines.iter().enumerate().filter(|(k, _)| is_withheld(*k));
    (model, rows.map(|(_, line)| line.row(&variables)).collect())
}

/// Whether a point is off a row by more than a tolerance.
fn misses(row: &Row, point: &Point) -> bool {
    let value = point.value(row.expression()).unwrap();
    value < row.lower() - 1e-6 || value > row.upper() + 1e-6
}

proptest! {
    #![proptest_config(config(60, "tests/regressions/lazy_constraints.txt"))]

    /// Tours by subtours found as needed are those of dynamic programming, whatever the options.
    #[test]
    fn a_tour_is_the_shortest(
        places in prop::collection::vec((0_u16..60, 0_u16..60), 6..10),
        options in unusual_options(),
    ) {
        let lengths = lengths(&places);
        let wants_best = options.pool_mode == PoolMode::Best && options.pool > 1;
        let solution = shortest(&lengths, options);
        prop_assert!(solution.is_optimal(), "{}", solution.termination());
        let (found, length) = (solution.objective().unwrap(), held_karp(&lengths));
        prop_assert!((found - length).abs() < 1e-6, "{found}, shortest is {length}");
        prop_assert!(!wants_best || solution.pool().is_complete());
        for leaf in solution.leaves() {
            prop_assert!(!leaf.bound.is_nan());
        }
    }
}

proptest! {
    #![proptest_config(config(300, "tests/regressions/lazy_constraints.txt"))]

    /// Any rows of any program may be withheld until a point violates them.
    #[test]
    fn rows_may_come_late(
        case in prop_oneof![
            case(Shape::LINEAR), case(Shape::BOUNDED), case(Shape::FEASIBILITY), case(Shape::QUADRATIC)
        ],
        withheld in any::<u32>(),
        options in unusual_options(),
        one_by_one in any::<bool>(),
    ) {
        let (model, rows) = split(&case, withheld);
        let lazy = |point: &Point| {
            let violated = rows.iter().filter(|row| misses(row, point)).cloned();
            Ok(violated.take(if one_by_one { 1 } else { rows.len() }).collect())
        };
        let best = options.pool_mode == PoolMode::Best;
        let solution = solve(&model, options.clone(), &lazy).unwrap();
        is_right(&case, &solution)?;
        let is_bounded = case.columns.iter().all(|c| c.lower.is_finite() && c.upper.is_finite());
        if is_bounded && options.pool > 1 && solution.is_optimal() {
            is_right_pool(&case, &solution, options.pool, best)?;
        }
    }

    /// Cuts that follow from the rows change no answer; a row that excludes the optimum is found,
    /// or was never needed.
    #[test]
    fn cuts_change_no_answer(
        case in prop_oneof![case(Shape::BOUNDED), case(Shape::FEASIBILITY)],
        withheld in any::<u32>(),
        options in unusual_options(),
        wrong in any::<bool>(),
    ) {
        let (model, rows) = split(&case, withheld);
        let lazy = |point: &Point| {
            Ok(rows.iter().filter(|row| misses(row, point)).cloned().collect())
        };
        let shown = AtomicUsize::new(0);
        let best = optimum(&case);
        let cuts = |point: &Point| {
            shown.fetch_add(1, Ordering::Relaxed);
            let mut cuts: Vec<Row> = if wrong { Vec::new() } else { rows.clone() };
            if let (true, Minimum::Attained { value, .. }) = (wrong, &best) {
                // Far above the optimum, at which nothing else is.
                let cost = model.objective().affine() * case.sign();
                cuts.push(cost.ge(value + 100.0));
            }
            cuts.retain(|cut| misses(cut, point) && !cut.expression().terms().is_empty());
            Ok(cuts)
        };
        let mut control =
            Control::default().with_lazy_constraints(&lazy).with_user_cuts(&cuts);
        match BranchAndBound::new(options).solve_with(&model, &mut control) {
            Ok(solution) => is_right(&case, &solution)?,
            Err(error) => {
                prop_assert!(wrong, "{error}");
                prop_assert!(matches!(error.kind(), ErrorKind::WrongCut { .. }), "{error}");
            }
        }
    }
}

/// The last round finds the best point of an earlier one again, with another rounding of `z`.
#[test]
fn a_pool_has_the_point_after_one_that_is_found_twice() {
    let mut model = Model::new("m");
    let x = model.binary_family("x", 2).unwrap();
    let z = model.continuous("z", 0.0, 3.0).unwrap();
    model.minimize(-2.0 * x[0] - 3.0 * x[1] + z).unwrap();
    let lazy = |point: &Point| {
        let row = (x[0] + x[1] + z).le(1.0);
        Ok(if misses(&row, point) { vec![row] } else { Vec::new() })
    };
    let options = Options::default().with_pool(2, PoolMode::Best);
    let solution = solve(&model, options, &lazy).unwrap();
    let found: Vec<f64> = solution.pool().iter().map(|p| p.objective()).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!((found[0] + 3.0).abs() < 1e-6 && (found[1] + 2.0).abs() < 1e-6, "{found:?}");
    assert!(solution.is_optimal() && solution.pool().is_complete());
}

#[test]
fn thirty_cities_take_few_rounds() {
    for seed in 1..=3 {
        let lengths = lengths(&places(30, seed));
        let solution = shortest(&lengths, Options::default());
        assert!(solution.is_optimal());
        let statistics = solution.statistics();
        assert!(statistics.lazy_constraints > 0 && statistics.excluded_by_rows > 0);
        assert!(statistics.nodes < 5000, "{}", statistics.nodes);
    }
}

#[test]
fn deterministic_searches_do_not_depend_on_threads() {
    let lengths = lengths(&places(16, 5));
    let counts = |threads| {
        let options = Options::precise().with_threads(threads);
        let solution = shortest(&lengths, options);
        let values = solution.point().unwrap().as_slice().to_vec();
        (values, solution.statistics().without_times())
    };
    assert_eq!(counts(1), counts(2));
}

#[test]
fn rows_that_exclude_everything_leave_nothing() {
    let mut model = Model::new("m");
    let x = model.integer_family("x", 3, 0.0, 3.0).unwrap();
    model.maximize(x[0] + x[1] - x[2]).unwrap();
    let never = |_: &Point| Ok(vec![(x[0] + x[1]).ge(7.0)]);
    let solution = solve(&model, Options::default(), &never).unwrap();
    assert_eq!(solution.termination(), Termination::Infeasible);
    assert!(solution.point().is_none());
    // Point by point.
    let not_this = |point: &Point| {
        let mut differs = Affine::zero();
        for v in x.iter() {
            let value = point.value(v)?;
            differs += (value + 1.0).powi(2) * v;
        }
        let at = point.value(&differs)?;
        Ok(vec![differs.le(at - 1.0)])
    };
    let solution = solve(&model, Options::default(), &not_this).unwrap();
    assert_eq!(solution.termination(), Termination::Infeasible);
}

#[test]
fn a_fall_may_be_ended_by_a_row() {
    let mut model = Model::new("fall");
    let x = model.continuous("x", 0.0, f64::INFINITY).unwrap();
    let n = model.integer("n", 0.0, f64::INFINITY).unwrap();
    model.maximize(x + 2.0 * n).unwrap();
    let limits = |point: &Point| {
        let mut rows = Vec::new();
        if point.value(x + n)? > 40.5 + 1e-6 {
            rows.push((x + n).le(40.5));
        }
        Ok(rows)
    };
    let solution = solve(&model, Options::default(), &limits).unwrap();
    assert!(solution.is_optimal(), "{}", solution.termination());
    assert!((solution.objective().unwrap() - 80.5).abs() < 1e-6);
    let solution = solve(&model, Options::default(), &|_| Ok(Vec::new())).unwrap();
    assert_eq!(solution.termination(), Termination::Unbounded);
}

/// Tangents of a circle are added where a point leaves it.
#[test]
fn a_circle_comes_as_its_tangents() {
    let mut model = Model::new("circle");
    let x = model.continuous("x", -2.0, 2.0).unwrap();
    let y = model.continuous("y", -2.0, 2.0).unwrap();
    model.maximize(x + 2.0 * y).unwrap();
    let tangents = |point: &Point| {
        let (a, b) = (point.value(x)?, point.value(y)?);
        let radius = a.hypot(b);
        let tangent = (a / radius * x + b / radius * y).le(1.0);
        Ok(if radius > 1.0 + 1e-6 { vec![tangent] } else { Vec::new() })
    };
    let solution = solve(&model, Options::default(), &tangents).unwrap();
    assert!(solution.is_optimal(), "{}", solution.termination());
    assert!((solution.objective().unwrap() - 5.0_f64.sqrt()).abs() < 1e-5);
    // A program without integers has multipliers of its own rows and variables.
    assert!(solution.reduced_cost(x).is_ok());
}

/// Without the rows that come late, presolve would fix the columns at their cheap ends.
#[test]
fn columns_that_nothing_holds_may_be_held_later() {
    let mut model = Model::new("m");
    let v = model.binary_family("v", 6).unwrap();
    let near = model.continuous("near", 0.0, 10.0).unwrap();
    model.add("near", v[0].on().implies(near.ge(4.0))).unwrap();
    model.add("side", either(near.le(1.0)).or(near.ge(3.0))).unwrap();
    model.minimize(v.iter().map(|v| 1.0 * v).sum::<Affine>() + 0.1 * near).unwrap();
    let late = |point: &Point| {
        let rows = vec![
            (v[0] + v[1] + v[2]).ge(2.0),
            (v[2] + v[3]).equals(1.0),
            near.ge(2.0),
            (v[0] - v[5]).ge(0.0),
            (v[5] + v[4]).ge(1.0),
        ];
        Ok(rows.into_iter().filter(|row| misses(row, point)).collect())
    };
    let solution = solve(&model, Options::default(), &late).unwrap();
    assert!(solution.is_optimal());
    // v1, v2, v4, and `near` at 3.
    assert!((solution.objective().unwrap() - 3.3).abs() < 1e-6, "{:?}", solution.objective());
}

#[test]
fn limits_return_the_best_point_and_a_bound() {
    let lengths = lengths(&places(22, 9));
    let length = shortest(&lengths, Options::default()).objective().unwrap();
    for nodes in [0, 1, 2, 5, 10, 20, 40, 80] {
        let solution = shortest(&lengths, Options::default().with_node_limit(nodes));
        assert!(solution.statistics().nodes <= nodes + 1, "{}", solution.statistics().nodes);
        assert!(solution.bound() <= length + 1e-6);
        if let Some(found) = solution.objective() {
            assert!(found >= length - 1e-6 && found >= solution.bound() - 1e-6);
        }
        let ended = solution.termination();
        assert!(ended.is_limit() || ended == Termination::Optimal, "{ended}");
    }
    let solution = shortest(&lengths, Options::default().with_time_limit(Duration::ZERO));
    assert_eq!(solution.termination(), Termination::TimeLimit);
    assert_eq!(solution.bound(), f64::NEG_INFINITY);
}

#[test]
fn the_user_sees_one_search() {
    let lengths = lengths(&places(20, 4));
    let tour = Tour::new(&lengths);
    let subtours = |point: &Point| tour.subtours(point);
    let (objectives, nodes) = (RefCell::new(Vec::new()), RefCell::new(0));
    let mut incumbent = |best: &Incumbent<'_>| {
        assert!(tour.subtours(best.point).unwrap().is_empty());
        objectives.borrow_mut().push(best.objective);
        ControlFlow::Continue(())
    };
    let mut progress = |event: &Event| {
        let now = event.progress().nodes;
        assert!(now >= nodes.replace(now), "nodes are counted over all rounds");
    };
    let mut control = Control::default()
        .with_lazy_constraints(&subtours)
        .with_incumbent(&mut incumbent)
        .with_progress(&mut progress);
    let solution = BranchAndBound::default().solve_with(&tour.model, &mut control).unwrap();
    let objectives = objectives.into_inner();
    assert!(objectives.windows(2).all(|pair| pair[1] < pair[0]), "{objectives:?}");
    assert_eq!(objectives.last().copied(), solution.objective());
    // The first best point ends the search.
    let mut stop = |_: &Incumbent<'_>| ControlFlow::Break(());
    let mut control = Control::default().with_lazy_constraints(&subtours).with_incumbent(&mut stop);
    let solution = BranchAndBound::default().solve_with(&tour.model, &mut control).unwrap();
    assert!(solution.objective().is_some());
    assert!(solution.is_optimal() || solution.termination() == Termination::Interrupted);
}

#[test]
fn starts_and_prepared_models_take_rows() {
    let lengths = lengths(&places(9, 2));
    let length = held_karp(&lengths);
    let tour = Tour::new(&lengths);
    let subtours = |point: &Point| tour.subtours(point);
    let options = Options::default();
    let first = solve(&tour.model, options.clone(), &subtours).unwrap();
    let start = MipStart::of(&first, tour.roads.iter().map(|(_, _, used)| *used));
    let mut control = Control::default().with_lazy_constraints(&subtours).with_start(&start);
    let mut solver = BranchAndBound::new(options);
    let second = solver.solve_with(&tour.model, &mut control).unwrap();
    assert!((second.objective().unwrap() - length).abs() < 1e-6);
    assert!(second.start_report().is_some());
    let mut prepared = solver.prepare(&tour.model).unwrap();
    for _ in 0..2 {
        let mut control = Control::default().with_lazy_constraints(&subtours);
        let solution = prepared.solve(&[], &mut control).unwrap();
        assert!((solution.objective().unwrap() - length).abs() < 1e-6);
    }
}

#[test]
fn errors_of_a_callback_end_the_solve() {
    let mut model = Model::new("m");
    let x = model.integer("x", 0.0, 9.0).unwrap();
    let y = Model::new("another").binary("y").unwrap();
    model.maximize(x).unwrap();
    let text = |rows: Vec<Row>| {
        let lazy = |_: &Point| Ok(rows.clone());
        solve(&model, Options::default(), &lazy).unwrap_err().to_string()
    };
    assert_eq!(
        text(vec![x.le(f64::NAN)]),
        "the constant of `lazy_constraint[0]` is NaN; give a finite number"
    );
    assert_eq!(
        text(vec![x.le(9.0), (f64::INFINITY * x).le(5.0)]),
        "a coefficient of `lazy_constraint[1]` is inf; give a finite number"
    );
    assert_eq!(
        text(vec![y.le(0.0)]),
        "variable number 0 used in `lazy_constraint[0]` belongs to another model or system; use a \
         handle only with the one that created it (or a clone of it), and take handles of a system \
         at a sample with `at`"
    );
    assert_eq!(
        text(vec![(x - x).ge(1.0)]),
        "statement `lazy_constraint[0]` has no variable left, and its constant -1 is not within 0 and \
         inf; check the expression it was built from"
    );
    let failing = |point: &Point| {
        point.value(y)?;
        Ok(Vec::new())
    };
    let error = solve(&model, Options::default(), &failing).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }), "{error}");
}

#[test]
fn names_of_the_user_stay_theirs() {
    let mut model = Model::new("m");
    let x = model.integer("x", 0.0, 9.0).unwrap();
    let own = model.add(("lazy_constraint", 0), x.le(8.0)).unwrap();
    model.maximize(x).unwrap();
    let lazy = |point: &Point| {
        Ok(if point.value(x)? > 3.5 { vec![x.le(5.0), x.le(3.0)] } else { Vec::new() })
    };
    let solution = solve(&model, Options::default(), &lazy).unwrap();
    assert_eq!(solution.objective(), Some(3.0));
    assert_eq!(model.constraints().len(), 1);
    assert_eq!(model.constraint_by_name(("lazy_constraint", 0)).unwrap(), own);
}

/// Triangles of which no two corners may be taken: the relaxation takes half of everything.
fn triangles(count: usize) -> (Model, Family) {
    let mut model = Model::new("triangles");
    let v = model.binary_family("v", 3 * count).unwrap();
    for k in 0..count {
        for (side, (a, b)) in [(0, 1), (1, 2), (0, 2)].into_iter().enumerate() {
            let pair = v[3 * k + a] + v[3 * k + b];
            model.add(("pair", 3 * k + side), pair.le(1.0)).unwrap();
        }
    }
    let weight = |k: usize| 1.0 + 0.001 * (k * k % 17) as f64;
    model.maximize((0..3 * count).map(|k| weight(k) * v[k]).sum::<Affine>()).unwrap();
    (model, v)
}

/// Options without what would find the triangles.
fn plain() -> Options {
    Options::default().with_cuts(false).with_probing(false).with_presolve(false)
}

#[test]
fn cuts_save_nodes() {
    let (model, v) = triangles(12);
    let shown = AtomicUsize::new(0);
    let cuts = |point: &Point| {
        shown.fetch_add(1, Ordering::Relaxed);
        let mut cuts = Vec::new();
        for k in 0..12 {
            let triangle = v[3 * k] + v[3 * k + 1] + v[3 * k + 2];
            if point.value(&triangle)? > 1.01 {
                cuts.push(triangle.le(1.0));
            }
        }
        Ok(cuts)
    };
    let mut control = Control::default().with_user_cuts(&cuts);
    let solution = BranchAndBound::new(plain()).solve_with(&model, &mut control).unwrap();
    let without = BranchAndBound::new(plain().with_blocks(false)).solve(&model).unwrap();
    assert!(solution.is_optimal() && without.is_optimal());
    assert!((solution.objective().unwrap() - without.objective().unwrap()).abs() < 1e-6);
    assert!(shown.into_inner() > 0);
    assert_eq!(solution.statistics().user_cuts, 12);
    let (with, without) = (solution.statistics().nodes, without.statistics().nodes);
    assert!(with < without / 2, "{with} nodes, {without} without cuts");
}

#[test]
fn a_wrong_cut_is_named() {
    let (model, v) = triangles(12);
    let wrong = |_: &Point| Ok(vec![(v[0] + v[1] + v[2]).le(1.0), (v[3] + v[4] + v[5]).le(0.0)]);
    let mut control = Control::default().with_user_cuts(&wrong);
    let error = BranchAndBound::new(plain()).solve_with(&model, &mut control).unwrap_err();
    let ErrorKind::WrongCut { cut, row, amount, objective } = error.kind() else {
        panic!("{error}")
    };
    assert_eq!((cut.as_str(), *amount), ("user_cut[1]", 1.0));
    assert_eq!(row, "v[3] + v[4] + v[5] <= 0");
    assert_eq!(
        error.to_string(),
        format!(
            "the user cut `user_cut[1]`: v[3] + v[4] + v[5] <= 0 is wrong: a point of the model \
             violates it by 1, with an objective of {objective}; return only rows that every \
             solution satisfies"
        )
    );
}

#[test]
fn cuts_that_leave_nothing_are_doubted() {
    // Points are rare, so that none is known that could tell.
    let mut model = Model::new("rare");
    let v = model.binary_family("v", 14).unwrap();
    for row in 0..2 {
        let weight = |k: usize| (11 + (k * k * (7 + row) + 5 * k) % 83) as f64;
        let sum = v.iter().enumerate().map(|(k, v)| weight(k) * v).sum::<Affine>();
        let planted = (0..14).filter(|k| k % 3 == 0).map(weight).sum::<f64>();
        model.add(("weights", row), sum.equals(planted)).unwrap();
    }
    model.maximize(v.iter().map(|v| 1.0 * v).sum::<Affine>()).unwrap();
    let options = plain().with_heuristics(Heuristics::none());
    let looked = BranchAndBound::new(options.clone().with_node_limit(50)).solve(&model).unwrap();
    assert!(looked.point().is_none());
    let found = BranchAndBound::new(options.clone().with_node_limit(1000)).solve(&model).unwrap();
    assert!(found.point().is_some(), "{}", found.termination());
    let nothing = |_: &Point| Ok(vec![v.iter().map(|v| 1.0 * v).sum::<Affine>().ge(25.0)]);
    let mut control = Control::default().with_user_cuts(&nothing);
    let answer = BranchAndBound::new(options).solve_with(&model, &mut control);
    assert!(matches!(answer.unwrap_err().kind(), ErrorKind::WrongCut { .. }));
}

#[test]
fn cuts_are_checked_as_rows_are() {
    let (model, v) = triangles(12);
    let bad = |_: &Point| Ok(vec![(f64::NAN * v[0]).le(0.0)]);
    let mut control = Control::default().with_user_cuts(&bad);
    let error = BranchAndBound::new(plain()).solve_with(&model, &mut control).unwrap_err();
    assert_eq!(error.to_string(), "a coefficient of `user_cut[0]` is NaN; give a finite number");
}
