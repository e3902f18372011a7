//! Random systems and scenes with disturbances, and their programs.

use carom::collision_tolerant::{Endpoint, Objective, Scenario};
use carom::hybrid::{HybridProgram, HybridSystem, Restitution};
use carom::prelude::*;

use super::Draw;

/// A program from a start to a goal, for a case, with disturbances times a factor.
pub(crate) fn program(case: u64, factor: f64) -> Result<HybridProgram, Error> {
    let mut draw = Draw::new(case + 1);
    match case % 6 {
        0 => gears(&mut draw, factor),
        1 => bounce(&mut draw, factor),
        2 => turned(&mut draw, factor),
        3 => thrusters(&mut draw, factor),
        4 => scene(&mut draw, factor),
        _ => beside_a_wall(&mut draw, factor),
    }
}

/// A cart with two gears that differ in drag and strength.
fn gears(draw: &mut Draw, factor: f64) -> Result<HybridProgram, Error> {
    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", -1.0, 12.0)?;
    let v = cart.state("v", -3.0, 3.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    let push = factor * draw.within(0.01, 0.04);
    cart.disturbance(x, -0.5 * push, 0.3 * push)?;
    cart.disturbance(v, -push, push)?;
    let split = draw.within(0.6, 1.2);
    let (low, high) = (draw.within(0.5, 0.9), draw.within(0.9, 1.4));
    let drag = draw.within(0.0, 0.3);
    cart.mode("low gear")?.rates([x.is(v), v.is(low * u)])?.guard(v.le(split))?;
    let fast = cart.mode("high gear")?.rates([x.is(v), v.is(high * u - drag * v)])?;
    fast.guard(v.ge(split))?;
    cart.limit("slow at the end", (x + 3.0 * v).le(14.0))?;
    let end = draw.within(1.8, 2.6);
    let mut program = cart.program(9)?;
    program.start([x.equals(0.0), v.equals(0.0)])?;
    program.goal([x.within(end - 0.5, end + 0.5), v.within(-0.4, 0.4)])?;
    program.require("way", [x.ge(0.4 * end)], When::OnceIn(3..=6))?;
    let fuel = program.sum_abs("fuel", u)?;
    program.minimize(fuel)?;
    Ok(program)
}

/// A ball on a line with an engine, a floor and an uncertain restitution.
fn bounce(draw: &mut Draw, factor: f64) -> Result<HybridProgram, Error> {
    let mut ball = HybridSystem::new(0.25);
    let h = ball.state("h", 0.0, 6.0)?;
    let v = ball.state("v", -8.0, 8.0)?;
    let u = ball.input("u", -4.0, 4.0)?;
    ball.disturbance(v, -0.02 * factor, 0.03 * factor)?;
    let e = draw.within(0.4, 0.7);
    let spread = factor * draw.within(0.02, 0.05);
    ball.rates([h.is(v), v.is(u - 3.0)])?;
    ball.mode("flight")?.guard(h.predicted().ge(0.0))?;
    ball.event("bounce")?
        .guard(h.predicted().le(0.0))?
        .guard(v.predicted().le(0.0))?
        .reset([h.is(-e * h.predicted()), v.is(-e * v.predicted())])?
        .uncertain(-spread, spread, [h.is(h.predicted()), v.is(v.predicted())])?
        .uncertain(0.0, 0.01 * factor, [v.is(1.0)])?;
    let from = draw.within(1.5, 2.5);
    let mut program = ball.program(8)?;
    program.start([h.equals(from), v.equals(-1.0)])?;
    program.goal([h.within(1.0, 2.0), v.within(-1.5, 1.5)])?;
    program.require("at the floor", [h.le(0.45)], When::OnceIn(2..=6))?;
    program.minimize(program.sum(u.square())?)?;
    Ok(program)
}

/// Two coupled states that turn, in three regions of the plane, with a disc to stay in.
fn turned(draw: &mut Draw, factor: f64) -> Result<HybridProgram, Error> {
    let mut plane = HybridSystem::new(1.0);
    let x = plane.state("x", -6.0, 6.0)?;
    let y = plane.state("y", -6.0, 6.0)?;
    let u = plane.input("u", -1.5, 1.5)?;
    let w = plane.input("w", -1.5, 1.5)?;
    let by = factor * draw.within(0.02, 0.06);
    plane.disturbance(x, -by, by)?;
    plane.disturbance(y, -by, by)?;
    for (name, lower, upper) in [("left", -6.0, -1.0), ("middle", -1.0, 1.5), ("right", 1.5, 6.0)] {
        let (sin, cos) = draw.within(-0.4, 0.4).sin_cos();
        let size = draw.within(0.8, 1.05);
        plane
            .mode(name)?
            .next([
                x.is(size * cos * x - size * sin * y + u),
                y.is(size * sin * x + size * cos * y + w),
            ])?
            .guard(x.within(lower, upper))?;
    }
    plane.limit("disc", norm([x, y]).le(5.5))?;
    let mut program = plane.program(7)?;
    program.start([x.equals(-4.0), y.equals(draw.within(-1.0, 1.0))])?;
    program.goal([x.within(3.0, 4.5), y.within(-0.8, 0.8)])?;
    program.require("near", norm([x - 2.0, y - 1.0]).le(1.5), When::OnceIn(4..=6))?;
    let way = program.sum_abs("way", u)? + program.sum_abs("lift", w)?;
    program.minimize(way)?;
    Ok(program)
}

/// A mass with a fan that is on or off and a brake that slows it, two choices in every step.
fn thrusters(draw: &mut Draw, factor: f64) -> Result<HybridProgram, Error> {
    let mut mass = HybridSystem::new(0.5);
    let x = mass.state("x", 0.0, 10.0)?;
    let v = mass.state("v", -2.0, 2.0)?;
    let u = mass.input("u", -0.6, 0.6)?;
    mass.disturbance(v, -0.03 * factor, 0.02 * factor)?;
    mass.next([x.is(x + 0.5 * v), v.is(v + 0.5 * u)])?;
    let gust = factor * draw.within(0.0, 0.03);
    mass.mode_of("fan", "off")?;
    mass.mode_of("fan", "on")?.next([x.is(x + 0.5 * v), v.is(v + 0.5 * u + 0.3)])?.uncertain(
        -gust,
        gust,
        [v.is(1.0)],
    )?;
    mass.mode_of("brake", "open")?;
    mass.mode_of("brake", "closed")?.next([x.is(x + 0.5 * v), v.is(0.7 * v + 0.5 * u)])?;
    let mut program = mass.program(8)?;
    program.start([x.equals(0.5), v.equals(0.0)])?;
    program.goal([x.within(4.0, 5.0), v.within(-0.4, 0.4)])?;
    program.minimize(program.sum(u.square())?)?;
    Ok(program)
}

/// A puck that may bounce off a wall, under pushes.
fn scene(draw: &mut Draw, factor: f64) -> Result<HybridProgram, Error> {
    let e = draw.within(0.3, 0.6);
    let surface = Surface::bounce(Restitution::new(e)?).with_spread(factor * 0.03);
    let push = 0.01 * factor;
    let y = draw.within(0.4, 0.6);
    let block = [1.2..=1.5, -0.1..=draw.within(0.3, 0.5)];
    let scene = Scene::new(0.25)
        .with_body(
            Body::new("puck", [0.0..=3.0, 0.0..=1.4], 2.0, 3.0)
                .with_pushes([-push..=push, -push..=push])
                .with_start([0.4, y, 0.0, 0.0])
                .with_goal([2.2..=2.6, 0.3..=1.0, -0.6..=0.6, -0.6..=0.6]),
        )
        .with_obstacle(Solid::halfspace("wall", [-1.0, 0.0], -2.8, surface))
        .with_obstacle(Solid::cuboid("block", &block, Surface::avoid()));
    let mut program = scene.program(8)?;
    program.minimize(program.effort()?)?;
    Ok(program.into())
}

/// The paper's vehicle beside a wall with an uncertain restitution, fast enough that it has to hit.
fn beside_a_wall(draw: &mut Draw, factor: f64) -> Result<HybridProgram, Error> {
    let push = 0.02 * factor;
    let goal = Region::from([0.1..=0.8, -0.5..=1.5]);
    let scenario = Scenario::paper()
        .with_time_step(0.1)
        .with_restitution(draw.within(0.2, 0.4))?
        .with_spread(0.05 * factor)
        .with_pushes(-push..=push)
        .with_goal_region(goal);
    let mut from = Endpoint::at_rest(draw.within(4.0, 5.0));
    from.velocity = -9.0;
    Ok(scenario.with_start(from).program(9, Objective::Effort)?.into())
}
