//! Events of new best points, and the log.

use std::io::{self, Write};
use std::ops::ControlFlow;

use carom::prelude::*;
use carom::solution::Heuristic;

use super::knapsack;

/// Every point that is reported is feasible and better than the one before, and the last one is the
/// answer.
#[test]
fn incumbents_are_reported_with_their_points() {
    let model = knapsack(18, 4);
    for (threads, deterministic) in [(1, false), (2, false), (1, true), (2, true)] {
        let options = Options::default().with_threads(threads).with_deterministic(deterministic);
        let mut seen: Vec<(f64, Vec<f64>)> = Vec::new();
        let mut note = |best: &Incumbent<'_>| {
            assert_eq!(best.point.value(model.objective()), Ok(best.objective));
            assert!(Heuristic::ALL.contains(&best.found_by));
            assert!(Verification::of(&model, best.point, 1e-6).holds());
            seen.push((best.objective, best.point.as_slice().to_vec()));
            ControlFlow::Continue(())
        };
        let mut control = Control::default().with_incumbent(&mut note);
        let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
        assert!(seen.windows(2).all(|w| w[0].0 < w[1].0), "it maximises");
        assert_eq!(seen.len() as u64, solution.statistics().incumbents);
        let (objective, point) = seen.last().unwrap();
        assert_eq!(solution.objective(), Some(*objective));
        assert_eq!(solution.point().unwrap().as_slice(), point);
    }
}

#[test]
fn the_log_has_a_line_for_every_new_best_point() {
    let mut log = Log::new(Vec::new());
    let mut incumbents = 0;
    let mut callback = |event: &Event| {
        incumbents += usize::from(matches!(event, Event::Incumbent(_)));
        log.record(event);
    };
    let mut control = Control::default().with_progress(&mut callback);
    let solution = BranchAndBound::default().solve_with(&knapsack(18, 4), &mut control).unwrap();
    log.finish(&solution);
    let text = String::from_utf8(log.into_inner().unwrap()).unwrap();
    let heading =
        "      nodes     open  depth        incumbent            bound     gap %   seconds";
    assert_eq!(text.lines().next().unwrap(), heading);
    let marked = text.lines().filter(|line| {
        let mut letters = line.chars();
        letters.next().is_some_and(|mark| mark != ' ')
            && letters.next() == Some(' ')
            && line.len() == heading.len()
    });
    assert_eq!(marked.count(), incumbents);
    assert!(text.contains("optimal: objective"), "{text}");
    assert!(text.contains("time: propagation"), "{text}");
}

#[test]
fn a_writer_that_fails_is_reported_once() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::Error::other("full"))
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut log = Log::new(Full);
    let mut callback = |event: &Event| log.record(event);
    let mut control = Control::default().with_progress(&mut callback);
    let solution = BranchAndBound::default().solve_with(&knapsack(5, 0), &mut control).unwrap();
    assert!(solution.is_optimal());
    assert!(log.into_inner().is_err());
}
