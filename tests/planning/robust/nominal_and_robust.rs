//! Without disturbance a tube is none; with one, a plan costs more and says what it promises.

use carom::ErrorKind;
use carom::hybrid::{Feedback, RobustError};
use carom::prelude::*;

use super::cases;

fn cart(push: f64) -> Result<(HybridSystem, State, State, Input), Error> {
    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", 0.0, 9.0)?;
    let v = cart.state("v", -2.0, 2.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    if push > 0.0 {
        cart.disturbance(v, -push, push)?;
    }
    cart.mode("roll")?.rates([x.is(v), v.is(u)])?;
    Ok((cart, x, v, u))
}

#[test]
fn without_disturbance_the_optimum_is_the_nominal_one() -> Result<(), Error> {
    let mut found = 0;
    for case in 0..20 {
        let program = cases::program(case, 0.0)?;
        let feedback = Feedback::regulator(program.system())?;
        let robust = program.robust(&feedback)?;
        let mut solver = BranchAndBound::default();
        let (nominal, tube) = (program.solve(&mut solver), robust.solve(&mut solver));
        let (Ok(nominal), Ok(tube)) = (&nominal, &tube) else {
            assert!(nominal.is_err() && tube.is_err(), "case {case}");
            continue;
        };
        found += 1;
        let price = tube.price(nominal).unwrap_or(f64::NAN);
        assert!(price.abs() <= 1e-5, "case {case}: {price}");
        assert!(tube.to_string().starts_with("nothing disturbs the system"));
        assert!(!nominal.to_string().contains("nominal"));
    }
    assert!(found >= 15, "{found}");
    Ok(())
}

#[test]
fn ranges_that_are_a_point_at_zero_tighten_nothing() -> Result<(), Error> {
    let (mut cart, x, v, u) = cart(0.0)?;
    cart.disturbance(v, 0.0, 0.0)?;
    let mut program = cart.program(6)?;
    program.start([x.equals(1.0), v.equals(0.0)])?;
    program.goal([x.equals(3.0), v.equals(0.0)])?;
    program.minimize(program.sum(u.square())?)?;
    let robust = program.robust(&Feedback::none(&cart)?)?;
    let same = (robust.program().model().constraint_count(), program.model().constraint_count());
    assert_eq!(same.0, same.1);
    Ok(())
}

#[test]
fn a_promise_has_a_price_and_words() -> Result<(), Error> {
    let (cart, x, v, u) = cart(0.05)?;
    let mut program = cart.program(6)?;
    program.start([x.equals(1.0), v.equals(0.0)])?;
    program.goal([x.within(2.8, 3.2), v.within(-0.3, 0.3)])?;
    program.minimize(program.sum(u.square())?)?;
    let mut solver = BranchAndBound::default();
    let nominal = program.solve(&mut solver)?;
    assert!(nominal.to_string().starts_with("# nominal: "));
    let tube = program.robust(&Feedback::regulator(&cart)?)?.solve(&mut solver)?;
    assert!(tube.price(&nominal).is_some_and(|price| price > 1e-3));
    let text = tube.to_string();
    let promise = "for every disturbance in these ranges, in every step anew, the run takes these \
                   transitions and keeps every limit: v by [-0.05, 0.05]";
    assert_eq!(text.lines().next(), Some(promise));
    assert!(text.contains("x stays within"));
    Ok(())
}

/// The certificate is tight: for larger ranges it fails, and then some disturbance does what it
/// says.
#[test]
fn a_certificate_fails_where_a_run_does() -> Result<(), Error> {
    let (cart, x, v, _) = cart(0.05)?;
    let mut program = cart.program(6)?;
    program.start([x.equals(1.0), v.equals(0.0)])?;
    program.goal([v.within(-0.5, 0.5)])?;
    program.require("room", [x.le(8.0)], When::Throughout(0..=6))?;
    program.maximize(program.end(x)?)?;
    // The fastest plan has no more room than the tube takes.
    program.require("slow", [v.le(1.2)], When::Throughout(0..=6))?;
    let feedback = Feedback::none(&cart)?;
    let tube = program.robust(&feedback)?.solve(&mut BranchAndBound::default())?;
    assert!(tube.certify(1.0).is_ok() && tube.certify(0.5).is_ok());
    let (mut holds, mut fails) = (1.0, 4.0);
    assert!(tube.certify(fails).is_err());
    for _ in 0..40 {
        let middle = 0.5 * (holds + fails);
        match tube.certify(middle) {
            Ok(_) => holds = middle,
            Err(_) => fails = middle,
        }
    }
    // The plan is the fastest, so there is no more room than for the ranges themselves.
    assert!(holds < 1.0 + 1e-3, "{holds}");
    let error = tube.certify(1.05);
    let Err(error) = error else { panic!("certified too much") };
    let ErrorKind::Robust(own) = error.kind() else { panic!("{error}") };
    assert!(matches!(own, RobustError::Violated { .. } | RobustError::Condition { .. }));
    let run = tube.simulate(&mut |range| 1.05 * range.upper)?;
    let speeds = run.run.state("v")?;
    let ends = run.run.state("x")?;
    let beyond = speeds.iter().any(|v| *v > 1.2 + 1e-4) || speeds[6].abs() > 0.5 + 1e-4;
    assert!(beyond || ends.iter().any(|x| *x > 8.0 + 1e-4), "{speeds:?}");
    Ok(())
}

#[test]
fn a_mode_is_taken_only_if_every_run_takes_it() -> Result<(), Error> {
    // Beyond 3 m the ground is another one; the start of a step is on one side for all runs.
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", 0.0, 9.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.disturbance(x, -0.2, 0.2)?;
    cart.mode("road")?.next([x.is(x + u)])?.guard(x.le(3.0))?;
    cart.mode("sand")?.next([x.is(x + 0.5 * u)])?.guard(x.ge(3.0))?;
    let mut program = cart.program(3)?;
    program.start([x.equals(2.0)])?;
    program.require("near", [x.within(1.0, 9.0)], When::Throughout(0..=3))?;
    program.maximize(program.end(x)?)?;
    let mut solver = BranchAndBound::default();
    let nominal = program.solve(&mut solver)?;
    assert!((nominal.value(x, 1)? - 3.0).abs() < 1e-6);
    let feedback = Feedback::none(&cart)?;
    let tube = program.robust(&feedback)?.solve(&mut solver)?;
    // Either 2.8 m or less: after one step the tube is 0.2 m to both sides.
    let at = tube.plan.value(x, 1)?;
    assert!(at <= 2.8 + 1e-6, "{at}");
    assert!(tube.simulate(&mut |range| range.lower)?.kept);
    let mut other = 0;
    let mut draws = [1.0, -1.0, 1.0, -1.0].into_iter().cycle();
    for _ in 0..4 {
        let run = cart.fly(&nominal.run, [[0.0]], &mut |_| 0.2 * draws.next().unwrap_or(1.0))?;
        other += usize::from(!run.kept);
    }
    assert!(other > 0);
    Ok(())
}

/// A controller that plans robustly leaves room for the next push; one that plans nominally does
/// not.
#[test]
fn a_controller_leaves_room_for_the_next_push() -> Result<(), Error> {
    let (mut cart, x, v, _) = cart(0.05)?;
    cart.limit("slow", v.le(1.0))?;
    let mut program = cart.program(4)?;
    program.maximize(program.end(x)?)?;
    let robust: HybridProgram = program.robust(&Feedback::none(&cart)?)?.into();
    // Every push is the largest one.
    let plant = |state: &[f64], next: &ControlMove| {
        let run = cart.simulate(state, &[&next.input])?;
        Ok(run.end()?.iter().zip([0.0, 0.05]).map(|(x, w)| x + w).collect())
    };
    let mut solver = BranchAndBound::default();
    let run = RecedingHorizon::new(robust, &mut solver)?.run(&[0.0, 0.0], 6, plant)?;
    let most = run.states.iter().map(|state| state[1]).fold(0.0, f64::max);
    assert!((most - 1.0).abs() <= 1e-5, "{most}");
    Ok(())
}
