//! Cases of scenes, of the paper's vehicle, and in controllers.

use carom::ErrorKind;
use carom::collision_tolerant::{Endpoint, Objective, PlanningProgram, Scenario};
use carom::hybrid::scene::{DamageMeasure, DamageRule, SceneProgram};
use carom::hybrid::{MoveSource, Restitution};
use carom::prelude::*;

use super::Draw;

const STEPS: usize = 8;

/// A puck on the way to a goal behind a block, beside a wall that rebounds by e.
fn table(e: f64, block: f64) -> Result<Scene, Error> {
    let surface = Surface::bounce(Restitution::new(e)?);
    let block = [1.2..=1.5, -0.1..=block];
    let puck = Body::new("puck", [0.0..=3.0, 0.0..=1.4], 2.0, 3.0)
        .with_start([0.4, 0.5, 1.0, 0.0])
        .with_goal([1.9..=2.6, 0.3..=1.0, -1.0..=-0.2, -0.6..=0.6]);
    Ok(Scene::new(0.25)
        .with_body(puck)
        .with_obstacle(Solid::halfspace("wall", [-1.0, 0.0], -2.8, surface))
        .with_obstacle(Solid::cuboid("block", &block, Surface::avoid())))
}

fn optimum(program: &SceneProgram) -> Result<f64, Error> {
    let solution = BranchAndBound::default().solve(program.model())?;
    Ok(solution.objective().unwrap_or(f64::NAN))
}

fn best(scene: &Scene) -> Result<f64, Error> {
    let mut program = scene.program(STEPS)?;
    program.minimize(program.effort()?)?;
    optimum(&program)
}

fn tree(scenes: [&Scene; 2], until: usize) -> Result<SceneProgram, Error> {
    let mut program = scenes[0].program(STEPS)?;
    program.add_case("other", scenes[1], until)?;
    let own = program.effort()?;
    let its = program.in_case("other", |case| case.effort())?;
    program.minimize(0.5 * own + 0.5 * its)?;
    Ok(program)
}

#[test]
fn one_case_of_a_scene_is_its_program_and_two_apart_are_the_mean() -> Result<(), Error> {
    let mut draw = Draw::new(7);
    for _ in 0..3 {
        let (e, block) = (draw.within(0.3, 0.7), draw.within(0.2, 0.6));
        let (one, other) = (table(e, block)?, table(draw.within(0.3, 0.7), 0.8 - block)?);
        let (first, second) = (best(&one)?, best(&other)?);
        let same = optimum(&tree([&one, &one], STEPS)?)?;
        assert!((same - first).abs() <= 1e-4 * (1.0 + first), "{same} {first}");
        let apart = optimum(&tree([&one, &other], 0)?)?;
        let mean = 0.5 * (first + second);
        assert!((apart - mean).abs() <= 1e-4 * (1.0 + mean), "{apart} {mean}");
        let mut last = apart;
        for until in [3, 5] {
            let program = tree([&one, &other], until)?;
            let solution = BranchAndBound::default().solve(program.model())?;
            let Some(cost) = solution.objective() else { break };
            assert!(cost >= last - 1e-4 * (1.0 + last), "{cost} {last}");
            last = cost;
            let plan = program.plan(&solution)?;
            let case = &plan.cases["other"];
            let inputs = plan.bodies[0].acceleration.iter().zip(&case.bodies[0].acceleration);
            for (own, its) in inputs.take(until).flat_map(|(own, its)| own.iter().zip(its)) {
                assert!((own - its).abs() <= 1e-6);
            }
            // Each case is what its own scene does.
            assert_eq!(other.replay(case)?.certificate, case.certificate);
        }
    }
    Ok(())
}

#[test]
fn rules_of_a_case_are_its_own() -> Result<(), Error> {
    let scene = table(0.5, 0.4)?;
    let gentle = DamageRule::new("no hit", DamageMeasure::ImpactSpeed).with_count(0);
    let careful = scene.clone().with_rule(gentle.with_price(1.0));
    let mut program = scene.program(STEPS)?;
    program.add_case("careful", &careful, 2)?;
    let (own, its) = (program.hits(), program.in_case("careful", |case| Ok(case.hits()))?);
    program.maximize(own + its)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    assert!(!plan.hits.is_empty() && plan.cases["careful"].hits.is_empty());
    // The names of the case begin with its own.
    let far = program.in_case("careful", |case| case.largest_impact())?;
    let name = program.model().variable_ref(far.terms()[0].0)?.name().to_string();
    assert_eq!(name, "careful_largest_damage");
    Ok(())
}

