//! Bad input to reach sets gets a typed error that names the thing and says what to do.

use carom::ErrorKind;
use carom::collision_tolerant::Scenario;
use carom::hybrid::reach::{HorizonVariables, ReachSets, SetOptions};
use carom::hybrid::{HybridSystem, LinearSystem, Matrix, Region};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::{Halfspace, Transition};

fn push() -> HybridSystem {
    HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_state("v", Interval::new(-9.0, 9.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("flight", LinearSystem::double_integrator(0.1).unwrap()))
}

const REST: [Interval; 2] =
    [Interval { lower: 0.0, upper: 0.0 }, Interval { lower: 0.0, upper: 0.0 }];

fn refused(system: HybridSystem) -> String {
    system.check().unwrap_err().to_string()
}

#[test]
fn systems_whose_parts_do_not_fit() {
    assert_eq!(
        refused(HybridSystem::new(1.0)),
        "the number of states of the hybrid system is 0; it must be at least 1"
    );
    let still = HybridSystem::new(1.0).with_state("x", Interval::new(0.0, 1.0));
    assert_eq!(
        refused(still),
        "the number of transitions of the hybrid system is 0; it must be at least 1, stated by `mode` or `event`"
    );
    assert_eq!(
        refused(push().with_input("b", Interval::new(0.0, 1.0))),
        "the flow of a transition has shape 2x1; expected 2 states and 2 inputs"
    );
    let mut open = push();
    open.parts_mut().states[1].1.upper = f64::INFINITY;
    assert_eq!(refused(open), "the upper limit of `v` is inf; give a finite number");
    let mut crossed = push();
    crossed.parts_mut().inputs[0].1 = Interval::new(1.0, -1.0).into();
    assert_eq!(refused(crossed), "bounds of `a` are crossed: 1 > -1; swap or relax them");
    let mut huge = push();
    huge.parts_mut().states[0].1.upper = 1e20;
    assert_eq!(
        refused(huge),
        "a limit of `x` is 100000000000000000000; it must be below 1e20 in magnitude"
    );
    let overflowing = Halfspace::new("overflowing", [1e300, 0.0], 1.0);
    assert!(refused(push().with_limit(overflowing)).starts_with("a number of `overflowing` is 1"));
    let short = Halfspace::new("short", [1.0], 0.0);
    assert_eq!(
        refused(push().with_limit(short)),
        "the length of the normal of the half-space `short` is 1; it must be 2, one entry per state, or \
         3, with the inputs"
    );
    let odd = Halfspace::new("odd", [1.0, f64::NAN], 0.0);
    assert_eq!(refused(push().with_limit(odd)), "a number of `odd` is NaN; give a finite number");
    let flow = LinearSystem::double_integrator(0.1).unwrap();
    let reset = |rows, offset: Vec<f64>| {
        let matrix = Matrix::from_fn(rows, 2, |_, _| 0.0);
        push().with_transition(Transition::event("hit", flow.clone()).with_reset(matrix, offset))
    };
    assert_eq!(
        refused(reset(3, vec![0.0; 2])),
        "the matrix of a reset has shape 3x2; expected 2x2"
    );
    assert_eq!(
        refused(reset(2, vec![0.0; 3])),
        "the length of the offset of a reset is 3; it must be 2"
    );
    assert_eq!(
        refused(reset(2, vec![0.0, f64::INFINITY])),
        "an entry of the reset of `hit` is inf; give a finite number"
    );
}

#[test]
fn ends_and_options_out_of_range() {
    let new = |start: &[Interval], options| ReachSets::new(&push(), start, REST, options);
    let text = |result: Result<ReachSets, Error>| result.unwrap_err().to_string();
    let fine = SetOptions::default;
    assert_eq!(text(new(&REST[..1], fine())), "the length of the start is 1; it must be 2");
    let nan = [Interval::point(f64::NAN), Interval::point(0.0)];
    assert_eq!(text(new(&nan, fine())), "the lower limit of `x` is NaN; give a finite number");
    assert_eq!(
        text(new(&REST, fine().with_events(65))),
        "the number of events of reach sets is 65; it must be within [0, 64]"
    );
    assert_eq!(
        text(new(&REST, fine().with_vertices(7))),
        "the number of vertices of reach sets is 7; it must be at least 8"
    );
    assert_eq!(
        text(new(&REST, fine().with_margin(f64::NAN))),
        "the margin of reach sets is NaN; it must be within [0, 1]"
    );
    assert_eq!(
        text(new(&REST, fine().with_direction([1.0]))),
        "the length of a template direction is 1; it must be 2"
    );
    let mut sets = new(&REST, fine()).unwrap();
    for absurd in [100_001, usize::MAX] {
        assert!(matches!(sets.forward(absurd).unwrap_err().kind(), ErrorKind::OutOfRange { .. }));
        assert!(matches!(sets.tube(absurd).unwrap_err().kind(), ErrorKind::OutOfRange { .. }));
    }
    assert!(matches!(sets.tube(0).unwrap_err().kind(), ErrorKind::OutOfRange { .. }));
    let set = sets.forward(3).unwrap().swap_remove(0).unwrap();
    assert!(matches!(set.support(&[1.0]).unwrap_err().kind(), ErrorKind::Length { .. }));
    assert!(matches!(
        set.contains(&[f64::NAN, 0.0]).unwrap_err().kind(),
        ErrorKind::NotFinite { .. }
    ));
    assert!(matches!(set.outline(0, 0).unwrap_err().kind(), ErrorKind::OutOfRange { .. }));
    assert!(matches!(set.outline(0, 2).unwrap_err().kind(), ErrorKind::OutOfRange { .. }));
    assert!(matches!(
        new(&REST, fine()).unwrap().with_first_inputs(&[]).unwrap_err().kind(),
        ErrorKind::Length { .. }
    ));
}

#[test]
fn starts_and_goals_outside_the_limits_have_no_plan() {
    let outside = [Interval::point(10.0), Interval::point(0.0)];
    for (start, goal, place) in [(&outside, &REST, "at the start"), (&REST, &outside, "at the end")]
    {
        let mut sets = ReachSets::new(&push(), start, goal, SetOptions::default()).unwrap();
        assert!(!sets.may_finish(1).unwrap() && sets.tube(7).unwrap().is_empty());
        let text = sets.explain(7).unwrap().unwrap().to_string();
        assert_eq!(
            text,
            format!(
                "no plan has 7 steps (7 s): {place}, the upper limit of x is missed by at least 1"
            )
        );
    }
}

#[test]
fn programs_that_do_not_fit_the_tube() {
    let scenario = Scenario::paper().with_time_step(0.25);
    let tube = scenario.reach_sets().unwrap().tube(12).unwrap();
    let mut model = Model::new("m");
    let family = |model: &mut Model, name: &str, count| {
        model.continuous_family(name, count, -9.0, 9.0).unwrap()
    };
    let (x, v) = (family(&mut model, "x", 13), family(&mut model, "v", 13));
    let short = family(&mut model, "short", 12);
    let hit = model.binary_family("hit", 12).unwrap();
    let mut refuse =
        |variables: HorizonVariables| tube.tighten(&mut model, &variables).unwrap_err().to_string();
    assert_eq!(
        refuse(HorizonVariables::new([x.clone()])),
        "the length of the list of state families is 1; it must be 2"
    );
    assert_eq!(
        refuse(HorizonVariables::new([x.clone(), short.clone()])),
        "the length of a state family of the horizon is 12; it must be 13"
    );
    let states = || HorizonVariables::new([x.clone(), v.clone()]);
    assert_eq!(
        refuse(states().with_transition(2, hit.clone())),
        "the number of a transition is 2; it must be below 2"
    );
    assert_eq!(
        refuse(states().with_transition(1, x.clone())),
        "the length of a transition family of the horizon is 13; it must be 12"
    );
    assert_eq!(
        refuse(states().with_quantity(short.clone(), 0, [(vec![1.0, 0.0], 0.0)])),
        "the length of the values of a quantity is 1; it must be 2"
    );
    let mut other = Model::new("other");
    let strangers = other.continuous_family("x", 13, 0.0, 1.0).unwrap();
    assert!(matches!(
        tube.tighten(&mut model, &HorizonVariables::new([strangers, v.clone()]))
            .unwrap_err()
            .kind(),
        ErrorKind::ForeignHandle { .. }
    ));
}

#[test]
fn states_too_large_to_compute_with() {
    let mut wide = push();
    wide.parts_mut().states[0].1 = Interval::new(-1e308, 1e308);
    let text = |system: &HybridSystem| {
        ReachSets::new(system, REST, REST, SetOptions::default()).unwrap_err().to_string()
    };
    assert!(text(&wide).starts_with("a limit of `x` is -1"), "{}", text(&wide));
    let flow =
        LinearSystem::new(Matrix::from_fn(2, 2, |_, _| 1e100), Matrix::zeros(2, 1), vec![0.0; 2]);
    let steep = push().with_transition(Transition::new("leap", flow.unwrap()));
    assert!(text(&steep).starts_with("an entry of the flow of `leap` is 1"), "{}", text(&steep));
    wide.parts_mut().states[0].1 = Interval::new(-9e19, 9e19);
    let mut sets = ReachSets::new(&wide, REST, REST, SetOptions::default()).unwrap();
    assert!(!sets.tube(30).unwrap().is_empty());
}

#[test]
fn one_step_is_no_plural() {
    let far = [Interval::point(5.0), Interval::point(0.0)];
    let mut sets = ReachSets::new(&push(), REST, far, SetOptions::default()).unwrap();
    let text = sets.explain(1).unwrap().unwrap().to_string();
    assert!(text.starts_with("no plan has 1 step (1 s): "), "{text}");
}

#[test]
fn regions_that_do_not_fit() {
    let refused = |start: Region| {
        ReachSets::new(&push(), start, REST, SetOptions::default()).unwrap_err().to_string()
    };
    let rest = || Region::point([0.0, 0.0]);
    assert_eq!(refused(Region::point([0.0])), "the length of the start is 1; it must be 2");
    let crossed = Region::from([Interval::new(1.0, -1.0), Interval::REALS]);
    assert_eq!(refused(crossed), "bounds of `x` are crossed: 1 > -1; swap or relax them");
    let joint = Halfspace::new("joint", [1.0, 0.0, 1.0], 0.0);
    assert_eq!(
        refused(rest().with_halfspace(joint)),
        "the length of the normal of the half-space `joint` is 3; it must be 2, one entry per state"
    );
    let late = Halfspace::new("late", [1.0, 0.0], vec![0.0, 1.0]);
    assert_eq!(
        refused(rest().with_halfspace(late)),
        "the number of limits of `late` in the start is 2; it must be 1, the same at every step"
    );
    let text = refused(rest().with_mode("heater", "off"));
    assert!(text.contains("heater"), "{text}");
    let text = refused(rest().with_mode("mode", "off"));
    assert!(text.contains("off"), "{text}");
    let options = SetOptions::default().with_layers(0);
    assert_eq!(
        ReachSets::new(&push(), REST, REST, options).unwrap_err().to_string(),
        "the number of layers of reach sets is 0; it must be at least 1"
    );
}
