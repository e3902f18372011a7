//! Controllers: the plans of cold solves, moves without a plan, and closed loops.

use std::time::Duration;

use carom::ErrorKind;
use carom::hybrid::{
    ControlMove, Disturbance, HybridProgram, HybridSystem, LinearSystem, Lqr, MoveSource,
    RecedingHorizon, Region, State, TerminalOptions, TerminalSet, When,
};
use carom::interval::Interval;
use carom::prelude::*;

const H: f64 = 0.1;

/// A cart in front of a spring.
struct Cart {
    system: HybridSystem,
    x: State,
    v: State,
    u: Input,
}

fn cart() -> Cart {
    let mut system = HybridSystem::new(H);
    let x = system.state("x", -2.0, 2.0).unwrap();
    let v = system.state("v", -3.0, 3.0).unwrap();
    let u = system.input("u", -2.0, 2.0).unwrap();
    let flow = |spring: f64| [(x, x + H * v), (v, v + H * (u + spring * (1.0 - x)))];
    system.mode("free").unwrap().next(flow(0.0)).unwrap().guard(x.le(1.0)).unwrap();
    system.mode("pushed").unwrap().next(flow(20.0)).unwrap().guard(x.ge(1.0)).unwrap();
    Cart { system, x, v, u }
}

fn program(steps: usize) -> Result<HybridProgram, Error> {
    let Cart { system, x, v, u } = cart();
    let mut program = system.program(steps)?;
    program.minimize(program.sum(x.square() + 0.1 * v.square() + 0.05 * u.square())?)?;
    Ok(program)
}

fn plant(state: &[f64], next: &ControlMove) -> Result<Vec<f64>, Error> {
    Ok(cart().system.simulate(state, &[&next.input])?.last().to_vec())
}

#[test]
fn every_plan_costs_what_a_cold_one_does() {
    let program = program(10).unwrap();
    let mut push = Disturbance::new(vec![Interval::new(-0.02, 0.02); 2], 3);
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program.clone(), &mut solver).unwrap();
    let disturbed = |state: &[f64], next: &ControlMove| {
        let after = plant(state, next)?;
        Ok(after.iter().zip(push.next_value()).map(|(x, w)| (x + w).clamp(-1.9, 1.9)).collect())
    };
    let run = controller.run(&[0.5, 1.8], 12, disturbed).unwrap();
    assert_eq!(run.count(MoveSource::Optimal), 12);
    for next in &run.moves {
        let mut cold = program.clone();
        cold.require("at", Region::point(&next.state), When::At(0)).unwrap();
        let best = cold.solve(&mut BranchAndBound::default()).unwrap();
        let best = best.solution.objective().unwrap();
        let own = next.objective.unwrap();
        assert!((best - own).abs() <= 5e-6 * best.abs().max(1.0), "{best}, {own}");
        assert_eq!(next.states[0].len(), 2);
        assert_eq!((next.inputs.len(), next.is_admissible), (10, Some(true)));
    }
    let csv = run.to_csv();
    assert_eq!(csv.lines().count(), 13);
    let mut cells = csv.lines().skip(1).flat_map(|line| line.split(','));
    assert!(cells.all(|cell| cell != "-0" && cell.len() <= 19), "{csv}");
    let picture = run.to_svg("a cart");
    assert!(["a cart", "x0", "x1", "u0"].iter().all(|word| picture.contains(word)));
    assert!(!picture.contains("u1") && !picture.contains("NaN"));
    assert!(run.to_string().starts_with("12 steps: 12 optimal"));
}

