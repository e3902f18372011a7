//! Loops whose plans choose transitions and modes: the plant is told, and what has elapsed is
//! carried.

use std::time::Duration;

use carom::ErrorKind;
use carom::hybrid::{DeadEnd, Memory, MoveSource};
use carom::prelude::*;

/// A tank that a valve empties, with the modes of the valve in an order.
fn tank(names: [&str; 2]) -> (HybridSystem, State, Input) {
    let mut tank = HybridSystem::new(1.0);
    let h = tank.state("h", 0.0, 10.0).unwrap();
    let q = tank.input("q", 0.0, 1.0).unwrap();
    tank.rates([h.is(q)]).unwrap();
    for name in names {
        let mode = tank.mode_of("valve", name).unwrap();
        if name == "open" {
            mode.rates([h.is(q - 1.0)]).unwrap().guard(h.ge(1.0)).unwrap();
        }
    }
    (tank, h, q)
}

fn towards_2(names: [&str; 2]) -> (HybridSystem, HybridProgram) {
    let (tank, h, q) = tank(names);
    let mut program = tank.program(6).unwrap();
    program.minimize(program.sum((h - 2.0).square() + 0.001 * q).unwrap()).unwrap();
    (tank, program)
}

const ORDERS: [[&str; 2]; 2] = [["shut", "open"], ["open", "shut"]];

#[test]
fn a_plant_that_takes_the_whole_move_does_what_the_plan_chose() {
    for names in ORDERS {
        let (tank, program) = towards_2(names);
        let mut solver = BranchAndBound::default();
        let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
        let plant = |state: &[f64], next: &ControlMove| tank.simulate(state, next)?.end();
        let run = controller.run(&[8.0], 10, plant).unwrap();
        let expected = [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 2.0, 2.0, 2.0, 2.0];
        assert!(run.states.iter().zip(expected).all(|(x, at)| (x[0] - at).abs() < 1e-6), "{run}");
        for (k, next) in run.moves.iter().enumerate() {
            let valve = if k < 6 { "open" } else { "shut" };
            assert_eq!(next.transition("valve"), Some(valve));
            assert_eq!((next.transition("pump"), next.mode("valve")), (None, None));
            assert_eq!((next.transitions[0].1.len(), &next.events[..]), (6, &[0; 6][..]));
        }
    }
}

#[test]
fn a_plant_that_is_told_the_input_alone_is_an_error_that_keeps_the_record() {
    for names in ORDERS {
        let (tank, program) = towards_2(names);
        let mut solver = BranchAndBound::default();
        let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
        // The first two steps with the move, then without.
        let plant = |state: &[f64], next: &ControlMove| match next.step {
            0 | 1 => tank.simulate(state, next)?.end(),
            _ => tank.simulate(state, &[&next.input])?.end(),
        };
        let broken = controller.run(&[8.0], 10, plant).unwrap_err();
        assert_eq!((broken.record.states.len(), broken.record.moves.len()), (3, 3));
        let [first, second] = names;
        let error = format!(
            "step 0 is ambiguous: `{first}` and `{second}` of `valve` are possible and lead to different \
             states or modes, and nothing says which one is taken; simulate the whole move of a controller \
             (`simulate(state, &next)`), name transitions by `SimulationOptions::with_transitions` and modes \
             by `with_mode`, or allow the first one by `with_first_possible`"
        );
        assert_eq!(broken.to_string(), format!("the loop ended in step 2: {error}"));
        assert_eq!(format!("{broken:?}"), format!("BrokenLoop: {broken}"));
        let kind = broken.error.kind();
        assert!(matches!(kind, ErrorKind::DeadEnd(DeadEnd::Ambiguous { step: 0, .. })));
        assert_eq!(Error::from(broken).to_string(), error);
        // The ways out.
        let input = [[0.0]];
        let first_possible = SimulationOptions::default().with_first_possible(true);
        let end = tank.simulate_with(&[8.0], &input, &first_possible).unwrap().end().unwrap();
        assert_eq!(end, [if first == "open" { 7.0 } else { 8.0 }]);
        let named = SimulationOptions::default().with_transitions(vec![vec!["open".into()]]);
        assert_eq!(tank.simulate_with(&[8.0], &input, &named).unwrap().end().unwrap(), [7.0]);
        // Where one is possible, nothing has to be said.
        assert_eq!(tank.simulate(&[0.5], &input).unwrap().end().unwrap(), [0.5]);
    }
}

