//! What a user says about a search steers it and never changes its answer.
//!
//! Random programs are solved under random priorities, with rules for splits and sources of points
//! that answer anything: sensible splits, fixed and continuous variables, handles of another model,
//! NaN. The optimum must be that of enumeration, and the counts must tell what was taken.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use carom::ErrorKind;
use carom::prelude::*;
use carom::solution::Heuristic;
use carom::solver::{Guidance, Heuristics, NodeView, SplitAt};
use proptest::prelude::*;

/// Agreement of objectives, relative and absolute.
const AGREEMENT: f64 = 1e-6;

fn foreign() -> Variable {
    Model::new("another").binary("z").unwrap()
}

/// Answers without a plan, but the same for the same node.
struct Whim<'a> {
    variables: &'a [Variable],
    seed: usize,
}

impl Whim<'_> {
    fn number(&self, node: &NodeView<'_>, salt: usize) -> usize {
        let mut state = self.seed ^ salt ^ (node.depth() << 8);
        for &v in self.variables {
            let bounds = node.bounds(v).unwrap();
            let bits = bounds.lower.to_bits() ^ bounds.upper.to_bits().rotate_left(7);
            state = (state ^ bits as usize).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(23);
        }
        state
    }

    fn split(&self, node: &NodeView<'_>) -> Option<SplitAt> {
        let variable = self.variables[self.number(node, 1) % self.variables.len()];
        let value = match self.number(node, 2) % 8 {
            0 => return None,
            1 => f64::NAN,
            2 => 1e9,
            3 => return Some(SplitAt::new(foreign(), 0.0)),
            4 => node.value(variable).ok()?,
            5 => node.bounds(variable).ok()?.lower,
            k => k as f64 - 6.0,
        };
        Some(SplitAt::new(variable, value))
    }

    fn propose(&self, node: &NodeView<'_>) -> Vec<(Variable, f64)> {
        let mut values: Vec<(Variable, f64)> = Vec::new();
        for (k, &variable) in self.variables.iter().enumerate() {
            let number = self.number(node, 3 + k);
            if number.is_multiple_of(3) {
                values.push((variable, (number / 3 % 5) as f64 - 1.0));
            }
        }
        values.extend([(foreign(), 1.0), (self.variables[0], f64::NAN)]);
        values
    }
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/guidance.txt"))]

    #[test]
    fn guidance_never_changes_an_answer(
        case in prop_oneof![case(Shape::BOUNDED), case(Shape::FEASIBILITY), case(Shape::LINEAR)],
        priorities in prop::collection::vec(-2i32..3, 8),
        seed in any::<u16>(),
        threads in 1usize..3,
        splits in any::<bool>(),
    ) {
        let (model, variables) = case.build();
        let whim = Whim { variables: &variables, seed: usize::from(seed) };
        let split = |node: &NodeView<'_>| whim.split(node);
        let propose = |node: &NodeView<'_>| whim.propose(node);
        let mut guidance = Guidance::default().with_proposal(&propose);
        if splits {
            // Without, what presolve leaves is searched.
            guidance = guidance.with_branching(&split);
        }
        for (&variable, &priority) in variables.iter().zip(&priorities) {
            guidance = guidance.with_priority(variable, priority);
        }
        let mut control = Control::default().with_guidance(guidance);
        let options = Options::default().with_threads(threads);
        let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
        match optimum(&case) {
            Minimum::Infeasible => {
                prop_assert_eq!(solution.termination(), Termination::Infeasible, "{}", model);
            }
            Minimum::Unbounded => {
                prop_assert_eq!(solution.termination(), Termination::Unbounded, "{}", model);
            }
            Minimum::Attained { value, .. } => {
                prop_assert!(solution.is_optimal(), "{} {}", solution.termination(), model);
                let cost = case.sign() * solution.objective().unwrap();
                let allowed = AGREEMENT * value.abs().max(1.0);
                prop_assert!((cost - value).abs() <= allowed, "{cost}, optimum {value}\n{model}");
            }
        }
    }
}

/// Eight integers whose relaxed values are all fractional.
fn fractional() -> (Model, Family) {
    let mut model = Model::new("fractional");
    let x = model.integer_family("x", 8, 0.0, 5.0).unwrap();
    let mut cost = Quadratic::default();
    for v in x.iter() {
        cost += (v - 2.5).square();
    }
    let sum: Affine = x.iter().fold(Affine::zero(), |sum, v| sum + v);
    model.add("sum", (2.0 * sum).within(31.0, 41.0)).unwrap();
    model.minimize(cost).unwrap();
    (model, x)
}

