//! Inputs that take some values only: in programs, simulations, certificates, loops, files and
//! feedbacks.

use carom::ErrorKind;
use carom::hybrid::{Feedback, Lqr, MoveSource, TerminalOptions, TerminalSet};
use carom::prelude::*;

/// x⁺ = 0.9 x + u + 0.5 w, with an input from a list and one of whole numbers.
fn system(list: &[f64], whole: [f64; 2]) -> (HybridSystem, State, [Input; 2]) {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -9.0, 9.0).unwrap();
    let u = system.input_from("u", list.iter().copied()).unwrap();
    let w = system.integer_input("w", whole[0], whole[1]).unwrap();
    system.mode("go").unwrap().next([x.is(0.9 * x + u + 0.5 * w)]).unwrap();
    (system, x, [u, w])
}

/// Even and uneven lists, of whole numbers and of others, against all sequences.
#[test]
fn the_best_sequence_of_values_is_found() {
    let lists: [&[f64]; 8] = [
        &[-1.0, 0.0, 1.0],
        &[0.0, 1.0],
        &[0.3],
        &[-0.7, 0.45],
        &[-0.3, 0.1, 0.5, 0.9],
        &[-1.1, -0.2, 0.05, 0.7],
        &[-2.0, 1.0, 2.0],
        &[0.1, 0.2, 0.3, 0.4, 0.5],
    ];
    for list in lists {
        for (whole, aim) in [([-1.0, 1.0], 1.3), ([0.0, 2.5], 3.7), ([-1.4, -0.6], -2.2)] {
            let (system, x, [u, w]) = system(list, whole);
            let steps = 3;
            let mut program = system.program(steps).unwrap();
            program.start([x.equals(0.5)]).unwrap();
            let miss = program.end((x - aim).square()).unwrap();
            let cost = program.sum((x - aim).square() + 0.1 * u.square() + 0.2 * w).unwrap();
            program.minimize(cost + miss).unwrap();
            let plan = program.solve(&mut BranchAndBound::default()).unwrap();
            let numbers: Vec<f64> = (-9..=9).map(f64::from).collect();
            let numbers = numbers.iter().filter(|k| whole[0] <= **k && **k <= whole[1]);
            let pairs: Vec<[f64; 2]> =
                numbers.flat_map(|w| list.iter().map(move |u| [*u, *w])).collect();
            let mut best = f64::INFINITY;
            for code in 0..pairs.len().pow(steps as u32) {
                let (mut code, mut x, mut cost) = (code, 0.5, 0.0);
                for _ in 0..steps {
                    let [u, w] = pairs[code % pairs.len()];
                    code /= pairs.len();
                    cost += (x - aim) * (x - aim) + 0.1 * u * u + 0.2 * w;
                    x = 0.9 * x + u + 0.5 * w;
                }
                best = f64::min(best, cost + (x - aim) * (x - aim));
            }
            let found = plan.solution.objective().unwrap();
            assert!((found - best).abs() < 1e-5 * best.abs().max(1.0), "{list:?}: {found}, {best}");
            // The run has the values of the lists, and a simulation takes them.
            assert!(plan.run.input("u").unwrap().iter().all(|value| list.contains(value)));
            assert!(plan.run.input("w").unwrap().iter().all(|value| value.fract() == 0.0));
            let inputs = plan.run.input("u").unwrap().iter().zip(plan.run.input("w").unwrap());
            let inputs: Vec<[f64; 2]> = inputs.map(|(u, w)| [*u, *w]).collect();
            let run = system.simulate(&[0.5], &inputs).unwrap();
            assert!(run.is_complete(), "{run}");
            // The values of all variables in a run are a point of the rows.
            let mut values = vec![0.0; program.model().variable_count()];
            for (variable, value) in program.variables().values(&run.to_run()).unwrap() {
                values[variable.index()] = value;
            }
            let point = carom::solution::Point::new(program.model(), values).unwrap();
            let verification = Verification::of(program.model(), &point, 1e-6);
            assert!(verification.holds(), "{list:?}: {:?}", verification.violations());
        }
    }
}

