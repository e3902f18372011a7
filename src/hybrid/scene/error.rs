//! Errors of scenes.

use thiserror::Error;

/// A scene that contradicts itself, found before any planning.
///
/// In a [`carom::Error`](crate::Error) it is the [`source`](std::error::Error::source) of an error
/// of the kind [`ErrorKind::Other`](crate::ErrorKind::Other).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A body, a normal or a course has another number of axes than the scene.
    #[error("`{name}` has {found} axes and the scene has {expected}; give one entry per axis")]
    Axes {
        /// The body or the obstacle.
        name: String,
        /// Its number of axes.
        found: usize,
        /// The number of axes of the scene: those of its first body, from 1 to 3.
        expected: usize,
    },
    /// A face of an obstacle has no direction.
    #[error("face {face} of `{obstacle}` has a normal of length 0; give a direction out of it")]
    Normal {
        /// The obstacle.
        obstacle: String,
        /// The number of the face.
        face: usize,
    },
    /// The faces of an obstacle enclose nothing.
    #[error("the faces of `{obstacle}` cross, so that nothing is inside; turn or move them")]
    Crossed {
        /// The obstacle.
        obstacle: String,
    },
    /// A face of an obstacle lies outside the others.
    #[error(
        "face {face} of `{obstacle}` has no extent, because the other faces cut it off; drop it, \
         or move it inward"
    )]
    NoExtent {
        /// The obstacle.
        obstacle: String,
        /// The number of the face.
        face: usize,
    },
    /// A body starts or ends inside an obstacle or another body.
    #[error("`{body}` {end} inside `{obstacle}`; move one of them")]
    Inside {
        /// The body.
        body: String,
        /// `starts` or `ends`.
        end: &'static str,
        /// The obstacle, or the other body.
        obstacle: String,
    },
    /// A course is shorter than the plan.
    #[error(
        "the course of `{obstacle}` ends at sample {last} and the plan at sample {needed}; give \
         a place for every sample, or plan fewer steps"
    )]
    Course {
        /// The obstacle.
        obstacle: String,
        /// The last sample of the course.
        last: usize,
        /// The last sample of the plan.
        needed: usize,
    },
    /// A property of a surface that the scene cannot state.
    #[error("the surface of `{obstacle}` cannot be used: {reason}")]
    Surface {
        /// The obstacle.
        obstacle: String,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// A rule about damage that fits no surface.
    #[error("the rule `{rule}` cannot be used: {reason}")]
    Rule {
        /// The rule.
        rule: String,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// A plan that disagrees with its replay.
    #[error(
        "step {step} of the plan is not what the scene does: {what} by {by}; at most {allowed}"
    )]
    Replay {
        /// The step.
        step: usize,
        /// What disagrees, with its unit.
        what: String,
        /// By how much.
        by: f64,
        /// The allowed disagreement.
        allowed: f64,
    },
}

impl From<SceneError> for crate::Error {
    fn from(error: SceneError) -> Self {
        crate::Error::other(error)
    }
}
