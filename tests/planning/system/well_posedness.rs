//! Slips in the statement of a hybrid system are named, and nothing else is.

use crate::rows::wall::reflecting;
use carom::collision_tolerant::Wall;
use carom::hybrid::{HybridSystem, IllPosedness, LinearSystem};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::{Choice, Halfspace, Transition};
use proptest::prelude::*;

use crate::common::config;

/// The findings in a few words, sorted.
fn findings(system: &HybridSystem) -> Vec<String> {
    let flaws = system.well_posedness(&mut BranchAndBound::default()).unwrap();
    let mut words: Vec<String> = flaws.iter().map(words).collect();
    words.sort();
    words
}

fn words(flaw: &IllPosedness) -> String {
    match flaw {
        IllPosedness::Gap { choice, mode, .. } => {
            format!("gap {choice} {}", mode.as_deref().unwrap_or("-"))
        }
        IllPosedness::Overlap { transitions: [a, b], .. } => format!("overlap {a} {b}"),
        IllPosedness::NeverTaken { transition, .. } => format!("never taken {transition}"),
        IllPosedness::Stuck { modes, .. } => {
            let modes: Vec<&str> = modes.iter().map(|(_, mode)| mode.as_str()).collect();
            format!("stuck {}", modes.join(" "))
        }
        other => panic!("{other}"),
    }
}

/// The paper's wall: a mass on a line that rebounds at 0 m.
fn wall(e: f64) -> HybridSystem {
    super::wall(e, Some(5.0))
}

#[test]
fn the_wall_has_a_gap_and_ends_at_full_speed() {
    for e in [0.0, 0.5, 1.0] {
        let flaws = wall(e).well_posedness(&mut BranchAndBound::default()).unwrap();
        let [IllPosedness::Gap { witness, .. }, IllPosedness::Stuck { witness: end, .. }] =
            &flaws[..]
        else {
            panic!("{flaws:?}")
        };
        // At full speed at the far end of the domain.
        let at = end.states();
        assert!((at[0] - 20.0).abs() < 1e-3 && (at[1] - 8.0).abs() < 1e-3, "{end}");
        // It ends behind the wall while moving away.
        let (x, u) = (witness.states(), witness.inputs());
        let y = LinearSystem::double_integrator(0.1).unwrap().step(&x, &u).unwrap();
        assert!(y[0] < -1e-4 && y[1] > 1e-3, "{witness}: {y:?}");
        // The simulation agrees.
        let run = wall(e).simulate(&x, &[u]).unwrap();
        assert_eq!(run.dead_end.unwrap().step(), 0);
    }
    let mut declared = wall(0.5);
    declared.parts_mut().choices[0] = declared.parts().choices[0].clone().with_dead_ends(true);
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
    let elevator = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 15.0))
        .with_state("v", Interval::new(-2.5, 2.5))
        .with_input("u", Interval::new(-1.0, 1.0));
    assert_eq!(
        findings(&elevator.clone().with_choice(gears.clone())),
        ["overlap low high", "stuck "]
    );
    let free = elevator.clone().with_choice(gears.clone().with_free_choice(true));
    assert_eq!(findings(&free), ["stuck "]);
    // Slow enough to stop: with 0.06 m/s a step in low gear, v² <= 1.2 x and a bit less, from 40
    // tangents of it at either end.
    let mut safe = free;
    for k in 0..=40 {
        let at = 0.0625 * f64::from(k);
        // v <= (distance + at²/1.2) / (at/0.6).
        let slope = (at + 0.06) / 0.6;
        for (sign, end) in [(1.0, 15.0), (-1.0, 0.0)] {
            let limit = sign * end + at * at / 1.2;
            safe = safe.with_limit(Halfspace::new("braking", [sign, sign * slope], limit));
        }
    }
    assert_eq!(findings(&safe), [""; 0]);
}

/// A tank whose outflow changes at 2 m: level in m, inflow in m per step.
fn tank(below: Halfspace, above: Halfspace) -> HybridSystem {
    let flow = |decay: f64| LinearSystem::new([[decay]], [[1.0]], [0.0]).unwrap();
    HybridSystem::new(1.0)
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
    let flaws = system.well_posedness(&mut BranchAndBound::default()).unwrap();
    let IllPosedness::Gap { witness, margin, .. } = &flaws[0] else { panic!() };
    assert!((witness.states()[0] - 1.95).abs() < 1e-4 && (margin - 0.01).abs() < 1e-5);
    assert_eq!(
        flaws[0].to_string().split(';').next_back().unwrap(),
        " check the guards, or allow dead ends by `expect` [gap]"
    );
}

