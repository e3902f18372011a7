//! Errors of scenes.

use thiserror::Error;

/// A scene that contradicts itself, found before any planning.
///
/// It is an [`ErrorKind::Scene`](super::ErrorKind::Scene).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A body, a normal or a course has another number of axes than the scene.
    #[error(
        "`{name}` has {found} entries and the scene needs {expected}; give one per axis, and in \
         starts and goals one per position, one per velocity, one for a spin, and one for a heading"
    )]
    Axes {
        /// The body or the obstacle.
        name: String,
        /// Its number of axes.
        found: usize,
        /// The number of axes of the scene, those of its first body, from 1 to 3; twice as many in
        /// starts and goals, and one more each for a spin and a heading.
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
    /// A start or a goal that its body's own limits exclude.
    #[error(
        "`{body}` {end} with {what} {}, outside its {limit}; move it, or widen the limit",
        span(*lower, *upper)
    )]
    Limits {
        /// The body.
        body: String,
        /// `starts` or `ends`.
        end: &'static str,
        /// `x`, `vy`, `spin`, ...
        what: String,
        /// The least value that the start or the goal gives it, in m, m/s or rad/s.
        lower: f64,
        /// The largest value, in the same unit.
        upper: f64,
        /// The limit in words, with its range and unit.
        limit: String,
    },
    /// A start or a goal with a half-space that none of its states satisfies.
    #[error(
        "`{body}` {end} where the half-space `{halfspace}` does not allow it: {nearest} at least, \
         and {limit} at most; move one of them"
    )]
    Cut {
        /// The body.
        body: String,
        /// `starts` or `ends`.
        end: &'static str,
        /// The half-space.
        halfspace: String,
        /// The least value of its `normal . (x, v)` within the ranges and the body's limits.
        nearest: f64,
        /// Its limit.
        limit: f64,
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
    /// A spin that the scene cannot state.
    #[error("the spin of `{body}` cannot be used: {reason}")]
    Spin {
        /// The body.
        body: String,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// Forces or a heading that the scene cannot state.
    #[error("the forces on `{body}` cannot be used: {reason}")]
    Forces {
        /// The body.
        body: String,
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
    /// An interval of damage limits that the scene does not have.
    #[error("the scene has no damage interval: {reason}")]
    NoDamageLimitRange {
        /// Why.
        reason: String,
    },
    /// A plan that disagrees with its replay.
    #[error(
        "step {step} of the plan is not what the scene does: {what} by {by}; at most {allowed}"
    )]
    Replay {
        /// The step.
        step: usize,
        /// The disagreement in words, with its unit.
        what: String,
        /// By how much.
        by: f64,
        /// The allowed disagreement.
        allowed: f64,
    },
}

/// "0.3", or "from 0.2 to 0.4".
fn span(lower: f64, upper: f64) -> String {
    match lower == upper {
        true => format!("{lower}"),
        false => format!("from {lower} to {upper}"),
    }
}
