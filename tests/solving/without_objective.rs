//! Programs without an objective that take many nodes, so that they are searched in turns.

use carom::prelude::*;
use proptest::prelude::*;

/// Market splitting: several sums over the same binaries have to be exact. Splits tell little, so
/// the tree is large for its size.
fn market_split(weights: &[Vec<u8>], targets: &[u32]) -> (Model, Vec<Variable>) {
    let mut model = Model::new("market split");
    let x = model.binary_family("x", weights[0].len()).unwrap();
    for (k, (row, target)) in weights.iter().zip(targets).enumerate() {
        let sum: Affine = x.iter().zip(row).map(|(x, &w)| f64::from(w) * x).sum();
        model.add(("sum", k), sum.equals(f64::from(*target))).unwrap();
    }
    let x = x.iter().collect();
    (model, x)
}

fn sums(weights: &[Vec<u8>], subset: u32) -> Vec<u32> {
    let sum = |row: &Vec<u8>| {
        let chosen = row.iter().enumerate().filter(|(j, _)| subset >> j & 1 == 1);
        chosen.map(|(_, &w)| u32::from(w)).sum()
    };
    weights.iter().map(sum).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// By enumeration; with targets that are met by a subset, or are half of all.
    #[test]
    fn turns_find_what_enumeration_finds(
        weights in prop::collection::vec(prop::collection::vec(1_u8..100, 16), 2..4),
        subset in prop::option::of(0_u32..1 << 16),
        threads in 1_usize..3,
        deterministic: bool,
    ) {
        let targets: Vec<u32> = match subset {
            Some(subset) => sums(&weights, subset),
            None => sums(&weights, u32::MAX).iter().map(|all| all / 2).collect(),
        };
        let exists = (0..1_u32 << 16).any(|subset| sums(&weights, subset) == targets);
        let (model, x) = market_split(&weights, &targets);
        let options = Options::default().with_threads(threads).with_deterministic(deterministic);
        let (mut seen, mut nodes) = (Vec::new(), 0);
        let mut count = |event: &Event| {
            assert!(event.progress().nodes >= nodes, "nodes are counted over all turns");
            nodes = event.progress().nodes;
            seen.push(event.clone());
        };
        let mut control = Control::default().with_progress(&mut count);
        let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
        prop_assert_eq!(solution.point().is_some(), exists, "{}", solution.termination());
        prop_assert_eq!(solution.is_infeasible(), !exists);
        let roots = seen.iter().filter(|event| matches!(event, Event::Root(_))).count();
        prop_assert!(roots <= 1, "{} roots", roots);
        if exists {
            prop_assert!(solution.is_optimal());
            prop_assert_eq!((solution.objective(), solution.bound()), (Some(0.0), 0.0));
            let chosen = x.iter().enumerate().filter(|(_, x)| solution.value(**x).unwrap() > 0.5);
            let subset = chosen.fold(0, |subset, (j, _)| subset | 1 << j);
            prop_assert_eq!(sums(&weights, subset), targets);
        }
    }
}

#[test]
fn a_limit_of_nodes_counts_all_turns() {
    let weights: Vec<Vec<u8>> = (0..4_u16)
        .map(|k| (0..30_u16).map(|j| 1 + ((37 * j + 61 * k * j + 13 * k) % 99) as u8).collect())
        .collect();
    let targets: Vec<u32> = sums(&weights, u32::MAX >> 2).iter().map(|all| all / 2).collect();
    let (model, _) = market_split(&weights, &targets);
    for limit in [1, 50, 100, 101, 499, 700, 3000] {
        let options = Options::default().with_node_limit(limit);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        if solution.point().is_none() {
            assert_eq!(solution.termination(), Termination::NodeLimit);
            assert_eq!(solution.statistics().nodes, limit);
        }
    }
}

/// Who plays whom in which round, each once: any table will do, or one in which nobody plays on the
/// first court twice in a row, which costs. A local search finds one before the first relaxation.
#[test]
fn a_timetable_needs_no_relaxation() {
    const TEAMS: usize = 10;
    for costs in [false, true] {
        let mut model = Model::new("timetable");
        let pairs: Vec<(usize, usize)> =
            (0..TEAMS).flat_map(|a| (a + 1..TEAMS).map(move |b| (a, b))).collect();
        let plays: Vec<_> = (0..pairs.len())
            .map(|k| model.binary_family(&format!("m{k}_"), TEAMS - 1).unwrap().iter().collect())
            .collect::<Vec<Vec<Variable>>>();
        for (k, rounds) in plays.iter().enumerate() {
            let sum: Affine = rounds.iter().map(|&v| 1.0 * v).sum();
            model.add(("once", k), sum.equals(1.0)).unwrap();
        }
        for team in 0..TEAMS {
            for round in 0..TEAMS - 1 {
                let own = pairs.iter().zip(&plays).filter(|((a, b), _)| *a == team || *b == team);
                let sum: Affine = own.map(|(_, rounds)| 1.0 * rounds[round]).sum();
                model.add(("one", team * TEAMS + round), sum.equals(1.0)).unwrap();
            }
        }
        if costs {
            let early: Affine = plays.iter().take(3).map(|rounds| 1.0 * rounds[0]).sum();
            model.minimize(early).unwrap();
        }
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert_eq!(solution.termination(), Termination::Optimal);
        assert_eq!(solution.objective(), Some(0.0));
        assert_eq!(solution.statistics().nodes, 0, "costs: {costs}");
    }
}
