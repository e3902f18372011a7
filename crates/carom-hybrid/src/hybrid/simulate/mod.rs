//! Simulators of hybrid systems as they are stated.
//!
//! They work in `f64` and share no code with the rows of programs, so they check plans
//! independently: [`HybridSystem::simulate`](crate::hybrid::HybridSystem::simulate) evaluates
//! flows, guards and resets and says which transitions were possible, and
//! [`HybridSystem::certify`](crate::hybrid::HybridSystem::certify) does the same for a given run.
//! [Scenes](crate::hybrid::scene) locate what happens inside a step. Whether a plan is the run of
//! its inputs is decided in as many digits as that needs (`open_run.rs`), and its inputs are
//! corrected by `track.rs`.

mod certify;
mod condition;
mod decisions;
mod digits;
mod disturbed;
mod enclosed_motion;
mod follow;
mod implicit_step;
mod memory;
mod motion;
mod motion_tube;
mod open_run;
mod options;
mod plan;
mod run;
mod simulation;
mod step;
mod stepper;
mod track;
mod zonotope;

pub use certify::RunCertificate;
pub(crate) use condition::{guard_condition, limit_condition};
pub(crate) use decisions::Decided;
pub use decisions::Decisions;
pub use disturbed::DisturbedRun;
pub(crate) use follow::Followed;
pub use motion::ContinuousMotion;
pub use motion_tube::MotionTube;
pub use options::SimulationOptions;
pub use simulation::{SimulatedStep, Simulation};

pub use crate::error::{Condition, DeadEnd, RunError, TransitionCandidate};
