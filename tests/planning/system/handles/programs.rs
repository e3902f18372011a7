//! Programs of systems stated by handles: several systems, handles by name, order of statements.

use carom::ErrorKind;
use carom::hybrid::{
    ControlMove, HybridSystem, MoveSource, RecedingHorizon, SimulationOptions, State, When,
};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

/// A cart that moves by at most `most` a step, or waits at a price.
struct Cart {
    system: HybridSystem,
    x: State,
    u: Input,
    waits: Variable,
}

fn cart(time_step: f64, most: f64) -> Cart {
    let mut system = HybridSystem::new(time_step);
    let x = system.state("x", -9.0, 9.0).unwrap();
    let u = system.input("u", -most, most).unwrap();
    system.mode("roll").unwrap().next([(x, x + u)]).unwrap();
    let waits = system.mode("wait").unwrap().next([(x, x + 0.0)]).unwrap().taken();
    Cart { system, x, u, waits }
}

proptest! {
    #![proptest_config(config(16, "tests/regressions/joined.txt"))]

    /// Two systems in one program that have nothing to do with each other cost what they cost
    /// alone, and a row between them holds.
    #[test]
    fn systems_in_one_program_do_not_disturb_each_other(
        most in [1..=3_i32, 1..=3], start in [-4..=4_i32, -4..=4], goal in [-4..=4_i32, -4..=4],
        steps in 1..=4_usize,
    ) {
        let carts = [0, 1].map(|k| cart(1.0, f64::from(most[k])));
        let ends = |k: usize| (f64::from(start[k]), f64::from(goal[k]));
        let alone = |k: usize| {
            let Cart { system, x, u, waits } = &carts[k];
            let mut program = system.program(steps).unwrap();
            let (start, goal) = ends(k);
            program.start([x.equals(start)]).unwrap();
            program.goal([x.equals(goal)]).unwrap();
            program.minimize(program.sum(u.square() - 0.25 * waits).unwrap()).unwrap();
            BranchAndBound::default().solve(program.model()).unwrap().objective()
        };
        let [first, second] = &carts;
        let mut both = first.system.program(steps).unwrap();
        both.join("second", &second.system).unwrap();
        both.start([first.x.equals(ends(0).0), second.x.equals(ends(1).0)]).unwrap();
        both.goal([first.x.equals(ends(0).1), second.x.equals(ends(1).1)]).unwrap();
        let cost = first.u.square() + second.u.square() - 0.25 * (first.waits + second.waits);
        both.minimize(both.sum(cost).unwrap()).unwrap();
        let apart = first.x - second.x;
        match (alone(0), alone(1), both.solve(&mut BranchAndBound::default())) {
            (Some(a), Some(b), plan) => {
                let plan = plan.unwrap();
                let found = plan.solution.objective().unwrap();
                prop_assert!((found - a - b).abs() <= 1e-5 * found.abs().max(1.0), "{found} {a} {b}");
                let (run, certificate) = plan.joined("second").unwrap();
                prop_assert!(certificate.largest_residual <= 1e-6);
                let (own, other) = (plan.values(first.x).unwrap(), plan.values(second.x).unwrap());
                prop_assert_eq!(&plan.run.states[0].1, &own);
                prop_assert_eq!(&run.states[0].1, &other);
                for t in 0..=steps {
                    let value = plan.value(&apart, t).unwrap();
                    prop_assert!((value - own[t] + other[t]).abs() <= 1e-9);
                }
                let waits = run.transitions("mode").unwrap().iter().filter(|name| *name == "wait");
                prop_assert_eq!(waits.count(), plan.count(second.waits).unwrap());
            }
            (_, _, plan) => {
                let error = plan.map(|_| ()).unwrap_err();
                prop_assert!(matches!(error.kind(), ErrorKind::NoPlan { .. }), "{error}");
            }
        }
        // A row between them.
        let mut kept = both.clone();
        kept.require("near", [apart.within(-1.0, 1.0)], When::Throughout(0..=steps)).unwrap();
        match kept.solve(&mut BranchAndBound::default()) {
            Ok(plan) => {
                for t in 0..=steps {
                    prop_assert!(plan.value(&apart, t).unwrap().abs() <= 1.0 + 1e-6);
                }
            }
            Err(error) => {
                prop_assert!(matches!(error.kind(), ErrorKind::NoPlan { .. }), "{error}");
            }
        }
    }
}

