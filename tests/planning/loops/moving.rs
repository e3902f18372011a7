//! Limits, prices, references and courses by step move with the loop, or are refused.

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{
    ControlMove, HybridProgram, HybridSystem, LinearSystem, MoveSource, RecedingHorizon, Schedule,
    State,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Halfspace, Transition};

const H: f64 = 0.5;

/// A cart on a line, within a gate and with a place where it wants to be, which may depend on the
/// step.
struct Cart {
    system: HybridSystem,
    x: State,
    v: State,
    a: Input,
    gate: Variable,
    place: Variable,
}

fn cart_towards(gate: impl Into<Schedule<f64>>, place: impl Into<Schedule<f64>>) -> Cart {
    let mut system = HybridSystem::new(H);
    let x = system.state("x", -5.0, 5.0).unwrap();
    let v = system.state("v", -2.0, 2.0).unwrap();
    let a = system.input("a", -1.0, 1.0).unwrap();
    let gate = system.series("opening", gate).unwrap();
    let place = system.series("place", place).unwrap();
    system.limit("gate", x.le(gate)).unwrap();
    system.mode("drive").unwrap().rates([(x, v.into()), (v, Affine::from(a))]).unwrap();
    Cart { system, x, v, a, gate, place }
}

fn cart(gate: impl Into<Schedule<f64>>) -> Cart {
    cart_towards(gate, 0.0)
}

impl Cart {
    /// The program that begins with a step, towards the place.
    fn program(&self, step: usize, steps: usize) -> Result<HybridProgram, Error> {
        let Cart { x, v, a, place, .. } = *self;
        let mut program = self.system.from_step(step).program(steps)?;
        program
            .minimize(program.sum((x - place).square() + 0.1 * v.square() + 0.1 * a.square())?)?;
        Ok(program)
    }
}

