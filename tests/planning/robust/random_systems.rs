//! Random systems and scenes of kinds that could break a tube: feedbacks that do not stabilise,
//! ranges without 0, modes that last, resets that mix states, functions of states, pairs of bodies,
//! friction, obstacles that move.

use carom::hybrid::{Feedback, HybridRun, Restitution};
use carom::prelude::*;

use super::Draw;

/// A program with its feedback, and by how much a run misses what the program requires besides its
/// system.
pub(crate) type Kind = (HybridProgram, Feedback, Box<dyn Fn(&HybridRun) -> f64>);

pub(crate) const KINDS: u64 = 9;

/// By how much values leave a range.
fn beyond(values: impl IntoIterator<Item = f64>, lower: f64, upper: f64) -> f64 {
    values.into_iter().map(|value| (value - upper).max(lower - value)).fold(0.0, f64::max)
}

fn of<'a>(run: &'a HybridRun, state: &str) -> &'a [f64] {
    run.state(state).unwrap_or_default()
}

fn last(run: &HybridRun, state: &str) -> f64 {
    of(run, state).last().copied().unwrap_or(f64::NAN)
}

pub(crate) fn kind(case: u64, factor: f64) -> Result<Kind, Error> {
    let mut draw = Draw::new(case + 17);
    match case % KINDS {
        0 => unstable(&mut draw, factor),
        1 => swapped(&mut draw, factor),
        2 => lasting(&mut draw, factor),
        3 => functions(&mut draw, factor),
        4 => pair(&mut draw, factor),
        5 => friction(&mut draw, factor),
        6 => moving(&mut draw, factor),
        7 => turning(&mut draw, factor),
        _ => constant(&mut draw, factor),
    }
}

/// A state that grows by itself under a feedback that makes it worse, or under none.
fn unstable(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -8.0, 8.0)?;
    let u = system.input("u", -2.0, 2.0)?;
    system.disturbance(x, -0.03 * factor, 0.05 * factor)?;
    let (growth, split) = (draw.within(1.0, 1.3), draw.within(-0.5, 0.5));
    system.mode("below")?.next([x.is(growth * x + u)])?.guard(x.le(split))?;
    system.mode("above")?.next([x.is(0.9 * x + u)])?.guard(x.ge(split))?;
    let mut program = system.program(6)?;
    program.start([x.equals(-2.0)])?;
    program.goal([x.within(1.0, 3.0)])?;
    program.minimize(program.sum(u.square())?)?;
    let feedback = Feedback::new(&system, [[draw.within(0.0, 0.2)]])?;
    Ok((program, feedback, Box::new(|run| beyond([last(run, "x")], 1.0, 3.0))))
}

/// Three states that a hit mixes, with two uncertain parameters of ranges that end at 0.
fn swapped(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let mut system = HybridSystem::new(0.5);
    let x = system.state("x", -2.0, 6.0)?;
    let v = system.state("v", -4.0, 4.0)?;
    let w = system.state("w", -4.0, 4.0)?;
    let u = system.input("u", -2.0, 2.0)?;
    system.disturbance(v, 0.0, 0.03 * factor)?;
    system.disturbance(w, -0.02 * factor, 0.0)?;
    system.next([x.is(x + 0.5 * v), v.is(v + 0.5 * u), w.is(0.9 * w + 0.1 * v)])?;
    system.mode("free")?.guard(x.predicted().ge(0.0))?;
    let share = draw.within(0.3, 0.6);
    system
        .event("hit")?
        .guard(x.predicted().le(0.0))?
        .guard(v.predicted().le(0.0))?
        .reset([
            x.is(-share * x.predicted()),
            v.is(-share * v.predicted() + 0.2 * w.predicted()),
            w.is(0.5 * w.predicted() - 0.2 * v.predicted()),
        ])?
        .uncertain(0.0, 0.1 * factor, [v.is(v.predicted()), x.is(x.predicted())])?
        .uncertain(-0.05 * factor, 0.0, [w.is(v.predicted() + 0.1)])?;
    let mut program = system.program(7)?;
    program.start([x.equals(1.5), v.equals(-1.5), w.equals(0.0)])?;
    program.goal([x.within(0.5, 2.0), v.within(-0.8, 0.8), w.within(-1.0, 1.0)])?;
    program.require("near", [x.le(0.6)], When::OnceIn(1..=4))?;
    program.minimize(program.sum(u.square())?)?;
    let feedback = Feedback::regulator(&system)?;
    let miss = |run: &HybridRun| {
        let near = of(run, "x")[1..=4].iter().copied().fold(f64::INFINITY, f64::min) - 0.6;
        let ends =
            [(last(run, "x"), 0.5, 2.0), (last(run, "v"), -0.8, 0.8), (last(run, "w"), -1.0, 1.0)];
        ends.iter()
            .map(|(x, lower, upper)| beyond([*x], *lower, *upper))
            .fold(near.max(0.0), f64::max)
    };
    Ok((program, feedback, Box::new(miss)))
}

