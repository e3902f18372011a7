//! Random missions on random systems, compared with all sequences of modes.

use carom::hybrid::Mission;
use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::prelude::*;
use proptest::prelude::any;
use proptest::test_runner::TestCaseError;
use proptest::{prop_assert, prop_assert_eq, prop_assume, proptest};

use crate::common::config;

use super::sketch::{Sketch, sketches};
use super::systems::{Handles, Sample, SketchSystem, systems};

const MOST_RUNS: usize = 600;
const NEVER: f64 = f64::NEG_INFINITY;

/// The runs of as many steps as wanted, or of fewer if they are too many.
fn runs(system: &SketchSystem, wanted: usize) -> (usize, Vec<Vec<Sample>>) {
    let mut lengths = (1..=wanted).rev();
    lengths
        .find_map(|steps| Some((steps, system.runs(steps, MOST_RUNS)?)))
        .expect("a step has few runs")
}

fn greatest(sketch: &Sketch, runs: &[Vec<Sample>], strict: bool) -> f64 {
    runs.iter().map(|run| sketch.value(run, 0, true, strict)).fold(NEVER, f64::max)
}

fn is_late(error: &Error) -> bool {
    error.to_string().contains("late enough")
}

/// A program with the start, and with reach sets if wanted.
fn program(
    system: &SketchSystem,
    hybrid: &HybridSystem,
    handles: &Handles,
    steps: usize,
    tightened: bool,
) -> Result<HybridProgram, Error> {
    let mut program = hybrid.program(steps)?;
    program.start(system.starts(handles))?;
    if tightened {
        let start = hybrid.region(system.starts(handles))?;
        let anywhere = hybrid.region([handles.x.within(-50.0, 50.0)])?;
        let mut sets = ReachSets::new(hybrid, start, anywhere, SetOptions::default())?;
        let tube = sets.tube(steps)?;
        let _ = program.tighten(&tube)?;
    }
    Ok(program)
}