#[test]
fn a_move_comes_from_the_last_plan_when_there_is_no_new_one() {
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program(6).unwrap(), &mut solver).unwrap();
    let first = controller.step(&[0.0, 1.0]).unwrap();
    assert_eq!(first.source, MoveSource::Optimal);
    controller = controller.with_budget(Duration::ZERO);
    let state = plant(&[0.0, 1.0], &first).unwrap();
    let second = controller.step(&state).unwrap();
    assert_eq!(second.source, MoveSource::LastPlan);
    assert_eq!((second.input, second.is_admissible), (first.inputs[1].clone(), Some(true)));
    // It comes with what is left of the plan, from the measured state.
    assert!(second.reason.is_some() && second.states.len() == 6);
    assert_eq!((&second.states[0], &second.inputs[..]), (&state, &first.inputs[1..]));
    // Six inputs were planned.
    for _ in 0..4 {
        assert_eq!(controller.step(&[0.0, 0.0]).unwrap().source, MoveSource::LastPlan);
    }
    let last = controller.step(&[0.0, 0.0]).unwrap();
    assert_eq!((last.source, &last.input[..]), (MoveSource::Emergency, &[0.0][..]));
}

#[test]
fn a_state_out_of_range_gets_a_fallback_and_bad_numbers_an_error() {
    let mut solver = BranchAndBound::default();
    let controller = RecedingHorizon::new(program(4).unwrap(), &mut solver).unwrap();
    let mut controller = controller.with_fallback(|state| vec![-state[1].signum()]);
    let next = controller.step(&[0.0, 3.5]).unwrap();
    assert_eq!((next.source, &next.input[..]), (MoveSource::Given, &[-1.0][..]));
    assert_eq!(next.is_admissible, Some(false));
    assert!(next.reason.is_some_and(|why| why.contains("measured_v")));
    // Too fast to stay within the domain: there is no plan.
    let next = controller.step(&[1.95, 3.0]).unwrap();
    assert_eq!(next.source, MoveSource::Given);
    let error = controller.step(&[0.0]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Length { .. }));
    let error = controller.step(&[f64::NAN, 0.0]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
}

#[test]
fn a_terminal_set_keeps_the_loop_going() {
    let line = LinearSystem::double_integrator(H).unwrap();
    let lqr = Lqr::new(&line, [[1.0, 0.0], [0.0, 1.0]], [[1.0]]).unwrap();
    let mut system = HybridSystem::new(H);
    for name in ["x", "v"] {
        system.state(name, -2.0, 2.0).unwrap();
    }
    system.input("a", -1.0, 1.0).unwrap();
    system.mode("drive").unwrap().flow(line).unwrap();
    let options = TerminalOptions::default();
    let mut solver = BranchAndBound::default();
    let set =
        TerminalSet::new(&system, &["drive"], &lqr, &[0.0, 0.0], &options, &mut solver).unwrap();
    let mut program = system.program(5).unwrap();
    program.require("end", &set.region, When::At(5)).unwrap();
    program.minimize(0.0).unwrap();
    let controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let mut controller = controller.with_terminal_set(set).with_budget(Duration::ZERO);
    let next = controller.step(&[0.1, 0.1]).unwrap();
    assert_eq!((next.source, next.is_admissible), (MoveSource::TerminalFeedback, Some(true)));
}

#[test]
fn a_shrinking_horizon_arrives_in_time() {
    let build = |steps: usize| {
        let mut program = program(steps)?;
        program.goal([Interval::new(-0.1, 0.1), Interval::new(-0.1, 0.1)])?;
        Ok(program)
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::shrinking(20, build, &mut solver);
    let run = controller.run(&[0.3, 0.5], 20, plant).unwrap();
    assert!(run.states[20].iter().all(|x| x.abs() <= 0.1 + 1e-5), "{:?}", run.states[20]);
    assert_eq!(run.count(MoveSource::Optimal), 20);
    let error = controller.step(&[0.0, 0.0]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }));
}

#[test]
fn an_excess_of_softened_limits_is_reported() {
    let Cart { system, x, v, u } = cart();
    let mut program = system.program(5).unwrap();
    let cost = program.sum(x.square() + 0.1 * v.square() + 0.05 * u.square()).unwrap();
    let slow = program.soften("slow", v.le(0.5), 100.0, 0.0).unwrap();
    program.minimize(cost + slow.cost).unwrap();
    let mut solver = BranchAndBound::default();
    let controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let mut controller = controller.with_excess(slow.excess);
    let fast = controller.step(&[0.0, 1.0]).unwrap();
    assert_eq!(fast.source, MoveSource::Softened);
    assert!(fast.excess.is_some_and(|excess| excess > 0.5));
    let slow = controller.step(&[0.0, 0.2]).unwrap();
    assert_eq!(slow.source, MoveSource::Optimal);
}

