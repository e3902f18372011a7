//! Events of new best points, and the log.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::time::Duration;

use carom::prelude::*;
use carom::solution::Heuristic;
use carom::solver::MipStart;

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

/// What presolve has left, the relaxed root and the root, in this order and once each, with bounds
/// that get tighter.
#[test]
fn the_phases_before_the_tree_are_told() {
    for threads in [1, 2] {
        let mut events = Vec::new();
        let mut note = |event: &Event| events.push(event.clone());
        let mut control = Control::default().with_progress(&mut note);
        let mut solver = BranchAndBound::new(Options::default().with_threads(threads));
        let solution = solver.solve_with(&knapsack(18, 4), &mut control).unwrap();
        let Event::Presolved(size, first) = &events[0] else { panic!("{:?}", events[0]) };
        assert!(size.rows >= 1 && size.columns <= 18 && size.integers == size.columns, "{size}");
        assert!(size.nonzeros <= size.rows * size.columns && size.cones == 0, "{size}");
        assert_eq!((first.nodes, first.incumbent, first.bound), (0, None, f64::INFINITY));
        let Event::Relaxed(relaxed) = &events[1] else { panic!("{:?}", events[1]) };
        assert!(relaxed.bound.is_finite() && relaxed.nodes == 0);
        let root = events.iter().find(|event| matches!(event, Event::Root(_))).unwrap();
        assert!(
            root.progress().bound <= relaxed.bound + 1e-9 * relaxed.bound.abs(),
            "it maximises"
        );
        assert!(solution.objective().unwrap() <= root.progress().bound + 1e-6);
        let early = |event: &&Event| matches!(event, Event::Presolved(..) | Event::Relaxed(_));
        assert_eq!(events.iter().filter(early).count(), 2, "{events:?}");
    }
}

/// Two programs that share nothing: the bound of one is not told as that of both.
#[test]
fn blocks_have_one_presolve_and_no_bound_of_a_part() {
    let mut model = Model::new("two");
    let mut objective = Affine::default();
    for part in ["a", "b"] {
        let x = model.binary_family(part, 14).unwrap();
        let weight = |k: usize| f64::from((31 * k as u32 + 7) % 23 + 5);
        let sum: Affine = (0..14).map(|k| weight(k) * x[k]).sum();
        model.add(format!("{part}_room"), sum.le(90.0)).unwrap();
        objective += (0..14).map(|k| (weight(k) + (k % 5) as f64) * x[k]).sum::<Affine>();
    }
    model.maximize(objective).unwrap();
    let mut events = Vec::new();
    let mut note = |event: &Event| events.push(event.clone());
    let mut control = Control::default().with_progress(&mut note);
    let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    let presolved = events.iter().filter(|event| matches!(event, Event::Presolved(..))).count();
    assert_eq!(presolved, 1, "{events:?}");
    for event in events.iter().filter(|event| matches!(event, Event::Relaxed(_))) {
        assert!(event.progress().bound >= solution.objective().unwrap() - 1e-6, "{event:?}");
    }
}

/// An interrupt while the root is cut keeps the bound that is proved by then, and the point of a
/// start.
#[test]
fn an_interrupt_before_the_tree_keeps_the_bound_and_the_start() {
    let model = knapsack(18, 4);
    let best = BranchAndBound::default().solve(&model).unwrap().objective().unwrap();
    let nothing = MipStart::new().with_values(model.variables().map(|x| (x.id(), 0.0)));
    for start in [None, Some(&nothing)] {
        let (interrupt, mut told) = (Interrupt::new(), f64::NAN);
        let mut stop = |event: &Event| {
            if let Event::Relaxed(progress) = event {
                told = progress.bound;
                interrupt.trigger();
            }
        };
        let mut control = Control::default().with_progress(&mut stop).with_interrupt(&interrupt);
        if let Some(start) = start {
            control = control.with_start(start);
        }
        let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
        assert_eq!(solution.termination(), Termination::Interrupted);
        assert!(best <= solution.bound() && solution.bound() <= told + 1e-6, "{told} {solution:?}");
        assert_eq!(solution.point().is_some(), start.is_some());
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
    let heading = "      nodes     open  depth iterations        incumbent            bound    gap % tree %  seconds";
    let above: Vec<&str> = text.lines().take_while(|line| *line != heading).collect();
    assert!(above[0].starts_with("presolve left "), "{text}");
    assert!(above[1].starts_with("bound of the root "), "{text}");
    let explained = above[above.len() - 2];
    for heuristic in Heuristic::ALL {
        assert!(explained.contains(&format!("{} {heuristic}", heuristic.mark())), "{explained}");
    }
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

/// A line a second at first, then fewer, at least one a minute; another solve begins anew.
#[test]
fn a_long_search_fills_the_log_more_and_more_slowly() {
    let mut log = Log::new(Vec::new());
    for _ in 0..2 {
        for fifth in 0..36_000 {
            let elapsed = Duration::from_millis(200 * fifth);
            log.record(&Event::Progress(Progress::new(7, 0, 0, None, 0.0, elapsed)));
        }
    }
    let text = String::from_utf8(log.into_inner().unwrap()).unwrap();
    let times = text.lines().filter(|line| line.trim_start().starts_with('7'));
    let times: Vec<f64> =
        times.map(|line| line.split_whitespace().last().unwrap().parse().unwrap()).collect();
    let (first, second) = times.split_at(times.len() / 2);
    assert_eq!(first, second, "the second solve is told like the first one");
    let within =
        |from: f64, to: f64| first.iter().filter(|time| (from..to).contains(*time)).count();
    assert_eq!(within(0.0, 10.0), 10);
    assert!((20..=26).contains(&within(10.0, 100.0)), "{first:?}");
    assert_eq!(within(3600.0, 7200.0), 60);
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
