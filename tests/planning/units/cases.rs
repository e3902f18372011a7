//! Programs, sets, loops, tubes, terminal sets and simulations in other units.

use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::hybrid::{Feedback, Lqr, Mission, RecedingHorizon, TerminalOptions, TerminalSet};
use carom::prelude::*;

use super::{Lift, Units, lift};

const UNITS: [Units; 5] = [
    Units { length: 1e-7, time: 1e-3, origin: 0.0 },
    Units { length: 0.01, time: 1.0 / 3600.0, origin: 0.0 },
    Units { length: 1e6, time: 1e3, origin: 0.0 },
    Units { length: 1.0, time: 1.0, origin: 5e6 },
    Units { length: 1e-5, time: 10.0, origin: -1e6 },
];

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-5 * (1.0 + b.abs())
}

/// The effort and the places of a lift's cheapest way over a way-point.
fn way(units: Units) -> (f64, Vec<f64>, Vec<f64>) {
    let Lift { system, x, v, u, .. } = lift(units);
    let mut program = system.program(16).unwrap();
    program.start([x.equals(units.place(0.0)), v.equals(0.0)]).unwrap();
    program.require("way-point", [x.ge(units.place(0.1))], When::OnceIn(7..=8)).unwrap();
    let there = Mission::holds("there", [x.within(units.place(0.3), units.place(0.4))]);
    program.require_mission("mission", &there.always(15..)).unwrap();
    let fast = program.soften("fast", v.le(units.speed(0.3)), 1.0 / units.speed(1.0), 0.0).unwrap();
    let effort = program.sum(u.square()).unwrap();
    program.minimize(effort + fast.cost).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    let places = plan.values(x).unwrap().iter().map(|x| x / units.length - units.origin).collect();
    let speeds = plan.run.state("v").unwrap().iter().map(|v| v / units.speed(1.0)).collect();
    (plan.solution.objective().unwrap(), places, speeds)
}

#[test]
fn programs_cost_the_same() {
    let (cost, ..) = way(Units::ORDINARY);
    for units in UNITS {
        let (own, places, speeds) = way(units);
        assert!((own - cost).abs() < 1e-4 * cost, "{units:?}: {own} instead of {cost}");
        assert!(places[7..=8].iter().any(|x| *x > 0.1 - 1e-4), "{units:?}: {places:?}");
        assert!(places[15..].iter().all(|x| (x - 0.35).abs() < 0.05 + 1e-4), "{units:?}");
        assert!(speeds.iter().all(|v| v.abs() < 2.5 + 1e-4), "{units:?}");
    }
}

#[test]
fn sets_say_the_same_in_the_units_of_the_statement() {
    let sets = |units: Units| {
        let lift = lift(units);
        let (start, goal) = (lift.at_rest(0.0), lift.at_rest(3.0));
        let mut sets = ReachSets::new(&lift.system, start, goal, SetOptions::default()).unwrap();
        let text = sets.explain(20).unwrap().unwrap().to_string();
        let set = sets.forward(10).unwrap().remove(0).unwrap();
        let far = set.support(&[1.0, 0.0]).unwrap() / units.length - units.origin;
        let fast = set.bounding_box()[1].upper / units.speed(1.0);
        let middle = [units.place(0.2 * far), units.speed(0.3 * fast)];
        let outside = [units.place(1.01 * far), units.speed(0.3 * fast)];
        assert!(set.contains(&middle).unwrap() && !set.contains(&outside).unwrap(), "{units:?}");
        let tube = sets.tube(40).unwrap();
        let highest = tube.bounds(20).unwrap()[0].upper / units.length - units.origin;
        let outline = set.outline(0, 1).unwrap();
        let corner = outline.iter().map(|p| p[0] / units.length - units.origin);
        let corner = corner.fold(f64::NEG_INFINITY, f64::max);
        assert!(close(corner, far), "{units:?}: {corner} and {far}");
        (text.contains("no plan has 20 steps"), far, fast, highest)
    };
    let ordinary = sets(Units::ORDINARY);
    for units in UNITS {
        let own = sets(units);
        assert!(own.0 && ordinary.0);
        for (a, b) in [(own.1, ordinary.1), (own.2, ordinary.2), (own.3, ordinary.3)] {
            // Sets hold a margin, which is up to 1e-4 of a domain for the smallest of ordinary
            // ones.
            assert!((a - b).abs() < 2e-3, "{units:?}: {own:?} instead of {ordinary:?}");
        }
    }
}

