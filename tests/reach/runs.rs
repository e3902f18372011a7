//! Random runs never leave the sets.

use carom::hybrid::reach::{ReachSets, SetOptions, Tube};
use carom::interval::Interval;
use proptest::prelude::*;

use crate::systems::{Step, System, choices, system};

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
    #![proptest_config(ProptestConfig { cases: 160, ..ProptestConfig::default() })]

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
        let mut sets = ReachSets::new(&hybrid, &points(start), &points(goal), options).unwrap();
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
