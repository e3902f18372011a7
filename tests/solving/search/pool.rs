//! Pools of points, against enumeration.

use carom::ErrorKind;
use carom::model::PiecewiseAffine;
use carom::prelude::*;
use carom::solver::{Heuristics, PoolMode};
use proptest::prelude::*;

use super::knapsack;
use crate::common::config;
use crate::common::enumeration::all_optima;
use crate::common::generate::{Shape, case};

/// The values of the integer variables.
fn integers(model: &Model, values: &[f64]) -> Vec<i64> {
    let all = model.variables().zip(values);
    all.filter(|(v, _)| v.kind().is_integral()).map(|(_, x)| x.round() as i64).collect()
}

proptest! {
    #![proptest_config(config(150, "tests/regressions/pool.txt"))]

    /// The proved pool is what enumeration finds; and so it is on two threads and in rounds.
    #[test]
    fn the_best_points_are_the_best_ones(
        case in case(Shape::BOUNDED),
        size in 1..=7_usize,
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
    ) {
        let (model, _) = case.build();
        let options = Options::default()
            .with_pool(size, PoolMode::Best)
            .with_threads(threads)
            .with_deterministic(deterministic);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        let wanted = all_optima(&case);
        let pool = solution.pool();
        prop_assert_eq!(pool.len(), size.min(wanted.len()), "{:?}", wanted);
        prop_assert!(pool.is_complete());
        let mut seen = Vec::new();
        for (found, (_, value)) in pool.iter().zip(&wanted) {
            prop_assert!(found.verification().holds());
            let cost = case.sign() * found.objective();
            let near = |value: f64| (cost - value).abs() < 1e-5 * value.abs().max(1.0);
            prop_assert!(near(*value), "{} instead of {}", cost, value);
            let key = integers(&model, found.point().as_slice());
            let own = wanted.iter().find(|(integers, _)| *integers == key);
            prop_assert!(own.is_some_and(|(_, value)| near(*value)), "{:?}", key);
            prop_assert!(!seen.contains(&key), "{:?} twice", key);
            seen.push(key);
        }
        if let (Some(first), Some(point)) = (pool.iter().next(), solution.point()) {
            prop_assert_eq!(first.point(), point);
        }
    }

    /// Points that were met are verified, distinct and in order, and change nothing of the answer.
    #[test]
    fn points_that_were_met_are_points(case in case(Shape::BOUNDED), size in 2..=5_usize) {
        let (model, _) = case.build();
        // Pools are searched for in the program as it is.
        let options = Options::default().with_presolve(false);
        let plain = BranchAndBound::new(options.clone()).solve(&model).unwrap();
        let options = options.with_pool(size, PoolMode::Found);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        prop_assert_eq!(solution.termination(), plain.termination());
        if let (Some(found), Some(best)) = (solution.objective(), plain.objective()) {
            prop_assert!((found - best).abs() < 1e-5 * best.abs().max(1.0));
        }
        let pool = solution.pool();
        prop_assert!(pool.len() <= size && (!pool.is_complete() || pool.is_empty()));
        prop_assert!(pool.iter().all(|p| p.verification().holds()));
        let costs: Vec<f64> = pool.iter().map(|p| case.sign() * p.objective()).collect();
        prop_assert!(costs.windows(2).all(|w| w[0] <= w[1]));
        let mut keys: Vec<_> =
            pool.iter().map(|p| integers(&model, p.point().as_slice())).collect();
        keys.sort();
        keys.dedup();
        prop_assert_eq!(keys.len(), pool.len());
    }
}

#[test]
fn the_gap_of_a_pool_is_kept() {
    let model = knapsack(10, 5);
    let all = Options::default().with_pool(1000, PoolMode::Best);
    let all = BranchAndBound::new(all).solve(&model).unwrap();
    assert!(all.pool().is_complete() && all.pool().len() > 20);
    let best = all.objective().unwrap();
    let options = Options::default().with_pool(1000, PoolMode::Best).with_pool_gap(0.05);
    let near = BranchAndBound::new(options).solve(&model).unwrap();
    let wanted = all.pool().iter().filter(|p| p.objective() >= best - 0.05 * best).count();
    assert!(wanted > 1 && wanted < all.pool().len());
    assert_eq!(near.pool().len(), wanted);
    assert!(near.pool().is_complete());
    assert!(near.statistics().nodes < all.statistics().nodes);
}

/// The proof of the optimum is the proof of the best point, and that of a pool of one point.
#[test]
fn a_pool_of_one_point_is_proved_with_the_optimum() {
    let one = |mode| Options::default().with_pool(1, mode);
    let best = BranchAndBound::new(one(PoolMode::Best)).solve(&knapsack(10, 5)).unwrap();
    assert!(best.is_optimal() && best.pool().is_complete() && best.pool().len() == 1);
    let stopped = one(PoolMode::Best).with_node_limit(1).with_heuristics(Heuristics::none());
    let stopped = BranchAndBound::new(stopped).solve(&knapsack(20, 2)).unwrap();
    assert!(!stopped.is_optimal() && !stopped.pool().is_complete());
    let found = BranchAndBound::new(one(PoolMode::Found)).solve(&knapsack(10, 5)).unwrap();
    assert!(!found.pool().is_complete());
    let mut none = knapsack(10, 5);
    let x = none.binary("never").unwrap();
    none.add("no", x.ge(2.0)).unwrap();
    let none = BranchAndBound::new(one(PoolMode::Best)).solve(&none).unwrap();
    assert!(none.is_infeasible() && none.pool().is_complete() && none.pool().is_empty());
}

