//! Random runs through systems with memory, several choices, guards on inputs and values by step
//! never leave the sets.

use crate::common::config;
use carom::hybrid::reach::{HorizonVariables, ReachSet, ReachSets, SetOptions, Tube};
use carom::hybrid::{HybridSystem, Region};
use carom::interval::Interval;
use carom::prelude::*;
use proptest::prelude::*;

use super::plants::{DOMAIN, Plant, Run};

/// Rounding of the runs themselves, which are computed in floating point.
const NOISE: f64 = 1e-9;

fn holds(range: &Interval, value: f64) -> bool {
    range.lower - NOISE <= value && value <= range.upper + NOISE
}

/// The modes of a sample, by name.
fn named(run: &Run, sample: usize) -> Vec<(String, String)> {
    let modes = run.modes[sample].iter().enumerate();
    modes.filter_map(|(p, mode)| Some((format!("part {p}"), format!("m{}", (*mode)?)))).collect()
}

/// Whether a set that may hold a sample does.
fn some_set_holds(
    sets: &[ReachSet],
    state: &[f64],
    modes: &[(String, String)],
    events: usize,
) -> bool {
    let may = |set: &&ReachSet| {
        set.events() <= events && set.modes().iter().all(|mode| modes.contains(mode))
    };
    sets.iter().filter(may).any(|set| set.contains(state).unwrap())
}

fn region(run: &Run, sample: usize, with_modes: bool) -> Region {
    let mut region = Region::point(run.state(sample));
    if with_modes {
        for (choice, mode) in named(run, sample) {
            region = region.with_mode(choice, mode);
        }
    }
    region
}

fn check_samples(plant: &Plant, sets: &mut ReachSets, run: &Run) {
    let last = run.steps.len();
    for t in 0..=last {
        let modes = named(run, t);
        let events = |steps| -> usize {
            let steps: &[super::plants::Step] = steps;
            steps.iter().map(|step| plant.events_of(step)).sum()
        };
        let forward = sets.forward_by_mode(t).unwrap();
        let held = some_set_holds(&forward, run.state(t), &modes, events(&run.steps[..t]));
        assert!(held, "forward, sample {t}: {:?}", run.state(t));
        let hulls = sets.forward(t).unwrap();
        assert!(hulls.iter().flatten().any(|set| set.contains(run.state(t)).unwrap()));
        // Without values by step, backward sets need no horizon.
        if let Ok(backward) = sets.backward_by_mode(last - t) {
            let held = some_set_holds(&backward, run.state(t), &modes, events(&run.steps[t..]));
            assert!(held, "backward, sample {t}: {:?}", run.state(t));
        }
    }
}

fn check_tube(plant: &Plant, system: &HybridSystem, tube: &Tube, run: &Run) {
    assert!(!tube.is_empty(), "there is a run of {} steps", run.steps.len());
    for (t, step) in run.steps.iter().enumerate() {
        let mut first = 0;
        for (p, &k) in step.taken.iter().enumerate() {
            assert!(tube.is_possible(t, first + k), "law {k} of part {p} in step {t}");
            let predictions = tube.predictions(t, first + k).expect("the law is possible");
            let inside = predictions.iter().zip(&step.predictions[p]).all(|(r, &y)| holds(r, y));
            assert!(inside, "law {k} of part {p} in step {t}: {predictions:?}");
            first += plant.parts[p].laws.len();
        }
        assert_eq!(first, system.transitions().count());
    }
    let events: usize = run.steps.iter().map(|step| plant.events_of(step)).sum();
    assert!(tube.fewest_events().unwrap() <= events);
    assert!(tube.most_events().is_none_or(|most| most >= events));
    for t in 0..=run.steps.len() {
        let bounds = tube.bounds(t).expect("the tube is not empty");
        assert!(bounds.iter().zip(run.state(t)).all(|(r, &x)| holds(r, x)), "sample {t}");
        for (choice, mode) in named(run, t) {
            assert!(tube.is_mode_possible(t, &choice, &mode), "{choice} in {mode} at {t}");
        }
        let to_go: Vec<ReachSet> = tube.to_go(t).cloned().collect();
        assert!(some_set_holds(&to_go, run.state(t), &named(run, t), usize::MAX));
    }
}

