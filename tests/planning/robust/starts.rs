//! Starts that are not known exactly, and shortest horizons of robust programs.

use carom::ErrorKind;
use carom::collision_tolerant::{Endpoint, Scenario};
use carom::hybrid::{Feedback, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;

use super::{Draw, cases};

#[test]
fn a_start_that_is_known_is_the_robust_program() -> Result<(), Error> {
    for case in [0, 2, 3] {
        let program = cases::program(case, 0.5)?;
        let feedback = Feedback::regulator(program.system())?;
        let x = program.system().state_named(&program.system().parts().states[0].0)?;
        let (plain, zero) =
            (program.robust(&feedback)?, program.robust_from(&feedback, [(x, 0.0..=0.0)])?);
        assert_eq!(plain.program().model().to_string(), zero.program().model().to_string());
    }
    Ok(())
}

#[test]
fn every_start_of_a_box_keeps_the_plan() -> Result<(), Error> {
    let mut found = 0;
    for case in 0..12 {
        let mut draw = Draw::new(case + 100);
        let program = cases::program(case, 0.2)?;
        let feedback = Feedback::regulator(program.system())?;
        let system = program.system().clone();
        let names: Vec<String> =
            system.parts().states.iter().map(|(name, _)| name.clone()).collect();
        let mut start = Vec::new();
        for name in &names {
            let half = draw.within(0.002, 0.01);
            start.push((system.state_named(name)?, -half..=0.7 * half));
        }
        let Ok(plan) =
            program.robust_from(&feedback, start.clone())?.solve(&mut BranchAndBound::default())
        else {
            continue;
        };
        found += 1;
        assert!(plan.to_string().contains(&format!("{} at the start by", names[0])));
        for run in 0..200_u64 {
            let mut asked = 0;
            let flown = plan.simulate(&mut |range| {
                asked += 1;
                match run {
                    0 => range.lower,
                    1 => range.upper,
                    _ if draw.unit() < 0.3 => draw.within(range.lower, range.upper),
                    _ if draw.unit() < 0.5 => range.lower,
                    _ => range.upper,
                }
            })?;
            assert!(asked >= names.len());
            assert!(flown.kept, "case {case}, run {run}: {:?}", flown.deviation);
            for (i, (name, values)) in flown.run.states.iter().enumerate() {
                for (t, (x, z)) in values.iter().zip(plan.plan.run.state(name)?).enumerate() {
                    let Interval { lower, upper } = plan.certificate.states[t][i];
                    assert!(
                        lower - 1e-9 <= x - z && x - z <= upper + 1e-9,
                        "case {case}: {}",
                        x - z
                    );
                }
            }
        }
    }
    assert!(found >= 5, "{found}");
    Ok(())
}

#[test]
fn a_box_at_the_start_takes_room_at_once() -> Result<(), Error> {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", 0.0, 9.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.mode("roll")?.next([x.is(x + u)])?;
    let mut program = cart.program(3)?;
    program.start([x.within(0.0, 2.0)])?;
    program.maximize(program.end(x)? - 2.0 * program.at(x, 0)?)?;
    let feedback = Feedback::new(&cart, [[-0.5]])?;
    let robust = program.robust_from(&feedback, [(x, -0.3..=0.2)])?;
    let plan = robust.solve(&mut BranchAndBound::default())?;
    // All starts are in the domain, and the first input leaves room for what the feedback adds.
    assert!((plan.plan.value(x, 0)? - 0.3).abs() < 1e-5, "{}", plan.plan.value(x, 0)?);
    assert!(plan.plan.value(u, 0)? <= 0.85 + 1e-5);
    assert!(plan.certify(1.0).is_ok() && plan.certify(1.2).is_err());
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let error = plan.certify(bad).map(drop).map_err(|error| error.kind().clone());
        assert!(matches!(error, Err(ErrorKind::OutOfRange { .. })), "{bad}");
    }
    let kind = |start: &[(State, Interval)]| {
        let made = program.robust_from(&feedback, start.iter().copied());
        made.err().map(|error| error.kind().clone())
    };
    let range = Interval::new(-0.1, 0.1);
    assert!(matches!(kind(&[(x, range), (x, range)]), Some(ErrorKind::DuplicateName { .. })));
    assert!(kind(&[(x, Interval::new(0.1, -0.1))]).is_some());
    assert!(kind(&[(x, Interval::new(f64::NAN, 0.1))]).is_some());
    assert!(kind(&[(x, Interval::new(0.0, f64::INFINITY))]).is_some());
    let mut other = HybridSystem::new(1.0);
    let y = other.state("y", 0.0, 1.0)?;
    assert!(matches!(kind(&[(y, range)]), Some(ErrorKind::ForeignHandle { .. })));
    Ok(())
}

