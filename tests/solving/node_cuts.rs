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

const BINARIES: usize = 13;

fn covers() -> impl Strategy<Value = Covers> {
    let whole = |range: std::ops::RangeInclusive<i32>| range.prop_map(f64::from);
    let sizes = prop::collection::vec(whole(0..=30), BINARIES);
    let demand = (whole(40..=160), sizes, [whole(1..=9), whole(1..=9)]);
    let demands = prop::collection::vec(demand, 5..9);
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
            let less = model.continuous(("less", i), 0.0, 500.0).unwrap();
            let more = model.continuous(("more", i), 0.0, 500.0).unwrap();
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

/// Nodes of a search, and whether its optimum and bound are those of the enumeration.
fn search(covers: &Covers, has_cuts: bool) -> (u64, Result<(), TestCaseError>) {
    let options = Options::default().with_cuts(has_cuts).with_gap(1e-9);
    let solution = BranchAndBound::new(options).solve(&covers.model()).unwrap();
    let least = covers.least_cost();
    let check = || {
        prop_assert!(solution.is_optimal());
        prop_assert!((solution.objective().unwrap() - least).abs() <= 1e-6 * least.max(1.0));
        prop_assert!(solution.bound() <= least + 1e-6 * least.max(1.0));
        prop_assert_eq!(solution.statistics().contradictions, 0);
        Ok(())
    };
    (solution.statistics().nodes, check())
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/node_cuts.txt"))]

    #[test]
    fn cuts_at_nodes_keep_the_optimum(covers in covers()) {
        for has_cuts in [false, true] {
            search(&covers, has_cuts).1?;
        }
    }
}

/// Many of these trees are so large that nodes are cut, and smaller than without cuts.
#[test]
fn trees_with_cuts_are_smaller() {
    let mut runner = TestRunner::deterministic();
    let (mut without, mut with) = (0, 0);
    for _ in 0..12 {
        let covers = covers().new_tree(&mut runner).unwrap().current();
        without += search(&covers, false).0;
        with += search(&covers, true).0;
    }
    assert!(without > 12 * 100, "{without}");
    assert!(with < without, "{with} of {without}");
}