#[test]
fn bad_cases_leave_a_scene_as_it_was() -> Result<(), Error> {
    let scene = table(0.5, 0.4)?;
    let mut program = scene.program(STEPS)?;
    let before = program.model().to_string();
    let kind = |result: Result<(), Error>| result.err().map(|error| error.kind().clone());
    let mut slower = scene.clone();
    slower.time_step = 0.5;
    let late = kind(program.add_case("late", &scene, STEPS + 1));
    assert!(matches!(late, Some(ErrorKind::OutOfRange { .. })));
    assert!(matches!(
        kind(program.add_case("slow", &slower, 2)),
        Some(ErrorKind::OutOfRange { .. })
    ));
    let mut other = scene.clone();
    other.bodies[0].name = "ball".into();
    assert!(matches!(
        kind(program.add_case("ball", &other, 2)),
        Some(ErrorKind::UnknownName { .. })
    ));
    assert!(matches!(kind(program.add_case("", &scene, 2)), Some(ErrorKind::DuplicateName { .. })));
    assert!(matches!(
        kind(program.in_case("nobody", |_| Ok(()))),
        Some(ErrorKind::UnknownName { .. })
    ));
    assert_eq!(program.model().to_string(), before);
    program.add_case("second", &scene, 2)?;
    let both = program.model().to_string();
    assert!(matches!(
        kind(program.add_case("second", &scene, 2)),
        Some(ErrorKind::DuplicateName { .. })
    ));
    assert!(matches!(
        kind(program.program_mut().share_inputs(["second", "third"], 2)),
        Some(ErrorKind::UnknownName { .. })
    ));
    program.in_case("second", |case| case.add("speedy", case.hits().ge(0.5)).map(drop))?;
    assert!(program.model().constraint_by_name("second_speedy").is_ok());
    assert_ne!(program.model().to_string(), both);
    // A tube is around one system, and the error says so.
    let feedback = carom::hybrid::Feedback::none(program.system())?;
    assert!(program.program().robust(&feedback).is_err());
    Ok(())
}

#[test]
fn cases_that_part_together_share_on() -> Result<(), Error> {
    let scenes = [table(0.3, 0.4)?, table(0.5, 0.4)?, table(0.6, 0.4)?];
    let mut program = scenes[0].program(STEPS)?;
    program.add_case("middle", &scenes[1], 1)?;
    program.add_case("lively", &scenes[2], 1)?;
    program.program_mut().share_inputs(["middle", "lively"], 4)?;
    let mut cost = program.effort()?;
    for name in ["middle", "lively"] {
        cost += program.in_case(name, |case| case.effort())?;
    }
    program.minimize(cost)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    let input = |name: &str, t: usize| plan.cases[name].bodies[0].acceleration[t][0];
    assert!((0..4).all(|t| (input("middle", t) - input("lively", t)).abs() < 1e-6));
    assert!((input("middle", 0) - plan.bodies[0].acceleration[0][0]).abs() < 1e-6);
    Ok(())
}

/// The paper's vehicle, fast enough that it has to hit.
fn beside_a_wall(e: f64) -> Result<Scenario, Error> {
    let mut from = Endpoint::at_rest(4.5);
    from.velocity = -9.0;
    let goal = Region::from([0.1..=0.8, -0.5..=1.5]);
    let scenario = Scenario::paper().with_time_step(0.1).with_restitution(e)?;
    Ok(scenario.with_goal_region(goal).with_start(from))
}

fn objective(program: &PlanningProgram) -> Result<f64, Error> {
    let solution = BranchAndBound::default().solve(program.model())?;
    Ok(solution.objective().unwrap_or(f64::NAN))
}

