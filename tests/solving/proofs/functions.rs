//! Proofs of programs with functions: accepted as they are written, with claims that are true, and
//! rejected once they are damaged.

use std::time::Duration;

use carom::prelude::*;
use carom_proof::{Claim, check};
use proptest::prelude::*;

use super::{file, is_proved, solved};
use crate::nonlinear::case;

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// The claims of random programs, against brackets of their optima.
    #[test]
    fn claims_are_true_and_proved(case in case()) {
        let Ok((model, _)) = case.model() else { return Ok(()) };
        let path = file("functions_random");
        let mut solver = BranchAndBound::new(Options::default().with_proof(&path));
        solver.options_mut().relative_gap = 1e-4;
        solver.options_mut().absolute_gap = 1e-4;
        solver.options_mut().time_limit = Some(Duration::from_secs(5));
        let solution = solver.solve(&model).unwrap();
        let log = std::fs::read(&path).unwrap_or_default();
        // Products with binaries alone become rows.
        if !String::from_utf8_lossy(&log).contains("\nterms ") {
            return Ok(());
        }
        let Some(report) = solution.proof().filter(|report| report.is_complete) else {
            // A limit may come first, but not where the search needs none.
            prop_assert!(solution.statistics().nodes > 100, "{:?}", solution.proof());
            return Ok(());
        };
        prop_assert_eq!(report.bytes, log.len() as u64);
        let proved = check(&log[..]);
        prop_assert!(proved.is_ok(), "{}", proved.unwrap_err());
        let (_, upper) = case.bracket(0.0);
        match proved.unwrap().claim {
            Claim::Infeasible => prop_assert!(solution.is_infeasible() && upper.is_infinite()),
            Claim::Bound(bound) => {
                prop_assert!(bound <= upper + 1e-9 * upper.abs().max(1.0), "{bound} of {upper}");
                let gap = 4e-4 * solution.bound().abs().max(1.0);
                prop_assert!((solution.bound() - bound).abs() <= gap, "{bound}");
            }
        }
    }
}

/// Each function in rows and objectives, integers, a product, a quotient and a norm.
fn mixed() -> Model {
    let mut model = Model::new("mixed");
    let x = model.continuous("x", -1.0, 2.0).expect("a variable");
    let y = model.continuous("y", 0.5, 3.0).expect("a variable");
    let n = model.integer("n", 0.0, 4.0).expect("a variable");
    model.add("wave", (x.sin() + (y * 2.0).cos()).le(0.9)).expect("a row");
    model.add("steep", (x.exp() - y.ln() + n).ge(2.5)).expect("a row");
    model.add("round", (x * x + y * y + n * n).le(12.0)).expect("a row");
    model.add("part", (x / y).le(0.8)).expect("a row");
    model.minimize(x * y + n.pow(1.5) + x.tanh() - y.sqrt()).expect("an objective");
    model
}

#[test]
fn mixed_functions_are_proved() {
    let solution = is_proved(&mixed(), "functions_mixed");
    assert!(solution.is_optimal());
    let mut none = mixed();
    let x = none.variable_by_name("x").expect("x");
    none.add("far", (x.exp() + x.atan()).ge(8.6)).expect("a row");
    assert!(is_proved(&none, "functions_none").is_infeasible());
}

/// The lines of a log with its count of steps made right.
fn recounted(lines: &[String]) -> String {
    let begin = lines.iter().position(|line| line == "proof").expect("a proof") + 1;
    let steps = &lines[begin..lines.len() - 1];
    let count = steps.iter().filter(|line| !line.starts_with('#')).count();
    format!("{}\nend {count}\n", lines[..lines.len() - 1].join("\n"))
}

#[test]
fn damaged_logs_of_functions_are_rejected() {
    let (_, log) = solved(&mixed(), "functions_damaged");
    let lines: Vec<String> =
        String::from_utf8(log).expect("text").lines().map(str::to_owned).collect();
    assert!(check(recounted(&lines).as_bytes()).is_ok());
    let places = |letter: &str| -> Vec<usize> {
        (0..lines.len()).filter(|&k| lines[k].starts_with(letter)).collect()
    };
    // Rows of functions that are moved by a thousandth: nearly all touch their functions.
    let rows = places("n ");
    let mut rejected = 0;
    for &k in &rows {
        let mut words: Vec<String> = lines[k].split(' ').map(str::to_owned).collect();
        let value: f64 = words[3].parse().expect("a number");
        let step = 1e-3 * value.abs().max(1.0);
        words[3] = if words[2] == "L" { value + step } else { value - step }.to_string();
        let mut damaged = lines.clone();
        damaged[k] = words.join(" ");
        rejected += usize::from(check(recounted(&damaged).as_bytes()).is_err());
    }
    assert!(!rows.is_empty() && 10 * rejected >= 9 * rows.len(), "{rejected} of {}", rows.len());
    // Each leaf that is left out leaves a case open.
    for k in places("x ") {
        let mut damaged = lines.clone();
        damaged.remove(k);
        assert!(check(recounted(&damaged).as_bytes()).is_err(), "{}", lines[k]);
    }
    // Ranges that are wider than those of the rows.
    for (from, to) in [("c c -1 2 x", "c c -1.5 2 x"), ("c c 0.5 3 y", "c c 0.5 3.5 y")] {
        let damaged: Vec<String> = lines.iter().map(|line| line.replace(from, to)).collect();
        assert_ne!(damaged, lines);
        assert!(check(recounted(&damaged).as_bytes()).is_err(), "{to}");
    }
}

#[test]
fn functions_of_ones_own_are_named() {
    use carom::interval::Interval;
    use carom::model::SmoothFunction;
    #[derive(Debug)]
    struct Drag;
    impl SmoothFunction for Drag {
        fn name(&self) -> &str {
            "drag"
        }
        fn value(&self, v: f64) -> f64 {
            v * v.abs()
        }
        fn derivative(&self, v: f64) -> f64 {
            2.0 * v.abs()
        }
        fn range(&self, v: Interval) -> Interval {
            Interval::new(v.lower * v.lower.abs(), v.upper * v.upper.abs())
        }
        fn slope_range(&self, v: Interval) -> Interval {
            Interval::new(0.0, 2.0 * v.lower.abs().max(v.upper.abs()))
        }
        fn curvature_range(&self, v: Interval) -> Interval {
            let sign = |v: f64| if v >= 0.0 { 2.0 } else { -2.0 };
            Interval::new(sign(v.lower), sign(v.upper))
        }
    }
    let mut model = Model::new("own");
    let v = model.continuous("v", -1.0, 2.0).expect("a variable");
    model.minimize(v.own(Drag) - v).expect("an objective");
    let (solution, log) = solved(&model, "functions_own");
    assert!(solution.proof().is_some_and(|report| report.is_complete));
    let text = check(&log[..]).expect("a proof").to_string();
    assert!(text.contains("assumed enclosure") && text.contains("of drag"), "{text}");
}
