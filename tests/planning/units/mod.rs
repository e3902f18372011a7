//! A change of the units of length and time, or of the origin, changes nothing: the same steps and
//! hits, the same loops, the same price, and an error where the digits of a float do not suffice.
//!
//! The numbers that are compared come from the same statement in ordinary units; runs are simulated
//! here once more.

mod cases;
mod random;
mod scenarios;

use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{Restitution, ShortestOptions};
use carom::prelude::*;

/// The units of length and time of a statement, and the place of its origin in this unit of length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Units {
    pub(super) length: f64,
    pub(super) time: f64,
    pub(super) origin: f64,
}

impl Units {
    pub(super) const ORDINARY: Units = Units { length: 1.0, time: 1.0, origin: 0.0 };

    pub(super) fn new(length: f64, time: f64) -> Self {
        Units { length, time, origin: 0.0 }
    }

    pub(super) fn at(origin: f64) -> Self {
        Units { origin, ..Units::ORDINARY }
    }

    pub(super) fn place(self, x: f64) -> f64 {
        self.length * (self.origin + x)
    }

    pub(super) fn speed(self, v: f64) -> f64 {
        v * self.length / self.time
    }

    pub(super) fn push(self, a: f64) -> f64 {
        a * self.length / self.time / self.time
    }
}

/// A puck on a table between cushions: 14 steps and two hits.
fn puck(units: Units) -> Scene {
    let table = [units.place(0.0)..=units.place(2.0), units.place(0.0)..=units.place(1.0)];
    let puck = Body::new("puck", &table, units.speed(3.0), units.push(3.0))
        .with_start([units.place(1.2), units.place(0.2), units.speed(2.0), units.speed(2.0)])
        .with_goal([units.place(0.4), units.place(0.2), 0.0, 0.0]);
    let cushion = Surface::bounce(Restitution::new(0.9).unwrap());
    Scene::new(0.1 * units.time).with_body(puck).with_room("cushion", &table, cushion)
}

/// A drone between three boxes: 23 steps.
fn boxes(units: Units) -> Scene {
    let sides =
        |low: [f64; 2], high: [f64; 2]| [0, 1].map(|i| units.place(low[i])..=units.place(high[i]));
    let room = sides([0.0, 0.0], [6.0, 4.0]);
    let drone = Body::new("drone", &room, units.speed(1.2), units.push(2.0))
        .with_start([units.place(0.4), units.place(0.5), 0.0, 0.0])
        .with_goal([units.place(5.5), units.place(3.5), 0.0, 0.0]);
    let cuboid = |name: &str, low, high| Solid::cuboid(name, sides(low, high), Surface::avoid());
    Scene::new(0.25 * units.time)
        .with_body(drone)
        .with_room("room", &room, Surface::avoid())
        .with_obstacle(cuboid("a", [1.2, 0.0], [1.9, 2.2]))
        .with_obstacle(cuboid("b", [2.8, 1.4], [3.4, 4.0]))
        .with_obstacle(cuboid("c", [4.3, 0.6], [4.9, 2.6]))
}

/// A lift with two gears: 72 steps to 12 m, 35 to 3 m.
pub(super) struct Lift {
    pub(super) system: HybridSystem,
    pub(super) x: State,
    pub(super) v: State,
    pub(super) u: Input,
    pub(super) units: Units,
}

pub(super) fn lift(units: Units) -> Lift {
    let mut system = HybridSystem::new(0.1 * units.time);
    let x = system.state("x", units.place(0.0), units.place(15.0)).unwrap();
    let v = system.state("v", units.speed(-2.5), units.speed(2.5)).unwrap();
    let u = system.input("u", -1.0, 1.0).unwrap();
    system.mode("low gear").unwrap().rates([x.is(v), v.is(units.push(0.6) * u)]).unwrap();
    let high = system.mode("high gear").unwrap();
    let high = high.rates([x.is(v), v.is(units.push(1.5) * u)]).unwrap();
    high.guard(v.ge(units.speed(0.4))).unwrap();
    Lift { system, x, v, u, units }
}

impl Lift {
    pub(super) fn at_rest(&self, x: f64) -> [Row; 2] {
        [self.x.equals(self.units.place(x)), self.v.equals(0.0)]
    }
}

fn hits(scene: &Scene) -> (Option<usize>, Option<usize>) {
    let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    let found = scene.shortest_with(&options, &mut solver).unwrap();
    (found.steps, found.plan.map(|plan| plan.hits.len()))
}

#[test]
fn a_puck_takes_as_many_steps_in_any_unit() {
    let ordinary = hits(&puck(Units::ORDINARY));
    assert_eq!(ordinary, (Some(14), Some(2)));
    for units in [
        Units::new(1e-3, 1e-3),
        Units::new(1e-7, 1.0),
        Units::new(0.01, 1.0 / 3600.0),
        Units::new(1e5, 1e3),
        Units::new(1e9, 1e-9),
        Units::at(5e6),
        Units::at(1e8),
        Units { length: 1e-6, time: 1e-3, origin: 1e6 },
    ] {
        assert_eq!(hits(&puck(units)), ordinary, "{units:?}");
    }
}

#[test]
fn a_lift_takes_as_many_steps_in_any_unit() {
    for units in [
        Units::ORDINARY,
        Units::new(1e-3, 1e3),
        Units::new(1e-7, 1e-3),
        Units::new(1e-9, 1e9),
        Units::new(1e7, 1.0),
        Units::at(-3.0),
        Units::at(5e6),
        Units::at(1e8),
    ] {
        let lift = lift(units);
        let (start, goal) = (lift.at_rest(0.0), lift.at_rest(12.0));
        let found = lift.system.shortest(start, goal, &mut BranchAndBound::default()).unwrap();
        assert_eq!(found.steps, Some(72), "{units:?}");
    }
}

#[test]
fn obstacles_of_a_map_are_where_they_are() {
    for units in [Units::ORDINARY, Units::at(5e6), Units::at(1e8), Units::new(1e-6, 1e2)] {
        assert_eq!(hits(&boxes(units)).0, Some(23), "{units:?}");
    }
}

#[test]
fn digits_that_do_not_suffice_are_an_error() {
    let lift = lift(Units::at(1e10));
    let (start, goal) = (lift.at_rest(0.0), lift.at_rest(12.0));
    let error = lift.system.shortest(start, goal, &mut BranchAndBound::default()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("`x`") && text.contains("from another origin"), "{text}");
    for scene in [puck(Units::at(1e10)), boxes(Units::at(1e10))] {
        let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
        let text = scene.shortest_with(&options, &mut solver).unwrap_err().to_string();
        assert!(text.contains(" x`") && text.contains("from another origin"), "{text}");
    }
}
