//! Robots of one mission, for examples that include the missions of the tests.

use carom::hybrid::Mission;
use carom::prelude::*;

use crate::missions::Point;

/// The columns of places in which robots start and arrive.
const PLACES: usize = 10;

/// Robots that cross the room to places of their own within 15 steps, and keep clear of the pillar
/// and of each other. They begin in rows of ten, and end in such rows.
pub(crate) fn robots(count: usize) -> Result<(HybridProgram, Mission), Error> {
    let steps = 15;
    let robots: Vec<Point> = (0..count).map(|_| Point::new()).collect::<Result<_, _>>()?;
    let mut program = robots[0].system.program(steps)?;
    for (k, robot) in robots.iter().enumerate().skip(1) {
        program.join(&format!("robot {k}"), &robot.system)?;
    }
    let mut parts = Vec::new();
    for (k, robot) in robots.iter().enumerate() {
        let place = |k: usize| [0.4 + (k % PLACES) as f64, (k / PLACES) as f64];
        let [x, y] = place(k);
        for (i, row) in robot.start([x, y + 0.5]).into_iter().enumerate() {
            program.require(&format!("start {k} {i}"), [row], When::At(0))?;
        }
        let [x, y] = place((3 * k + 2) % count);
        let sides = [x - 0.3, x + 0.3, 9.0 - y, 10.0 - y];
        let place = robot.within(&format!("place {k}"), sides);
        let pillar = robot.within(&format!("pillar {k}"), [4.0, 6.0, 4.0, 6.0]);
        parts.extend([place.eventually(0..), (!pillar).always(0..)]);
        for (j, other) in robots.iter().enumerate().skip(k + 1) {
            let ([x, y], [a, b]) = (robot.position, other.position);
            let near = [(x - a).within(-0.4, 0.4), (y - b).within(-0.4, 0.4)];
            parts.push((!Mission::holds(format!("near {k} {j}"), near)).always(0..));
        }
    }
    let mission = Mission::all(parts);
    program.require_mission("mission", &mission)?;
    Ok((program, mission))
}
