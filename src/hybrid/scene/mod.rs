#![doc = include_str!("../../../docs/modules/scene.md")]

mod axes;
mod body;
mod compare;
mod contact;
mod damage_interval;
mod damage_rows;
mod declarations;
mod ends;
mod entry;
mod error;
mod geometry;
mod handles;
mod law;
pub(crate) mod line;
mod loose;
mod mitigate;
mod picture;
mod place;
mod plan;
mod program;
mod replay;
mod resting;
mod rule;
pub(crate) mod samples;
mod shortest;
mod soften;
mod solid;
mod statement;
mod surface;
mod system;

pub(crate) use axes::region_where;
pub use body::{Body, Shape};
pub use compare::StepComparison;
pub use damage_interval::{DamageInterval, IntervalEnd, IntervalOptions};
pub use error::SceneError;
pub use handles::{BodyHandle, ObstacleHandle};
pub use mitigate::{Avoidable, Mitigation};
pub use picture::ScenePicture;
pub use plan::{BodyPath, SceneHit, ScenePlan};
pub use program::SceneProgram;
pub use replay::SceneCertificate;
pub use rule::{DamageMeasure, DamageRule};
pub use solid::Solid;
#[doc(alias("obstacle avoidance", "collision avoidance", "motion planning"))]
pub use statement::Scene;
pub use surface::Surface;
