#![doc = include_str!("../../docs/hybrid.md")]

pub mod contact;
pub mod damage;
pub(crate) mod exponential;
pub(crate) mod horizon;
pub mod linear;
mod matrix;
mod memory;
pub(crate) mod mission;
#[cfg(feature = "nalgebra")]
mod nalgebra;
pub(crate) mod program;
pub mod reach;
mod receding;
pub(crate) mod robust;
pub(crate) mod rows;
pub mod scene;
pub mod shortest_horizon;
pub mod simulate;
pub(crate) mod step;
pub(crate) mod system;
mod terminal;
mod well_posedness;

#[doc(alias("coefficient of restitution", "bounce"))]
pub use contact::Restitution;
pub use damage::ImpactEstimate;
pub use linear::LinearSystem;
pub use matrix::Matrix;
pub use memory::Memory;
pub use mission::{IntoWindow, Mission};
pub use program::When;
pub use program::{AtSample, HybridPlan, HybridProgram, SoftLimit};
#[doc(alias("MPC", "model predictive control", "receding horizon"))]
pub use receding::RecedingHorizon;
pub use receding::{BrokenLoop, ClosedLoop, ControlMove, Disturbance, MoveSource};
#[doc(alias("tube", "robust control"))]
pub use robust::RobustProgram;
pub use robust::{Feedback, RobustCertificate, RobustPlan};
pub use rows::HybridRun;
pub use shortest_horizon::{
    HorizonAttempt, HorizonEvent, HorizonModel, HorizonProof, HorizonRefutation, HorizonVerdict,
    LeastTimeStep, Monotonicity, ShortestHorizon, ShortestOptions, ShortestStatus, SolvedHorizon,
    TimeStepGrid, least_time_step, shortest_horizon,
};
pub use simulate::{
    Condition, ContinuousMotion, DeadEnd, Decisions, DisturbedRun, MotionTube, RunCertificate,
    RunError, SimulatedStep, Simulation, SimulationOptions, TransitionCandidate,
};
#[doc(alias("LCP", "complementarity"))]
pub use system::Discretization;
pub use system::LinearComplementarity;
pub use system::{
    HybridSystem, Input, IntoRegion, MixedLogicalDynamical, Region, Schedule, State, SystemRow,
    TransitionMut,
};
#[doc(alias("linear-quadratic regulator", "Riccati equation"))]
pub use terminal::Lqr;
pub use terminal::TerminalOptions;
#[doc(alias("invariant set", "terminal constraint"))]
pub use terminal::TerminalSet;
pub use well_posedness::{IllPosedness, WitnessPoint};

pub use crate::error::{RobustError, TerminalError};
