//! MIP starts: whatever they say, status and optimum stay the same. The ends of the tree cover it.

use carom::prelude::*;
use carom::solution::{LeafBox, StartStatus};
use carom::solver::MipStart;
use proptest::prelude::*;

use super::knapsack;
use crate::common::config;
use crate::common::enumeration::all_optima;
use crate::common::generate::{Shape, case};
use crate::common::judge::is_right;

type Numbers = Vec<(usize, f64)>;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (-4..=6_i32).prop_map(f64::from),
        1 => Just(0.4),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e18]),
    ]
}

fn nonsense() -> impl Strategy<Value = Numbers> {
    prop::collection::vec((0..9_usize, number()), 0..6)
}

/// A start over the variables of a model; positions beyond them are of another model.
fn start(variables: &[Variable], values: &Numbers) -> MipStart {
    let mut other = Model::new("other");
    let foreign = other.binary("z").unwrap();
    let at = |j: usize| variables.get(j).copied().unwrap_or(foreign);
    MipStart::new().with_values(values.iter().map(|&(j, value)| (at(j), value)))
}

fn solve(model: &Model, start: &MipStart, options: Options) -> Solution {
    let mut control = Control::default().with_start(start);
    BranchAndBound::new(options).solve_with(model, &mut control).unwrap()
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/seeds.txt"))]

    #[test]
    fn no_start_changes_an_answer(
        case in case(Shape::QUADRATIC),
        values in nonsense(),
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
    ) {
        let (model, variables) = case.build();
        let start = start(&variables, &values);
        let options = Options::default().with_threads(threads).with_deterministic(deterministic);
        let solution = solve(&model, &start, options);
        is_right(&case, &solution)?;
        let report = solution.start_report().unwrap();
        let is_integral = |&(j, value): &(usize, f64)| {
            let variable = variables.get(j).and_then(|&v| model.variable_ref(v).ok());
            variable.is_some_and(|v| v.kind().is_integral()) && value.is_finite()
        };
        let known = values.iter().filter(|value| is_integral(value)).count();
        prop_assert_eq!(report.ignored, values.len() - known);
        prop_assert!(known > 0 || report.status.is_none());
    }

    /// The ends of a tree, finished or not, cover all assignments of the integers without overlap.
    #[test]
    fn ends_cover_the_tree(case in case(Shape::BOUNDED), limit in prop::option::of(1..6_u64)) {
        let (model, _) = case.build();
        let mut options = Options::default().with_leaves(true);
        options.node_limit = limit;
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        let integral: Vec<Variable> = model
            .variables()
            .filter(|v| v.kind().is_integral())
            .map(|v| v.id())
            .collect();
        for (assignment, cost) in all_optima(&case) {
            let of = |variable: Variable| {
                let place = integral.iter().position(|&v| v == variable);
                assignment[place.expect("an integer variable")] as f64
            };
            let holds = |leaf: &&LeafBox| {
                leaf.bounds.iter().all(|b| (b.lower..=b.upper).contains(&of(b.variable)))
            };
            let around: Vec<&LeafBox> = solution.leaves().iter().filter(holds).collect();
            prop_assert_eq!(around.len(), 1, "{:?} in {:?}", assignment, solution.leaves());
            // The bound of an end holds for its points, up to the cutoff.
            let best = case.sign() * solution.objective().unwrap_or(f64::INFINITY);
            let bound = case.sign() * around[0].bound;
            prop_assert!(cost >= bound.min(best) - 1e-5 * cost.abs().max(1.0));
        }
    }
}

#[test]
fn starts_are_accepted_repaired_or_rejected() {
    let mut model = Model::new("m");
    let v = model.integer_family("n", 3, 0.0, 9.0).unwrap();
    model.add("sum", (v[0] + v[1] + v[2]).equals(10.0)).unwrap();
    model.minimize((v[0] - 1.0).square() + (v[1] - 7.0).square() + v[2].square()).unwrap();
    let status = |guess: &[(usize, f64)]| {
        let start = MipStart::new().with_values(guess.iter().map(|&(j, value)| (v[j], value)));
        let solution = solve(&model, &start, Options::default());
        assert!(solution.is_optimal());
        assert!((solution.objective().unwrap() - 2.0).abs() < 1e-5);
        solution.start_report().unwrap().status.clone().unwrap()
    };
    assert_eq!(status(&[(0, 4.0), (1, 4.0)]), StartStatus::Accepted);
    assert_eq!(status(&[(0, 4.0), (1, 4.0), (2, 2.0)]), StartStatus::Accepted);
    assert_eq!(
        status(&[(0, 4.0), (1, 4.0), (2, 3.0)]),
        StartStatus::Repaired { changed: vec![v[2]] }
    );
    assert_eq!(status(&[(0, 12.0)]), StartStatus::Repaired { changed: vec![v[0]] });

    let z = model.binary("z").unwrap();
    model.add("never", (2.0 * (v[0] + z)).equals(7.0)).unwrap();
    let start = MipStart::new().with_values([(v[1], 3.0), (z, 1.0)]);
    let solution = solve(&model, &start, Options::default());
    assert!(solution.is_infeasible());
}

