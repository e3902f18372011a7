//! Every rule of branching leads to the same answer.
//!
//! Random programs are compared with enumeration under each rule. Horizons are random chains of up
//! to twelve steps, whose exact answer is a recursion over their states: all their numbers are
//! whole, and differences of neighbours are limited, so a whole trajectory is as good as any.

use std::collections::BTreeMap;

use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use carom::prelude::*;
use carom::solver::BranchingRule;
use proptest::prelude::*;
use proptest::sample::select;

const RULES: [BranchingRule; 3] =
    [BranchingRule::Automatic, BranchingRule::Pseudocosts, BranchingRule::LatestFirst];

/// Agreement of objectives, relative and absolute.
const AGREEMENT: f64 = 1e-6;

/// Largest state.
const TOP: i64 = 12;

/// A state that drifts within limits and jumps at events.
#[derive(Debug, Clone)]
struct Chain {
    /// Jump and cost of each step's event.
    steps: Vec<(i64, i64)>,
    drift: [i64; 2],
    ends: [i64; 2],
    /// Whether events have their cost.
    priced: bool,
    /// In which order the columns are created.
    stride: usize,
}

fn chain() -> impl Strategy<Value = Chain> {
    let steps = prop::collection::vec((-4..=4i64, 0..=3i64), 8..=12);
    let drift = select(vec![[-1, 0], [0, 1], [-1, 1], [1, 2], [-2, -1]]);
    let stride = select(vec![1usize, 5, 7, 11]);
    (steps, drift, 0..=TOP, 0..=TOP, any::<bool>(), stride).prop_map(
        |(steps, drift, start, goal, priced, stride)| Chain {
            steps,
            drift,
            ends: [start, goal],
            priced,
            stride,
        },
    )
}

impl Chain {
    fn model(&self) -> Model {
        let n = self.steps.len();
        let mut model = Model::new("chain");
        let mut columns = BTreeMap::new();
        for k in 0..=n {
            // Strides are prime to all numbers of states but two, which keep their order.
            let stride = if (n + 1).is_multiple_of(self.stride) { 1 } else { self.stride };
            let t = k * stride % (n + 1);
            let state = model.continuous(format!("state_{t}"), 0.0, TOP as f64).unwrap();
            let event = model.binary(format!("event_{t}")).unwrap();
            columns.insert(t, (state, event));
        }
        let mut cost = Affine::zero();
        for (t, &(jump, price)) in self.steps.iter().enumerate() {
            let ((now, event), (next, _)) = (columns[&t], columns[&(t + 1)]);
            let limits = self.drift.map(|d| d as f64);
            let step = next - now - jump as f64 * event;
            model.add(format!("step_{t}"), step.within(limits[0], limits[1])).unwrap();
            cost += price as f64 * event;
        }
        let (first, last) = (columns[&0].0, columns[&n].0);
        model.fix(first, self.ends[0] as f64).unwrap();
        model.fix(last, self.ends[1] as f64).unwrap();
        model.fix(columns[&n].1, 0.0).unwrap();
        if self.priced {
            model.minimize(cost).unwrap();
        }
        model
    }

    /// The least cost, by a recursion over steps.
    fn least_cost(&self) -> Option<i64> {
        let mut costs = BTreeMap::from([(self.ends[0], 0)]);
        for &(jump, price) in &self.steps {
            let mut next: BTreeMap<i64, i64> = BTreeMap::new();
            for (&state, &cost) in &costs {
                for (moved, cost) in [(0, cost), (jump, cost + if self.priced { price } else { 0 })]
                {
                    for drift in self.drift[0]..=self.drift[1] {
                        let state = state + moved + drift;
                        if (0..=TOP).contains(&state) {
                            let entry = next.entry(state).or_insert(cost);
                            *entry = cost.min(*entry);
                        }
                    }
                }
            }
            costs = next;
        }
        costs.get(&self.ends[1]).copied()
    }
}

proptest! {
    #![proptest_config(config(32, "tests/regressions/branching_rules.txt"))]

    #[test]
    fn rules_agree_with_enumeration(
        case in prop_oneof![case(Shape::BOUNDED), case(Shape::FEASIBILITY)],
    ) {
        let (model, _) = case.build();
        for rule in RULES {
            let options = Options::default().with_branching(rule);
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            let optimum = match optimum(&case) {
                Minimum::Attained { value, .. } => value,
                _ => {
                    let ended = solution.termination();
                    prop_assert_eq!(ended, Termination::Infeasible, "{:?} {}", rule, model);
                    continue;
                }
            };
            prop_assert!(solution.is_optimal(), "{rule:?} {} {model}", solution.termination());
            let cost = case.sign() * solution.objective().unwrap();
            let allowed = AGREEMENT * optimum.abs().max(1.0);
            prop_assert!((cost - optimum).abs() <= allowed, "{rule:?}: {cost}, {optimum}\n{model}");
        }
    }

    #[test]
    fn rules_agree_on_chains(chain in chain(), threads in 1usize..3) {
        let model = chain.model();
        for rule in RULES {
            let options = Options::default().with_branching(rule).with_threads(threads);
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            match chain.least_cost() {
                None => {
                    let ended = solution.termination();
                    prop_assert_eq!(ended, Termination::Infeasible, "{:?} {}", rule, model);
                }
                Some(cost) => {
                    prop_assert!(solution.is_optimal(), "{rule:?} {model}");
                    let found = solution.objective().unwrap();
                    prop_assert!((found - cost as f64).abs() <= AGREEMENT, "{rule:?}: {found}, {cost}");
                }
            }
        }
    }
}
