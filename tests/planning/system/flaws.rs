//! Slips in the statement of a hybrid system are named, and nothing else is.

use carom::hybrid::{
    Choice, Contact, Flaw, Halfspace, HybridSystem, LinearSystem, Restitution, Transition, Wall,
};
use carom::interval::Interval;
use carom::prelude::*;

/// The findings in a few words, sorted.
fn findings(system: &HybridSystem) -> Vec<String> {
    let flaws = system.flaws(&mut BranchAndBound::default()).unwrap();
    let mut words: Vec<String> = flaws.iter().map(words).collect();
    words.sort();
    words
}

fn words(flaw: &Flaw) -> String {
    match flaw {
        Flaw::Gap { choice, mode, .. } => {
            format!("gap {choice} {}", mode.as_deref().unwrap_or("-"))
        }
        Flaw::Overlap { transitions: [a, b], .. } => format!("overlap {a} {b}"),
        Flaw::NeverTaken { transition, .. } => format!("never taken {transition}"),
        Flaw::LeavesDomain { transition, state, .. } => format!("leaves {transition} {state}"),
        Flaw::NeverEntered { mode, .. } => format!("never entered {mode}"),
        Flaw::NoWayOn { mode, .. } => format!("no way on {mode}"),
        Flaw::NeverKept { mode, least, .. } => format!("never kept {mode} {least}"),
        Flaw::NoEffect { input } => format!("no effect {input}"),
        Flaw::Unbounded { name, .. } => format!("unbounded {name}"),
        other => panic!("{other}"),
    }
}

/// The paper's wall: a mass on a line that rebounds at 0 m.
fn wall(e: f64) -> HybridSystem {
    super::wall(e, Some(5.0))
}

#[test]
fn the_wall_has_one_gap_and_nothing_else() {
    for e in [0.0, 0.5, 1.0] {
        let flaws = wall(e).flaws(&mut BranchAndBound::default()).unwrap();
        let [Flaw::Gap { witness, .. }] = &flaws[..] else { panic!("{flaws:?}") };
        // It ends behind the wall while moving away.
        let (x, u) = (witness.states(), witness.inputs());
        let y = LinearSystem::double_integrator(0.1).unwrap().step(&x, &u).unwrap();
        assert!(y[0] < -1e-4 && y[1] > 1e-3, "{witness}: {y:?}");
        // The simulation agrees.
        let run = wall(e).simulate(&x, &[u]).unwrap();
        assert_eq!(run.dead_end.unwrap().step(), 0);
    }
    let mut declared = wall(0.5);
    declared.choices[0] = declared.choices[0].clone().with_dead_ends(true);
    assert_eq!(findings(&declared), [""; 0]);
}

#[test]
fn gears_overlap_unless_the_choice_is_free() {
    let line = LinearSystem::double_integrator(0.1).unwrap();
    let gear = |strength: f64| {
        let gain = [[strength * line.b()[(0, 0)]], [strength * line.b()[(1, 0)]]];
        LinearSystem::new(line.a(), gain, [0.0, 0.0]).unwrap()
    };
    let fast = Halfspace::limit("the least speed of high gear", [0.0, -1.0], -0.4);
    let gears = Choice::new("gear")
        .with_transition(Transition::new("low", gear(0.6)))
        .with_transition(Transition::new("high", gear(1.5)).with_guard(fast));
    let elevator = HybridSystem::new()
        .with_state("x", Interval::new(0.0, 15.0))
        .with_state("v", Interval::new(-2.5, 2.5))
        .with_input("u", Interval::new(-1.0, 1.0));
    assert_eq!(findings(&elevator.clone().with_choice(gears.clone())), ["overlap low high"]);
    let free = elevator.with_choice(gears.with_free_choice(true));
    assert_eq!(findings(&free), [""; 0]);
}

/// A tank whose outflow changes at 2 m: level in m, inflow in m per step.
fn tank(below: Halfspace, above: Halfspace) -> HybridSystem {
    let flow = |decay: f64| LinearSystem::new([[decay]], [[1.0]], [0.0]).unwrap();
    HybridSystem::new()
        .with_state("level", Interval::new(0.0, 5.0))
        .with_input("inflow", Interval::new(0.0, 0.5))
        .with_transition(Transition::new("low", flow(0.9)).with_guard(below))
        .with_transition(Transition::new("high", flow(0.7)).with_guard(above))
}

#[test]
fn a_flipped_sign_a_gap_and_an_overlap_are_named() {
    let below = |limit: f64| Halfspace::new("up to 2 m", [1.0], limit);
    let above = |limit: f64| Halfspace::new("from 2 m on", [-1.0], -limit);
    assert_eq!(findings(&tank(below(2.0), above(2.0))), [""; 0]);
    assert_eq!(findings(&tank(below(1.9), above(2.0))), ["gap mode -"]);
    assert_eq!(findings(&tank(below(2.1), above(2.0))), ["overlap low high"]);
    let flipped = Halfspace::new("from 2 m on", [1.0], 2.0);
    assert_eq!(findings(&tank(below(2.0), flipped)), ["gap mode -", "overlap low high"]);
    let nowhere = Halfspace::new("from 2 m on", [1.0], -2.0);
    assert_eq!(findings(&tank(below(2.0), nowhere)), ["gap mode -", "never taken high"]);

    let system = tank(below(1.9), above(2.0));
    let flaws = system.flaws(&mut BranchAndBound::default()).unwrap();
    let Flaw::Gap { witness, margin, .. } = &flaws[0] else { panic!() };
    assert!((witness.states()[0] - 1.95).abs() < 1e-4 && (margin - 0.01).abs() < 1e-5);
    assert_eq!(
        flaws[0].to_string().split(';').next_back().unwrap(),
        " check the guards, or declare it with `with_dead_ends`"
    );
}

