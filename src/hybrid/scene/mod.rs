#![doc = include_str!("../../../docs/modules/scene.md")]

mod body;
mod compare;
mod contact;
mod damage_rows;
mod ends;
mod entry;
mod error;
mod geometry;
mod law;
pub(crate) mod line;
mod loose;
mod mitigate;
mod picture;
mod plan;
mod program;
mod replay;
mod resting;
mod rule;
mod shortest;
mod soften;
mod solid;
mod statement;
mod surface;
mod system;

pub use body::{Body, Shape};
pub use compare::StepComparison;
pub use error::SceneError;
pub use mitigate::{Avoidable, Mitigation};
pub use plan::{BodyPath, SceneHit, ScenePlan};
pub use program::SceneProgram;
pub use replay::SceneCertificate;
pub use rule::{DamageMeasure, DamageRule};
pub use shortest::ShortestScenePlan;
pub use solid::Solid;
pub use statement::Scene;
pub use surface::Surface;
