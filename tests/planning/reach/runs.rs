//! Random runs never leave the sets.

use crate::common::config;
use carom::hybrid::reach::{ReachSets, SetOptions, Tube};
use carom::hybrid::{HybridSystem, LinearSystem, Matrix};
use carom::interval::Interval;
use carom_hybrid::internals::Transition;
use proptest::prelude::*;

use super::systems::{Mode, Step, System, choices, system};

/// Rounding of the runs themselves, which are computed in floating point.
const NOISE: f64 = 1e-9;

fn points(state: &[f64]) -> Vec<Interval> {
    state.iter().map(|&x| Interval::point(x)).collect()
}

fn holds(range: &Interval, value: f64) -> bool {
    range.lower - NOISE <= value && value <= range.upper + NOISE
}

/// Every sample lies in the forward set of its step and number of events, and in the backward set
/// of its steps and events to go.
fn check_samples(system: &System, sets: &mut ReachSets, start: &[f64], run: &[Step]) {
    let most = sets.options().events;
    let events = |steps: &[Step]| {
        steps.iter().filter(|step| system.modes[step.mode].is_event).count().min(most)
    };
    for t in 0..=run.len() {
        let state = if t == 0 { start } else { &run[t - 1].next };
        let (so_far, to_come) = (events(&run[..t]), events(&run[t..]));
        let forward = sets.forward(t).unwrap().swap_remove(so_far).expect("a run leads here");
        assert!(forward.contains(state).unwrap(), "forward, sample {t}: {state:?}");
        let backward = sets.backward(run.len() - t).unwrap().swap_remove(to_come);
        let backward = backward.expect("a run leads on from here");
        assert!(backward.contains(state).unwrap(), "backward, sample {t}: {state:?}");
        assert!(forward.intersects(&backward).unwrap() && backward.intersects(&forward).unwrap());
        for (range, &value) in forward.bounding_box().iter().zip(state) {
            assert!(holds(range, value));
        }
        let sum: f64 = state.iter().sum();
        assert!(forward.support(&vec![1.0; state.len()]).unwrap() >= sum - NOISE);
    }
}

/// What the run does is possible, and within the bounds.
fn check_tube(tube: &Tube, start: &[f64], run: &[Step]) {
    assert!(!tube.is_empty(), "there is a run of {} steps", run.len());
    for (t, step) in run.iter().enumerate() {
        assert!(tube.is_possible(t, step.mode), "mode {} in step {t}", step.mode);
        let predictions = tube.predictions(t, step.mode).expect("the mode is possible");
        assert!(predictions.iter().zip(&step.prediction).all(|(range, &y)| holds(range, y)));
    }
    for t in 0..=run.len() {
        let state = if t == 0 { start } else { &run[t - 1].next };
        let bounds = tube.bounds(t).expect("the tube is not empty");
        assert!(bounds.iter().zip(state).all(|(range, &x)| holds(range, x)), "sample {t}");
    }
}

proptest! {
    #![proptest_config(config(32, "tests/regressions/reach.txt"))]

    #[test]
    fn random_runs_stay_in_the_sets(
        system in system(),
        start in prop::collection::vec(-3.0..3.0_f64, 4),
        choices in choices(12),
        events in 0..4_usize,
        vertices in prop_oneof![Just(8_usize), Just(16), Just(256)],
    ) {
        let start = &start[..system.states];
        let run = system.run(start, &choices);
        prop_assume!(!run.is_empty());
        let goal = &run[run.len() - 1].next;
        let options = SetOptions::default().with_events(events).with_vertices(vertices);
        let hybrid = system.hybrid();
        let mut sets = ReachSets::new(&hybrid, points(start), points(goal), options).unwrap();
        prop_assert!(sets.may_finish(run.len()).unwrap());
        check_samples(&system, &mut sets, start, &run);
        check_tube(&sets.tube(run.len()).unwrap(), start, &run);
        prop_assert_eq!(sets.explain(run.len()).unwrap(), None);
    }
}