/// A heater that stays on or off, under weather.
fn lasting(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let mut room = HybridSystem::new(300.0);
    let t = room.state("t", 5.0, 40.0)?;
    let p = room.input("p", 0.0, 1.0)?;
    room.disturbance(t, -0.2 * factor, 0.3 * factor)?;
    let [off, on] = room.modes("heater", ["off", "on"])?;
    let keep = draw.within(0.8, 0.9);
    let cooled = keep * t + (1.0 - keep) * 10.0;
    room.stay(off)?.next([t.is(cooled.clone() + 0.5 * p)])?.guard(t.ge(18.0))?;
    room.stay(on)?.next([t.is(cooled.clone() + 4.0 + 0.5 * p)])?.guard(t.le(24.0))?;
    room.switch(off, on)?.next([t.is(cooled.clone() + 0.5 * p)])?.guard(t.le(20.5))?;
    room.switch(on, off)?.next([t.is(cooled + 0.5 * p)])?.guard(t.ge(20.0))?;
    let mut program = room.program(8)?;
    program.start([t.equals(21.0)])?;
    program.require("warm", [t.within(17.5, 25.0)], When::Throughout(2..=8))?;
    program.minimize(program.sum(p)?)?;
    let feedback = Feedback::none(&room)?;
    let miss = |run: &HybridRun| beyond(of(run, "t")[2..].iter().copied(), 17.5, 25.0);
    Ok((program, feedback, Box::new(miss)))
}

/// Limits of magnitudes, of a maximum and of sums that rows define by each other, in both orders.
fn functions(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -6.0, 6.0)?;
    let y = system.state("y", -6.0, 6.0)?;
    let u = system.input("u", -2.0, 2.0)?;
    let w = system.input("w", -2.0, 2.0)?;
    system.disturbance(x, -0.1 * factor, 0.1 * factor)?;
    system.disturbance(y, -0.05 * factor, 0.1 * factor)?;
    system.mode("drift")?.next([x.is(x + u), y.is(0.9 * y + 0.1 * x + w)])?;
    let mut program = system.program(5)?;
    program.start([x.equals(0.0), y.equals(0.0)])?;
    let most = draw.within(2.0, 3.0);
    for t in 1..=5 {
        let model = program.model_mut();
        // The sum comes before its parts, and its magnitude is taken of what a row defines.
        let [sum, part] = ["sum", "part"].map(|name| model.continuous((name, t), -20.0, 20.0));
        let (sum, part) = (sum?, part?);
        let size = model.absolute(("size", t), sum)?;
        let larger = model.maximum(("larger", t), [Affine::from(sum), 1.0 * part])?;
        program.add(("size most", t), size.le(most))?;
        program.add(("larger most", t), larger.le(most))?;
        program.add(("sum is", t), (sum - part).equals(program.at(y, t)?))?;
        program.add(("part is", t), part.equals(program.at(x - 0.5 * y, t)?))?;
    }
    program.maximize(program.end(x + 0.3 * y)?)?;
    let feedback = Feedback::new(&system, [[-0.4, 0.0], [0.0, -0.3]])?;
    let miss = move |run: &HybridRun| {
        let pairs = of(run, "x").iter().zip(of(run, "y"));
        let sizes = pairs.map(|(x, y)| (x + 0.5 * y).abs().max(x - 0.5 * y));
        beyond(sizes, -20.0, most)
    };
    Ok((program, feedback, Box::new(miss)))
}

/// Two pucks on a line, one of which pushes the other, with an uncertain restitution.
fn pair(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let push = 0.01 * factor;
    let mut scene = Scene::new(0.25);
    let puck = |name: &str, from: [f64; 2], to: [std::ops::RangeInclusive<f64>; 2]| {
        Body::new(name, [0.0..=5.0], 2.5, 2.0)
            .with_pushes([-push..=push])
            .with_start(from)
            .with_goal(to)
    };
    let speed = draw.within(0.8, 1.4);
    let first = scene.body(puck("a", [0.5, speed], [0.4..=2.2, -1.2..=1.2]))?;
    let second = scene.body(puck("b", [1.5, 0.0], [1.8..=3.2, -1.5..=1.5]))?;
    scene.pair(
        first,
        second,
        Surface::bounce(Restitution::new(0.5)?).with_spread(0.04 * factor),
    )?;
    let mut program = scene.program(7)?;
    let (effort, hits) = (program.effort()?, program.hits());
    program.add("they meet", hits.ge(1.0))?;
    program.minimize(effort)?;
    let feedback = Feedback::regulator(program.system())?;
    let miss = |run: &HybridRun| {
        beyond([last(run, "a x")], 0.4, 2.2).max(beyond([last(run, "b x")], 1.8, 3.2))
    };
    Ok((program.into(), feedback, Box::new(miss)))
}