fn solve(model: &Model, guidance: Guidance<'_>) -> Solution {
    let mut control = Control::default().with_guidance(guidance);
    BranchAndBound::default().solve_with(model, &mut control).unwrap()
}

#[test]
fn splits_of_a_rule_are_taken_and_counted() {
    let (model, x) = fractional();
    let first_open = |node: &NodeView<'_>| {
        let open = |v: &Variable| node.bounds(*v).is_ok_and(|b| b.lower < b.upper);
        let variable = x.iter().find(open)?;
        Some(SplitAt::new(variable, node.value(variable).ok()?))
    };
    let solution = solve(&model, Guidance::default().with_branching(&first_open));
    assert!(solution.is_optimal());
    assert_eq!(solution.objective(), Some(2.0));
    let statistics = solution.statistics();
    assert!(statistics.user_splits > 0);
    assert_eq!(statistics.refused_splits, 0);
}

#[test]
fn splits_that_divide_nothing_are_refused_and_counted() {
    let (mut model, x) = fractional();
    let y = model.continuous("y", 0.0, 1.0).unwrap();
    let other = foreign();
    for (variable, value) in [(y, 0.5), (other, 0.0), (x[0], f64::NAN), (x[0], 5.5), (x[0], -1.0)] {
        let rule = move |_: &NodeView<'_>| Some(SplitAt::new(variable, value));
        let solution = solve(&model, Guidance::default().with_branching(&rule));
        assert!(solution.is_optimal());
        assert_eq!(solution.objective(), Some(2.0));
        assert_eq!(solution.statistics().user_splits, 0);
        assert!(solution.statistics().refused_splits > 0, "{value}");
    }
}

#[test]
fn a_priority_of_another_model_is_an_error() {
    let (model, _) = fractional();
    let guidance = Guidance::default().with_priority(foreign(), 1);
    let mut control = Control::default().with_guidance(guidance);
    let error = BranchAndBound::default().solve_with(&model, &mut control).unwrap_err();
    assert!(
        matches!(error.kind(), ErrorKind::ForeignHandle { kind: "variable", index: 0, .. }),
        "{error}"
    );
}

/// A rule that watches sees which columns the search has split: those of high priority first.
#[test]
fn high_priorities_are_split_first() {
    let (model, x) = fractional();
    let last = x[7];
    let (with, without) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let split_first = |seen: &AtomicUsize, node: &NodeView<'_>| {
        let narrowed = |v: Variable| node.bounds(v).is_ok_and(|b| b.upper - b.lower < 5.0);
        if node.depth() == 1 && narrowed(last) {
            seen.fetch_add(1, Ordering::Relaxed);
        }
        None
    };
    let watch = |node: &NodeView<'_>| split_first(&with, node);
    let guidance = Guidance::default().with_priority(last, 1).with_branching(&watch);
    assert_eq!(solve(&model, guidance).objective(), Some(2.0));
    let watch = |node: &NodeView<'_>| split_first(&without, node);
    assert_eq!(solve(&model, Guidance::default().with_branching(&watch)).objective(), Some(2.0));
    assert!(with.into_inner() > 0);
    assert_eq!(without.into_inner(), 0);
}

#[test]
fn proposed_points_are_completed_and_counted() {
    let (model, x) = fractional();
    let propose = |_: &NodeView<'_>| x.iter().take(4).map(|v| (v, 2.0)).collect();
    // Other heuristics may find the optimum first.
    let options = Options::default().with_heuristics(Heuristics::none());
    let mut control = Control::default().with_guidance(Guidance::default().with_proposal(&propose));
    let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
    assert_eq!(solution.objective(), Some(2.0));
    let count = solution.statistics().heuristics.of(Heuristic::Proposal);
    assert!(count.calls > 0 && count.points > 0, "{count:?}");
}

/// What splits a node takes as long as relaxing it, so a search that is over does not begin to.
#[test]
fn a_node_is_not_split_after_the_end() {
    let (model, _) = fractional();
    let interrupt = Interrupt::new();
    let propose = |_: &NodeView<'_>| {
        interrupt.trigger();
        Vec::new()
    };
    let guidance = Guidance::default().with_proposal(&propose);
    let mut control = Control::default().with_guidance(guidance).with_interrupt(&interrupt);
    let options = Options::default().with_heuristics(Heuristics::none());
    let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
    assert_eq!(solution.termination(), Termination::Interrupted);
    let counts = solution.statistics();
    assert_eq!((counts.nodes, counts.split, counts.unfinished), (1, 0, 1), "{counts:?}");
    // The relaxed root, proved.
    assert!(solution.bound().abs() < 1e-6, "{}", solution.bound());
}