/// The tests above mean something: most random runs have several steps, many have events, and all
/// numbers of states occur.
#[test]
fn random_runs_are_not_trivial() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    let mut runner = TestRunner::deterministic();
    let (mut long, mut eventful, mut sizes) = (0, 0, [0; 4]);
    for _ in 0..200 {
        let system = system().new_tree(&mut runner).unwrap().current();
        let choices = choices(12).new_tree(&mut runner).unwrap().current();
        let run = system.run(&vec![0.5; system.states], &choices);
        long += usize::from(run.len() >= 3);
        eventful += usize::from(run.iter().any(|step| system.modes[step.mode].is_event));
        sizes[system.states - 1] += 1;
    }
    assert!(long > 60 && eventful > 40, "{long} long, {eventful} with events");
    assert!(sizes.iter().all(|&count| count > 20), "{sizes:?}");
}

/// A mode that nearly flattens the plane onto a line, along which its input pushes.
fn flattening() -> impl Strategy<Value = Mode> {
    let rest = prop_oneof![Just(0.0), Just(1e-7), 1e-9..1e-5_f64];
    let vector = prop::collection::vec(-0.2..0.2_f64, 2);
    (rest, vector, -0.5..0.5_f64, any::<bool>()).prop_map(|(rest, c, push, is_event)| Mode {
        a: vec![vec![0.03 + rest, 0.05], vec![0.06, 0.1 + rest]],
        b: vec![vec![push], vec![2.0 * push]],
        c,
        guards: Vec::new(),
        prediction_guards: Vec::new(),
        reset: None,
        is_event,
    })
}

proptest! {
    #![proptest_config(config(32, "tests/regressions/reach.txt"))]

    /// Undoing such a mode magnifies the sets a million times in every step, and the sets of the
    /// samples are slivers in which rounding hides the order of the corners.
    #[test]
    fn runs_that_are_nearly_flattened_stay_in_the_sets(
        modes in prop::collection::vec(flattening(), 1..=3),
        start in prop::collection::vec(-1.0..1.0_f64, 2),
        choices in prop::collection::vec((any::<u8>(), prop_oneof![Just(-1.0), Just(1.0)]), 40),
        margin in prop_oneof![Just(1e-12), Just(4e-6)],
        vertices in prop_oneof![Just(8_usize), Just(512)],
    ) {
        let system = System { states: 2, inputs: 1, modes };
        let choices: Vec<(u8, Vec<f64>)> =
            choices.into_iter().map(|(mode, input)| (mode, vec![input])).collect();
        let run = system.run(&start, &choices);
        prop_assert_eq!(run.len(), 40);
        let goal = &run[run.len() - 1].next;
        let options = SetOptions::default().with_vertices(vertices).with_margin(margin);
        let mut sets =
            ReachSets::new(&system.hybrid(), points(&start), points(goal), options).unwrap();
        check_samples(&system, &mut sets, &start, &run);
        check_tube(&sets.tube(run.len()).unwrap(), &start, &run);
    }
}

/// A damped vehicle can always rest where it is. Undoing the damping magnifies rounding step by
/// step, far beyond the domain in a long horizon.
#[test]
fn resting_under_damping_is_never_excluded() {
    for (damping, steps) in [(1e-3, 120), (0.5, 1200)] {
        let a = Matrix::from_fn(2, 2, |i, j| [[1.0, 0.01], [0.0, damping]][i][j]);
        let b = Matrix::from_fn(2, 1, |i, _| [0.0, 0.01][i]);
        let glide = LinearSystem::new(a, b, vec![0.0; 2]).unwrap();
        let vehicle = HybridSystem::new(1.0)
            .with_state("x", Interval::new(-50.0, 50.0))
            .with_state("v", Interval::new(-10.0, 10.0))
            .with_input("a", Interval::new(-1.0, 1.0))
            .with_transition(Transition::new("glide", glide));
        let rest = points(&[0.0, 0.0]);
        let mut sets = ReachSets::new(&vehicle, &rest, &rest, SetOptions::default()).unwrap();
        let tube = sets.tube(steps).unwrap();
        assert_eq!(tube.died(), None, "damping {damping}");
        assert!(tube.bounds(steps / 2).unwrap().iter().all(|range| range.contains(0.0)));
    }
}