#[test]
fn the_papers_vehicle_has_cases() -> Result<(), Error> {
    for kind in [Objective::Effort, Objective::LargestDamage] {
        let (soft, hard) = (beside_a_wall(0.25)?, beside_a_wall(0.35)?);
        let (one, two) = (objective(&soft.program(9, kind)?)?, objective(&hard.program(9, kind)?)?);
        for (scenario, until, expected) in [(&soft, 9, 2.0 * one), (&hard, 0, one + two)] {
            let mut program = soft.program(9, kind)?;
            let own = program.model().objective().clone();
            let its = program.add_case("other", scenario, until, kind)?;
            program.minimize(own + its)?;
            let found = objective(&program)?;
            assert!((found - expected).abs() <= 1e-4 * (1.0 + expected), "{found} {expected}");
        }
        let mut program = soft.program(9, kind)?;
        let own = program.model().objective().clone();
        let its = program.add_case("other", &hard, 3, kind)?;
        program.minimize(own + its)?;
        let plan = program.solve(&mut BranchAndBound::default())?;
        let case = &plan.cases["other"].trajectory;
        let inputs = plan.trajectory.acceleration.iter().zip(&case.acceleration);
        assert!(inputs.take(3).all(|(own, its)| (own - its).abs() <= 1e-6));
        assert!(!case.impacts.is_empty());
        assert!(plan.cases["other"].certificate.drift <= 1e-6);
    }
    Ok(())
}

/// A cart before a gate that is at 3 m or at 4 m and is seen after two steps.
#[test]
fn a_controller_applies_what_all_cases_share() -> Result<(), Error> {
    let cart = |gate: f64| {
        let mut cart = HybridSystem::new(1.0);
        let x = cart.state("x", -1.0, 9.0)?;
        let u = cart.input("u", -1.0, 1.0)?;
        cart.limit("gate", x.le(gate))?;
        cart.mode("roll")?.next([x.is(x + u)])?;
        Ok::<_, Error>((cart, x, u))
    };
    let ((near, x, u), (far, y, w)) = (cart(3.0)?, cart(4.0)?);
    let build = |until: usize| {
        let mut program = near.program(5)?;
        program.add_case("far", &far, until)?;
        let costs = program.sum((x - 3.0).square() + 0.1 * u.square())?
            + program.sum((y - 4.0).square() + 0.1 * w.square())?;
        program.minimize(costs)?;
        Ok::<_, Error>(program)
    };
    let mut solver = BranchAndBound::default();
    let alone = RecedingHorizon::new(build(0)?, &mut solver).map(drop);
    assert!(matches!(alone.map_err(|e| e.kind().clone()), Err(ErrorKind::OutOfRange { .. })));
    let plant = |state: &[f64], next: &ControlMove| far.simulate(state, &[&next.input])?.end();
    for moving in [false, true] {
        let mut solver = BranchAndBound::default();
        let mut controller = match moving {
            false => RecedingHorizon::new(build(2)?, &mut solver)?,
            true => RecedingHorizon::moving(|_| build(2), &mut solver),
        };
        let run = controller.run(&[0.0], 6, plant)?;
        for next in &run.moves {
            assert_eq!((next.input.len(), next.state.len()), (1, 1));
            assert_eq!(next.source, MoveSource::Optimal);
            assert_eq!(next.states[0].len(), 1);
        }
        // The gate may be at 3 m, so that nobody goes beyond.
        assert!(run.states.iter().all(|state| state[0] <= 3.0 + 1e-6), "{:?}", run.states);
        assert!((run.states[6][0] - 3.0).abs() < 0.2);
    }
    Ok(())
}

/// A scene's tree in a controller: the puck arrives whichever of the two restitutions the wall has.
#[test]
fn a_controller_plans_with_cases_of_a_scene() -> Result<(), Error> {
    let start_free = |e: f64| {
        let mut scene = table(e, 0.4)?;
        scene.bodies[0].start = None;
        Ok::<_, Error>(scene)
    };
    for e in [0.35, 0.55] {
        let build = |steps: usize| {
            let mut program = start_free(0.35)?.program(steps)?;
            program.add_case("lively", &start_free(0.55)?, steps.min(2))?;
            let own = program.effort()?;
            let its = program.in_case("lively", |case| case.effort())?;
            program.minimize(own + its)?;
            Ok(program)
        };
        let world = start_free(e)?.hybrid_system()?;
        let mut solver = BranchAndBound::default();
        let mut controller = RecedingHorizon::shrinking(STEPS, build, &mut solver);
        let plant =
            |state: &[f64], next: &ControlMove| world.simulate(state, &[&next.input])?.end();
        let run = controller.run(&[0.4, 0.5, 1.0, 0.0], STEPS - 2, plant)?;
        assert!(run.moves.iter().all(|next| next.state.len() == 4 && next.input.len() == 2));
        assert!(run.moves[0].source == MoveSource::Optimal);
    }
    Ok(())
}
