//! Hybrid systems, stated once: simulation, certificates, flaws, constructors, texts.

mod certify;
mod complementarity;
mod constructors;
mod handles;
mod input_ranges;
mod literature;
mod norms;
mod random;
#[cfg(feature = "serde")]
mod serde;
mod simulate;
mod tables;
mod text;
mod well_posedness;

use crate::rows::wall::reflecting;
use carom::collision_tolerant::Wall;
use carom::hybrid::HybridSystem;
use carom::interval::Interval;

/// A mass on a line that rebounds at 0 m with restitution `e`, in steps of 0.1 s.
fn wall(e: f64, max_speed: Option<f64>) -> HybridSystem {
    let [flight, impact] = reflecting(Wall::default(), e, 0.1, max_speed);
    HybridSystem::new(0.1)
        .with_state("x", Interval::new(0.0, 20.0))
        .with_state("v", Interval::new(-8.0, 8.0))
        .with_input("a", Interval::new(-1.0, 1.0))
        .with_transition(flight)
        .with_transition(impact)
}