#[test]
fn a_stopped_search_proves_no_pool() {
    let options = Options::default().with_pool(50, PoolMode::Best).with_node_limit(10);
    let solution = BranchAndBound::new(options).solve(&knapsack(20, 2)).unwrap();
    assert!(!solution.pool().is_complete());
}

#[test]
fn sizes_out_of_range_are_refused() {
    for options in [
        Options::default().with_pool(0, PoolMode::Found),
        Options::default().with_pool(2, PoolMode::Best).with_pool_gap(f64::NAN),
    ] {
        let refused = BranchAndBound::new(options).solve(&knapsack(3, 0));
        assert!(matches!(refused.unwrap_err().kind(), ErrorKind::OutOfRange { .. }));
    }
}

/// A commitment of units with piecewise costs over some steps: most integers of its lowered form
/// are auxiliary, and may take either value where nothing flows. With the binaries that are the
/// user's.
fn commitment(demand: &[u8], prices: &[u8]) -> (Model, Vec<Variable>) {
    let mut model = Model::new("commitment");
    let (mut cost, mut switches) = (Affine::zero(), Vec::new());
    let curve = [(0.0, 0.0), (2.0, 3.0), (4.0, 4.0), (6.0, 9.0)];
    let curve = PiecewiseAffine::new(curve).unwrap();
    let units = prices.len();
    let on: Vec<_> =
        (0..units).map(|u| model.binary_family(&format!("on{u}"), demand.len()).unwrap()).collect();
    for (t, &demand) in demand.iter().enumerate() {
        let mut power = Affine::zero();
        for (u, &price) in prices.iter().enumerate() {
            let p = model.semicontinuous((format!("p{u}"), t), 1.0, 6.0).unwrap();
            let burnt = model.piecewise((format!("cost{u}"), t), p, &curve).unwrap();
            model.add((format!("off{u}"), t), on[u][t].off().implies(p.le(0.0))).unwrap();
            model.add((format!("lit{u}"), t), on[u][t].on().implies(p.ge(1.0))).unwrap();
            cost += (1.0 + 0.1 * f64::from(price)) * burnt + 0.3 * f64::from(price) * on[u][t];
            if t > 0 {
                model.add((format!("ramp{u}"), t), (on[u][t] - on[u][t - 1]).ge(-1.0)).unwrap();
            }
            power += p;
            switches.push(on[u][t]);
        }
        let store = model.semicontinuous(("store", t), 0.5, 1.0).unwrap();
        cost += 0.9 * store;
        model.add(("balance", t), (power + store).ge(f64::from(demand))).unwrap();
    }
    model.minimize(cost).unwrap();
    (model, switches)
}

proptest! {
    #![proptest_config(config(20, "tests/regressions/pool.txt"))]

    /// Points differ by the user's integers, however many others the lowered model has.
    #[test]
    fn auxiliary_integers_tell_no_points_apart(
        demand in prop::collection::vec(0_u8..9, 2..4),
        prices in prop::collection::vec(0_u8..9, 1..3),
        size in 2_usize..6,
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
        cuts in any::<bool>(),
    ) {
        let (mut model, switches) = commitment(&demand, &prices);
        let options = Options::default()
            .with_pool(size, PoolMode::Best)
            .with_threads(threads)
            .with_deterministic(deterministic)
            .with_cuts(cuts);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        prop_assert!(solution.pool().is_complete());
        let mut values = Vec::new();
        for code in 0..1_u32 << switches.len() {
            for (k, &switch) in switches.iter().enumerate() {
                model.fix(switch, f64::from(code >> k & 1)).unwrap();
            }
            values.extend(BranchAndBound::default().solve(&model).unwrap().objective());
        }
        values.sort_by(f64::total_cmp);
        let found: Vec<f64> = solution.pool().iter().map(|point| point.objective()).collect();
        prop_assert_eq!(found.len(), size.min(values.len()));
        for (found, value) in found.iter().zip(&values) {
            prop_assert!((found - value).abs() < 1e-5, "{} instead of {}", found, value);
        }
    }
}

/// Auxiliary binaries that may take either value would each double the leaves; splitting at them,
/// or leaving out cuts, takes thousands of nodes.
#[test]
fn a_pool_of_a_commitment_takes_few_nodes() {
    let (model, _) = commitment(&[3, 9, 8, 4, 1, 7, 2, 0, 0, 6, 3, 5], &[2, 5, 7, 8]);
    let options = Options::default().with_pool(5, PoolMode::Best).with_node_limit(1000);
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.pool().is_complete(), "{}", solution.statistics().nodes);
    assert_eq!(solution.pool().len(), 5);
}
