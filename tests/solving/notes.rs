//! Remarks about searches that take long.

use carom::prelude::*;
use carom::solution::{Note, Outcome, Statistics};
use carom::solver::Heuristics;

/// A ring of pairs of which one has to be taken, with weights that nothing rounds up.
fn ring(count: usize) -> Model {
    let mut model = Model::new("ring");
    let x = model.binary_family("x", count).unwrap();
    for k in 0..count {
        for distance in [1, 3, 4] {
            let row = (x[k] + x[(k + distance) % count]).le(1.0);
            model.add((format!("pair {distance}").as_str(), k), row).unwrap();
        }
    }
    model
        .maximize(x.iter().enumerate().map(|(k, x)| (1.0 + k as f64 / 997.0) * x).sum::<Affine>())
        .unwrap();
    model
}

#[test]
fn a_search_without_a_point_and_one_with_a_wide_gap_say_so() {
    let mut model = ring(61);
    let heuristics = Heuristics::none();
    let options =
        Options::default().with_node_limit(120).with_cuts(false).with_heuristics(heuristics);
    let solution = BranchAndBound::new(options.clone()).solve(&model).unwrap();
    let gap = solution.relative_gap();
    assert_eq!(solution.termination(), Termination::NodeLimit);
    match solution.point() {
        Some(_) => assert_eq!(solution.notes(), [Note::WideGap { gap }]),
        None => assert_eq!(solution.notes(), [Note::NoPoint { nodes: 120 }]),
    }
    model.minimize(0.0).unwrap();
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.is_optimal());
    assert_eq!(solution.notes(), []);
}

/// The notes of a search with such counts, as text.
fn notes(count: impl FnOnce(&mut Statistics)) -> Vec<String> {
    let mut model = Model::new("m");
    model.binary("x").unwrap();
    let mut statistics = Statistics::default();
    count(&mut statistics);
    let outcome = Outcome::new(Termination::TimeLimit, None, f64::NEG_INFINITY, statistics);
    let solution = Solution::new(&model, outcome, 1e-6).unwrap();
    solution.notes().iter().map(ToString::to_string).collect()
}

#[test]
fn a_method_that_gives_up_is_named() {
    let text = "the first method gave up on 150 of 200 relaxations, which were solved twice; measure \
                variables in units that make their values about 1, or set `Options::relaxation` to the \
                second method [method-gives-up]";
    let given_up = |times, first, second| {
        notes(|counts| {
            counts.relaxation_counts.given_up = times;
            counts.relaxation_counts.active_set = first;
            counts.relaxation_counts.interior_point = second;
        })
    };
    assert_eq!(given_up(150, 200, 150), [text]);
    assert!(given_up(99, 99, 99).is_empty());
    assert!(given_up(100, 200, 100).is_empty());
}

#[test]
fn nodes_that_are_split_though_they_are_whole_are_named() {
    let text = "3000 of 3737 nodes were split although their integers were whole, so the search proves \
                digits; allow a larger gap, or leave out cuts [whole-splits]";
    let splits = |whole, all| notes(|counts| (counts.whole_splits, counts.split) = (whole, all));
    assert_eq!(splits(3000, 3737), [text]);
    assert!(splits(100, 400).is_empty());
    assert!(splits(90, 90).is_empty());
}