/// A puck that slides along a rough wall of a known restitution.
fn friction(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let push = 0.01 * factor;
    let rough = Surface::bounce(Restitution::new(0.5)?).with_friction(draw.within(0.1, 0.3));
    let scene = Scene::new(0.25)
        .with_body(
            Body::new("puck", [0.0..=3.0, 0.0..=2.0], 2.5, 2.5)
                .with_pushes([-push..=push, -0.5 * push..=push])
                .with_start([0.4, 0.4, 1.2, -0.8])
                .with_goal([1.8..=2.6, 0.2..=1.2, -0.8..=0.8, -0.8..=0.8]),
        )
        .with_obstacle(Solid::halfspace("floor", [0.0, 1.0], 0.1, rough));
    let mut program = scene.program(7)?;
    let (effort, hits) = (program.effort()?, program.hits());
    program.add("it hits", hits.ge(1.0))?;
    program.minimize(effort)?;
    let feedback = Feedback::regulator(program.system())?;
    let miss = |run: &HybridRun| beyond([last(run, "puck x")], 1.8, 2.6);
    Ok((program.into(), feedback, Box::new(miss)))
}

/// A gate that moves, with a slanted face, to be avoided.
fn moving(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let push = 0.01 * factor;
    let rate = draw.within(-0.1, 0.1);
    let course = (0..=8).map(|t| vec![0.0, rate * f64::from(t)]);
    let gate = Solid::polytope(
        "gate",
        [(vec![-1.0, 0.2], -1.1), (vec![1.0, 0.2], 1.9), (vec![0.0, 1.0], 0.7)],
        Surface::avoid(),
    );
    let scene = Scene::new(0.25)
        .with_body(
            Body::new("puck", [0.0..=3.0, 0.0..=2.0], 2.5, 3.0)
                .with_pushes([-push..=push, -push..=push])
                .with_start([0.3, 0.5, 0.0, 0.0])
                .with_goal([2.2..=2.8, 0.2..=1.4, -1.0..=1.0, -1.0..=1.0]),
        )
        .with_obstacle(gate.with_course(course));
    let mut program = scene.program(8)?;
    program.minimize(program.effort()?)?;
    let feedback = Feedback::regulator(program.system())?;
    let miss = |run: &HybridRun| beyond([last(run, "puck x")], 2.2, 2.8);
    Ok((program.into(), feedback, Box::new(miss)))
}

/// A plane that turns, where boxes along no direction shrink, with a mode on each side of a slanted
/// line.
fn turning(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let mut plane = HybridSystem::new(1.0);
    let x = plane.state("x", -6.0, 6.0)?;
    let y = plane.state("y", -6.0, 6.0)?;
    let u = plane.input("u", -1.5, 1.5)?;
    plane.disturbance(x, -0.02 * factor, 0.01 * factor)?;
    plane.disturbance(y, 0.0, 0.02 * factor)?;
    let (sin, cos) = draw.within(0.5, 0.9).sin_cos();
    let next = [x.is(cos * x - sin * y + u), y.is(sin * x + cos * y)];
    plane.mode("over")?.next(next.clone())?.guard((y - 0.5 * x).ge(0.1))?;
    let under = plane.mode("under")?.next(next)?.guard((y - 0.5 * x).le(0.1))?;
    under.uncertain(-0.01 * factor, 0.02 * factor, [x.is(y.predicted() + 0.1)])?;
    let mut program = plane.program(6)?;
    program.start([x.equals(-2.0), y.equals(1.0)])?;
    program.goal([x.within(-1.5, 1.5), y.within(-1.5, 1.5)])?;
    program.require("disc", norm([x, y]).le(4.0), When::Throughout(1..=6))?;
    let way = program.sum_abs("way", u)?;
    program.minimize(way)?;
    let feedback = Feedback::regulator(&plane)?;
    let miss = |run: &HybridRun| {
        let sizes = of(run, "x").iter().zip(of(run, "y")).map(|(x, y)| x.hypot(*y));
        beyond(sizes, 0.0, 4.0).max(beyond([last(run, "x"), last(run, "y")], -1.5, 1.5))
    };
    Ok((program, feedback, Box::new(miss)))
}

/// A disturbance that is always there: its range is a point, or does not contain 0.
fn constant(draw: &mut Draw, factor: f64) -> Result<Kind, Error> {
    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", -1.0, 8.0)?;
    let v = cart.state("v", -2.0, 2.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    let wind = factor * draw.within(0.01, 0.03);
    cart.disturbance(v, wind, wind)?;
    cart.disturbance(x, 0.2 * wind, wind)?;
    cart.mode("roll")?.rates([x.is(v), v.is(u)])?.guard(x.predicted().le(5.0))?;
    let mut program = cart.program(8)?;
    program.start([x.equals(0.0), v.equals(0.0)])?;
    program.goal([x.within(3.0, 4.5), v.within(-0.5, 0.5)])?;
    program.minimize(program.sum(u.square())?)?;
    let feedback = Feedback::regulator(&cart)?;
    let miss = |run: &HybridRun| {
        beyond([last(run, "x")], 3.0, 4.5).max(beyond([last(run, "v")], -0.5, 0.5))
    };
    Ok((program, feedback, Box::new(miss)))
}
