//! What has no robust form, and bad input.

use carom::ErrorKind;
use carom::hybrid::{Feedback, RobustError};
use carom::prelude::*;

fn cart() -> Result<(HybridSystem, State, Input), Error> {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", 0.0, 9.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.disturbance(x, -0.1, 0.1)?;
    cart.mode("roll")?.next([x.is(x + u)])?;
    Ok((cart, x, u))
}

fn reason<T>(result: Result<T, Error>) -> Option<RobustError> {
    match result.err()?.kind() {
        ErrorKind::Robust(own) => Some(own.clone()),
        _ => None,
    }
}

#[test]
fn one_value_is_too_little_for_all_runs() -> Result<(), Error> {
    let (cart, x, _) = cart()?;
    let mut program = cart.program(4)?;
    program.start([x.equals(1.0)])?;
    program.goal([x.equals(3.0)])?;
    let error = reason(program.robust(&Feedback::none(&cart)?));
    let Some(RobustError::OneValue { statement, width }) = &error else { panic!("{error:?}") };
    assert_eq!(statement, "goal[4]");
    assert!((width - 0.2).abs() < 1e-12);
    assert_eq!(
        error.map(|error| error.to_string()).as_deref(),
        Some(
            "`goal[4]` requires one value, but disturbed runs differ there by 2.000e-1 or more; give \
             it a range, such as `x.within(lower, upper)`"
        )
    );
    Ok(())
}

#[test]
fn a_tube_is_around_one_system() -> Result<(), Error> {
    let ((cart, ..), (other, ..)) = (cart()?, cart()?);
    let mut program = cart.program(4)?;
    program.join("other", &other)?;
    let error = reason(program.robust(&Feedback::none(&cart)?));
    assert_eq!(error, Some(RobustError::SeveralSystems { count: 2 }));
    Ok(())
}

#[test]
fn a_square_is_no_row_of_a_tube() -> Result<(), Error> {
    let (cart, x, u) = cart()?;
    let mut program = cart.program(3)?;
    program.start([x.equals(1.0)])?;
    let square = program.at(x.square() + u.square(), 2)?;
    program.add("round", square.le(4.0))?;
    let error = reason(program.robust(&Feedback::none(&cart)?));
    let Some(RobustError::Statement { statement, .. }) = error else { panic!("{error:?}") };
    assert_eq!(statement, "round");
    Ok(())
}

#[test]
fn a_gain_fits_its_system() -> Result<(), Error> {
    let (cart, ..) = cart()?;
    let wrong = Feedback::new(&cart, [[1.0, 2.0]]);
    assert!(matches!(wrong.map_err(|e| e.kind().clone()), Err(ErrorKind::Shape { .. })));
    let wrong = Feedback::new(&cart, [[f64::NAN]]);
    assert!(matches!(wrong.map_err(|e| e.kind().clone()), Err(ErrorKind::NotFinite { .. })));
    let mut pair = HybridSystem::new(1.0);
    let [a, b] = [pair.state("a", 0.0, 1.0)?, pair.state("b", 0.0, 1.0)?];
    pair.mode("still")?.next([a.is(a), b.is(b)])?;
    let program = cart.program(3)?;
    let error = reason(program.robust(&Feedback::none(&pair)?));
    assert_eq!(error, Some(RobustError::OtherSystem { found: 2, expected: 1 }));
    Ok(())
}

#[test]
fn a_range_of_a_parameter_contains_zero() -> Result<(), Error> {
    let mut ball = HybridSystem::new(0.1);
    let h = ball.state("h", 0.0, 5.0)?;
    ball.next([h.is(h)])?;
    for (lower, upper) in [(0.1, 0.2), (-0.2, -0.1), (f64::NAN, 1.0), (0.2, -0.2)] {
        let name = format!("from {lower} to {upper}");
        let stated = ball.mode(&name)?.uncertain(lower, upper, [h.is(h.predicted())]);
        assert!(stated.is_err(), "{name}");
    }
    // A function of the start is none of the prediction.
    let stated = ball.mode("start")?.uncertain(-0.1, 0.1, [h.is(h + 1.0)]);
    assert!(matches!(stated.map_err(|e| e.kind().clone()), Err(ErrorKind::Misplaced { .. })));
    Ok(())
}

