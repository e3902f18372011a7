//! Integers without bounds, or with bounds beyond all digits.

use crate::common::config;
use crate::torture::families::{Family, Path};
use crate::torture::oracle::Verdict;
use carom::model::lp;
use carom::prelude::*;
use proptest::prelude::*;

const REGRESSIONS: &str = "tests/regressions/open_integers.txt";

/// Most nodes of a tiny program.
const NODES: u64 = 500;

fn solve(text: &str) -> Solution {
    let model = lp::read(text).expect("a readable file").model;
    let options = Options::default().with_node_limit(NODES);
    BranchAndBound::new(options).solve(&model).expect("a solvable model")
}

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    /// Equalities over whole numbers that a binary makes impossible by divisibility alone.
    #[test]
    fn equalities_with_open_integers(seed in any::<u64>()) {
        let family = Family::OpenIntegers;
        let case = family.program(seed);
        let (model, variables) = case.build();
        let truth = family.truth(&case);
        let options = Path::Usual.options().with_node_limit(NODES);
        let solution =
            BranchAndBound::new(options.clone()).solve(&model).expect("a solvable model");
        let verdict = family.judge(&case, &variables, &options, &solution, &truth);
        prop_assert_eq!(verdict, Verdict::Right, "seed {}: {:?}", seed, solution.termination());
    }

    /// Whole numbers between -1e15 and 1e20 with a point near 0: no bound refutes it, and what is
    /// found is a point.
    #[test]
    fn far_bounds_refute_no_point(
        columns in prop::collection::vec((0..5usize, 0..4usize, -5..=5i32), 2..=5),
        rows in prop::collection::vec((prop::collection::vec(-4..=5i32, 5), 0..3u8, 0..4i32), 1..=4),
    ) {
        let mut text = "Minimize\n obj: 0 x0\nSubject To\n".to_owned();
        for (i, (coefficients, kind, room)) in rows.iter().enumerate() {
            let pairs = || coefficients.iter().zip(&columns);
            let terms = coefficients.iter().take(columns.len()).enumerate();
            let terms = terms.map(|(j, a)| format!(" {a:+} x{j}"));
            let terms: String = terms.collect();
            let activity: i32 = pairs().map(|(a, column)| a * column.2).sum();
            let limit = match kind {
                0 => format!("= {activity}"),
                1 => format!("<= {}", activity + room),
                _ => format!(">= {}", activity - room),
            };
            text += &format!(" r{i}: {terms} {limit}\n");
        }
        text += "Bounds\n";
        for (j, &(below, above, at)) in columns.iter().enumerate() {
            let lower = [f64::from(at), -1e15, -9e18, -1e17, 0.0_f64.min(f64::from(at))][below];
            let upper = [f64::from(at.max(0)), 1e16, 1e18, 9e19][above];
            text += &format!(" {lower} <= x{j} <= {upper}\n");
        }
        let names: String = (0..columns.len()).map(|j| format!(" x{j}")).collect();
        text += &format!("General\n{names}\nEnd\n");
        let solution = solve(&text);
        let ended = solution.termination();
        prop_assert!(matches!(ended, Termination::Optimal | Termination::NodeLimit), "{ended} {text}");
        prop_assert!(solution.verification().is_none_or(|found| found.holds()), "{}", text);
    }
}

/// A quarter counted as rounding between numbers of 1e14, so that a row became an equality without
/// a solution.
#[test]
fn a_quarter_beside_large_numbers() {
    for upper in [2, 5] {
        let text = format!(
            "Minimize\n obj: 0 x0\nSubject To\n r0: 4 x0 + x1 = 1\nBounds\n\
             0 <= x0 <= 4000000000000000\n -1000000000000000 <= x1 <= {upper}\nGeneral\n x0 x1\nEnd\n"
        );
        assert_eq!(solve(&text).termination(), Termination::Optimal);
    }
}

/// Without an end, because every relaxation of `x4 = 1` has a point, however far its integers are.
#[test]
fn a_binary_that_divisibility_decides() {
    let text = "Minimize\n obj: 0.5 x2\nSubject To\n r0: 1 x4 + 2 x0 + 1 x3 >= 2\n\
                r1: - 1000 x0 + 2000 x1 + 1000 x2 = 6000\n\
                r2: - 1500 x3 + 2000 x1 + 500 x0 - 2000 x4 = 4500\n\
                Bounds\n 0 <= x2 <= 1\n 0 <= x4 <= 1\nGeneral\n x0 x1 x3\nBinary\n x2 x4\nEnd\n";
    let solution = solve(text);
    assert_eq!(solution.termination(), Termination::Optimal);
    assert_eq!(solution.objective(), Some(0.0));
    // The same where the binary decides a continuous column.
    let text = text
        .replace("Bounds", " r3: c - 2000 x4 = 0\nBounds")
        .replace("- 2000 x4 = 4500", "- c = 4500");
    let solution = solve(&text);
    assert_eq!(solution.termination(), Termination::Optimal);
    assert_eq!(solution.objective(), Some(0.0));
}

/// Equalities that are solvable one by one, but not together, and equalities that other rules have
/// divided: a tree over their integers has no end.
#[test]
fn hardly_any_tree_over_open_integers_ends_at_a_limit() {
    let family = Family::OpenIntegers;
    let is_open = |seed: &u64| {
        let (model, _) = family.program(*seed).build();
        let options = Path::Usual.options().with_node_limit(NODES);
        let solution = BranchAndBound::new(options).solve(&model).expect("a solvable model");
        solution.termination().is_limit()
    };
    let known = [91_000_266, 11_000_142, 11_000_435, 21_000_403, 21_000_592];
    assert_eq!(known.iter().copied().filter(is_open).collect::<Vec<u64>>(), Vec::<u64>::new());
    assert!((0..500).filter(is_open).count() <= 1);
}