#[test]
fn a_limit_from_a_step_on_is_met_when_its_time_comes() {
    let cart = cart_towards([vec![5.0; 12], vec![1.0]].concat(), 3.0);
    let system = &cart.system;
    let build = |step: usize| cart.program(step, 8);
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant = |state: &[f64], next: &ControlMove| {
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
    // From -2 to 2 and back, seen some steps ahead.
    let course: Vec<f64> = (0..30).map(|k| 2.0 * (f64::from(k) / 4.0).sin()).collect();
    let Cart { system, x, a, place, .. } = cart_towards(5.0, course.clone());
    let build = |step: usize| {
        let mut program = system.from_step(step).program(6)?;
        program.minimize(program.sum(10.0 * (x - place).square() + 0.01 * a.square())?)?;
        Ok::<_, Error>(program)
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant = |state: &[f64], next: &ControlMove| {
        Ok(system.simulate(state, &[&next.input])?.last().to_vec())
    };
    let run = controller.run(&[0.0, 0.5 / H], 24, plant).unwrap();
    for (state, place) in run.states.iter().zip(&course).skip(3) {
        assert!((state[0] - place).abs() < 0.2, "{state:?}, {place:?}");
    }
}

/// A store that loses 1 in each step, and is filled at a price by step.
#[test]
fn a_price_by_step_is_paid_when_it_is_low() {
    // Cheap in every fourth and fifth step.
    let price = |k: usize| if k % 5 >= 3 { 1.0 } else { 10.0 };
    let mut store = HybridSystem::new(H);
    let full = store.state("full", 0.0, 4.0).unwrap();
    let buy = store.input("buy", 0.0, 3.0).unwrap();
    let prices = store.series("price", (0..40).map(price).collect::<Vec<f64>>()).unwrap();
    store.mode("use").unwrap().next([(full, full + buy - 1.0)]).unwrap();
    let build = |step: usize| {
        let mut program = store.from_step(step).program(5)?;
        // What is left in the end is worth the usual price.
        program.minimize(program.sum(prices * buy)? - 1.01 * program.end(full)?)?;
        Ok::<_, Error>(program)
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant = |state: &[f64], next: &ControlMove| Ok(vec![state[0] + next.input[0] - 1.0]);
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
        .with_obstacle(Solid::cuboid("gate", sides, Surface::avoid()).with_course(course))
}

#[test]
fn a_course_by_step_is_avoided_where_it_is() {
    let scene = lane();
    let build = |step: usize| {
        let mut program = HybridProgram::from(scene.from_step(step).plain_program(8)?);
        let system = program.system();
        let [x, y] = [system.state_named("cart x")?, system.state_named("cart y")?];
        let [vx, vy] = [system.state_named("cart vx")?, system.state_named("cart vy")?];
        let [ax, ay] = [system.input_named("cart ax")?, system.input_named("cart ay")?];
        let miss = (x - 3.0).square() + (y - 0.5).square();
        let end = program.end(5.0 * &miss + vx.square() + vy.square())?;
        let cost = program.sum(miss + 0.05 * (ax.square() + ay.square()))?;
        program.minimize(cost + end)?;
        Ok::<_, Error>(program)
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let system = scene.hybrid_system().unwrap();
    let start = [0.5, 0.5, 0.0, 0.0];
    let plant = |state: &[f64], next: &ControlMove| {
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
    let Cart { system, x, a, .. } = cart(5.0);
    let mut program = system.program(5).unwrap();
    let mut most = Vec::new();
    for t in 0..=5 {
        let limit = program.model_mut().parameter(("most", t), 5.0, -5.0, 5.0).unwrap();
        program.add(("below", t), program.at(x.le(limit), t).unwrap()).unwrap();
        most.push(limit);
    }
    let wanted = program.model_mut().parameter("wanted", 0.0, -5.0, 5.0).unwrap();
    let miss = (x - wanted).square();
    let cost = program.sum(&miss + 0.1 * a.square()).unwrap() + program.end(miss).unwrap();
    program.minimize(cost).unwrap();
    let mut solver = BranchAndBound::default();
    let controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let mut asked = Vec::new();
    let mut controller = controller
        .with_forecast(most.clone(), [vec![5.0; 10], vec![0.5]].concat())
        .unwrap()
        .with_parameters(|step, state| {
            asked.push((step, state[0]));
            vec![(wanted, 2.0)]
        })
        .unwrap();
    let plant = |state: &[f64], next: &ControlMove| {
        Ok(system.simulate(state, &[&next.input])?.last().to_vec())
    };
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
    let refused = |program: HybridProgram, name: &str| {
        let mut solver = BranchAndBound::default();
        let error = RecedingHorizon::new(program, &mut solver).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(name) && text.contains("RecedingHorizon::moving"), "{text}");
    };
    // A series is a series wherever it stands: in limits, guards, costs and soft limits.
    let by_step = cart([5.0, 1.0].to_vec());
    refused(by_step.program(0, 4).unwrap(), "the series `opening`");
    refused(cart_towards(5.0, vec![0.0, 1.0]).program(0, 4).unwrap(), "the series `place`");
    let mut guarded = HybridSystem::new(H);
    let v = guarded.state("v", -2.0, 2.0).unwrap();
    let most = guarded.series("most", vec![2.0, 1.0]).unwrap();
    guarded.mode("drive").unwrap().guard(v.le(most)).unwrap().next([(v, 0.5 * v)]).unwrap();
    refused(guarded.program(4).unwrap(), "the series `most`");
    let Cart { system, x, gate, .. } = cart(5.0);
    let mut program = system.program(4).unwrap();
    let soft = program.soften("soft", x.le(gate - 1.0), 1.0, 0.0).unwrap();
    program.minimize(soft.cost).unwrap();
    assert!(RecedingHorizon::new(program, &mut BranchAndBound::default()).is_ok());
    // Ranges of inputs, and systems of numbers.
    let mut tired = HybridSystem::new(H);
    let w = tired.state("w", -9.0, 9.0).unwrap();
    let b = tired.input("b", vec![-1.0, -0.5], vec![1.0, 0.5]).unwrap();
    tired.mode("drive").unwrap().next([(w, w + b)]).unwrap();
    refused(tired.program(4).unwrap(), "the range of the input `b`");
    let line = LinearSystem::double_integrator(H).unwrap();
    let numbers = |limits: Vec<Halfspace>, guards: Vec<Halfspace>| {
        let system = HybridSystem::new(H)
            .with_state("x", Interval::new(-5.0, 5.0))
            .with_state("v", Interval::new(-2.0, 2.0))
            .with_input("a", Interval::new(-1.0, 1.0));
        let system = limits.into_iter().fold(system, HybridSystem::with_limit);
        let drive = Transition::new("drive", line.clone()).with_guards(guards);
        system.with_transition(drive).program(4).unwrap()
    };
    let gate = Halfspace::new("gate", [1.0, 0.0], vec![5.0, 1.0]);
    refused(numbers(vec![gate], vec![]), "the limit `gate`");
    let slow = Halfspace::new("slow", [0.0, 1.0], vec![2.0, 1.0]);
    refused(numbers(vec![], vec![slow]), "the guard `slow` of the transition `drive`");
    // A model of one's own with a system in it, and a scene.
    let mut program = by_step.program(0, 4).unwrap();
    let measured = program.model_mut().parameter("m", 0.0, -1.0, 1.0).unwrap();
    let states: Family = (0..=4).map(|t| program.variable(by_step.x, t).unwrap()).collect();
    let mut solver = BranchAndBound::default();
    let error =
        RecedingHorizon::of_model(program.model(), &[measured], &[states], &[], &mut solver);
    assert!(error.unwrap_err().to_string().contains("the series `opening`"));
    let course = lane().plain_program(4).unwrap();
    refused(course.into(), "the transition `beyond 2` of `cart at gate`");
    // The same value in each step is no dependence, and neither is an end.
    let Cart { system, x, v, .. } = cart(vec![5.0, 5.0]);
    let mut program = system.program(4).unwrap();
    program.goal([x.within(-1.0, 1.0), v.within(-1.0, 1.0)]).unwrap();
    assert!(RecedingHorizon::new(program, &mut solver).is_ok());
}

#[test]
fn bad_forecasts_are_refused() {
    let cart = cart(5.0);
    let mut program = cart.program(0, 3).unwrap();
    let limit = program.model_mut().parameter(("most", 0), 5.0, -5.0, 5.0).unwrap();
    let plain = program.variable(cart.x, 0).unwrap();
    let mut solver = BranchAndBound::default();
    let mut try_out = |parameters: Vec<Variable>, values: Vec<f64>| {
        let controller = RecedingHorizon::new(program.clone(), &mut solver).unwrap();
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
    let controller = RecedingHorizon::new(program.clone(), &mut solver).unwrap();
    let mut controller = controller.with_parameters(|_, _| vec![(limit, 9.0)]).unwrap();
    let error = controller.step(&[0.0, 0.0]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    drop(controller);
    let build = |step: usize| cart.program(step, 3);
    let built = RecedingHorizon::moving(build, &mut solver);
    let error = built.with_forecast([limit], [1.0]).map(|_| ()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }), "{error}");
}
