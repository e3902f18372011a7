//! Modes, dwell times, events, choices and values by step, in cases with known answers.

use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::hybrid::{HybridSystem, LinearSystem, Region};
use carom::interval::Interval;
use carom_hybrid::internals::{Choice, Halfspace, Transition};

fn options() -> SetOptions {
    SetOptions::default().with_margin(0.0)
}

/// A heater: -1 K a step when it is off, +2 K when it is on.
fn heater(least: usize, most: Option<usize>) -> HybridSystem {
    let flow = |rise: f64| LinearSystem::new([[1.0]], [[]], [rise]).unwrap();
    let choice = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(-1.0)).within("off"))
        .with_transition(Transition::event("start", flow(-1.0)).between("off", "on"))
        .with_transition(Transition::new("heat", flow(2.0)).within("on"))
        .with_transition(Transition::new("stop", flow(2.0)).between("on", "off"))
        .with_dwell("on", least, most);
    HybridSystem::new(1.0).with_state("T", Interval::new(0.0, 30.0)).with_choice(choice)
}

fn from(temperature: f64, mode: &str) -> Region {
    Region::point([temperature]).with_mode("heater", mode)
}

fn anywhere() -> Region {
    Region::from([Interval::REALS])
}

#[test]
fn modes_that_begin_are_kept() {
    let system = heater(3, None);
    let mut sets = ReachSets::new(&system, from(10.0, "off"), anywhere(), options()).unwrap();
    // start, heat, heat, stop: the heater is on for three samples.
    let off = |sets: &mut ReachSets, t: usize| -> Vec<(f64, f64)> {
        let sets = sets.forward_by_mode(t).unwrap();
        let off = sets.iter().filter(|set| set.modes()[0].1 == "off" && set.events() == 1);
        off.map(|set| (set.bounding_box()[0].lower, set.bounding_box()[0].upper)).collect()
    };
    assert!(off(&mut sets, 3).is_empty(), "three steps are too few to start and stop");
    let found = off(&mut sets, 4);
    assert!(found.len() == 1 && (found[0].0 - 15.0).abs() < 1e-9, "{found:?}");
    assert!((found[0].1 - 15.0).abs() < 1e-9);
    // The tube of four steps to 15 K with the heater off leaves one way.
    let mut sets =
        ReachSets::new(&system, from(10.0, "off"), from(15.0, "off"), options()).unwrap();
    let tube = sets.tube(4).unwrap();
    let possible: Vec<Vec<usize>> =
        (0..4).map(|t| (0..4).filter(|&m| tube.is_possible(t, m)).collect()).collect();
    assert_eq!(possible, [[1], [2], [2], [3]]);
    assert!(tube.is_mode_possible(2, "heater", "on") && !tube.is_mode_possible(2, "heater", "off"));
    assert!(
        !tube.is_mode_possible(2, "heater", "broken") && !tube.is_mode_possible(9, "heater", "on")
    );
    // Without a dwell time, there are shorter ways up and down, but none to 15 K.
    let mut free =
        ReachSets::new(&heater(1, None), from(10.0, "off"), from(12.0, "off"), options()).unwrap();
    assert!(!free.tube(4).unwrap().is_empty());
    let mut kept =
        ReachSets::new(&system, from(10.0, "off"), from(12.0, "off"), options()).unwrap();
    assert!(kept.tube(4).unwrap().is_empty());
}

#[test]
fn modes_end_in_time() {
    // At most two samples in a row.
    let system = heater(1, Some(2));
    let mut sets = ReachSets::new(&system, from(10.0, "off"), anywhere(), options()).unwrap();
    let highest = |sets: &mut ReachSets, t: usize| -> f64 {
        let sets = sets.forward(t).unwrap();
        sets.iter().flatten().map(|set| set.bounding_box()[0].upper).fold(0.0, f64::max)
    };
    // start, heat, stop, start: -1 +2 +2 -1.
    assert!((highest(&mut sets, 4) - 12.0).abs() < 1e-9);
    // Merged dwell times only enlarge the sets.
    let coarse = options().with_layers(2);
    let mut merged = ReachSets::new(&system, from(10.0, "off"), anywhere(), coarse).unwrap();
    assert!((highest(&mut merged, 4) - 15.0).abs() < 1e-9);
    // A plan may begin in the middle of a mode, but not stay beyond its time.
    let mut sets = ReachSets::new(&system, from(10.0, "on"), from(14.0, "on"), options()).unwrap();
    assert!(sets.tube(2).unwrap().is_empty());
    let mut sets = ReachSets::new(&system, from(10.0, "on"), from(12.0, "on"), options()).unwrap();
    assert!(!sets.tube(1).unwrap().is_empty());
}

