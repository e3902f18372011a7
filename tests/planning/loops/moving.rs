//! Limits, prices, references and courses by step move with the loop, or are refused.

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{HybridSystem, LinearSystem, Move, MoveSource, RecedingHorizon, Region, When};
use carom::internals::hybrid::{Halfspace, SystemVariables, Transition};
use carom::interval::Interval;
use carom::prelude::*;

const H: f64 = 0.5;

/// A cart on a line, within a gate that may depend on the step.
fn cart(gate: Vec<f64>) -> HybridSystem {
    HybridSystem::new(H)
        .with_state("x", Interval::new(-5.0, 5.0))
        .with_state("v", Interval::new(-2.0, 2.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_limit(Halfspace::new("gate", [1.0, 0.0], gate))
        .with_transition(Transition::new("drive", LinearSystem::double_integrator(H).unwrap()))
}

fn program(
    system: &HybridSystem,
    steps: usize,
    cost: &Cost,
) -> Result<(SystemVariables, Model), Error> {
    let mut model = Model::new("cart");
    let program = system.write(&mut model, "", steps)?;
    let cost = program.add_cost(&mut model, "cost", cost)?;
    model.minimize(cost)?;
    Ok((program, model))
}

/// The weight of the position and of the speed, and where the cart shall be.
fn towards(place: impl Into<carom::hybrid::Schedule<Vec<f64>>>) -> Cost {
    Cost::quadratic([[1.0, 0.0], [0.0, 0.1]], [[0.1]]).with_state_reference(place)
}

#[test]
fn a_limit_from_a_step_on_is_met_when_its_time_comes() {
    let system = cart([vec![5.0; 12], vec![1.0]].concat());
    let cost = towards(vec![3.0, 0.0]);
    let build = |step: usize| program(&system.from_step(step), 8, &cost);
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant = |state: &[f64], next: &Move| {
        let now = system.from_step(next.step);
        Ok(now.simulate(state, &[&next.input])?.last().to_vec())
    };
    let run = controller.run(&[0.0, 0.0], 16, plant).unwrap();
    assert_eq!(run.count(MoveSource::Optimal), 16);
    // Nobody returns before it is necessary.
    assert!(run.states.iter().take(9).any(|state| state[0] > 2.0));
    // A simulation of the whole system, which knows the step, goes through.
    let inputs: Vec<Vec<f64>> = run.moves.iter().map(|next| next.input.clone()).collect();
    let whole = system.simulate(&[0.0, 0.0], &inputs).unwrap();
    assert!(whole.is_complete(), "{whole}");
    for (own, simulated) in run.states.iter().zip(&whole.states) {
        assert!(own.iter().zip(simulated).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}

#[test]
fn a_reference_by_step_is_followed() {
    let system = cart(vec![5.0]);
    // From -2 to 2 and back, seen some steps ahead.
    let course: Vec<Vec<f64>> = (0..30)
        .map(|k| vec![2.0 * (f64::from(k) / 4.0).sin(), 0.5 * (f64::from(k) / 4.0).cos() / H])
        .collect();
    let cost =
        Cost::quadratic([[10.0, 0.0], [0.0, 0.0]], [[0.01]]).with_state_reference(course.clone());
    let build = |step: usize| program(&system, 6, &cost.clone().from_step(step));
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant =
        |state: &[f64], next: &Move| Ok(system.simulate(state, &[&next.input])?.last().to_vec());
    let run = controller.run(&course[0], 24, plant).unwrap();
    for (state, place) in run.states.iter().zip(&course).skip(3) {
        assert!((state[0] - place[0]).abs() < 0.2, "{state:?}, {place:?}");
    }
}

/// A store that loses 1 in each step, and is filled at a price by step.
#[test]
fn a_price_by_step_is_paid_when_it_is_low() {
    let store = HybridSystem::new(H)
        .with_state("full", Interval::new(0.0, 4.0))
        .with_input("buy", Interval::new(0.0, 3.0))
        .with_transition(Transition::new(
            "use",
            LinearSystem::new([[1.0]], [[1.0]], [-1.0]).unwrap(),
        ));
    // Cheap in every fourth and fifth step.
    let price = |k: usize| if k % 5 >= 3 { 1.0 } else { 10.0 };
    let build = |step: usize| {
        let mut model = Model::new("store");
        let program = store.write(&mut model, "", 5)?;
        let buy = program.inputs()[0].iter().enumerate();
        let cost: Affine = buy.map(|(t, buy)| price(step + t) * buy).sum();
        // What is left in the end is worth the usual price.
        model.minimize(cost - 1.01 * program.states()[0][5])?;
        Ok((program, model))
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant = |state: &[f64], next: &Move| Ok(vec![state[0] + next.input[0] - 1.0]);
    let run = controller.run(&[3.0], 20, plant).unwrap();
    for (k, next) in run.moves.iter().enumerate() {
        assert!(price(k) < 5.0 || next.input[0] < 1e-6, "{k}: {:?}", next.input);
    }
}

/// A gate of a lane goes up and down.
fn lane() -> Scene {
    let lane = [Interval::new(0.0, 4.0), Interval::new(0.0, 1.0)];
    let body = Body::new("cart", lane, 2.0, 2.0);
    let sides = [Interval::new(1.5, 1.9), Interval::new(-0.05, 1.05)];
    let course = (0..50).map(|t| [0.0, if (10..50).contains(&t) { 1.2 } else { 0.0 }]);
    Scene::new(0.25)
        .with_body(body)
        .with_obstacle(Solid::cuboid("gate", &sides, Surface::avoid()).with_course(course))
}

#[test]
fn a_course_by_step_is_avoided_where_it_is() {
    let scene = lane();
    let build = |step: usize| {
        let mut program = scene.from_step(step).plain_program(8)?;
        let cost = Cost::quadratic(
            [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0; 4]],
            [[0.05, 0.0], [0.0, 0.05]],
        )
        .with_state_reference(vec![3.0, 0.5, 0.0, 0.0])
        .with_terminal([
            [5.0, 0.0, 0.0, 0.0],
            [0.0, 5.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]);
        let cost = program.hybrid.add_cost(&mut program.model, "cost", &cost)?;
        program.model.minimize(cost)?;
        Ok((program.hybrid, program.model))
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let system = scene.hybrid_system().unwrap();
    let start = [0.5, 0.5, 0.0, 0.0];
    let plant = |state: &[f64], next: &Move| {
        let now = system.from_step(next.step);
        Ok(now.simulate(state, &[&next.input])?.last().to_vec())
    };
    let run = controller.run(&start, 24, plant).unwrap();
    assert!(run.moves.iter().all(|next| !next.states.is_empty()), "{run}");
    assert!(run.states[10].first().is_some_and(|&x| x < 1.5 + 1e-6), "{:?}", run.states[10]);
    assert!(run.states[24].first().is_some_and(|&x| x > 2.5), "{:?}", run.states[24]);
    let inputs: Vec<Vec<f64>> = run.moves.iter().map(|next| next.input.clone()).collect();
    let options = carom::hybrid::SimulationOptions::default().with_tolerance(1e-5);
    let whole = system.simulate_with(&start, &inputs, &options).unwrap();
    assert!(whole.is_complete(), "{whole}");
    // A course ends where it was stated to end.
    let error = scene.from_step(45).plain_program(8).unwrap_err();
    assert!(error.to_string().contains("gate"), "{error}");
}

#[test]
fn forecasts_move_with_the_loop() {
    let system = cart(vec![5.0]);
    let (handles, mut model) = program(&system, 5, &towards(vec![0.0, 0.0])).unwrap();
    let mut most = Vec::new();
    for t in 0..=5 {
        let limit = model.parameter(("most", t), 5.0, -5.0, 5.0).unwrap();
        model.add(("below", t), handles.states()[0][t].le(limit)).unwrap();
        most.push(limit);
    }
    let wanted = model.parameter("wanted", 0.0, -5.0, 5.0).unwrap();
    let miss = handles.states()[0].iter().map(|x| (x - wanted).square()).sum::<Quadratic>();
    let push = handles.inputs()[0].iter().map(|a| 0.1 * a.square()).sum::<Quadratic>();
    model.minimize(miss + push).unwrap();
    let mut solver = BranchAndBound::default();
    let controller = RecedingHorizon::new(&handles, model, &mut solver).unwrap();
    let mut asked = Vec::new();
    let mut controller = controller
        .with_forecast(most.clone(), [vec![5.0; 10], vec![0.5]].concat())
        .unwrap()
        .with_parameters(|step, state| {
            asked.push((step, state[0]));
            vec![(wanted, 2.0)]
        })
        .unwrap();
    let plant =
        |state: &[f64], next: &Move| Ok(system.simulate(state, &[&next.input])?.last().to_vec());
    let run = controller.run(&[0.0, 0.0], 16, plant).unwrap();
    assert_eq!(run.count(MoveSource::Optimal), 16);
    drop(controller);
    assert_eq!(asked.len(), 16);
    assert!(asked.iter().enumerate().all(|(k, (step, _))| k == *step));
    assert!(run.states[..9].iter().any(|state| state[0] > 1.2), "{:?}", run.states);
    assert!(run.states[10..].iter().all(|state| state[0] < 0.5 + 1e-6), "{:?}", run.states);
}

#[test]
fn what_cannot_move_is_refused() {
    let refused = |(program, model): (SystemVariables, Model), name: &str| {
        let mut solver = BranchAndBound::default();
        let error = RecedingHorizon::new(&program, model, &mut solver).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(name) && text.contains("RecedingHorizon::moving"), "{text}");
    };
    let cost = towards(vec![0.0, 0.0]);
    refused(program(&cart(vec![5.0, 1.0]), 4, &cost).unwrap(), "the limit `gate`");
    let push = cart(vec![5.0]);
    let ranges = vec![Interval::new(-1.0, 1.0), Interval::new(-0.5, 0.5)];
    let mut tired = push.clone().with_input("b", ranges);
    let two = LinearSystem::new([[1.0, H], [0.0, 1.0]], [[0.0, 0.0], [H, 1.0]], [0.0, 0.0]);
    tired.choices.clear();
    let tired = tired.with_transition(Transition::new("drive", two.unwrap()));
    let mut model = Model::new("tired");
    let written = tired.write(&mut model, "", 4).unwrap();
    refused((written, model), "the range of the input `b`");
    let guarded = Transition::new("drive", LinearSystem::double_integrator(H).unwrap())
        .with_guard(Halfspace::new("slow", [0.0, 1.0], vec![2.0, 1.0]));
    let mut own = push.clone();
    own.choices.clear();
    refused(
        program(&own.with_transition(guarded), 4, &cost).unwrap(),
        "the guard `slow` of the transition `drive`",
    );
    let by_step = towards(vec![vec![0.0, 0.0], vec![1.0, 0.0]]);
    refused(program(&push, 4, &by_step).unwrap(), "the reference of the cost `cost`");
    let (handles, mut model) = program(&push, 4, &cost).unwrap();
    let limit = Halfspace::new("soft", [1.0, 0.0], vec![4.0, 1.0]);
    let price = handles.soften(&mut model, "soft", &limit, 1.0, 0.0).unwrap();
    let price = model.objective().clone() + price;
    model.minimize(price).unwrap();
    let measured = model.parameter("m", 0.0, -1.0, 1.0).unwrap();
    let states = [handles.states()[0].clone()];
    let mut solver = BranchAndBound::default();
    let error = RecedingHorizon::of_model(&model, &[measured], &states, &[], &mut solver);
    assert!(error.unwrap_err().to_string().contains("the soft limit `soft`"));
    refused((handles, model), "the soft limit `soft`");
    let course = lane().plain_program(4).unwrap();
    refused((course.hybrid, course.model), "the transition `beyond 2` of `cart at gate`");
    // The same value in each step is no dependence, and neither is an end.
    let (handles, mut model) = program(&cart(vec![5.0, 5.0]), 4, &cost).unwrap();
    let end = Region::from([Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0)]);
    handles.require(&mut model, "end", &end, When::At(4)).unwrap();
    assert!(RecedingHorizon::new(&handles, model, &mut solver).is_ok());
}

#[test]
fn bad_forecasts_are_refused() {
    let system = cart(vec![5.0]);
    let (handles, mut model) = program(&system, 3, &towards(vec![0.0, 0.0])).unwrap();
    let limit = model.parameter(("most", 0), 5.0, -5.0, 5.0).unwrap();
    let plain = handles.states()[0][0];
    let mut solver = BranchAndBound::default();
    let mut try_out = |parameters: Vec<Variable>, values: Vec<f64>| {
        let controller = RecedingHorizon::new(&handles, model.clone(), &mut solver).unwrap();
        controller.with_forecast(parameters, values).map(|_| ()).unwrap_err()
    };
    let error = try_out(vec![limit], vec![1.0, 7.0]);
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    let error = try_out(vec![limit], vec![f64::NAN]);
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }), "{error}");
    let error = try_out(vec![limit], vec![]);
    assert!(error.to_string().contains("the number of values of the forecast of `most`"));
    let error = try_out(vec![plain], vec![1.0]);
    assert!(matches!(error.kind(), ErrorKind::NotParameter { .. }), "{error}");
    // Values that a function gives are checked in the step.
    let controller = RecedingHorizon::new(&handles, model.clone(), &mut solver).unwrap();
    let mut controller = controller.with_parameters(|_, _| vec![(limit, 9.0)]).unwrap();
    let error = controller.step(&[0.0, 0.0]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    drop(controller);
    let build = |_: usize| program(&system, 3, &towards(vec![0.0, 0.0]));
    let built = RecedingHorizon::moving(build, &mut solver);
    let error = built.with_forecast([limit], [1.0]).map(|_| ()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }), "{error}");
}
