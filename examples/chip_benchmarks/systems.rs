//! Controllers with modes: programs whose start is open.

use std::ops::RangeInclusive;

use carom::explicit::{ExplicitProgram, ExplicitTable};
use carom::hybrid::{HybridProgram, Memory};
use carom::prelude::*;

/// A program with a first input, and the axes of its table.
pub(crate) struct System {
    pub(crate) program: HybridProgram,
    pub(crate) axes: Vec<Variable>,
    pub(crate) input: Affine,
    closed: Option<ProvedStep>,
    /// The loss that is asked for, absolute and relative, and the finest edge.
    goal: [f64; 3],
}

/// What is to be proved of the loop.
struct ProvedStep {
    /// The axes at the next sample, with their largest disturbances.
    next: Vec<(Affine, f64)>,
    /// The longest edge of a piece.
    finest: f64,
    /// Where the loop is to be in the end.
    goal: Vec<RangeInclusive<f64>>,
}

impl System {
    /// The table, with at most so many cells.
    pub(crate) fn table(&self, cells: usize) -> Result<ExplicitTable, Error> {
        let [absolute, relative, finest] = self.goal;
        let outputs = [self.input.clone()];
        let explicit =
            ExplicitProgram::new(self.program.model(), self.axes.iter().copied(), outputs)?;
        let explicit = explicit.with_loss(absolute, relative)?.with_finest(finest)?;
        let explicit = match &self.closed {
            None => explicit,
            Some(ProvedStep { next, finest, goal }) => explicit
                .with_next(self.program.model(), next.iter().cloned(), *finest)?
                .with_goal(goal.iter().cloned())?,
        };
        Ok(explicit.with_cell_limit(cells).build())
    }
}

/// A cart on a rail with a soft wall at 0.5 m that pushes it back.
pub(crate) fn wall() -> Result<System, Error> {
    let step = 0.2;
    let mut cart = HybridSystem::new(step);
    let x = cart.state("x", -2.0, 1.0)?; // m
    let v = cart.state("v", -2.0, 2.0)?; // m/s
    let u = cart.input("u", -1.0, 1.0)?; // m/s²
    let flow = |push: Affine| [(x, x + step * v), (v, v + step * (u + push))];
    cart.mode("free")?.next(flow(0.0.into()))?.guard(x.le(0.5))?;
    cart.mode("pushed")?.next(flow(20.0 * (0.5 - x)))?.guard(x.ge(0.5))?;
    let mut program = cart.program(4)?;
    let cost = program.sum(x.square() + 0.5 * v.square() + 0.2 * u.square())?;
    program.minimize(cost + 4.0 * program.end(x.square() + v.square())?)?;
    let axes = program.open_start([(x, -1.0..=0.7), (v, -1.0..=1.0)])?;
    let input = program.at(u, 0)?;
    let next = vec![(program.at(x, 1)?, 0.01), (program.at(v, 1)?, 0.01)];
    let goal = [0.02, 0.02, 1.0 / 256.0];
    let closed = Some(ProvedStep { next, finest: 1.0 / 64.0, goal: vec![-0.3..=0.3, -0.3..=0.3] });
    Ok(System { program, axes, input, closed, goal })
}

/// A buck converter: a switch connects the coil to the source or not.
pub(crate) fn converter() -> Result<System, Error> {
    let mut buck = HybridSystem::new(1.0);
    let current = buck.state("i", -1.0, 4.0)?; // A
    let voltage = buck.state("v", -1.0, 3.0)?; // V
    let flow = |source: f64| {
        let next = current + 0.25 * (source - voltage) - 0.05 * current;
        [(current, next), (voltage, voltage + 0.25 * (current - voltage))]
    };
    let on = buck.mode("on")?.next(flow(3.0))?.taken();
    buck.mode("off")?.next(flow(0.0))?;
    let mut program = buck.program(4)?;
    let cost = program.sum((voltage - 1.5).square() + 0.2 * (current - 1.5).square())?;
    program.minimize(cost + 4.0 * program.end((voltage - 1.5).square())?)?;
    let axes = program.open_start([(current, 0.0..=3.0), (voltage, 0.0..=2.5)])?;
    let input = program.at(on, 0)?;
    let next = vec![(program.at(current, 1)?, 0.01), (program.at(voltage, 1)?, 0.01)];
    let goal = [0.02, 0.05, 1.0 / 256.0];
    let closed = Some(ProvedStep { next, finest: 1.0 / 64.0, goal: vec![1.0..=2.0, 1.0..=2.0] });
    Ok(System { program, axes, input, closed, goal })
}

