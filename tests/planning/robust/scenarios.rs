//! Cases with shared inputs.

use carom::ErrorKind;
use carom::prelude::*;

/// A ball that hits a floor with a restitution, from 2 m; its height, speed and engine.
fn ball(e: f64) -> Result<(HybridSystem, State, State, Input), Error> {
    let mut ball = HybridSystem::new(0.25);
    let h = ball.state("h", 0.0, 6.0)?;
    let v = ball.state("v", -8.0, 8.0)?;
    let u = ball.input("u", -4.0, 4.0)?;
    ball.rates([h.is(v), v.is(u - 3.0)])?;
    ball.mode("flight")?.guard(h.predicted().ge(0.0))?;
    ball.event("bounce")?
        .guard(h.predicted().le(0.0))?
        .guard(v.predicted().le(0.0))?
        .reset([h.is(-e * h.predicted()), v.is(-e * v.predicted())])?;
    Ok((ball, h, v, u))
}

const STEPS: usize = 8;

fn stated(program: &mut HybridProgram, name: &str, h: State, v: State) -> Result<(), Error> {
    program.require(&format!("{name}start"), [h.equals(2.0), v.equals(-1.0)], When::At(0))?;
    program.require(&format!("{name}goal"), [h.within(1.0, 2.0)], When::At(STEPS))?;
    program.require(&format!("{name}floor"), [h.le(0.3)], When::OnceIn(2..=6))
}

#[test]
fn one_case_is_the_nominal_program() -> Result<(), Error> {
    let (first, h, v, u) = ball(0.5)?;
    let mut nominal = first.program(STEPS)?;
    stated(&mut nominal, "", h, v)?;
    nominal.minimize(nominal.sum(u.square())?)?;
    let mut solver = BranchAndBound::default();
    let best = nominal.solve(&mut solver)?.solution.objective().unwrap_or(f64::NAN);
    // The same case twice, with the inputs shared to the end: the mean is the one.
    let (second, g, w, b) = ball(0.5)?;
    let mut twice = first.program(STEPS)?;
    twice.add_case("second", &second, STEPS)?;
    stated(&mut twice, "", h, v)?;
    stated(&mut twice, "second_", g, w)?;
    let cost = twice.sum(0.5 * u.square() + 0.5 * b.square())?;
    twice.minimize(cost)?;
    let both = twice.solve(&mut solver)?.solution.objective().unwrap_or(f64::NAN);
    assert!((best - both).abs() <= 1e-5 * (1.0 + best.abs()), "{best} {both}");
    Ok(())
}

/// The longer inputs are shared, the more a tree costs; and it never costs less than knowing the
/// case.
#[test]
fn a_tree_costs_more_the_later_it_branches() -> Result<(), Error> {
    let mut solver = BranchAndBound::default();
    let mut last = f64::NEG_INFINITY;
    for until in [0, 2, 4, 6] {
        let ((first, h, v, u), (second, g, w, b)) = (ball(0.4)?, ball(0.6)?);
        let mut program = first.program(STEPS)?;
        program.add_case("lively", &second, until)?;
        stated(&mut program, "", h, v)?;
        stated(&mut program, "lively_", g, w)?;
        program.minimize(program.sum(0.5 * u.square() + 0.5 * b.square())?)?;
        let plan = program.solve(&mut solver)?;
        let cost = plan.solution.objective().unwrap_or(f64::NAN);
        assert!(cost >= last - 1e-5, "{until}: {cost} after {last}");
        last = cost;
        let (lively, certificate) = plan.joined("lively")?;
        assert!(certificate.largest_violation <= 1e-5);
        for t in 0..until {
            assert!((plan.run.input("u")?[t] - lively.input("u")?[t]).abs() <= 1e-6);
        }
    }
    Ok(())
}

#[test]
fn bad_cases_are_refused_and_leave_the_program() -> Result<(), Error> {
    let ((first, ..), (second, ..)) = (ball(0.4)?, ball(0.6)?);
    let mut program = first.program(STEPS)?;
    let before = program.model().to_string();
    let error = program.add_case("late", &second, STEPS + 1);
    assert!(matches!(error.map_err(|e| e.kind().clone()), Err(ErrorKind::OutOfRange { .. })));
    let mut other = HybridSystem::new(0.25);
    let x = other.state("x", 0.0, 1.0)?;
    let w = other.input("w", 0.0, 1.0)?;
    other.mode("move")?.next([x.is(x + w)])?;
    let error = program.add_case("other", &other, 2);
    assert!(matches!(error.map_err(|e| e.kind().clone()), Err(ErrorKind::UnknownName { .. })));
    let none: [Affine; 0] = [];
    let error = program.worst("worst", none);
    assert!(matches!(error.map_err(|e| e.kind().clone()), Err(ErrorKind::EmptyRow { .. })));
    assert_eq!(program.model().to_string(), before);
    Ok(())
}