#[test]
fn resets_that_leave_the_domain_are_named() {
    // The sign of the reset's position is wrong: it ends behind the wall.
    let mut wrong = wall(0.5);
    let impact = wrong.choices[0].transitions[1].clone();
    wrong.choices[0].transitions[1] = impact.with_reset([[0.5, 0.0], [0.0, -0.5]], [0.0, 0.0]);
    assert_eq!(findings(&wrong), ["gap mode -", "leaves impact x"]);
    let flaws = wrong.flaws(&mut BranchAndBound::default()).unwrap();
    let Flaw::LeavesDomain { witness, distance, .. } = &flaws[1] else { panic!("{flaws:?}") };
    // At the wall with the largest impact speed: 0.1 s at 5 m/s, scaled by 0.5.
    assert!(witness.states()[0] < 1e-3 && (0.2..0.26).contains(distance), "{}", flaws[1]);
    // A wall at 3 m whose offset was forgotten.
    let contact = Contact::new(Wall::below(3.0).unwrap(), Restitution::new(0.5).unwrap());
    let [flight, impact] = contact.transitions(0.1, None).unwrap();
    let ceiling = HybridSystem::new()
        .with_state("x", Interval::new(1.0, 3.0))
        .with_state("v", Interval::new(-8.0, 8.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_transition(flight)
        .with_transition(impact.with_reset([[-0.5, 0.0], [0.0, -0.5]], [0.0, 0.0]));
    // All of its resets leave the domain, so it can never be taken.
    let expected = ["gap mode -", "leaves impact x", "never taken impact"];
    assert_eq!(findings(&ceiling), expected);
    // A flow without inputs that leaves it.
    let grow = LinearSystem::new([[1.1]], [[]; 1], [0.0]).unwrap();
    let growing = HybridSystem::new()
        .with_state("x", Interval::new(0.0, 1.0))
        .with_transition(Transition::new("grow", grow));
    assert_eq!(findings(&growing), ["leaves grow x"]);
}

#[test]
fn modes_without_a_way_are_named() {
    let flow = |heat: f64| LinearSystem::new([[0.9]], [[]; 1], [0.5 + heat]).unwrap();
    let heater = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(0.0)).within("off"))
        .with_transition(Transition::event("start", flow(1.0)).between("off", "on"))
        .with_transition(Transition::event("explode", flow(1.0)).between("on", "broken"))
        .with_transition(Transition::new("repair", flow(0.0)).between("shelf", "off"))
        .with_free_choice(true)
        .with_dwell("on", 3, None);
    let system =
        HybridSystem::new().with_state("T", Interval::new(0.0, 40.0)).with_choice(heater.clone());
    let expected = ["never entered shelf", "never kept on 3", "no way on broken"];
    assert_eq!(findings(&system), expected);

    let stay = Transition::new("heat", flow(1.0)).within("on");
    let whole = HybridSystem::new().with_state("T", Interval::new(0.0, 40.0));
    let whole = whole.with_choice(heater.clone().with_transition(stay));
    assert_eq!(findings(&whole), ["never entered shelf", "no way on broken"]);

    // Three samples at a strong heat do not fit into the domain.
    let strong = Transition::new("heat", flow(20.0)).within("on");
    let strong = strong.with_guard(Halfspace::new("warm", [-1.0], -10.0));
    let narrow = HybridSystem::new().with_state("T", Interval::new(0.0, 31.0));
    let narrow = narrow.with_choice(heater.with_transition(strong).with_dead_ends(true));
    assert_eq!(findings(&narrow), ["never entered shelf", "never kept on 3"]);
}

#[test]
fn idle_inputs_and_huge_domains_are_named() {
    let flow = LinearSystem::new([[0.5]], [[1.0, 0.0]], [0.0]).unwrap();
    let system = HybridSystem::new()
        .with_state("x", Interval::new(-1e12, 1e12))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_input("idle", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("only", flow));
    assert_eq!(findings(&system), ["no effect idle", "unbounded x"]);
}

#[test]
fn steps_and_choices_are_looked_at() {
    // The door between the modes opens a gap in step 2 only.
    let below = Halfspace::new("below", [1.0], vec![2.0, 2.0, 1.5, 2.0]);
    let above = Halfspace::new("above", [-1.0], -2.0);
    let flaws = tank(below, above).flaws(&mut BranchAndBound::default()).unwrap();
    let [Flaw::Gap { witness, .. }] = &flaws[..] else { panic!("{flaws:?}") };
    assert_eq!(witness.step, 2);

    // A second choice whose transition is possible only with the first one's help.
    let flow = |shift: f64| LinearSystem::new([[1.0]], [[]; 1], [shift]).unwrap();
    let system = |lift: f64| {
        HybridSystem::new()
            .with_state("h", Interval::new(0.0, 10.0))
            .with_flow(flow(0.0))
            .with_choice(
                Choice::new("lift")
                    .with_transition(Transition::new("rest", flow(0.0)))
                    .with_transition(Transition::new("up", flow(lift)))
                    .with_free_choice(true),
            )
            .with_choice(
                Choice::new("drop")
                    .with_transition(Transition::new("hold", flow(0.0)))
                    .with_transition(Transition::new("fall", flow(-12.0)))
                    .with_free_choice(true),
            )
    };
    assert_eq!(findings(&system(3.0)), [""; 0]);
    assert_eq!(findings(&system(1.0)), ["never taken fall"]);
}