#[test]
fn a_start_without_a_point_is_rejected_in_words() {
    // Whatever the binaries are, their squares have to meet a sum that propagation does not see.
    let mut model = Model::new("m");
    let v = model.binary_family("v", 6).unwrap();
    let x = model.continuous_family("x", 6, 0.0, 1.0).unwrap();
    for k in 0..6 {
        model.add(("on", k), (x[k] - v[k]).le(0.0)).unwrap();
    }
    let pairs: Affine = (0..6).map(|k| x[k] + 0.0).sum();
    model.add("all", pairs.clone().ge(2.5)).unwrap();
    model.add("few", v.iter().map(|v| 1.0 * v).sum::<Affine>().le(3.0)).unwrap();
    model.minimize(v.iter().enumerate().map(|(k, v)| (k + 1) as f64 * v).sum::<Affine>()).unwrap();
    let start = MipStart::new().with_values(v.iter().map(|v| (v, 0.0)));
    let solution = solve(&model, &start, Options::default());
    assert!(solution.is_optimal());
    match solution.start_report().unwrap().status.as_ref().unwrap() {
        StartStatus::Repaired { changed } => assert_eq!(changed.len(), 3),
        StartStatus::Rejected { reason } => assert!(reason.contains("point"), "{reason}"),
        other => panic!("{other:?}"),
    }
}

/// Presolve takes most of the columns out and decides some; a start from the optimum is accepted
/// all the same, and so is one over other integers than are left.
#[test]
fn starts_go_through_presolve() {
    let mut model = Model::new("m");
    let v = model.binary_family("v", 12).unwrap();
    let n = model.integer("n", 0.0, 20.0).unwrap();
    let m = model.integer("m", 0.0, 40.0).unwrap();
    let x = model.continuous("x", 0.0, 100.0).unwrap();
    model.add("decided", (v[0] + v[1]).ge(2.0)).unwrap();
    model.add("copy", (m - 2.0 * n).equals(0.0)).unwrap();
    model.add("sum", (x - 3.0 * m - v[2]).equals(0.0)).unwrap();
    let load: Affine = v.iter().enumerate().map(|(k, v)| (3 + k * k % 7) as f64 * v).sum();
    model.add("load", (load + n).within(17.0, 23.0)).unwrap();
    let cost: Affine = v.iter().enumerate().map(|(k, v)| (2 + k * k % 5) as f64 * v).sum();
    model.minimize(cost - 0.5 * x + (n - 4.0).square()).unwrap();
    let best = BranchAndBound::default().solve(&model).unwrap();
    let optimum = best.objective().unwrap();
    let all: Vec<Variable> =
        model.variables().filter(|v| v.kind().is_integral()).map(|v| v.id()).collect();
    let known: Vec<(Variable, f64)> = all.iter().map(|&v| (v, best.value(v).unwrap())).collect();
    let only = |variable: Variable| known.iter().copied().filter(|k| k.0 == variable).collect();
    for (guess, accepted) in [
        (known.clone(), true),
        (only(m), true),
        (only(v[0]), true),
        (vec![(v[0], 0.0)], false),
        (vec![(m, 7.0)], false),
    ] {
        for presolve in [true, false] {
            let start = MipStart::new().with_values(guess.clone());
            let solution = solve(&model, &start, Options::default().with_presolve(presolve));
            assert!(solution.is_optimal());
            assert!((solution.objective().unwrap() - optimum).abs() < 1e-5);
            match solution.start_report().unwrap().status.clone().unwrap() {
                StartStatus::Accepted => assert!(accepted, "{guess:?}, {presolve}"),
                StartStatus::Repaired { changed } => {
                    assert_eq!(changed, [guess[0].0]);
                    assert!(!accepted, "{guess:?}, {presolve}");
                }
                other => panic!("{guess:?}, {presolve}: {other:?}"),
            }
        }
    }
}

/// The same program again, from its own plan.
#[test]
fn the_own_plan_is_accepted() {
    for number in 0..4 {
        let model = knapsack(16, number);
        let first = BranchAndBound::default().solve(&model).unwrap();
        let start = MipStart::of(&first, model.variables().map(|v| v.id()));
        let again = solve(&model, &start, Options::default());
        assert!(again.is_optimal());
        assert_eq!(again.start_report().unwrap().status, Some(StartStatus::Accepted));
    }
}

/// Where any point will do, a start that leads to one is the answer.
#[test]
fn a_start_answers_a_program_without_an_objective() {
    let mut model = Model::new("any");
    let v = model.binary_family("v", 12).unwrap();
    let sum = v.iter().enumerate().map(|(k, v)| (2 * k + 3) as f64 * v).sum::<Affine>();
    model.add("sum", sum.within(40.0, 41.0)).unwrap();
    let first = BranchAndBound::default().solve(&model).unwrap();
    let start = MipStart::of(&first, v.iter());
    let mut seen = 0;
    let mut count = |_: &Incumbent<'_>| {
        seen += 1;
        std::ops::ControlFlow::Continue(())
    };
    let mut control = Control::default().with_start(&start).with_incumbent(&mut count);
    let again = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    assert!(again.is_optimal());
    assert_eq!(again.start_report().unwrap().status, Some(StartStatus::Accepted));
    assert_eq!((again.statistics().nodes, seen), (0, 1));
}