fn compare(
    system: &SketchSystem,
    sketch: &Sketch,
    wanted: usize,
    tightened: bool,
) -> Result<(), TestCaseError> {
    let (steps, runs) = runs(system, wanted);
    let (hybrid, handles) = system.build().unwrap();
    let mission = sketch.mission(&handles, system.time_step);
    let negation = !&mission;
    let solver = &mut BranchAndBound::default();
    let mut required = program(system, &hybrid, &handles, steps, tightened).unwrap();
    if sketch.has_empty_window() {
        let error = required.require_mission("mission", &mission).unwrap_err();
        prop_assert!(error.to_string().contains("no sample is in the window"), "{error}");
        return Ok(());
    }

    // Required: a negated row fails by itself.
    let is_true = greatest(sketch, &runs, true) > 0.0;
    match required.require_mission("mission", &mission) {
        Ok(()) => {
            let solution = solver.solve(required.model()).unwrap();
            prop_assert_eq!(!solution.is_infeasible(), is_true, "{}", mission);
            if is_true {
                let plan = required.plan(&solution).unwrap();
                prop_assert!(plan.robustness(&mission).unwrap() >= -1e-6);
                let own = plan.robustness(&mission).unwrap();
                prop_assert_eq!(hybrid.robustness(&mission, &plan.run).unwrap(), own);
                // With its negation there is no plan.
                match required.require_mission("negation", &negation) {
                    Ok(()) => prop_assert!(solver.solve(required.model()).unwrap().is_infeasible()),
                    Err(error) => prop_assert!(is_late(&error), "{error}"),
                }
            }
        }
        Err(error) => {
            prop_assert!(is_late(&error), "{error}");
            prop_assert!(!is_true, "{mission} is late, but true");
        }
    }

    // With a margin.
    let best = greatest(sketch, &runs, false);
    for least in [-90.0, 0.0] {
        let mut program = program(system, &hybrid, &handles, steps, tightened).unwrap();
        let margin = match program.mission_margin("margin", &mission, least) {
            Ok(margin) => margin,
            Err(error) => {
                prop_assert!(is_late(&error), "{error}");
                prop_assert_eq!(best, NEVER);
                continue;
            }
        };
        program.maximize(margin).unwrap();
        let solution = solver.solve(program.model()).unwrap();
        prop_assert_eq!(solution.is_infeasible(), best < least, "{} is {}", mission, best);
        if best >= least && best.is_finite() {
            let found = solution.objective().unwrap();
            prop_assert!((found - best).abs() < 1e-5, "{mission}: {found}, not {best}");
            program.plan(&solution).unwrap();
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(250, "tests/regressions/mission.txt"))]

    #[test]
    fn optimum_and_status_are_those_of_all_sequences(
        system in systems(), sketch in sketches(true), wanted in 1_usize..=12, tightened in any::<bool>(),
    ) {
        compare(&system, &sketch, wanted, tightened)?;
    }

    #[test]
    fn rows_have_the_robustness_of_the_evaluator_at_each_sequence(
        system in systems(), sketch in sketches(true), wanted in 1_usize..=12, chosen in any::<proptest::sample::Index>(),
    ) {
        prop_assume!(!sketch.has_empty_window());
        let (steps, runs) = runs(&system, wanted);
        prop_assume!(!runs.is_empty());
        let run = chosen.get(&runs);
        let (hybrid, handles) = system.build().unwrap();
        let mut program = program(&system, &hybrid, &handles, steps, false).unwrap();
        let mission = sketch.mission(&handles, system.time_step);
        let expected = sketch.value(run, 0, true, false);
        let is_free = handles.taken.len() > 1;
        for (k, sample) in run.iter().enumerate().take(if is_free { steps } else { 0 }) {
            let taken = Affine::from(handles.taken[sample.taken.unwrap()]);
            program.add(("moves", k), program.at(taken.equals(1.0), k).unwrap()).unwrap();
        }
        let Ok(margin) = program.mission_margin("margin", &mission, -90.0) else {
            prop_assert_eq!(expected, NEVER);
            return Ok(());
        };
        program.maximize(margin).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        prop_assert_eq!(solution.is_infeasible(), expected == NEVER);
        if expected.is_finite() {
            let found = solution.objective().unwrap();
            prop_assert!((found - expected).abs() < 1e-5, "{mission}: {found}, not {expected}");
            let plan = program.plan(&solution).unwrap();
            prop_assert!((plan.robustness(&mission).unwrap() - expected).abs() < 1e-6);
            prop_assert!((hybrid.robustness(&mission, &plan.run).unwrap() - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn the_evaluator_follows_the_definition(
        system in systems(), sketch in sketches(false), wanted in 1_usize..=12,
        shifts in proptest::collection::vec(-2.0..2.0, 13), chosen in any::<proptest::sample::Index>(),
    ) {
        prop_assume!(!sketch.has_empty_window());
        let (_, runs) = runs(&system, wanted);
        prop_assume!(!runs.is_empty());
        // Any numbers, also such as no run has.
        let mut run = chosen.get(&runs).clone();
        for (sample, shift) in run.iter_mut().zip(shifts) {
            (sample.x, sample.y) = (sample.x + shift, sample.y - 0.7 * shift);
        }
        let (_hybrid, handles) = system.build().unwrap();
        if handles.y.is_none() {
            run.iter_mut().for_each(|sample| sample.y = sample.x);
        }
        let value = |handle: Variable, k: usize| {
            let sample = run.get(k)?;
            match handle {
                h if h == Variable::from(handles.x) => Some(sample.x),
                h if h == Variable::from(handles.input) => sample.input,
                _ => Some(sample.y),
            }
        };
        let mission = sketch.mission(&handles, system.time_step);
        for (mission, positive) in [(!&mission, false), (mission, true)] {
            let found = mission.robustness(run.len(), system.time_step, value).unwrap();
            let expected = sketch.value(&run, 0, positive, false);
            prop_assert!(found == expected || (found - expected).abs() < 1e-9, "{mission}: {found}, not {expected}");
        }
    }

    #[test]
    fn a_text_that_is_read_says_the_same(system in systems(), sketch in sketches(true)) {
        let (hybrid, handles) = system.build().unwrap();
        let mission = sketch.mission(&handles, system.time_step);
        let read = Mission::parse(&mission.to_string(), [mission.clone()]).unwrap();
        prop_assert_eq!(read.to_string(), mission.to_string());
        let _ = hybrid;
    }
}