/// No run is lost by the changes to a program that has it.
fn check_tightening(plant: &Plant, tube: &Tube, run: &Run) {
    let steps = run.steps.len();
    let mut model = Model::new("m");
    let states: Vec<Family> = (0..plant.states)
        .map(|i| model.continuous_family(&format!("s{i}"), steps + 1, -DOMAIN, DOMAIN).unwrap())
        .collect();
    let mut variables = HorizonVariables::new(states.clone());
    let (mut taken, mut modes) = (Vec::new(), Vec::new());
    let mut first = 0;
    for (p, part) in plant.parts.iter().enumerate() {
        for k in 0..part.laws.len() {
            let family = model.binary_family(&format!("taken_{p}_{k}"), steps).unwrap();
            variables = variables.with_transition(first + k, family.clone());
            taken.push((p, k, family));
        }
        for mode in part.modes() {
            let family = model.binary_family(&format!("mode_{p}_{mode}"), steps + 1).unwrap();
            let (choice, name) = (format!("part {p}"), format!("m{mode}"));
            variables.modes.push((choice, name, family.clone()));
            modes.push((p, mode, family));
        }
        first += part.laws.len();
    }
    let report = tube.tighten(&mut model, &variables).unwrap();
    assert!(!report.infeasible);
    let inside = |variable, value: f64| {
        assert!(holds(&model.variable_ref(variable).unwrap().bounds(), value), "{report}");
    };
    for (t, step) in run.steps.iter().enumerate() {
        for (p, k, family) in &taken {
            inside(family[t], f64::from(u8::from(step.taken[*p] == *k)));
        }
    }
    for t in 0..=steps {
        states.iter().zip(run.state(t)).for_each(|(family, &x)| inside(family[t], x));
        for (p, mode, family) in &modes {
            inside(family[t], f64::from(u8::from(run.modes[t][*p] == Some(*mode))));
        }
    }
}

fn options() -> impl Strategy<Value = SetOptions> {
    let vertices = prop_oneof![Just(8_usize), Just(256)];
    let layers = prop_oneof![Just(1_usize), Just(5), Just(256)];
    (0..4_usize, vertices, layers).prop_map(|(events, vertices, layers)| {
        SetOptions::default().with_events(events).with_vertices(vertices).with_layers(layers)
    })
}

proptest! {
    #![proptest_config(config(20, "tests/regressions/reach_modes.txt"))]

    #[test]
    fn runs_with_memory_and_choices_stay_in_the_sets(
        seeds in any::<(u64, u64)>(),
        options in options(),
        with_modes in any::<(bool, bool)>(),
        is_disturbed in any::<bool>(),
    ) {
        let plant = Plant::random(seeds.0);
        let run = plant.run(seeds.1, 8, is_disturbed);
        prop_assume!(!run.steps.is_empty());
        let system = plant.hybrid();
        let options = options.with_disturbance(is_disturbed);
        let (start, goal) =
            (region(&run, 0, with_modes.0), region(&run, run.steps.len(), with_modes.1));
        let mut sets = ReachSets::new(&system, start, goal, options).unwrap();
        prop_assert!(sets.may_finish(run.steps.len()).unwrap());
        check_samples(&plant, &mut sets, &run);
        let tube = sets.tube(run.steps.len()).unwrap();
        check_tube(&plant, &system, &tube, &run);
        check_tightening(&plant, &tube, &run);
        prop_assert_eq!(sets.explain(run.steps.len()).unwrap(), None);
    }
}

/// The test above means something: most runs have several steps, and every feature occurs.
#[test]
fn random_plants_are_not_trivial() {
    let (mut long, mut eventful, mut switched, mut several, mut refuted) = (0, 0, 0, 0, 0);
    for seed in 0..40 {
        let plant = Plant::random(seed);
        let run = plant.run(seed + 1, 8, false);
        long += usize::from(run.steps.len() >= 3);
        eventful += usize::from(run.steps.iter().any(|step| plant.events_of(step) > 0));
        switched += usize::from(run.modes.iter().any(|modes| *modes != run.modes[0]));
        several += usize::from(plant.parts.len() > 1 && !run.steps.is_empty());
        // Far away, the sets refute something.
        let far = Region::point(vec![15.0; plant.states]);
        let start = Region::point(run.start.clone());
        let mut sets = ReachSets::new(&plant.hybrid(), start, far, SetOptions::default()).unwrap();
        refuted += usize::from(sets.tube(3).unwrap().is_empty());
    }
    let counts = [long, eventful, switched, several, refuted];
    assert!(counts.iter().all(|&count| count > 5), "{counts:?}");
}