#[test]
fn resets_that_leave_the_domain_are_dead_ends() {
    // The sign of the reset's position is wrong: it ends behind the wall.
    let mut wrong = wall(0.5);
    let impact = wrong.parts().choices[0].transitions[1].clone();
    wrong.parts_mut().choices[0].transitions[1] =
        impact.with_reset([[0.5, 0.0], [0.0, -0.5]], [0.0, 0.0]);
    let wrong = wrong.with_limit(Halfspace::new("towards the wall", [0.0, 1.0], 0.0));
    assert_eq!(findings(&wrong), ["gap mode -", "stuck "]);
    let flaws = wrong.well_posedness(&mut BranchAndBound::default()).unwrap();
    let IllPosedness::Stuck { witness, .. } = &flaws[1] else { panic!("{flaws:?}") };
    // Near the wall, so fast that it is hit whatever the input.
    let at = witness.states();
    assert!(at[0] + 0.1 * at[1] + 0.005 < 1e-3, "{}", flaws[1]);
    // A wall at 3 m whose offset was forgotten.
    let [flight, impact] = reflecting(Wall::below(3.0).unwrap(), 0.5, 0.1, None);
    let ceiling = HybridSystem::new(1.0)
        .with_state("x", Interval::new(1.0, 3.0))
        .with_state("v", Interval::new(-8.0, 8.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_transition(flight)
        .with_transition(impact.with_reset([[-0.5, 0.0], [0.0, -0.5]], [0.0, 0.0]));
    // All of its resets leave the domain, so it can never be taken.
    let expected = ["gap mode -", "never taken impact", "stuck "];
    assert_eq!(findings(&ceiling), expected);
    // A flow without inputs that leaves it.
    let grow = LinearSystem::new([[1.1]], [[]; 1], [0.0]).unwrap();
    let growing = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 1.0))
        .with_transition(Transition::new("grow", grow));
    assert_eq!(findings(&growing), ["stuck "]);
}

#[test]
fn states_without_a_way_to_stay_are_named() {
    let domain = Interval::new(0.0, 10.0);
    // One step of 1 s: x + v + a/2 <= 10 needs x + v <= 10.5.
    let line = LinearSystem::double_integrator(1.0).unwrap();
    let cart = HybridSystem::new(1.0)
        .with_state("x", domain)
        .with_state("v", Interval::new(-1.0, 1.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("roll", line));
    let flaws = cart.well_posedness(&mut BranchAndBound::default()).unwrap();
    // At either end, which are mirror images.
    let text = |at: &str| {
        format!(
            "no input keeps the state in its domain at {at}; widen the domain, exclude such states by \
             a limit, or allow dead ends by `expect` [dead-end]"
        )
    };
    let ends = ["x = 10.000000, v = 1.000000", "x = 0.000000, v = -1.000000"].map(text);
    assert!(ends.contains(&flaws[0].to_string()), "{}", flaws[0]);
    assert_eq!(flaws.len(), 1);
    let limited = cart
        .with_limit(Halfspace::new("slow at the far end", [1.0, 1.0], 10.0))
        .with_limit(Halfspace::new("slow at the near end", [-1.0, -1.0], 0.0));
    assert_eq!(findings(&limited), [""; 0]);

    // A drift that only another choice can stop, in one of its modes.
    let flow = |shift: f64| LinearSystem::new([[1.0]], [[1.0]], [shift]).unwrap();
    let drifting = |brake: f64| {
        let brakes = Choice::new("brake")
            .with_transition(Transition::new("release", flow(1.0)).within("off"))
            .with_transition(Transition::new("press", flow(1.0 - brake)).within("on"));
        HybridSystem::new(1.0)
            .with_state("x", domain)
            .with_input("u", Interval::new(-0.5, 0.5))
            .with_flow(flow(1.0))
            .with_choice(Choice::new("idle").with_transition(Transition::new("idle", flow(1.0))))
            .with_choice(brakes)
    };
    assert_eq!(findings(&drifting(1.0)), ["stuck off"]);
    assert_eq!(findings(&drifting(0.2)), ["stuck off", "stuck on"]);
    let mut declared = drifting(1.0);
    declared.parts_mut().choices[1].may_end = true;
    assert_eq!(findings(&declared), [""; 0]);
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/flaws.txt"))]

    /// A state is reported exactly if a grid of states and inputs has one, up to the grid's width.
    #[test]
    fn a_grid_finds_the_same_states(
        matrix in prop::collection::vec(-1.1..1.1_f64, 4),
        gains in prop::collection::vec(-1.0..1.0_f64, 4),
        shift in prop::collection::vec(-0.3..0.3_f64, 2),
        split in -0.5..0.5_f64,
    ) {
        // Two modes left and right of a line, with two inputs.
        let unit = Interval::new(-1.0, 1.0);
        let flow = |sign: f64| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| matrix[k] * if k > 1 { sign } else { 1.0 });
            let gains = [[gains[0], 0.2 * gains[1]], [gains[2], sign * 0.2 * gains[3]]];
            LinearSystem::new([[a, b], [c, d]], gains, shift.clone()).unwrap()
        };
        let (left, right) = (flow(1.0), flow(-1.0));
        let system = HybridSystem::new(1.0)
            .with_state("x", unit)
            .with_state("y", unit)
            .with_input("u", Interval::new(-0.3, 0.3))
            .with_input("w", unit)
            .with_transition(Transition::new("left", left.clone())
                .with_guard(Halfspace::new("left", [1.0, 0.0], split)))
            .with_transition(Transition::new("right", right.clone())
                .with_guard(Halfspace::new("right", [-1.0, 0.0], -split)));
        let found = findings(&system).contains(&"stuck ".to_owned());
        // How far outside the best next state is, over the corners and a grid of the inputs.
        let outside = |x: &[f64]| {
            let flow = if x[0] <= split { &left } else { &right };
            let inputs = (0..=20).flat_map(|i| (0..=20).map(move |j| [i, j]));
            let next = inputs.map(|[i, j]| {
                let u = [-0.3 + 0.03 * f64::from(i), -1.0 + 0.1 * f64::from(j)];
                let next = flow.step(x, &u).unwrap();
                next[0].abs().max(next[1].abs()) - 1.0
            });
            next.fold(f64::INFINITY, f64::min)
        };
        let grid = (0..=16).flat_map(|i| (0..=16).map(move |j| [i, j]));
        let grid = grid.map(|[i, j]| [-1.0 + 0.125 * f64::from(i), -1.0 + 0.125 * f64::from(j)]);
        let worst = grid.map(|x| outside(&x)).fold(f64::NEG_INFINITY, f64::max);
        // Between two inputs of the grid the next state moves by less than this.
        let width = 0.03 + 0.02;
        prop_assert!(found || worst <= width, "missed: {worst}");
        if let Some(IllPosedness::Stuck { witness, .. }) = system
            .well_posedness(&mut BranchAndBound::default())
            .unwrap()
            .into_iter()
            .find(|flaw| matches!(flaw, IllPosedness::Stuck { .. }))
        {
            prop_assert!(outside(&witness.states()) > 0.0, "{witness}");
        }
    }
}

