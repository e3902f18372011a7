//! Steps whose search is stopped early.

use std::time::Duration;

use carom::hybrid::{ControlMove, HybridProgram, HybridSystem, MoveSource, RecedingHorizon, State};
use carom::prelude::*;
use carom::solver::Prepared;

/// Three rows over binaries with one point each for most values of the parameter: hard to find,
/// easy to complete.
fn needle() -> (Model, Variable) {
    let mut model = Model::new("needle");
    let z = model.binary_family("z", 22).unwrap();
    let [over, under] = ["over", "under"].map(|name| model.continuous(name, 0.0, 0.7).unwrap());
    let wanted = model.parameter("wanted", 0.0, -0.2, 0.2).unwrap();
    let mut state: u64 = 7;
    let mut draw = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % 100) as f64
    };
    for row in 0..3 {
        let factors: Vec<f64> = z.iter().map(|_| draw()).collect();
        let planted: f64 =
            factors.iter().enumerate().filter(|(k, _)| k % 3 != 1).map(|(_, a)| a).sum();
        let sum: Affine = z.iter().zip(&factors).map(|(z, a)| *a * z).sum();
        model.add(("row", row), (sum - over + under + wanted).equals(planted)).unwrap();
    }
    // A point takes a relaxation.
    let size = (over + under - 0.5).square() + (over - 2.0 * under).square();
    model.minimize(size).unwrap();
    (model, wanted)
}

#[test]
fn a_missed_budget_keeps_the_last_plan() {
    let (model, wanted) = needle();
    let solve = |prepared: &mut dyn Prepared, value: f64| {
        prepared.solve(&[(wanted, value)], &mut Control::default()).unwrap()
    };
    let stopped = Options::default().with_node_limit(1);
    // Nothing is found at once ...
    let mut cold = BranchAndBound::new(stopped.clone());
    let mut cold = cold.prepare(&model).unwrap();
    assert!(solve(&mut *cold, 0.1).point().is_none());
    // ... but the last point is completed, also after searches that found nothing.
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    assert!(solve(&mut *prepared, 0.0).point().is_some());
    prepared.options_mut().time_limit = Some(Duration::ZERO);
    for _ in 0..3 {
        assert!(solve(&mut *prepared, 0.0).point().is_none());
    }
    *prepared.options_mut() = stopped;
    assert!(solve(&mut *prepared, 0.1).point().is_some());
}

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

fn program() -> Result<HybridProgram, Error> {
    let Cart { system, x, v, u } = cart();
    let mut program = system.program(10)?;
    program.minimize(program.sum(x.square() + 0.1 * v.square() + 0.05 * u.square())?)?;
    Ok(program)
}

fn plant(state: &[f64], next: &ControlMove) -> Result<Vec<f64>, Error> {
    let after = cart().system.simulate(state, &[&next.input])?;
    Ok(after.last().iter().map(|x| x + 0.01 * (x * 1e3).sin()).collect())
}

/// From nothing, with hardly any nodes, prepared or built in each step.
#[test]
fn every_step_has_a_plan_with_a_budget_of_a_node() {
    let options = Options::default().with_node_limit(1);
    let mut solver = BranchAndBound::new(options.clone());
    let mut controller = RecedingHorizon::new(program().unwrap(), &mut solver).unwrap();
    let run = controller.run(&[0.5, 1.8], 30, plant).unwrap();
    assert!(run.moves.iter().all(|next| !next.states.is_empty()), "{run}");
    let mut solver = BranchAndBound::new(options);
    let mut controller = RecedingHorizon::moving(|_| program(), &mut solver);
    let run = controller.run(&[0.5, 1.8], 30, plant).unwrap();
    let planned = run.moves.iter().filter(|next| !next.states.is_empty()).count();
    assert!(planned >= 29, "{run}");
}

#[test]
fn a_plan_follows_a_step_without_one() {
    let mut solver = BranchAndBound::default();
    let controller = RecedingHorizon::new(program().unwrap(), &mut solver).unwrap();
    // The first search has a budget of its own, the others have none.
    let second = Duration::from_secs(1000);
    let mut controller = controller.with_budget(Duration::ZERO).with_first_budget(second);
    let mut state = vec![0.5, 1.8];
    let mut sources = Vec::new();
    for step in 0..8 {
        if step == 4 {
            controller = controller.with_budget(second);
        }
        let next = controller.step(&state).unwrap();
        state = plant(&state, &next).unwrap();
        sources.push(next.source);
    }
    let missed = [MoveSource::LastPlan; 3];
    assert_eq!(sources[0], MoveSource::Optimal);
    assert_eq!(sources[1..4], missed, "{sources:?}");
    assert!(sources[4..].iter().all(|source| *source == MoveSource::Optimal), "{sources:?}");
}