/// A room with a heater that stays on or off for two steps or more, and a price of its energy.
fn thermostat(memory: &Memory) -> Result<System, Error> {
    let mut room = HybridSystem::new(900.0);
    let warm = room.state("warm", 10.0, 30.0)?; // °C
    let [off, on] = room.modes("heater", ["off", "on"])?;
    let flow = |heat: f64| [(warm, warm + 0.1 * (10.0 - warm) + heat)];
    room.stay(off)?.next(flow(0.0))?;
    room.stay(on)?.next(flow(2.0))?;
    room.switch(off, on)?;
    room.switch(on, off)?;
    room.dwell(on, 2, None)?;
    room.dwell(off, 2, None)?;
    let heats = room.acting(on)?;
    let mut program = room.program(5)?;
    program.start_from(memory)?;
    let mut axes = program.open_start([(warm, 14.0..=26.0)])?;
    let price = program.model_mut().parameter("price", 1.0, 0.0, 2.0)?;
    let mut cost: Quadratic = program.sum((warm - 20.0).square())?;
    for t in 0..5 {
        cost += program.at(heats, t)? * price;
    }
    program.minimize(cost)?;
    let input = program.at(heats, 0)?;
    axes.push(price);
    let goal = [0.1, 0.03, 1.0 / 256.0];
    Ok(System { program, axes, input, closed: None, goal })
}

/// The thermostat with a heater that is off, and may be switched.
pub(crate) fn heater_off() -> Result<System, Error> {
    thermostat(&Memory::default().with_mode("heater", "off", 2))
}

/// The thermostat with a heater that is on, and may be switched.
pub(crate) fn heater_on() -> Result<System, Error> {
    thermostat(&Memory::default().with_mode("heater", "on", 2))
}

/// The thermostat with a heater that was switched off, and stays so for a step.
pub(crate) fn just_off() -> Result<System, Error> {
    thermostat(&Memory::default().with_mode("heater", "off", 1))
}

/// The thermostat with a heater that was switched on, and stays so for a step.
pub(crate) fn just_on() -> Result<System, Error> {
    thermostat(&Memory::default().with_mode("heater", "on", 1))
}

/// A pole on a cart between soft walls, linearised (arXiv 1910.08251), with a short horizon.
///
/// The tip of the pole is a state, so that the walls are at 1/8 and 7/8 of the side of the box,
/// where cells are cut.
fn pole(steps: usize, tips: [f64; 2], speed: f64, finest: f64) -> Result<System, Error> {
    let step = 0.1;
    let mut cart = HybridSystem::new(step);
    let tip = cart.state("tip", -1.0, 1.0)?; // m
    let speed_of_tip = cart.state("speed", -3.0, 3.0)?; // m/s
    let angle = cart.state("angle", -0.7, 0.7)?; // rad
    let rate = cart.state("rate", -4.0, 4.0)?; // rad/s
    let u = cart.input("u", -3.0, 3.0)?; // N
    let flow = |push: Affine| {
        [
            (tip, tip + step * speed_of_tip),
            (speed_of_tip, speed_of_tip - step * (10.0 * angle + push.clone())),
            (angle, angle + step * rate),
            (rate, rate + step * (20.0 * angle + u + push)),
        ]
    };
    cart.mode("free")?.next(flow(0.0.into()))?.guard(tip.le(0.5))?.guard(tip.ge(-0.5))?;
    cart.mode("right")?.next(flow(50.0 * (tip - 0.5)))?.guard(tip.ge(0.5))?;
    cart.mode("left")?.next(flow(50.0 * (tip + 0.5)))?.guard(tip.le(-0.5))?;
    let mut program = cart.program(steps)?;
    // Of the cart.
    let (x, v) = (tip + angle, speed_of_tip + rate);
    let cost = program.sum(x.clone().square() + angle.square() + 0.1 * u.square())?;
    program.minimize(
        cost + program.end(x.square() + v.square() + 5.0 * angle.square() + rate.square())?,
    )?;
    let axes = program.open_start([
        (tip, tips[0]..=tips[1]),
        (speed_of_tip, -speed..=speed),
        (angle, -0.1..=0.1),
        (rate, -0.2..=0.2),
    ])?;
    let input = program.at(u, 0)?;
    Ok(System { program, axes, input, closed: None, goal: [0.2, 0.1, finest] })
}

/// The pole between the walls and a sixth of a metre beyond, for a step.
pub(crate) fn pole_between() -> Result<System, Error> {
    pole(1, [-2.0 / 3.0, 2.0 / 3.0], 0.2, 1.0 / 256.0)
}

/// The pole within a tenth of a metre of a wall, for two steps.
pub(crate) fn pole_beside() -> Result<System, Error> {
    pole(2, [0.4, 0.6], 1.0, 1.0 / 16.0)
}
