//! Way-points and time windows against all the samples at which they can be met.

use carom::ErrorKind;
use carom::hybrid::{HybridProgram, HybridSystem, IntoRegion, Region, State, When};
use carom::interval::Interval;
use carom::model::Row;
use carom::prelude::*;
use carom_hybrid::internals::Halfspace;
use proptest::prelude::*;

use crate::common::config;

const STEPS: usize = 6;

/// A cart from rest at 0, which pays for its push and for being away from there.
fn cart() -> (HybridProgram, [State; 2]) {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -9.0, 9.0).unwrap();
    let v = system.state("v", -5.0, 5.0).unwrap();
    let a = system.input("a", -2.0, 2.0).unwrap();
    system.mode("go").unwrap().rates([(x, v.into()), (v, Affine::from(a))]).unwrap();
    let mut program = system.program(STEPS).unwrap();
    program.start([x.equals(0.0), v.equals(0.0)]).unwrap();
    program.minimize(program.sum(0.1 * x.square() + a.square()).unwrap()).unwrap();
    (program, [x, v])
}

/// The least effort, or infinity.
fn least<R: IntoRegion>(regions: impl Fn([State; 2]) -> Vec<(R, When)>) -> f64 {
    let (mut program, states) = cart();
    for (k, (region, when)) in regions(states).into_iter().enumerate() {
        program.require(&format!("way{k}"), region, when).unwrap();
    }
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert!(solution.is_optimal() || solution.is_infeasible());
    if solution.is_optimal() {
        program.plan(&solution).unwrap();
    }
    solution.objective().unwrap_or(f64::INFINITY)
}

proptest! {
    #![proptest_config(config(16, "tests/regressions/windows.txt"))]

    #[test]
    fn windows_mean_what_they_say(
        low in -4.0..4.0_f64, width in 0.0..2.0_f64, slope in -1.0..1.0_f64,
        from in 0..STEPS, length in 0..4_usize,
    ) {
        let rows = |[x, v]: [State; 2]| -> Vec<Row> {
            vec![x.within(low, low + width), (slope * x + v).le(slope * low + 1.5)]
        };
        let window = from..=(from + length).min(STEPS);
        let single = window.clone().map(|t| least(|states| vec![(rows(states), When::At(t))]));
        let best = single.fold(f64::INFINITY, f64::min);
        let once = least(|states| vec![(rows(states), When::OnceIn(window.clone()))]);
        prop_assert!(once == best || (once - best).abs() <= 1e-5 * best.max(1.0), "{once} {best}");
        let each = least(|states| {
            window.clone().map(|t| (rows(states), When::At(t))).collect()
        });
        let all = least(|states| vec![(rows(states), When::Throughout(window.clone()))]);
        prop_assert!(all == each || (all - each).abs() <= 1e-5 * each.max(1.0), "{all} {each}");
        // The same as a region of numbers.
        let region = Region::from([Interval::new(low, low + width), Interval::REALS])
            .with_halfspace(Halfspace::new("slow", [slope, 1.0], slope * low + 1.5));
        let plain = least(|_| vec![(&region, When::Throughout(window.clone()))]);
        prop_assert!(all == plain || (all - plain).abs() <= 1e-5 * all.max(1.0), "{all} {plain}");
    }
}

#[test]
fn regions_may_ask_for_modes() {
    // Heat rises by 2 when on, and falls by 1 when off; a switch keeps the flow of the mode it
    // leaves.
    let mut system = HybridSystem::new(1.0);
    let t = system.state("T", 0.0, 30.0).unwrap();
    let [off, on] = system.modes("heater", ["off", "on"]).unwrap();
    system.stay(off).unwrap().next([(t, t - 1.0)]).unwrap();
    system.switch(off, on).unwrap().next([(t, t - 1.0)]).unwrap();
    system.stay(on).unwrap().next([(t, t + 2.0)]).unwrap();
    system.switch(on, off).unwrap().next([(t, t + 2.0)]).unwrap();
    let run = |mode: Variable| {
        let mut program = system.program(4).unwrap();
        program.start([t.equals(10.0), off.equals(1.0)]).unwrap();
        program.require("end", [mode.equals(1.0)], When::At(4)).unwrap();
        program.maximize(program.end(t).unwrap()).unwrap();
        let plan = program.solve(&mut BranchAndBound::default()).unwrap();
        assert!((plan.value(mode, 4).unwrap() - 1.0).abs() < 1e-6);
        plan.solution.objective().unwrap()
    };
    // Off for a step, which starts, then on for three; the last of them may stop.
    assert!((run(on) - 15.0).abs() < 1e-6);
    assert!((run(off) - 15.0).abs() < 1e-6);
    // At the second sample it can be on only at 9.
    let mut program = system.program(2).unwrap();
    program.start([t.equals(10.0), off.equals(1.0)]).unwrap();
    program.require("hot", [t.ge(9.5), on.equals(1.0)], When::OnceIn(0..=1)).unwrap();
    assert!(BranchAndBound::default().solve(program.model()).unwrap().is_infeasible());
    let error = program.solve(&mut BranchAndBound::default()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NoPlan { .. }), "{error}");
}

#[test]
fn bad_windows_are_refused_and_change_nothing() {
    let (mut program, [x, v]) = cart();
    let before = program.model().to_string();
    let rest = Region::point([1.0, 0.0]);
    let at_rest = || [x.equals(1.0), v.equals(0.0)];
    #[allow(clippy::reversed_empty_ranges)]
    let empty = 4..=3;
    for when in [When::At(7), When::Throughout(3..=7), When::OnceIn(empty)] {
        let error = program.require("way", at_rest(), when).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    #[allow(clippy::reversed_empty_ranges)]
    let texts = [
        (
            When::At(7),
            "the sample of `way` is 7; it must be at most 6, the last sample of the horizon",
        ),
        (
            When::Throughout(3..=7),
            "the last sample of `way` is 7; it must be at most 6, the last sample of the horizon",
        ),
        (
            When::OnceIn(8..=9),
            "the first sample of `way` is 8; it must be at most 6, the last sample of the horizon",
        ),
        (
            When::OnceIn(4..=3),
            "the last sample of `way` is 3; it must be at least 4, the first sample",
        ),
    ];
    for (when, text) in texts {
        let error = program.require("way", at_rest(), when).unwrap_err();
        assert_eq!(error.to_string(), text);
    }
    // A half-space without a direction is named, not the row that it would have become.
    let flat = rest.clone().with_halfspace(Halfspace::new("flat", [0.0, 0.0], 1.0));
    let error = program.require("way", &flat, When::At(1)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the largest entry of the normal of the half-space `flat` is 0; it must be another number \
         than 0; give a direction"
    );
    let error = program.require("way", Region::point([1.0]), When::At(1)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Length { .. }));
    let foreign = Model::new("other").continuous("y", 0.0, 1.0).unwrap();
    let error = program.require("way", [x.ge(foreign)], When::Throughout(0..=3)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }), "{error}");
    // Its names are taken.
    let error = program.require("start", at_rest(), When::At(0)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }), "{error}");
    assert_eq!(program.model().to_string(), before);
}