#[test]
fn an_uncertain_restitution_stays_between_0_and_1() -> Result<(), Error> {
    for (e, spread) in [(0.1, 0.2), (0.9, 0.2), (0.5, -0.1), (0.5, f64::NAN)] {
        let surface = Surface::bounce(Restitution::new(e)?).with_spread(spread);
        let scene = Scene::new(0.1)
            .with_body(Body::new("puck", [0.0..=2.0], 1.0, 1.0))
            .with_obstacle(Solid::halfspace("wall", [-1.0], -1.5, surface));
        assert!(scene.hybrid_system().is_err(), "{e} ± {spread}");
    }
    let rough = Surface::bounce(Restitution::new(0.5)?).with_spread(0.1).with_friction(0.3);
    let scene = Scene::new(0.1)
        .with_body(Body::new("puck", [0.0..=2.0, 0.0..=1.0], 1.0, 1.0))
        .with_obstacle(Solid::halfspace("wall", [-1.0, 0.0], -1.5, rough));
    let text = scene.hybrid_system().err().map(|error| error.to_string()).unwrap_or_default();
    assert!(text.contains("drop `with_spread`"), "{text}");
    Ok(())
}

#[test]
fn a_system_says_what_is_uncertain() -> Result<(), Error> {
    let mut ball = HybridSystem::new(0.1);
    let h = ball.state("h", 0.0, 5.0)?;
    let v = ball.state("v", -9.0, 9.0)?;
    ball.rates([h.is(v), v.is(-9.81)])?;
    ball.mode("flight")?.guard(h.predicted().ge(0.0))?;
    ball.event("bounce")?
        .guard(h.predicted().le(0.0))?
        .reset([h.is(0.0), v.is(-0.3 * v.predicted())])?
        .uncertain(-0.1, 0.2, [v.is(v.predicted())])?;
    assert!(ball.to_string().contains("v+ uncertain by [-0.1, 0.2] times v'"), "{ball}");
    Ok(())
}

#[test]
fn bounds_are_tightened_too() -> Result<(), Error> {
    let (cart, x, _) = cart()?;
    let mut program = cart.program(4)?;
    program.start([x.equals(1.0)])?;
    let last = program.variable(x, 4)?;
    program.model_mut().set_bounds(last, 0.0, 3.0)?;
    program.maximize(program.end(x)?)?;
    let feedback = Feedback::new(&cart, [[-1.0]])?;
    let plan = program.robust(&feedback)?.solve(&mut BranchAndBound::default())?;
    assert!((plan.plan.value(x, 4)? - 2.9).abs() < 1e-5);
    program.model_mut().fix(last, 2.0)?;
    let error = reason(program.robust(&feedback));
    let Some(RobustError::OneValue { statement, .. }) = error else { panic!("{error:?}") };
    assert_eq!(statement, "x[4]");
    Ok(())
}

#[test]
fn ranges_of_disturbances_are_checked() -> Result<(), Error> {
    let bad = [(f64::NAN, 0.1), (0.0, f64::NAN), (0.1, -0.1), (f64::NEG_INFINITY, 0.1)];
    for (lower, upper) in bad {
        let mut cart = HybridSystem::new(1.0);
        let x = cart.state("x", 0.0, 9.0)?;
        assert!(cart.disturbance(x, lower, upper).is_err(), "{lower}..{upper}");
        let puck = Body::new("puck", [0.0..=2.0], 1.0, 1.0).with_pushes([lower..=upper]);
        let scene = Scene::new(0.1).with_body(puck);
        assert!(scene.hybrid_system().is_err(), "{lower}..{upper}");
        let scenario = carom::collision_tolerant::Scenario::paper().with_pushes(lower..=upper);
        assert!(scenario.hybrid_system().is_err(), "{lower}..{upper}");
    }
    Ok(())
}