#[test]
fn what_cannot_join_is_refused() {
    let (first, second) = (cart(1.0, 1.0), cart(1.0, 2.0));
    let mut program = first.system.program(3).unwrap();
    program.join("second", &second.system).unwrap();
    let before = program.model().to_string();
    let mut refused = |name: &str, system: &HybridSystem| {
        let error = program.join(name, system).unwrap_err().to_string();
        assert_eq!(program.model().to_string(), before);
        error
    };
    assert_eq!(
        refused("slow", &cart(2.0, 1.0).system),
        "the time step (s) is 2; it must be 1, that of the program"
    );
    let taken = |name: &str| {
        format!(
            "the name `{name}` is already taken by another system of the program; choose another one"
        )
    };
    let twice = "the system of `again` cannot stand in this program; it is in it already; state a \
                 second system, with handles of its own";
    assert_eq!(refused("again", &first.system), twice);
    assert_eq!(refused("again", &second.system.clone()), twice);
    assert_eq!(refused("second", &cart(1.0, 1.0).system), taken("second"));
    assert_eq!(refused("", &cart(1.0, 1.0).system), taken(""));
    let mut empty = HybridSystem::new(1.0);
    empty.state("y", 0.0, 1.0).unwrap();
    assert!(refused("empty", &empty).contains("the number of transitions"));
    // A third system has no value here.
    let error = program.at(second.x - cart(1.0, 1.0).x, 0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }), "{error}");
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    let error = plan.joined("third").unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::UnknownName { name, .. } if name == "third"));
}

/// Two carts that are measured together, and keep apart.
#[test]
fn two_systems_are_controlled_together() {
    let (first, second) = (cart(1.0, 1.0), cart(1.0, 1.0));
    let mut program = first.system.program(4).unwrap();
    program.join("second", &second.system).unwrap();
    let apart = program.soften("apart", (second.x - first.x).ge(1.0), 1e3, 0.0).unwrap();
    let miss = (first.x - 3.0).square() + (second.x + 3.0).square();
    let cost = program.sum(miss).unwrap();
    program.minimize(cost + apart.cost).unwrap();
    let mut solver = BranchAndBound::default();
    let controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let mut controller = controller.with_excess(apart.excess);
    let plant = |state: &[f64], next: &ControlMove| {
        Ok(vec![state[0] + next.input[0], state[1] + next.input[1]])
    };
    let run = controller.run(&[-2.0, 2.0], 6, plant).unwrap();
    assert_eq!(run.count(MoveSource::Optimal), 6, "{run}");
    assert!(run.states.iter().all(|state| state[1] - state[0] >= 1.0 - 1e-5), "{:?}", run.states);
    let end = run.states.last().unwrap();
    assert!((end[1] - end[0] - 1.0).abs() < 1e-4, "{end:?}");
}

