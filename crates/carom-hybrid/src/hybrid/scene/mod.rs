#![doc = include_str!("../../../docs/scene.md")]

mod axes;
mod body;
mod case;
mod compare;
mod contact;
mod damage_limit_range;
mod damage_rows;
mod declarations;
mod decoupled_relaxation;
mod ends;
mod entry;
mod geometry;
mod handles;
mod law;
pub(crate) mod line;
mod mitigate;
mod picture;
mod place;
mod plan;
mod program;
mod rebound;
mod replay;
mod replayed;
mod resting;
mod rule;
pub(crate) mod samples;
mod shortest;
mod soften;
mod solid;
mod spin;
mod statement;
mod surface;
mod system;
mod units;
mod words;

pub(crate) use axes::region_where;
pub use body::{Body, Shape};
pub use compare::StepComparison;
pub use damage_limit_range::{DamageLimitEnd, DamageLimitOptions, DamageLimitRange};
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
pub(crate) use units::SceneUnits;

pub use crate::error::SceneError;