/// What leads to the same, and a tie on a boundary that both guards share, is no ambiguity.
#[test]
fn the_same_end_and_a_shared_boundary_are_not_ambiguous() {
    let system = |second: f64, limit: f64| {
        let mut system = HybridSystem::new(1.0);
        let x = system.state("x", -9.0, 9.0).unwrap();
        system.mode("low").unwrap().next([x.is(0.5 * x)]).unwrap().guard(x.le(1.0)).unwrap();
        let high = system.mode("high").unwrap().next([x.is(second * x)]).unwrap();
        high.guard(x.ge(limit)).unwrap();
        system
    };
    let ambiguous = |second: f64, limit: f64, x: f64| {
        let run = system(second, limit).simulate(&[x], &[[]; 1]);
        run.map(|run| (run.ambiguous_steps().len(), run.last()[0])).map_err(|_| "ambiguous")
    };
    assert_eq!(ambiguous(0.25, 1.0, 1.0), Ok((1, 0.5)));
    assert_eq!(ambiguous(0.5, 0.0, 0.75), Ok((1, 0.375)));
    assert_eq!(ambiguous(0.25, 0.0, 0.75), Err("ambiguous"));
    assert_eq!(ambiguous(0.25, 0.0, 0.0), Ok((1, 0.0)));
    assert_eq!(ambiguous(0.25, 0.0, 2.0), Ok((0, 0.5)));
}

#[test]
fn the_rest_of_a_plan_is_replayed_with_its_own_modes() {
    for names in ORDERS {
        let (tank, h, _) = tank(names);
        let mut program = tank.program(6).unwrap();
        program.minimize(program.sum((h - 2.0).square()).unwrap()).unwrap();
        let mut solver = BranchAndBound::default();
        let controller = RecedingHorizon::new(program, &mut solver).unwrap();
        let second = Duration::from_secs(1000);
        let mut controller = controller.with_budget(Duration::ZERO).with_first_budget(second);
        controller.step(&[8.0]).unwrap();
        let next = controller.step(&[7.0]).unwrap();
        assert_eq!((next.source, next.is_admissible), (MoveSource::LastPlan, Some(true)));
        let states: Vec<f64> = next.states.iter().map(|state| state[0]).collect();
        // The last step costs nothing, so the plan may take either mode in it.
        let expected = [7.0, 6.0, 5.0, 4.0, 3.0];
        assert!(states.iter().zip(expected).all(|(x, at)| (x - at).abs() < 1e-6), "{states:?}");
        assert_eq!((states.len(), next.transition("valve")), (6, Some("open")));
        // From a state from which its valve cannot be open to the end, it is open as long as it
        // can.
        let next = controller.step(&[3.5]).unwrap();
        assert_eq!((next.source, next.is_admissible), (MoveSource::LastPlan, Some(true)));
        let [(_, valve)] = &next.transitions[..] else { panic!() };
        assert_eq!(valve.join(" "), "open open open shut");
    }
}

/// A heater with least times in its modes.
fn room() -> (HybridSystem, State, [Variable; 2]) {
    let mut room = HybridSystem::new(600.0);
    let t = room.state("t", 0.0, 35.0).unwrap();
    let [off, on] = room.modes("heater", ["off", "on"]).unwrap();
    let cooling = (5.0 - t) * (1.0 / 7200.0);
    room.stay(off).unwrap().rates([t.is(cooling.clone())]).unwrap();
    room.stay(on).unwrap().rates([t.is(cooling + 0.004)]).unwrap();
    room.switch(off, on).unwrap();
    room.switch(on, off).unwrap();
    room.dwell(on, 3, 5).unwrap();
    room.dwell(off, 2, None).unwrap();
    (room, t, [off, on])
}

fn comfortable(steps: usize) -> (HybridSystem, HybridProgram) {
    let (room, t, _) = room();
    let mut program = room.program(steps).unwrap();
    program.minimize(program.sum((t - 20.0).square()).unwrap()).unwrap();
    (room, program)
}