#[test]
fn modes_without_a_way_on_are_gaps() {
    let flow = |heat: f64| LinearSystem::new([[0.9]], [[]; 1], [0.5 + heat]).unwrap();
    let heater = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(0.0)).within("off"))
        .with_transition(Transition::event("start", flow(1.0)).between("off", "on"))
        .with_transition(Transition::event("explode", flow(1.0)).between("on", "broken"))
        .with_free_choice(true);
    let system = |heater: Choice| {
        HybridSystem::new(1.0).with_state("T", Interval::new(0.0, 40.0)).with_choice(heater)
    };
    assert_eq!(findings(&system(heater.clone())), ["gap heater broken"]);
    let flaws = system(heater.clone()).well_posedness(&mut BranchAndBound::default()).unwrap();
    let text = flaws[0].to_string();
    assert!(text.starts_with("gap in `heater`: no transition is possible in the mode `broken`"));
    assert_eq!(findings(&system(heater.with_dead_ends(true))), [""; 0]);
}

#[test]
fn transitions_beyond_a_limit_are_never_possible() {
    let flow = |shift: f64| LinearSystem::new([[1.0]], [[]; 1], [shift]).unwrap();
    let jumps = |limit: f64| {
        HybridSystem::new(1.0)
            .with_state("h", Interval::new(0.0, 10.0))
            .with_limit(Halfspace::limit("low", [1.0], limit))
            .with_choice(
                Choice::new("jump")
                    .with_transition(Transition::new("rest", flow(0.0)))
                    .with_transition(Transition::new("up", flow(6.0)))
                    .with_transition(Transition::event("down", flow(-1.0)))
                    .with_free_choice(true),
            )
    };
    assert_eq!(findings(&jumps(7.0)), [""; 0]);
    assert_eq!(findings(&jumps(5.0)), ["never taken up"]);
    assert_eq!(findings(&jumps(7.0).with_most_events(0)), ["never taken down"]);
}

#[test]
fn steps_and_choices_are_looked_at() {
    // The door between the modes opens a gap in step 2 only.
    let below = Halfspace::new("below", [1.0], vec![2.0, 2.0, 1.5, 2.0]);
    let above = Halfspace::new("above", [-1.0], -2.0);
    let flaws = tank(below, above).well_posedness(&mut BranchAndBound::default()).unwrap();
    let [IllPosedness::Gap { witness, .. }] = &flaws[..] else { panic!("{flaws:?}") };
    assert_eq!(witness.step, 2);

    // A second choice whose transition is possible only with the first one's help.
    let flow = |shift: f64| LinearSystem::new([[1.0]], [[]; 1], [shift]).unwrap();
    let system = |lift: f64| {
        HybridSystem::new(1.0)
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