#[test]
fn an_explanation_names_modes() {
    let system = heater(3, None);
    let mut sets =
        ReachSets::new(&system, from(10.0, "off"), from(29.0, "off"), options()).unwrap();
    let reason = sets.explain(4).unwrap().unwrap();
    let modes: Vec<&str> = reason.findings.iter().map(|f| f.modes[0].1.as_str()).collect();
    assert!(modes.contains(&"off"), "{modes:?}");
    let text = reason.to_string();
    assert!(text.contains("with 1 event, with heater off, T is 15, and 29 is needed"), "{text}");
    let svg = sets.tube(4).unwrap().to_svg(0, 0, None);
    assert!(svg.is_err(), "one state has no plane");
}

#[test]
fn most_events_are_followed_exactly() {
    let system = heater(1, None).with_most_events(1);
    let goal = from(10.0, "off");
    // start, stop, idle three times: two starts would need two events.
    let mut once = ReachSets::new(&system, from(12.0, "off"), &goal, options()).unwrap();
    let mut twice = ReachSets::new(&heater(1, None), from(12.0, "off"), &goal, options()).unwrap();
    // With k starts that each heat once, 5 steps change the temperature by 3 k - 5.
    assert_eq!(once.forward(5).unwrap().len(), 2);
    assert!(!once.tube(5).unwrap().is_empty() && !twice.tube(5).unwrap().is_empty());
    let (up, start) = (from(13.0, "off"), from(12.0, "off"));
    let mut once = ReachSets::new(&system, &start, &up, options()).unwrap();
    // Heated three times in a row, and not at once twice.
    let tube = once.tube(5).unwrap();
    assert_eq!(tube.most_events(), if tube.is_empty() { None } else { Some(1) });
    let limited = heater(1, Some(1)).with_most_events(1);
    let mut once = ReachSets::new(&limited, &start, &up, options()).unwrap();
    assert!(once.tube(5).unwrap().is_empty());
    let mut twice = ReachSets::new(&heater(1, Some(1)), &start, &up, options()).unwrap();
    assert!(!twice.tube(5).unwrap().is_empty());
}

fn cart(states: usize) -> HybridSystem {
    let mut system = HybridSystem::new(1.0).with_input("u", Interval::new(-1.0, 1.0));
    for i in 0..states {
        system = system.with_state(format!("x{i}"), Interval::new(-50.0, 50.0));
    }
    system
}

#[test]
fn doors_close_and_winds_turn() {
    let flow = LinearSystem::new([[1.0]], [[1.0]], [0.0]).unwrap();
    // A door at 2.5 m is open in samples 0 to 3, and then closed for those before it.
    let door = Halfspace::limit("door", [1.0], vec![50.0, 50.0, 50.0, 50.0, 2.5]);
    let system = cart(1).with_limit(door).with_transition(Transition::new("roll", flow.clone()));
    let start = Region::point([0.0]);
    let mut sets = ReachSets::new(&system, &start, Region::point([3.0]), options()).unwrap();
    assert!(!sets.tube(3).unwrap().is_empty(), "before it closes");
    assert!(sets.tube(4).unwrap().is_empty());
    let text = sets.explain(4).unwrap().unwrap().to_string();
    assert!(text.contains("at the end, door is missed by at least 0.5"), "{text}");
    assert!(sets.backward(1).is_err(), "backward sets need the horizon");
    let tube = sets.tube(3).unwrap();
    let bound = tube.to_go(1).next().unwrap().bounding_box()[0];
    assert!((bound.lower - 1.0).abs() < 1e-9 && (bound.upper - 5.0).abs() < 1e-9, "{bound:?}");

    // A range, a reset and a guard by step: no thrust in step 0, then a push of 10 m in step 1.
    let jump = Transition::event("jump", flow)
        .with_reset_by_step([[1.0]], vec![vec![0.0], vec![10.0], vec![0.0]])
        .with_guard(Halfspace::new("not yet", [1.0], vec![-1.0, f64::INFINITY, -1.0]));
    let roll = LinearSystem::new([[1.0]], [[1.0]], [0.0]).unwrap();
    let ranges = vec![Interval::point(0.0), Interval::new(-1.0, 1.0)];
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-50.0, 50.0))
        .with_input("u", ranges)
        .with_transition(Transition::new("roll", roll))
        .with_transition(jump);
    let mut sets = ReachSets::new(&system, &start, Region::point([12.0]), options()).unwrap();
    let first = sets.forward(1).unwrap();
    assert!(first[0].as_ref().unwrap().bounding_box()[0].width() < 1e-9 && first[1].is_none());
    let second = sets.forward(2).unwrap()[1].as_ref().unwrap().bounding_box()[0];
    assert!((second.lower - 9.0).abs() < 1e-9 && (second.upper - 11.0).abs() < 1e-9);
    assert!(sets.tube(2).unwrap().is_empty() && !sets.tube(3).unwrap().is_empty());
    let tube = sets.tube(3).unwrap();
    let jumps: Vec<usize> = (0..3).filter(|&t| tube.is_possible(t, 1)).collect();
    assert_eq!(jumps, [1]);
}