#[test]
fn a_loop_moves_the_same() {
    let run = |units: Units| {
        let mut cart = HybridSystem::new(0.5 * units.time);
        let x = cart.state("x", units.place(-9.0), units.place(9.0)).unwrap();
        let v = cart.state("v", units.speed(-2.0), units.speed(2.0)).unwrap();
        let a = cart.input("a", units.push(-1.0), units.push(1.0)).unwrap();
        cart.mode("roll").unwrap().rates([x.is(v), v.is(a)]).unwrap();
        let mut program = cart.program(8).unwrap();
        program.goal([x.equals(units.place(0.0)), v.equals(0.0)]).unwrap();
        let (away, push) = (x - units.place(0.0), 1.0 / units.push(1.0) * a);
        let away = 1.0 / units.length * away;
        let mut cost = Quadratic::zero();
        for t in 0..8 {
            let (away, push) = (program.at(&away, t).unwrap(), program.at(&push, t).unwrap());
            cost += &away * &away + &push * &push;
        }
        program.minimize(cost).unwrap();
        let mut solver = BranchAndBound::default();
        let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
        let mut state = vec![units.place(3.0), 0.0];
        let mut all = Vec::new();
        for _ in 0..6 {
            let next = controller.step(&state).unwrap();
            let run = cart.simulate(&state, &[&next.input]).unwrap();
            assert!(run.is_complete(), "{units:?}: {:?}", run.dead_end);
            state = run.last().to_vec();
            assert!(close(next.states[0][0] / units.length - units.origin, {
                next.state[0] / units.length - units.origin
            }));
            all.push(state[0] / units.length - units.origin);
        }
        all
    };
    let ordinary = run(Units::ORDINARY);
    for units in UNITS {
        let own = run(units);
        let apart = own.iter().zip(&ordinary).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-3, "{units:?}: {own:?} instead of {ordinary:?}");
    }
}

#[test]
fn tubes_and_terminal_sets_are_the_same() {
    let found = |units: Units| {
        let mut cart = HybridSystem::new(0.25 * units.time);
        let x = cart.state("x", units.place(0.0), units.place(9.0)).unwrap();
        let v = cart.state("v", units.speed(-2.0), units.speed(2.0)).unwrap();
        let a = cart.input("a", units.push(-1.0), units.push(1.0)).unwrap();
        cart.disturbance(v, units.speed(-0.02), units.speed(0.02)).unwrap();
        cart.mode("roll").unwrap().rates([x.is(v), v.is(a)]).unwrap();
        let feedback = Feedback::regulator(&cart).unwrap();
        let start = [x.equals(units.place(1.0)), v.equals(0.0)];
        let goal = [
            x.within(units.place(3.5), units.place(4.5)),
            v.within(units.speed(-0.4), units.speed(0.4)),
        ];
        let (options, mut solver) = (Default::default(), BranchAndBound::default());
        let robust = cart.shortest_robust(start, goal, &feedback, &options, &mut solver).unwrap();
        let plan = robust.plan.unwrap();
        let run = plan.simulate(&mut |range| range.upper).unwrap();
        assert!(run.kept, "{units:?}");
        let gain = feedback.gain()[(0, 0)] * units.length / units.push(1.0);
        let weights = [1.0 / units.length.powi(2), 1.0 / units.speed(1.0).powi(2)];
        let flow = carom::hybrid::LinearSystem::double_integrator(0.25 * units.time).unwrap();
        let q = [[weights[0], 0.0], [0.0, weights[1]]];
        let lqr = Lqr::new(&flow, q, [[1.0 / units.push(1.0).powi(2)]]).unwrap();
        let target = [units.place(4.0), 0.0];
        let options = TerminalOptions::default();
        let set = TerminalSet::new(&cart, &["roll"], &lqr, &target, &options, &mut solver).unwrap();
        let inside =
            |x: f64, v: f64| set.region.contains(&[units.place(x), units.speed(v)], 0.0).unwrap();
        let grid =
            (0..20).flat_map(|i| (0..11).map(move |j| (0.5 * i as f64, j as f64 * 0.4 - 2.0)));
        let members: Vec<bool> = grid.map(|(x, v)| inside(x, v)).collect();
        let push = set.feedback(&[units.place(4.3), 0.0]).unwrap()[0] / units.push(1.0);
        (robust.steps, gain, members, push)
    };
    let ordinary = found(Units::ORDINARY);
    for units in UNITS {
        let own = found(units);
        assert_eq!(own.0, ordinary.0, "{units:?}");
        assert!(close(own.1, ordinary.1) && close(own.3, ordinary.3), "{units:?}: {own:?}");
        let differ = own.2.iter().zip(&ordinary.2).filter(|(a, b)| a != b).count();
        assert!(differ <= 2, "{units:?}: {differ} of {} points", own.2.len());
    }
}

#[test]
fn simulations_take_the_same_transitions() {
    let run = |units: Units| {
        let lift = lift(units);
        let inputs: Vec<[f64; 1]> = (0..30).map(|t| [if t < 15 { 1.0 } else { -0.5 }]).collect();
        let first = SimulationOptions::default().with_first_possible(true);
        let start = [units.place(0.0), 0.0];
        let run = lift.system.simulate_with(&start, &inputs, &first).unwrap();
        assert!(run.is_complete(), "{units:?}: {:?}", run.dead_end);
        let taken: Vec<String> = run.steps.iter().map(|step| step.taken[0].clone()).collect();
        (taken, run.last()[0] / units.length - units.origin)
    };
    let ordinary = run(Units::ORDINARY);
    for units in UNITS {
        let own = run(units);
        assert_eq!(own.0, ordinary.0, "{units:?}");
        assert!(close(own.1, ordinary.1), "{units:?}: {} instead of {}", own.1, ordinary.1);
    }
}