/// Any model in which parameters are what is measured.
#[test]
fn a_model_of_ones_own_is_controlled() {
    let mut model = Model::new("tank");
    let level = model.continuous_family("level", 5, 0.0, 10.0).unwrap();
    let open = model.binary_family("open", 4).unwrap();
    let measured = model.parameter("measured", 5.0, 0.0, 10.0).unwrap();
    model.add("now", (level[0] - measured).equals(0.0)).unwrap();
    for t in 0..4 {
        let change = level[t + 1] - level[t] - 1.5 * open[t];
        model.add(("flow", t), change.equals(-1.0)).unwrap();
    }
    let miss = level.iter().map(|x| (x - 4.0).square()).sum::<Quadratic>();
    model.minimize(miss).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller =
        RecedingHorizon::of_model(&model, &[measured], &[level], &[open], &mut solver).unwrap();
    let tank = |state: &[f64], next: &ControlMove| Ok(vec![state[0] + 1.5 * next.input[0] - 1.0]);
    let run = controller.run(&[7.0], 12, tank).unwrap();
    assert!((run.states[12][0] - 4.0).abs() < 1.5, "{:?}", run.states);
    let mut solver = BranchAndBound::default();
    let states = model.continuous_family("other", 5, 0.0, 1.0).unwrap();
    let wrong = RecedingHorizon::of_model(&model, &[measured], &[], &[], &mut solver);
    assert!(matches!(wrong.unwrap_err().kind(), ErrorKind::Length { .. }));
    let wrong = [states[0]];
    let error = RecedingHorizon::of_model(&model, &wrong, &[states], &[], &mut solver);
    assert!(matches!(error.unwrap_err().kind(), ErrorKind::NotParameter { .. }));
}

/// Without a system a check of one's own judges what comes instead of a plan.
#[test]
fn a_check_of_ones_own_judges_fallbacks() {
    let mut model = Model::new("tank");
    let level = model.continuous_family("level", 4, 0.0, 10.0).unwrap();
    let open = model.continuous_family("open", 3, 0.0, 2.0).unwrap();
    let measured = model.parameter("measured", 5.0, 0.0, 10.0).unwrap();
    model.add("now", (level[0] - measured).equals(0.0)).unwrap();
    for t in 0..3 {
        model.add(("flow", t), (level[t + 1] - level[t] - open[t]).equals(-1.0)).unwrap();
    }
    model.minimize(level.iter().map(|x| (x - 4.0).square()).sum::<Quadratic>()).unwrap();
    let mut solver = BranchAndBound::default();
    let holds = |state: &[f64], inputs: &[Vec<f64>]| {
        let mut x = state[0];
        inputs.iter().all(|u| {
            x += u[0] - 1.0;
            (0.0..=10.0).contains(&x)
        })
    };
    let controller =
        RecedingHorizon::of_model(&model, &[measured], &[level], &[open], &mut solver).unwrap();
    let mut controller = controller.with_check(holds).with_fallback(|_| vec![2.0]);
    assert_eq!(controller.step(&[9.0]).unwrap().source, MoveSource::Optimal);
    controller = controller.with_budget(Duration::ZERO);
    // The last plan empties a tank that is nearly empty now; the given input does not.
    let next = controller.step(&[0.5]).unwrap();
    assert_eq!((next.source, next.is_admissible), (MoveSource::Given, Some(true)));
    // What is left of the plan stops the inflow.
    assert_eq!(controller.step(&[9.9]).unwrap().source, MoveSource::LastPlan);
    // Nothing is left, and nothing is admissible: the given input, and a word about it.
    let next = controller.step(&[9.9]).unwrap();
    assert_eq!((next.source, next.is_admissible), (MoveSource::Given, Some(false)));
    // A fallback that gives no number is refused.
    let mut controller = controller.with_fallback(|_| vec![f64::NAN]);
    let error = controller.step(&[9.9]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
}
