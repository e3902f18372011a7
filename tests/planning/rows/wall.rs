//! The reflecting wall: the general rows beside the hand-written ones.

use carom::hybrid::{
    Contact, ContactStep, Horizon, HybridProgram, HybridSystem, LinearSystem, Restitution,
    Transition, Wall,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom::reformulate;

const TIME_STEP: f64 = 0.1;
const POSITIONS: Interval = Interval { lower: 0.0, upper: 20.0 };
const SPEEDS: Interval = Interval { lower: -5.0, upper: 5.0 };
const FORCES: Interval = Interval { lower: -10.0, upper: 10.0 };

fn contact(e: f64) -> Contact {
    Contact::new(Wall::above(0.0).unwrap(), Restitution::new(e).unwrap())
}

/// The wall as a system.
fn system(e: f64) -> HybridSystem {
    let [flight, impact] = contact(e).transitions(TIME_STEP, None).unwrap();
    let impact: Transition = impact.with_output("impact speed", [0.0, -1.0], 0.0);
    HybridSystem::new()
        .with_state("x", POSITIONS)
        .with_state("v", SPEEDS)
        .with_input("a", FORCES)
        .with_transition(flight)
        .with_transition(impact)
}

fn general(e: f64, steps: usize) -> (Model, HybridProgram) {
    let mut model = Model::new("general");
    let horizon = Horizon::new(steps, TIME_STEP).unwrap();
    let program = system(e).write(&mut model, "", &horizon).unwrap();
    (model, program)
}

/// The same by hand.
fn by_hand(e: f64, steps: usize) -> Model {
    let mut model = Model::new("by hand");
    let x = model.continuous_family("x", steps + 1, POSITIONS.lower, POSITIONS.upper).unwrap();
    let v = model.continuous_family("v", steps + 1, SPEEDS.lower, SPEEDS.upper).unwrap();
    let a = model.continuous_family("a", steps, FORCES.lower, FORCES.upper).unwrap();
    let zeta = model.binary_family("impact", steps).unwrap();
    let vehicle = LinearSystem::double_integrator(TIME_STEP).unwrap();
    for t in 0..steps {
        let predicted = vehicle.predict(&[x[t], v[t]], &[a[t]]).unwrap();
        let step = ContactStep {
            step: t,
            time_step: TIME_STEP,
            position: x[t].into(),
            velocity: v[t].into(),
            acceleration: a[t].into(),
            acceleration_limits: FORCES,
            predicted_position: predicted[0].clone(),
            predicted_velocity: predicted[1].clone(),
            next_position: x[t + 1].into(),
            next_velocity: v[t + 1].into(),
            contact: zeta[t],
        };
        contact(e).add_step(&mut model, &step).unwrap();
    }
    model
}

#[test]
fn the_wall_has_the_rows_of_the_hand_written_one() {
    for e in [0.0, 0.5, 1.0] {
        let (model, _) = general(e, 3);
        let (own, hand) =
            (reformulate::lower(&model).unwrap(), reformulate::lower(&by_hand(e, 3)).unwrap());
        assert_eq!(own.model().variable_count(), hand.model().variable_count());
        assert_eq!(own.model().constraint_count(), hand.model().constraint_count());
    }
}