#[test]
fn other_values_are_refused() {
    let (system, ..) = system(&[-0.7, 0.45, 1.0], [0.0, 3.0]);
    let refused = |u: f64, w: f64| {
        let run = system.simulate(&[0.0], &[[u, w]]).unwrap();
        run.dead_end.map(|end| end.to_string())
    };
    assert_eq!(refused(0.45, 3.0), None);
    let no_way = "no transition of `mode` is possible in step 0: `go` violates the range of";
    assert_eq!(refused(0.55, 3.0), Some(format!("{no_way} `u` by 1.000e-1")));
    assert_eq!(refused(0.45, 2.75), Some(format!("{no_way} `w` by 2.500e-1")));
    assert_eq!(refused(0.45, 4.0), Some(format!("{no_way} `w` by 1.000e0")));
    let mut run = system.simulate(&[0.0], &[[0.45, 1.0]]).unwrap().to_run();
    assert!(system.certify(&run).is_ok());
    run.inputs[0].1[0] = 0.5;
    run.states[0].1[1] += 0.05;
    let error = system.certify(&run).unwrap_err().to_string();
    assert!(error.contains("violates the range of `u` by 5.000e-2"), "{error}");
}

#[test]
fn statements_that_say_nothing_are_refused() {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -9.0, 9.0).unwrap();
    let text = |result: Result<Input, Error>| result.unwrap_err().to_string();
    assert_eq!(
        text(system.input_from("u", [])),
        "the number of values of `u` is 0; it must be from 1 to 100000"
    );
    assert_eq!(
        text(system.input_from("u", [0.0, f64::NAN])),
        "a value of the input of `u` is NaN; give a finite number"
    );
    assert_eq!(
        text(system.integer_input("u", 0.2, 0.8)),
        "the upper end of `u` is 0.8; it must be at least 1, the first value of the input in its range"
    );
    // Nothing is left of what was refused; values may be given twice and in any order.
    let u = system.input_from("u", [1.0, 0.5, 1.0]).unwrap();
    system.mode("go").unwrap().next([x.is(x + u)]).unwrap();
    assert!(system.to_string().contains("input u in {0.5, 1}\n"), "{system}");
    assert_eq!(system.simulate(&[0.0], &[[0.5]]).unwrap().last(), [0.5]);
    let (other, ..) = self::system(&[0.0, 1.0], [0.0, 3.0]);
    assert!(other.to_string().contains("input w in [0, 3], whole numbers\n"), "{other}");
}

#[cfg(feature = "serde")]
#[test]
fn finite_inputs_come_back_from_files() {
    let (system, ..) = system(&[-0.7, 0.45, 1.0], [0.0, 3.0]);
    let text = serde_json::to_string(&system).unwrap();
    let back: HybridSystem = serde_json::from_str(&text).unwrap();
    assert_eq!((&back, back.to_string()), (&system, system.to_string()));
    let (other, ..) = self::system(&[-0.7, 0.5, 1.0], [0.0, 3.0]);
    assert!(other != system);
    let error = serde_json::from_str::<HybridSystem>(&text.replace("0.45,1.0", "1.0,0.45"));
    assert!(error.unwrap_err().to_string().contains("a value of `u` is 0.45; it must be above 1"));
    let error =
        serde_json::from_str::<HybridSystem>(&text.replace("\"w\":\"Whole\"", "\"v\":\"Whole\""));
    assert!(error.unwrap_err().to_string().contains("`v`"));
}

/// A valve that is open or shut, in a loop.
#[test]
fn loops_hand_out_allowed_values() {
    let mut tank = HybridSystem::new(1.0);
    let h = tank.state("h", 0.0, 10.0).unwrap();
    let open = tank.input_from("open", [0.0, 1.0]).unwrap();
    tank.disturbance(h, -0.1, 0.1).unwrap();
    tank.mode("flow").unwrap().next([h.is(h + 0.3 - 0.8 * open)]).unwrap();
    let mut program = tank.program(5).unwrap();
    program.minimize(program.sum((h - 3.0).square()).unwrap()).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let mut push = Disturbance::new([-0.1..=0.1], 5);
    let plant = |state: &[f64], next: &ControlMove| {
        assert!(next.input[0] == 0.0 || next.input[0] == 1.0, "{next:?}");
        Ok(vec![tank.simulate(state, next)?.end()?[0] + push.next_value()[0]])
    };
    let run = controller.run(&[6.0], 20, plant).unwrap();
    assert_eq!(run.count(MoveSource::Optimal), 20);
    assert!(run.states[12..].iter().all(|state| (state[0] - 3.0).abs() < 1.0), "{:?}", run.states);
}

