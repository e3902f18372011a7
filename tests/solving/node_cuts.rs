//! Cuts that are found at nodes, beside an enumeration of all binaries.

use carom::prelude::*;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::common::config;

/// Demands that binaries cover in part, at a cost; what they do not cover is bought. So is what is
/// too much of it.
#[derive(Debug, Clone)]
struct Covers {
    costs: Vec<f64>,
    /// By demand: what is needed, what each binary adds, and the prices of less and of more.
    demands: Vec<(f64, Vec<f64>, [f64; 2])>,
    /// Most binaries that are 1 in each of some windows.
    window: usize,
}

const BINARIES: usize = 15;

fn covers() -> impl Strategy<Value = Covers> {
    let whole = |range: std::ops::RangeInclusive<i32>| range.prop_map(f64::from);
    let sizes = prop::collection::vec(whole(0..=99), BINARIES);
    // A share of what all binaries add.
    let demand = (0.3..0.6, sizes, [whole(1..=9), whole(1..=9)]);
    let demand = demand.prop_map(|(share, sizes, prices): (f64, Vec<f64>, [f64; 2])| {
        ((share * sizes.iter().sum::<f64>()).floor(), sizes, prices)
    });
    let demands = prop::collection::vec(demand, 3..5);
    let costs = prop::collection::vec(whole(1..=25), BINARIES);
    (costs, demands, 3..7_usize).prop_map(|(costs, demands, window)| Covers {
        costs,
        demands,
        window,
    })
}

impl Covers {
    fn model(&self) -> Model {
        let mut model = Model::new("covers");
        let z: Vec<_> = (0..BINARIES).map(|j| model.binary(("z", j)).unwrap()).collect();
        let mut cost: Affine = z.iter().zip(&self.costs).map(|(&z, c)| *c * z).sum();
        for (i, (need, sizes, prices)) in self.demands.iter().enumerate() {
            let less = model.continuous(("less", i), 0.0, 2000.0).unwrap();
            let more = model.continuous(("more", i), 0.0, 2000.0).unwrap();
            let covered: Affine = z.iter().zip(sizes).map(|(&z, size)| *size * z).sum();
            model.add(("demand", i), (covered + less - more).equals(*need)).unwrap();
            cost += prices[0] * less + prices[1] * more;
        }
        for (k, part) in z.chunks(self.window).enumerate() {
            let sum: Affine = part.iter().map(|&z| Affine::from(z)).sum();
            model.add(("window", k), sum.le(part.len() as f64 - 1.0)).unwrap();
        }
        model.minimize(cost).unwrap();
        model
    }

    fn least_cost(&self) -> f64 {
        let cost = |set: usize| {
            let of = |values: &[f64]| -> f64 {
                (0..BINARIES).filter(|j| set >> j & 1 == 1).map(|j| values[j]).sum()
            };
            let bought = self.demands.iter().map(|(need, sizes, prices)| {
                let left = need - of(sizes);
                if left > 0.0 { prices[0] * left } else { -prices[1] * left }
            });
            of(&self.costs) + bought.sum::<f64>()
        };
        let is_allowed = |set: &usize| {
            let full = |start: usize| {
                let end = (start + self.window).min(BINARIES);
                (start..end).all(|j| set >> j & 1 == 1)
            };
            !(0..BINARIES).step_by(self.window).any(full)
        };
        (0..1 << BINARIES).filter(is_allowed).map(cost).fold(f64::INFINITY, f64::min)
    }
}

fn search(covers: &Covers, has_cuts: bool) -> Solution {
    let options = Options::default().with_cuts(has_cuts).with_relative_gap(1e-9);
    BranchAndBound::new(options).solve(&covers.model()).unwrap()
}

proptest! {
    #![proptest_config(config(8, "tests/regressions/node_cuts.txt"))]

    #[test]
    fn cuts_at_nodes_keep_the_optimum(covers in covers()) {
        let least = covers.least_cost();
        for has_cuts in [false, true] {
            let solution = search(&covers, has_cuts);
            prop_assert!(solution.is_optimal());
            prop_assert!((solution.objective().unwrap() - least).abs() <= 1e-6 * least.max(1.0));
            prop_assert!(solution.bound() <= least + 1e-6 * least.max(1.0));
            prop_assert_eq!(solution.statistics().contradictions, 0);
        }
    }
}

/// Many of these trees are so large that nodes are cut.
#[test]
fn trees_are_large_enough_for_cuts() {
    let mut runner = TestRunner::deterministic();
    let tree = |_| {
        let covers = covers().new_tree(&mut runner).unwrap().current();
        search(&covers, true).statistics().nodes
    };
    let nodes: u64 = (0..8).map(tree).sum();
    assert!(nodes > 8 * 60, "{nodes}");
}