/// The lengths of the stretches of a mode that begin and end within a list.
fn stretches(modes: &[&str], mode: &str) -> Vec<usize> {
    let mut all: Vec<(&str, usize)> = Vec::new();
    for own in modes {
        match all.last_mut() {
            Some((last, count)) if last == own => *count += 1,
            _ => all.push((own, 1)),
        }
    }
    let inner = all.len().saturating_sub(1);
    all[..inner].iter().skip(1).filter(|(own, _)| *own == mode).map(|(_, n)| *n).collect()
}

#[test]
fn dwell_times_hold_over_the_steps_of_a_loop() {
    let check = |run: &carom::hybrid::ClosedLoop| {
        let modes: Vec<&str> = run.moves.iter().filter_map(|next| next.mode("heater")).collect();
        assert_eq!(modes.len(), 24);
        let (on, off) = (stretches(&modes, "on"), stretches(&modes, "off"));
        assert!(on.len() > 1 && on.iter().all(|steps| (3..=5).contains(steps)), "{modes:?}");
        assert!(off.len() > 1 && off.iter().all(|steps| *steps >= 2), "{modes:?}");
        assert_eq!(run.count(MoveSource::Optimal), 24);
    };
    let (room, program) = comfortable(7);
    let plant = |state: &[f64], next: &ControlMove| room.simulate(state, next)?.end();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    controller.set_memory(Memory::default().with_mode("heater", "off", 7));
    let run = controller.run(&[17.0], 24, plant).unwrap();
    check(&run);
    assert_eq!(run.moves[0].memory, Memory::default().with_mode("heater", "off", 7));
    assert_eq!(run.moves[2].memory.samples("heater"), Some(2));
    // Programs that are built say nothing, or the mode, which is the one that is carried.
    for says_mode in [false, true] {
        let now = std::cell::Cell::new(false);
        let build = |_: usize| {
            let (room, t, [_, on]) = self::room();
            let mut program = room.program(7)?;
            if says_mode {
                program.start([on.equals(f64::from(u8::from(now.get())))])?;
            }
            program.minimize(program.sum((t - 20.0).square())?)?;
            Ok(program)
        };
        let mut solver = BranchAndBound::default();
        let mut controller = RecedingHorizon::moving(build, &mut solver);
        let plant = |state: &[f64], next: &ControlMove| {
            now.set(next.mode("heater") == Some("on"));
            room.simulate(state, next)?.end()
        };
        check(&controller.run(&[17.0], 24, plant).unwrap());
    }
}

/// A plant that switched by itself: its mode counts, told by hand or by the program.
#[test]
fn a_measured_mode_takes_the_place_of_the_carried_one() {
    let (_, program) = comfortable(5);
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    controller.set_memory(Memory::default().with_mode("heater", "off", 9));
    assert_eq!(controller.step(&[15.0]).unwrap().mode("heater"), Some("on"));
    assert_eq!(controller.memory(), &Memory::default().with_mode("heater", "on", 1).with_events(1));
    controller.set_memory(Memory::default().with_mode("heater", "off", 1));
    // It must be off for a second sample, however cold it is.
    assert_eq!(controller.step(&[15.0]).unwrap().mode("heater"), Some("off"));
    assert_eq!(controller.step(&[15.0]).unwrap().mode("heater"), Some("on"));
    controller.set_memory(Memory::default().with_mode("heater", "warm", 1));
    let error = controller.step(&[15.0]).unwrap_err();
    assert_eq!(error.to_string(), "the model has no mode of the choice named `warm`");

    let build = |step: usize| {
        let (room, t, [off, _]) = room();
        let mut program = room.program(5)?;
        match step {
            0 => program.start_from(&Memory::default().with_mode("heater", "on", 1))?,
            // The plant has switched to off, nobody knows when.
            1 => program.start([off.equals(1.0)])?,
            _ => {}
        }
        program.minimize(program.sum((t - 20.0).square())?)?;
        Ok(program)
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let first = controller.step(&[30.0]).unwrap();
    assert_eq!((first.mode("heater"), first.memory.samples("heater")), (Some("on"), Some(1)));
    let second = controller.step(&[15.0]).unwrap();
    assert_eq!((second.mode("heater"), second.memory.mode("heater")), (Some("on"), Some("off")));
    assert_eq!(second.memory.samples("heater"), None);
    let third = controller.step(&[30.0]).unwrap();
    assert_eq!((third.mode("heater"), third.memory.samples("heater")), (Some("on"), Some(1)));
}

#[test]
fn a_start_in_every_step_is_refused() {
    let (room, _, [off, _]) = room();
    let mut by_row = room.program(4).unwrap();
    by_row.start([off.equals(1.0)]).unwrap();
    let mut by_memory = room.program(4).unwrap();
    by_memory.start_from(&Memory::default().with_mode("heater", "on", 2)).unwrap();
    let named = ["a start in a mode of `heater`", "a memory of the start"];
    for (program, named) in [by_row, by_memory].into_iter().zip(named) {
        let error = RecedingHorizon::new(program, &mut BranchAndBound::default()).unwrap_err();
        let expected = format!(
            "a receding horizon with one program for all steps does not take {named}, because every step \
             would begin with it; leave it out, because the controller carries modes along, and tell the first \
             one by `RecedingHorizon::set_memory`"
        );
        assert_eq!(error.to_string(), expected);
    }
    let mut program = room.program(4).unwrap();
    let unknown = Memory::default().with_mode("cooler", "on", 2);
    let error = program.start_from(&unknown).unwrap_err();
    assert_eq!(error.to_string(), "the model has no choice of the system named `cooler`");
    program.start_from(&Memory::default().with_mode("heater", "on", 2)).unwrap();
    let error = program.start_from(&Memory::default().with_mode("heater", "on", 2)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }), "{error}");
}

