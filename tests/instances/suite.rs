//! The programs by name, with their answers, on which other solvers agree.

use carom::prelude::*;

use super::generators::{beside, boxes, cartpole, pendulum, puck, wall};
use super::random_miqp::random_miqp;

/// What is true of an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Truth {
    Infeasible,
    /// The optimum; 0 where any point will do.
    Optimum(f64),
}
use Truth::{Infeasible, Optimum};

/// All instances, or those whose name has one of the parts.
pub(crate) fn suite(parts: &[String]) -> Vec<(&'static str, Model, Truth)> {
    type Entry = (&'static str, fn() -> Model, Truth);
    let all: [Entry; 26] = [
        ("wall_dt02_e5_122", || wall(122, 0.02, 0.5, false), Infeasible),
        ("wall_dt02_e5_123", || wall(123, 0.02, 0.5, false), Optimum(0.0)),
        ("wall_dt0125_e5_194", || wall(194, 0.0125, 0.5, false), Infeasible),
        ("wall_dt0125_e5_195", || wall(195, 0.0125, 0.5, false), Optimum(0.0)),
        ("wall_dt005_e0_456", || wall(456, 0.005, 0.0, false), Infeasible),
        ("wall_dt005_e0_457", || wall(457, 0.005, 0.0, false), Optimum(0.0)),
        ("wall_dt005_e5_484", || wall(484, 0.005, 0.5, false), Infeasible),
        ("wall_dt005_e5_485", || wall(485, 0.005, 0.5, false), Optimum(0.0)),
        ("wall_fuel_80", || wall(80, 0.05, 0.5, true), Optimum(13.904818)),
        ("wall_fuel_60", || wall(60, 0.05, 0.5, true), Optimum(33.605465)),
        ("pendulum_20_bigm", || pendulum(20, [0.0, 0.8], false), Optimum(210.85804)),
        ("pendulum_20_hull", || pendulum(20, [0.0, 0.8], true), Optimum(210.85804)),
        ("two_pendulum_20", two_pendulums, Optimum(421.71608)),
        ("pendulum_40_bigm", || pendulum(40, [-0.05, 1.0], false), Optimum(28.912257)),
        ("pendulum_60_bigm", || pendulum(60, [-0.05, 1.0], false), Optimum(77.988932)),
        ("cartpole_10", || cartpole(10, [0.0, 0.1, 0.0, -1.0]), Optimum(54.629685)),
        ("cartpole_20", || cartpole(20, [0.0, 0.2, 0.0, -2.0]), Optimum(228.39263)),
        ("cartpole_30", || cartpole(30, [0.2, 0.3, 0.0, -2.0]), Optimum(268.26455)),
        ("boxes_20", || boxes(20, 4, false), Optimum(8.6969115)),
        ("boxes_30", || boxes(30, 4, false), Optimum(5.6235617)),
        ("boxes_20q", || boxes(20, 4, true), Optimum(4.1085127)),
        ("boxes_30q", || boxes(30, 3, true), Optimum(1.2218645)),
        ("puck_15", || puck(15, 0.33), Optimum(8.0782823)),
        ("puck_25", || puck(25, 0.2), Optimum(12.428306)),
        ("miqp_60_15", || random_miqp(60, 15, 0), Optimum(-2.8429577)),
        ("miqp_100_20", || random_miqp(100, 20, 1), Optimum(-5.36358)),
    ];
    let wanted = |name: &str| parts.is_empty() || parts.iter().any(|part| name.contains(part));
    let chosen = all.into_iter().filter(|(name, ..)| wanted(name));
    chosen.map(|(name, model, truth)| (name, model(), truth)).collect()
}

/// The same pendulum twice, written in two ways, without a common row.
fn two_pendulums() -> Model {
    beside(&[pendulum(20, [0.0, 0.8], false), pendulum(20, [0.0, 0.8], true)])
}
