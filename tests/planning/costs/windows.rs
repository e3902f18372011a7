//! Way-points and time windows against all the samples at which they can be met.

use carom::ErrorKind;
use carom::hybrid::{HybridSystem, LinearSystem, Region, When};
use carom::internals::hybrid::{Choice, Halfspace, SystemVariables, Transition};
use carom::interval::Interval;
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

const STEPS: usize = 6;

fn cart() -> (Model, SystemVariables, Quadratic) {
    let line = LinearSystem::double_integrator(1.0).unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_state("v", Interval::new(-5.0, 5.0))
        .with_input("a", Interval::new(-2.0, 2.0))
        .with_transition(Transition::new("go", line));
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", STEPS).unwrap();
    program.require(&mut model, "start", &Region::point([0.0, 0.0]), When::At(0)).unwrap();
    let effort = Cost::quadratic([[0.1, 0.0], [0.0, 0.0]], [[1.0]]);
    let effort = program.add_cost(&mut model, "effort", &effort).unwrap();
    (model, program, effort)
}

/// The least effort, or infinity.
fn least(regions: &[(&Region, When)]) -> f64 {
    let (mut model, program, effort) = cart();
    for (k, (region, when)) in regions.iter().enumerate() {
        program.require(&mut model, &format!("way{k}"), region, when.clone()).unwrap();
    }
    model.minimize(effort).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_optimal() || solution.is_infeasible());
    solution.objective().unwrap_or(f64::INFINITY)
}

proptest! {
    #![proptest_config(config(16, "tests/regressions/windows.txt"))]

    #[test]
    fn windows_mean_what_they_say(
        low in -4.0..4.0_f64, width in 0.0..2.0_f64, slope in -1.0..1.0_f64,
        from in 0..STEPS, length in 0..4_usize,
    ) {
        let region = Region::from([Interval::new(low, low + width), Interval::REALS])
            .with_halfspace(Halfspace::new("slow", [slope, 1.0], slope * low + 1.5));
        let window = from..=(from + length).min(STEPS);
        let single = window.clone().map(|t| least(&[(&region, When::At(t))]));
        let best = single.fold(f64::INFINITY, f64::min);
        let once = least(&[(&region, When::OnceIn(window.clone()))]);
        prop_assert!(once == best || (once - best).abs() <= 1e-5 * best.max(1.0), "{once} {best}");
        let each: Vec<_> = window.clone().map(|t| (&region, When::At(t))).collect();
        let (all, each) = (least(&[(&region, When::Throughout(window))]), least(&each));
        prop_assert!(all == each || (all - each).abs() <= 1e-5 * each.max(1.0), "{all} {each}");
    }
}

#[test]
fn regions_may_ask_for_modes() {
    // Heat rises by 2 when on, and falls by 1 when off.
    let flow = |by: f64| LinearSystem::new([[1.0]], [[]], [by]).unwrap();
    let heater = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(-1.0)).within("off"))
        .with_transition(Transition::event("start", flow(-1.0)).between("off", "on"))
        .with_transition(Transition::new("heat", flow(2.0)).within("on"))
        .with_transition(Transition::event("stop", flow(2.0)).between("on", "off"));
    let system =
        HybridSystem::new(1.0).with_state("T", Interval::new(0.0, 30.0)).with_choice(heater);
    let run = |mode: &str| {
        let mut model = Model::new("m");
        let program = system.write(&mut model, "", 4).unwrap();
        let start = Region::point([10.0]).with_mode("heater", "off");
        program.require(&mut model, "start", &start, When::At(0)).unwrap();
        let any = Region::from([Interval::REALS]);
        program.require(&mut model, "end", &any.with_mode("heater", mode), When::At(4)).unwrap();
        let warm = program.state("T").unwrap()[4];
        model.maximize(warm).unwrap();
        BranchAndBound::default().solve(&model).unwrap().objective().unwrap()
    };
    // Off for a step, which starts, then on for three; the last of them may stop.
    assert!((run("on") - 15.0).abs() < 1e-6);
    assert!((run("off") - 15.0).abs() < 1e-6);
    // At the second sample it can be on only at 9.
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", 2).unwrap();
    let start = Region::point([10.0]).with_mode("heater", "off");
    program.require(&mut model, "start", &start, When::At(0)).unwrap();
    let hot = Region::from([Interval::new(9.5, 30.0)]).with_mode("heater", "on");
    program.require(&mut model, "hot", &hot, When::OnceIn(0..=1)).unwrap();
    assert!(BranchAndBound::default().solve(&model).unwrap().is_infeasible());
}

#[test]
fn bad_windows_are_refused_and_change_nothing() {
    let (mut model, program, _) = cart();
    let before = model.to_string();
    let rest = Region::point([1.0, 0.0]);
    #[allow(clippy::reversed_empty_ranges)]
    let empty = 4..=3;
    for when in [When::At(7), When::Throughout(3..=7), When::OnceIn(empty)] {
        let error = program.require(&mut model, "way", &rest, when).unwrap_err();
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
        let error = program.require(&mut model, "way", &rest, when).unwrap_err();
        assert_eq!(error.to_string(), text);
    }
    // A half-space without a direction is named, not the row that it would have become.
    let flat = rest.clone().with_halfspace(Halfspace::new("flat", [0.0, 0.0], 1.0));
    let error = program.require(&mut model, "way", &flat, When::At(1)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the largest entry of the normal of the half-space `flat` is 0; it must be another number \
         than 0; give a direction"
    );
    let error = program.require(&mut model, "way", &Region::point([1.0]), When::At(1)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Length { .. }));
    // The name `start_1[0]` is taken.
    let error = program.require(&mut model, "start", &rest, When::At(0)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }), "{error}");
    assert_eq!(model.to_string(), before);
}