/// Every program from every memory takes the best of the sequences that an enumeration allows.
#[test]
fn a_start_from_a_memory_allows_what_an_enumeration_does() {
    let steps = 6;
    let memories =
        [("on", Some(1)), ("on", Some(2)), ("on", Some(4)), ("on", Some(5)), ("on", None)];
    let more = [("off", Some(1)), ("off", Some(2)), ("off", None), ("on", Some(7))];
    for (mode, samples) in memories.into_iter().chain(more) {
        // Sequences of modes at the samples 1, 2, ..., as bits.
        let allowed = |bits: u32| {
            let (mut now, mut count, mut is_known) =
                (mode, samples.unwrap_or(1), samples.is_some());
            (0..steps).all(|t| {
                let next = if bits >> t & 1 == 1 { "on" } else { "off" };
                let (least, most) = if now == "on" { (3, 5) } else { (2, usize::MAX) };
                let is_allowed = match next == now {
                    true => count < most,
                    false => !is_known || count >= least,
                };
                (count, is_known) = if next == now { (count + 1, is_known) } else { (1, true) };
                now = next;
                is_allowed
            })
        };
        for target in [10.0, 20.0, 40.0] {
            let cost = |bits: u32| {
                let mut t = 18.0;
                (0..steps).fold(0.0, |sum, k| {
                    let heat = if bits >> k & 1 == 1 { 0.004 } else { 0.0 };
                    // The exact solution of dt/ds = (5 - t) / 7200 + heat over 600 s.
                    let rest = 5.0 + 7200.0 * heat;
                    t = rest + (t - rest) * (-600.0_f64 / 7200.0).exp();
                    sum + (t - target) * (t - target)
                })
            };
            let best = (0..1u32 << steps).filter(|bits| allowed(*bits)).map(cost);
            let best = best.fold(f64::INFINITY, f64::min);
            let (room, t, _) = room();
            let mut program = room.program(steps).unwrap();
            program.start([t.equals(18.0)]).unwrap();
            program.start_from(&Memory::default().with_mode("heater", mode, samples)).unwrap();
            let cost = (1..=steps).map(|k| {
                let x = program.at(t, k).unwrap();
                (x - target).square()
            });
            let cost = cost.sum::<Quadratic>();
            program.minimize(cost).unwrap();
            let plan = program.solve(&mut BranchAndBound::default()).unwrap();
            let found = plan.solution.objective().unwrap();
            assert!(
                (found - best).abs() < 1e-4 * best.max(1.0),
                "{mode} {samples:?}: {found}, {best}"
            );
        }
    }
}

