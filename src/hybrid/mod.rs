#![doc = include_str!("../../docs/modules/hybrid.md")]

mod affine;
pub mod contact;
pub mod damage;
pub(crate) mod exponential;
mod flaws;
pub(crate) mod horizon;
pub mod linear;
mod matrix;
#[cfg(feature = "nalgebra")]
mod nalgebra;
pub(crate) mod program;
pub mod reach;
mod receding;
pub(crate) mod rows;
pub mod scene;
pub mod shortest_horizon;
pub mod simulate;
pub(crate) mod system;
mod terminal;
pub mod wall;

pub use contact::{Contact, ContactLaw, Restitution};
pub use damage::ImpactEstimate;
pub use flaws::{Flaw, Witness};
pub use linear::LinearSystem;
pub use matrix::Matrix;
pub use program::{AtSample, HybridPlan, HybridProgram, SoftLimit, When};
pub use receding::{ClosedLoop, Disturbance, Move, MoveSource, RecedingHorizon};
pub use rows::HybridRun;
pub use shortest_horizon::{
    Attempt, HorizonEvent, HorizonModel, LeastTimeStep, Refutation, Shortest, ShortestOptions,
    ShortestStatus, Solved, TimeStepGrid, Verdict, Waiting, least_time_step, shortest_horizon,
    shortest_horizon_with,
};
pub use simulate::{
    Candidate, Condition, DeadEnd, RunCertificate, RunError, SimulatedStep, Simulation,
    SimulationOptions,
};
pub use system::{
    HybridSystem, IntoRegion, LinearComplementarity, MixedLogicalDynamical, Region, Schedule,
    State, SystemRow, TransitionMut,
};
pub use terminal::{Lqr, TerminalError, TerminalOptions, TerminalSet};
pub(crate) use wall::FreeSide;
pub use wall::Wall;