/// Wheels that each may push their own cart by one metre.
fn carts(count: usize, coupled: bool) -> HybridSystem {
    let rows = |on: Option<usize>| {
        let identity = carom::hybrid::Matrix::identity(count);
        let gain = carom::hybrid::Matrix::from_fn(count, 1, |_, _| 0.0);
        let push = |i: usize| match on {
            Some(_) if coupled && i == 0 => 1.0,
            Some(on) if on == i && !coupled => 1.0,
            _ => 0.0,
        };
        LinearSystem::new(identity, gain, (0..count).map(push).collect::<Vec<_>>()).unwrap()
    };
    let mut system = cart(count).with_flow(rows(None));
    for c in 0..count {
        let choice = Choice::new(format!("wheel {c}"))
            .with_transition(Transition::new(format!("rest {c}"), rows(None)))
            .with_transition(Transition::event(format!("push {c}"), rows(Some(c))));
        system = system.with_choice(choice);
    }
    system
}

#[test]
fn effects_of_choices_add() {
    // Three wheels push one cart: 0 to 3 m a step.
    let system = carts(3, true);
    let goal = Region::point([7.0, 0.0, 0.0]);
    let mut sets =
        ReachSets::new(&system, Region::point([0.0; 3]), &goal, options().with_events(9)).unwrap();
    let layers = sets.forward(2).unwrap();
    let range = |events: usize| layers[events].as_ref().unwrap().bounding_box()[0];
    assert!((range(5).lower - 5.0).abs() < 1e-9 && (range(5).upper - 5.0).abs() < 1e-9);
    assert!(sets.tube(2).unwrap().is_empty() && !sets.tube(3).unwrap().is_empty());
    assert_eq!(sets.tube(3).unwrap().fewest_events(), Some(7));
}

#[test]
fn many_choices_are_relaxed_outward() {
    // Nine wheels: 512 moves, of which six wheels are followed.
    for coupled in [true, false] {
        let system = carts(9, coupled);
        let start = Region::point([0.0; 9]);
        let mut goal = [0.0; 9];
        goal[0] = if coupled { 18.0 } else { 2.0 };
        let mut sets = ReachSets::new(&system, &start, Region::point(goal), options()).unwrap();
        let tube = sets.tube(2).unwrap();
        assert!(!tube.is_empty() && sets.tube(1).unwrap().is_empty(), "{coupled}");
        assert!((0..18).step_by(2).all(|m| tube.is_possible(0, m + 1)) || !coupled);
        let reach = sets.forward(2).unwrap();
        let upper =
            reach.iter().flatten().map(|set| set.bounding_box()[0].upper).fold(0.0, f64::max);
        assert!((upper - goal[0]).abs() < 1e-6, "{upper}");
    }
}

#[test]
fn robust_sets_hold_disturbed_states() {
    let flow = LinearSystem::new([[1.0]], [[1.0]], [0.0]).unwrap();
    let system = cart(1)
        .with_transition(Transition::new("roll", flow))
        .with_disturbance([Interval::new(-0.1, 0.3)]);
    let end = Region::point([0.0]);
    let ends = |options| {
        let mut sets = ReachSets::new(&system, &end, &end, options).unwrap();
        let forward = sets.forward(2).unwrap()[0].as_ref().unwrap().bounding_box()[0];
        (forward, sets.backward(2).unwrap()[0].as_ref().unwrap().bounding_box()[0])
    };
    let (nominal, back) = ends(options());
    assert!((nominal.upper - 2.0).abs() < 1e-9 && (back.upper - 2.0).abs() < 1e-9);
    let (robust, back) = ends(options().with_disturbance(true));
    assert!((robust.lower + 2.2).abs() < 1e-9 && (robust.upper - 2.6).abs() < 1e-9, "{robust:?}");
    assert!((back.lower + 2.6).abs() < 1e-9 && (back.upper - 2.2).abs() < 1e-9, "{back:?}");
}

#[test]
fn regions_are_cut_by_halfspaces() {
    let flow = LinearSystem::double_integrator(1.0).unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_state("v", Interval::new(-9.0, 9.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("roll", flow));
    let start = Region::from([Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0)])
        .with_halfspace(Halfspace::new("slow", [1.0, 1.0], 0.0));
    let goal = Region::from([Interval::new(2.0, f64::INFINITY), Interval::REALS]);
    let mut sets = ReachSets::new(&system, &start, &goal, options()).unwrap();
    // x + v <= 0 and a <= 1: x⁺ <= 1/2, and 2 m are reached in two steps.
    let after = sets.forward(1).unwrap()[0].as_ref().unwrap().bounding_box()[0];
    assert!((after.upper - 0.5).abs() < 1e-9, "{after:?}");
    assert!(sets.tube(1).unwrap().is_empty() && !sets.tube(2).unwrap().is_empty());
    let nowhere = Region::point([3.0, 3.0]).with_halfspace(Halfspace::new("slow", [1.0, 1.0], 0.0));
    let mut sets = ReachSets::new(&system, &nowhere, &goal, options()).unwrap();
    let text = sets.explain(3).unwrap().unwrap().to_string();
    assert!(
        text.starts_with("no plan has 3 steps (3 s): at the start, slow is missed by at least 6"),
        "{text}"
    );
}