/// Events so far count against the limit.
#[test]
fn events_are_counted_over_the_loop() {
    let (mut room, t, _) = room();
    room.most_events(2);
    let mut program = room.program(5).unwrap();
    program.minimize(program.sum((t - 20.0).square()).unwrap()).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    controller.set_memory(Memory::default().with_mode("heater", "off", 9));
    let plant = |state: &[f64], next: &ControlMove| room.simulate(state, next)?.end();
    let run = controller.run(&[17.0], 20, plant).unwrap();
    let modes: Vec<&str> = run.moves.iter().filter_map(|next| next.mode("heater")).collect();
    let switches = modes.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert_eq!((modes[0], switches, run.moves[19].memory.events), ("on", 1, 2), "{modes:?}");
}

/// A jump out of a hard limit: the loop plans from the nearest state that has a plan, and goes on.
#[test]
fn a_loop_recovers_from_a_jump_out_of_hard_limits() {
    for names in ORDERS {
        let (tank, program) = towards_2(names);
        let mut solver = BranchAndBound::default();
        let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
        let plant = |state: &[f64], next: &ControlMove| {
            let after = tank.simulate(state, next)?.end()?;
            Ok(vec![after[0] + if next.step == 2 { 9.0 } else { 0.0 }])
        };
        let run = controller.run(&[5.0], 16, plant).unwrap();
        assert!(run.states[3][0] > 10.0 - 1e-6, "{:?}", run.states);
        assert!((run.states[16][0] - 2.0).abs() < 1e-5, "{:?}", run.states);
        let lost = &run.moves[3];
        assert_eq!((lost.source, lost.is_admissible), (MoveSource::Recovery, Some(false)));
        assert_eq!(lost.transition("valve"), Some("open"));
        assert!(lost.reason.as_ref().is_some_and(|why| why.contains("measured_h")));
    }
    // Far outside, the valve is open until it is inside again.
    let (tank, program) = towards_2(ORDERS[0]);
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let plant = |state: &[f64], next: &ControlMove| tank.simulate(state, next)?.end();
    let run = controller.run(&[13.5], 14, plant).unwrap();
    assert_eq!(run.count(MoveSource::Recovery), 4, "{run}");
    assert!(run.moves[..4].iter().all(|next| next.is_admissible == Some(false)));
    assert!((run.states[14][0] - 2.0).abs() < 0.5 + 1e-6, "{:?}", run.states);
    // Within the domain and behind a limit that no plan satisfies.
    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", -5.0, 5.0).unwrap();
    let v = cart.state("v", -2.0, 2.0).unwrap();
    let a = cart.input("a", -1.0, 1.0).unwrap();
    cart.limit("brake", (x + v).le(4.0)).unwrap();
    cart.mode("drive").unwrap().rates([x.is(v), v.is(a)]).unwrap();
    let mut program = cart.program(6).unwrap();
    program.minimize(program.sum(x.square() + v.square() + 0.1 * a.square()).unwrap()).unwrap();
    let mut other = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut other).unwrap();
    let plant = |state: &[f64], next: &ControlMove| {
        let after = cart.simulate(state, next)?.end()?;
        let push = if next.step == 1 { 2.0 } else { 0.0 };
        Ok(vec![after[0] + push, after[1]])
    };
    let run = controller.run(&[2.0, 1.0], 20, plant).unwrap();
    assert!(run.states[2][0] + run.states[2][1] > 4.0, "{:?}", run.states);
    assert_eq!(run.moves[2].source, MoveSource::Recovery);
    assert!(run.states[20].iter().all(|x| x.abs() < 0.3), "{:?}", run.states);
}

/// The valves of two tanks in one program, and what a plant of one of them is told.
#[test]
fn moves_of_several_systems_name_their_choices() {
    let [(first, h, _), (second, g, _)] = [tank(ORDERS[0]), tank(ORDERS[1])];
    let mut program = first.program(3).unwrap();
    program.join("second", &second).unwrap();
    let cost = program.sum((h - 2.0).square() + (g - 7.0).square()).unwrap();
    program.minimize(cost).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let next = controller.step(&[5.0, 7.0]).unwrap();
    assert_eq!(next.transition("valve"), Some("open"));
    assert_eq!(next.transition("second valve"), Some("shut"));
}