#[test]
fn a_feedback_does_not_correct_them() {
    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", 0.0, 9.0).unwrap();
    let v = cart.state("v", -2.0, 2.0).unwrap();
    let a = cart.input("a", -1.0, 1.0).unwrap();
    let gear = cart.input_from("gear", [-0.5, 0.0, 0.5]).unwrap();
    cart.disturbance(v, -0.02, 0.02).unwrap();
    cart.mode("roll").unwrap().rates([x.is(v), v.is(a + gear)]).unwrap();
    let mut program = cart.program(8).unwrap();
    program.start([x.equals(1.0), v.equals(0.0)]).unwrap();
    program.goal([x.within(3.5, 4.5), v.within(-0.5, 0.5)]).unwrap();
    program.minimize(program.sum(a.square()).unwrap()).unwrap();
    let regulator = Feedback::regulator(&cart).unwrap();
    assert!(regulator.gain()[(0, 0)] != 0.0);
    assert_eq!((regulator.gain()[(1, 0)], regulator.gain()[(1, 1)]), (0.0, 0.0));
    let mut solver = BranchAndBound::default();
    let plan = program.robust(&regulator).unwrap().solve(&mut solver).unwrap();
    assert!(plan.simulate(&mut |range| range.lower).unwrap().kept);
    assert!(plan.simulate(&mut |range| range.upper).unwrap().kept);
    let feedback = Feedback::new(&cart, [[-0.5, -0.5], [0.0, -0.1]]).unwrap();
    let error = program.robust(&feedback).map(|_| ()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the feedback corrects the input `gear`, which takes some values only and cannot be corrected; \
         give it a gain with zeros in the row of this input, as `Feedback::regulator` does"
    );
    // Neither does a terminal set.
    let mut line = HybridSystem::new(0.5);
    let x = line.state("x", -5.0, 5.0).unwrap();
    let v = line.state("v", -2.0, 2.0).unwrap();
    let a = line.input_from("a", [-1.0, 0.0, 1.0]).unwrap();
    line.mode("drive").unwrap().rates([x.is(v), v.is(a)]).unwrap();
    let flow = LinearSystem::double_integrator(0.5).unwrap();
    let lqr = Lqr::new(&flow, [[1.0, 0.0], [0.0, 1.0]], [[1.0]]).unwrap();
    let options = TerminalOptions::default();
    let set = TerminalSet::new(&line, &["drive"], &lqr, &[0.0, 0.0], &options, &mut solver);
    let error = set.unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }), "{error}");
}

/// Reach sets see the range, and refute no horizon that the values can do.
#[test]
fn a_shortest_run_takes_values_of_the_list() {
    let mut lift = HybridSystem::new(0.5);
    let x = lift.state("x", 0.0, 9.0).unwrap();
    let v = lift.state("v", -2.0, 2.0).unwrap();
    let u = lift.input_from("u", [-1.0, 0.0, 1.0]).unwrap();
    lift.mode("move").unwrap().rates([x.is(v), v.is(u)]).unwrap();
    let rest = |place: f64| [x.equals(place), v.equals(0.0)];
    for (place, least) in [(0.25, 2), (0.5, 3), (1.0, 4), (1.5, 5), (2.25, 6)] {
        // By enumeration: 3^least sequences, and none of fewer steps.
        let reaches = |steps: u32| {
            (0..3_usize.pow(steps)).any(|code| {
                let (mut code, mut x, mut v) = (code, 0.0, 0.0);
                for _ in 0..steps {
                    let u = (code % 3) as f64 - 1.0;
                    code /= 3;
                    (x, v) = (x + 0.5 * v + 0.125 * u, v + 0.5 * u);
                    if !(0.0..=9.0).contains(&x) || f64::abs(v) > 2.0 {
                        return false;
                    }
                }
                (x, v) == (place, 0.0)
            })
        };
        assert!(reaches(least) && (1..least).all(|fewer| !reaches(fewer)), "{place}");
        let found = lift.shortest(rest(0.0), rest(place), &mut BranchAndBound::default()).unwrap();
        assert_eq!(found.steps, Some(least as usize), "{place}");
    }
}
