//! Hybrid systems: linear dynamics, horizons, walls, contact laws, damage, replays, reach sets, and
//! the search for the shortest horizon.
//!
//! The parts add ordinary statements to a [`Model`](crate::model::Model), tighten its bounds
//! ([`reach`]) or work on plain numbers. None of them depends on how a model is solved; functions
//! that need to solve one take a `&mut dyn` [`Solver`](crate::solver::Solver).
//!
//! A vehicle that may hit a wall, for three steps:
//!
//! ```
//! use carom::hybrid::{Contact, ContactStep, LinearSystem, Restitution, Wall};
//! use carom::interval::Interval;
//! use carom::prelude::*;
//!
//! let (steps, dt) = (3, 0.5);
//! let vehicle = LinearSystem::double_integrator(dt)?;
//! let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.5)?);
//!
//! let mut model = Model::new("hop");
//! let x = model.continuous_family("x", steps + 1, 0.0, 20.0)?;
//! let v = model.continuous_family("v", steps + 1, -8.0, 8.0)?;
//! let a = model.continuous_family("a", steps, -1.0, 1.0)?;
//! let hit = model.binary_family("hit", steps)?;
//! for t in 0..steps {
//!     let predicted = vehicle.predict(&[x[t], v[t]], &[a[t]])?;
//!     floor.add_step(&mut model, &ContactStep {
//!         step: t,
//!         time_step: dt,
//!         position: x[t].into(),
//!         velocity: v[t].into(),
//!         acceleration: a[t].into(),
//!         acceleration_limits: Interval::new(-1.0, 1.0),
//!         predicted_position: predicted[0].clone(),
//!         predicted_velocity: predicted[1].clone(),
//!         next_position: x[t + 1].into(),
//!         next_velocity: v[t + 1].into(),
//!         contact: hit[t],
//!     })?;
//! }
//! assert_eq!(model.indicator_count(), 4 * steps);
//! # Ok::<(), carom::Error>(())
//! ```

pub mod contact;
pub mod damage;
pub(crate) mod exponential;
pub mod horizon;
pub mod linear;
pub mod reach;
pub mod shortest_horizon;
pub mod simulate;
pub mod wall;

pub use contact::{Contact, ContactLaw, ContactStep, ImpactSpeed, Restitution, RollOut};
pub use damage::{Damage, DamageFunction, DamageLimits};
/// Dense matrices, re-exported from `faer`.
pub use faer::Mat;
pub use horizon::Horizon;
pub use linear::LinearSystem;
pub use shortest_horizon::{
    Attempt, HorizonEvent, HorizonModel, Refutation, ShortestHorizon, ShortestOptions,
    ShortestStatus, Verdict, Waiting, shortest_horizon, shortest_horizon_with,
};
pub use simulate::{
    ContinuousReplay, DiscreteReplay, ReplayError, Samples, replay_continuous, replay_discrete,
};
pub use wall::{FreeSide, Wall};