/// A heater with a common flow, whose switches are stated before or after the modes.
#[test]
fn a_switch_has_the_flow_of_the_mode_that_it_enters() {
    let room = |switches_first: bool, has_common: bool| {
        let mut room = HybridSystem::new(1.0);
        let t = room.state("T", 0.0, 40.0).unwrap();
        if has_common {
            room.next([(t, 0.5 * t)]).unwrap();
        }
        let [off, on] = room.modes("heater", ["off", "on"]).unwrap();
        let switches = |room: &mut HybridSystem| {
            room.switch(off, on).unwrap().guard(t.le(19.0)).unwrap();
            room.switch(on, off).unwrap().guard(t.ge(21.0)).unwrap();
        };
        if switches_first {
            switches(&mut room);
        }
        room.stay(off).unwrap().next([(t, t - 1.0)]).unwrap().guard(t.ge(19.5)).unwrap();
        room.stay(on).unwrap().next([(t, t + 2.0)]).unwrap().guard(t.le(20.5)).unwrap();
        if !switches_first {
            switches(&mut room);
        }
        room.check().unwrap();
        let options = SimulationOptions::default().with_mode("heater", "off");
        let run = room.simulate_with(&[20.0], &[[]; 8], &options).unwrap();
        run.state("T").unwrap()
    };
    for (switches_first, has_common) in [(false, false), (false, true), (true, false), (true, true)]
    {
        let expected = [20.0, 19.0, 21.0, 20.0, 19.0, 21.0, 20.0, 19.0, 21.0];
        assert_eq!(room(switches_first, has_common), expected, "{switches_first} {has_common}");
    }
}

/// A rule about an input keeps its name, so that it can be dropped; a guard becomes a range.
#[test]
fn a_rule_about_an_input_keeps_its_name() {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -9.0, 9.0).unwrap();
    let u = cart.input("u", -2.0, 2.0).unwrap();
    let mode = cart.mode("calm").unwrap().next([(x, x + u)]).unwrap();
    mode.guard(u.ge(-1.0)).unwrap().limit("speed limit", u.le(0.5)).unwrap();
    let text = cart.to_string();
    assert!(text.contains("u <= 0.5 (speed limit; a limit)"), "{text}");
    assert!(text.contains("u in [-1, 2]"), "{text}");
    for (goal, steps) in [(2.0, 4), (-2.0, 2)] {
        let (start, goal) = ([x.equals(0.0)], [x.equals(goal)]);
        let found = cart.shortest(start, goal, &mut BranchAndBound::default()).unwrap();
        assert_eq!(found.steps, Some(steps));
    }
}

#[test]
fn a_limit_of_zero_has_no_sign() {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -9.0, 9.0).unwrap();
    cart.limit("in front", x.ge(0.0)).unwrap();
    cart.mode("stay").unwrap().next::<Affine>([]).unwrap();
    assert!(cart.to_string().contains("always -x <= 0 (in front; a limit)"), "{cart}");
}

/// States that are declared after a disturbance have none.
#[test]
fn states_may_follow_a_disturbance() {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", 0.0, 1.0).unwrap();
    system.disturbance(x, -0.5, 0.25).unwrap();
    system.state("y", 0.0, 1.0).unwrap();
    system.mode("stay").unwrap().next::<Affine>([]).unwrap();
    system.check().unwrap();
    assert!(system.to_string().contains("disturbance of y in [0, 0]"), "{system}");
}

/// All handles of a system that has none of them at hand.
#[test]
fn handles_are_found_by_name() {
    let mut ball = HybridSystem::new(0.1);
    let h = ball.state("height", 0.0, 5.0).unwrap();
    let v = ball.state("speed", -10.0, 10.0).unwrap();
    let push = ball.input("push", -1.0, 1.0).unwrap();
    let impact = ball.output("impact speed").unwrap();
    ball.rates([(h, v.into()), (v, push - 9.81)]).unwrap();
    let fall = ball.mode("fall").unwrap().guard(h.predicted().ge(0.0)).unwrap().taken();
    let bounce = ball.event("bounce").unwrap().guard(h.predicted().le(0.0)).unwrap();
    let bounce = bounce.reset([(h, -0.5 * h.predicted()), (v, -0.5 * v.predicted())]).unwrap();
    bounce.output(impact, -v.predicted()).unwrap();
    let [lit, _] = ball.modes("lamp", ["lit", "dark"]).unwrap();
    ball.stay(lit).unwrap();
    let found = (ball.state_named("speed").unwrap(), ball.input_named("push").unwrap());
    assert_eq!(found, (v, push));
    assert_eq!(ball.transition_named("mode", "fall").unwrap(), fall);
    assert_eq!(ball.mode_named("lamp", "lit").unwrap(), lit);
    assert_eq!(ball.output_named("impact speed").unwrap(), impact);
    let unknown = |error: Error, expected: &str| {
        assert!(matches!(error.kind(), ErrorKind::UnknownName { name, .. } if name == expected));
    };
    unknown(ball.state_named("push").unwrap_err(), "push");
    unknown(ball.input_named("height").unwrap_err(), "height");
    unknown(ball.transition_named("walls", "fall").unwrap_err(), "walls");
    unknown(ball.transition_named("mode", "fly").unwrap_err(), "fly");
    unknown(ball.mode_named("mode", "fall").unwrap_err(), "fall");
    // A mode that no transition names is none yet.
    unknown(ball.mode_named("lamp", "dark").unwrap_err(), "dark");
    unknown(ball.output_named("noise").unwrap_err(), "noise");
}