/// Each smaller number of steps is solved by itself.
#[test]
fn the_shortest_robust_plan_is_the_first_that_solves() -> Result<(), Error> {
    let mut draw = Draw::new(3);
    let mut longer = 0;
    for _ in 0..4 {
        let mut cart = HybridSystem::new(0.5);
        let x = cart.state("x", -1.0, 9.0)?;
        let v = cart.state("v", -2.0, 2.0)?;
        let a = cart.input("a", -1.0, 1.0)?;
        let push = draw.within(0.01, 0.04);
        cart.disturbance(v, -push, push)?;
        let sand = draw.within(0.8, 1.4);
        cart.mode("road")?.rates([x.is(v), v.is(a)])?.guard(x.le(sand))?;
        cart.mode("sand")?.rates([x.is(v), v.is(0.8 * a - 0.1 * v)])?.guard(x.ge(sand))?;
        let (start, goal) =
            ([x.equals(0.0), v.equals(0.0)], [x.within(1.8, 2.6), v.within(-0.4, 0.4)]);
        let feedback = Feedback::regulator(&cart)?;
        let mut solver = BranchAndBound::default();
        let mut first = None;
        for steps in 1..=20 {
            let mut program = cart.program(steps)?;
            program.start(start.clone())?;
            program.goal(goal.clone())?;
            if program.robust(&feedback)?.solve(&mut solver).is_ok() {
                first = Some(steps);
                break;
            }
        }
        let options = ShortestOptions::default().with_max_steps(20);
        let found =
            cart.shortest_robust(start.clone(), goal.clone(), &feedback, &options, &mut solver)?;
        assert_eq!(found.steps, first);
        assert!(first.is_none() || !found.monotonicity.is_monotone());
        let nominal = cart.shortest_with(start, goal, &options, &mut solver)?;
        assert!(nominal.steps <= found.steps);
        longer += usize::from(nominal.steps < found.steps);
        if let Some(plan) = found.plan {
            assert!(plan.simulate(&mut |range| range.lower)?.kept);
        }
    }
    assert!(longer > 0);
    Ok(())
}

#[test]
fn scenes_and_the_papers_vehicle_have_shortest_robust_plans() -> Result<(), Error> {
    let surface = Surface::bounce(Restitution::new(0.4)?).with_spread(0.05);
    let puck = |push: f64| {
        Body::new("puck", [0.0..=3.0], 2.0, 3.0)
            .with_pushes([-push..=push])
            .with_start([0.4, 0.0])
            .with_goal([2.2..=2.6, -0.5..=0.5])
    };
    let scene = |push: f64| {
        let wall = Solid::halfspace("wall", [-1.0], -2.8, surface);
        Scene::new(0.25).with_body(puck(push)).with_obstacle(wall)
    };
    let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    let feedback = Feedback::regulator(&scene(0.03).hybrid_system()?)?;
    let found = scene(0.03).shortest_robust(&feedback, &options, &mut solver)?;
    let nominal = scene(0.03).shortest_with(&options, &mut solver)?;
    assert!(found.steps.is_some() && nominal.steps <= found.steps);
    let steps = found.steps.unwrap_or(0);
    let fewer = scene(0.03).program(steps - 1)?.program().robust(&feedback)?.solve(&mut solver);
    assert!(matches!(fewer.map_err(|e| e.kind().clone()), Err(ErrorKind::NoPlan { .. })));

    let mut from = Endpoint::at_rest(4.5);
    from.velocity = -9.0;
    let scenario = Scenario::paper().with_time_step(0.1).with_restitution(0.3)?.with_spread(0.03);
    let scenario = scenario.with_goal_region(Region::from([0.1..=0.8, -0.5..=1.5]));
    let scenario = scenario.with_start(from).with_pushes(-0.02..=0.02);
    let feedback = Feedback::regulator(&scenario.hybrid_system()?)?;
    let options = options.with_max_steps(12);
    let found = scenario.shortest_robust(&feedback, &options, &mut solver)?;
    assert!(found.steps.is_some_and(|steps| steps <= 9), "{:?}", found.steps);
    assert!(found.plan.is_some_and(|plan| plan.to_string().starts_with("for every disturbance")));
    Ok(())
}
