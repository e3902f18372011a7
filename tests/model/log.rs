//! The log of a solve: how wide its lines are, what is told once, and how figures are shown.

use std::time::Duration;

use carom::prelude::*;
use carom::solution::Heuristic;
use carom::solver::{ProgramSize, Progress};

fn progress(nodes: u64, incumbent: Option<f64>, bound: f64) -> Progress {
    let mut progress =
        Progress::new(nodes, 3, 12, incumbent, bound, Duration::from_millis(100 * nodes));
    progress.found_by = incumbent.map(|_| Heuristic::Rounding);
    (progress.iterations, progress.cuts, progress.explored) = (1234, 5, Some(0.421));
    progress
}

fn text(log: Log<Vec<u8>>) -> String {
    String::from_utf8(log.into_inner().unwrap()).unwrap()
}

/// A model with a fraction at the root, and its log on lines of a width.
fn logged(width: usize) -> String {
    let mut model = Model::new("knapsack");
    let x = model.binary_family("x", 18).unwrap();
    let weight = |k: usize| 31.0 + ((k * 17) % 43) as f64;
    let load: Affine = x.iter().enumerate().map(|(k, x)| weight(k) * x).sum();
    model.add("room", load.le(411.0)).unwrap();
    let value = |k: usize| 1e4 + 37.0 + ((k * 29) % 41) as f64;
    model.maximize(x.iter().enumerate().map(|(k, x)| value(k) * x).sum::<Affine>()).unwrap();
    let mut log = Log::new(Vec::new()).with_width(width);
    log.say("a word or two before the search, which may need more than one of the lines");
    let mut record = |event: &Event| log.record(event);
    let mut control = Control::default().with_progress(&mut record);
    let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    log.finish(&solution);
    text(log)
}

#[test]
fn no_line_is_wider_than_the_terminal() {
    for width in 40..=120 {
        let text = logged(width);
        for line in text.lines() {
            assert!(line.chars().count() <= width, "{width}: {line}\n{text}");
        }
        for column in ["incumbent", "bound", "seconds"] {
            assert!(text.contains(column), "{width}: no {column} in\n{text}");
        }
        // A heading has the columns of the lines below it.
        let mut lines = text.lines().skip_while(|line| !line.contains("  incumbent "));
        let (heading, line) = (lines.next().unwrap(), lines.next().unwrap());
        assert_eq!(heading.len(), line.len(), "{width}:\n{text}");
    }
    let columns = |width: usize, name: &str| logged(width).contains(name);
    assert!(columns(80, "tree %") && columns(80, "open") && columns(80, "gap %"));
    assert!(columns(100, "iterations") && columns(100, "depth"));
    // What is narrower than all terminals counts as the narrowest.
    assert!(logged(0).lines().all(|line| line.len() <= 40));
}

/// The root has found a point, and an event of its own tells of it again.
#[test]
fn the_first_point_is_told_once() {
    let mut log = Log::new(Vec::new());
    let found = progress(1, Some(7.0), 9.0);
    log.record(&Event::Root(found));
    log.record(&Event::Incumbent(found));
    log.record(&Event::Incumbent(progress(2, Some(8.0), 9.0)));
    let text = text(log);
    let marked: Vec<&str> = text.lines().filter(|line| line.starts_with("R  ")).collect();
    assert_eq!(marked.len(), 2, "{text}");
    assert!(marked[0].contains(" 7 ") && marked[1].contains(" 8 "), "{text}");
    assert_eq!(text.lines().filter(|line| line.contains(" 7 ")).count(), 1, "{text}");
}

#[test]
fn the_columns_are_what_the_progress_says() {
    let mut log = Log::new(Vec::new());
    log.record(&Event::Relaxed(progress(0, None, 10.0)));
    log.record(&Event::Root(progress(1, None, 9.5)));
    let text = text(log);
    assert!(text.contains("bound of the root 10, after 1234 iterations (0.00 s)\n"), "{text}");
    assert!(text.contains("bound after 5 cuts 9.5 (0.10 s)\n"), "{text}");
    assert!(text.contains("tree % estimates the part of the tree that is done"), "{text}");
    let last: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
    assert_eq!(last, ["1", "3", "0", "1234", "-", "9.5", "-", "42.1", "0.10"]);
}

/// What rounding leaves of 0 is 0, beside larger numbers and without them; one is not many.
#[test]
fn remainders_are_zero_and_counts_agree() {
    for (incumbent, bound, shown) in
        [(-4.4e-16, -5e-16, ["0", "0"]), (1.0, 1e-13, ["1", "0"]), (1e-9, 1e-10, ["1e-9", "1e-10"])]
    {
        let mut log = Log::new(Vec::new());
        log.record(&Event::Root(progress(1, Some(incumbent), bound)));
        let text = text(log);
        let last: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(last[5..7], shown, "{text}");
    }
    let mut one = ProgramSize::default();
    (one.rows, one.columns, one.integers, one.nonzeros, one.cones) = (1, 1, 1, 1, 1);
    assert_eq!(one.to_string(), "1 row, 1 column (1 integral), 1 nonzero, 1 cone");
    let mut model = Model::new("m");
    let x = model.integer("x", 0.0, 10.0).unwrap();
    model.add("odd", (2.0 * x).within(3.0, 9.0)).unwrap();
    model.maximize(x).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let mut log = Log::new(Vec::new());
    log.finish(&solution);
    let text = text(log);
    for plural in [" 1 nodes", " 1 relaxations", " 1 iterations", " 1 calls", " 1 points"] {
        assert!(!text.contains(plural), "{text}");
    }
    assert!(text.contains("largest violation of the point: 0"), "{text}");
}