#[cfg(feature = "serde")]
proptest! {
    #![proptest_config(config(60, "tests/regressions/handles_serde.txt"))]

    #[test]
    fn handles_of_a_system_that_was_read_are_found_by_name(plain in super::plain::plain()) {
        let Ok(system) = plain.by_handles() else { return Err(TestCaseError::reject("crossed")) };
        prop_assume!(system.check().is_ok());
        let text = serde_json::to_string(&system).unwrap();
        let back: HybridSystem = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&back, &system);
        prop_assert_eq!(back.to_string(), system.to_string());
        // The old handles are those of another system.
        let old = system.state_named("s0").unwrap();
        prop_assert!(back.region([old.ge(0.0)]).is_err());
        let x = back.state_named("s0").unwrap();
        let mut program = back.program(2).unwrap();
        program.goal([x.ge(-1.0)]).unwrap();
        program.minimize(program.end(x).unwrap()).unwrap();
        let mut first = system.program(2).unwrap();
        first.goal([old.ge(-1.0)]).unwrap();
        first.minimize(first.end(old).unwrap()).unwrap();
        prop_assert_eq!(program.model().to_string(), first.model().to_string());
    }
}

/// Inputs may be declared when they are needed: what was stated before does not depend on them.
#[test]
fn an_input_after_a_limit_and_a_flow_is_that_of_a_system_in_order() {
    let stated = |is_late: bool| {
        let mut system = HybridSystem::new(1.0);
        let x = system.state("x", 0.0, 9.0).unwrap();
        let v = system.input("v", -1.0, 1.0).unwrap();
        let early = (!is_late).then(|| system.input("u", 0.0, 2.0).unwrap());
        system.limit("slow", v.within(-0.5, 0.5)).unwrap();
        system.limit("sum", (x + v).le(8.0)).unwrap();
        system.next([(x, x + v)]).unwrap();
        system.mode("coast").unwrap().guard(v.ge(0.25)).unwrap();
        let u = early.unwrap_or_else(|| system.input("u", 0.0, 2.0).unwrap());
        system.mode("boost").unwrap().next([(x, 1.0 * u)]).unwrap().guard(u.ge(0.5)).unwrap();
        (system, x)
    };
    let [(early, x), (late, late_x)] = [false, true].map(stated);
    assert_eq!(early.to_string(), late.to_string());
    let mut solver = BranchAndBound::default();
    let (start, goal) = ([x.equals(0.0)], [x.ge(7.4)]);
    let found = early.shortest(start, goal, &mut solver).unwrap();
    let (start, goal) = ([late_x.equals(0.0)], [late_x.ge(7.4)]);
    assert_eq!(late.shortest(start, goal, &mut solver).unwrap().steps, found.steps);
    // To 2 m by the boost, then 0.5 m a step.
    assert_eq!(found.steps, Some(12));
}
