//! Codes: the sections of the guide's page "Help", one for each question that an error raises.

use super::{Error, ErrorKind, RobustError, RunError, SceneError};

impl Error {
    /// The section of the guide's page "Help" that says why one sees this error, and what to do.
    ///
    /// It is a word such as `no-bound`, which errors of several kinds may share. `{:?}` ends with
    /// it in brackets, so that it is there where `main` returns the error or an `unwrap` fails.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let error = Model::new("m").continuous("x", 2.0, 1.0).unwrap_err();
    /// assert_eq!(error.code(), "number");
    /// assert_eq!(
    ///     format!("{error:?}"),
    ///     "bounds of `x` are crossed: 2 > 1; swap or relax them [number]"
    /// );
    /// ```
    pub fn code(&self) -> &'static str {
        use ErrorKind as Kind;

        match self.kind() {
            Kind::NotFinite { .. } | Kind::OutOfRange { .. } | Kind::CrossedBounds { .. } => {
                "number"
            }
            Kind::EmptyRow { .. }
            | Kind::FalseRow { .. }
            | Kind::UnlimitedRow { .. }
            | Kind::EmptyLogic { .. }
            | Kind::NeverTrue { .. } => "empty-statement",
            Kind::DuplicateName { .. } | Kind::InvalidName { .. } | Kind::UnknownName { .. } => {
                "name"
            }
            Kind::ForeignHandle { .. } | Kind::Misplaced { .. } => "handle",
            Kind::NotBinary { .. }
            | Kind::NotIntegral { .. }
            | Kind::IsParameter { .. }
            | Kind::NotParameter { .. } => "kind-of-variable",
            Kind::Stale { .. } => "out-of-date",
            Kind::UnboundedFunction { .. }
            | Kind::UnboundedSet { .. }
            | Kind::UnboundedIndicator { .. } => "no-bound",
            Kind::Pole { .. } => "pole",
            Kind::UnsafeBigM { .. } => "big-m",
            Kind::TooDeep { .. } => "too-deep",
            Kind::NotInFile { .. } => "not-in-file",
            Kind::NotConvex { .. }
            | Kind::NotCone { .. }
            | Kind::UnknownSign { .. }
            | Kind::NotConicRow { .. } => "not-convex",
            Kind::WrongCut { .. } => "wrong-cut",
            Kind::Shape { .. } | Kind::Length { .. } => "shape",
            Kind::Parse { .. } => "damaged-file",
            Kind::NoPoint { .. } | Kind::NoPlan { .. } => "no-point",
            Kind::NoMultipliers { .. } => "no-multipliers",
            Kind::Unsupported { .. } | Kind::Operator { .. } => "unsupported",
            Kind::Allocation => "memory",
            Kind::Io { .. } => "operating-system",
            Kind::Sweep { .. } => "sweep",
            Kind::Backend { .. } => "solver-failed",
            Kind::Scene(error) => of_scene(error),
            Kind::Run(RunError::Drift { .. }) => "drift",
            Kind::Run(_) => "not-certified",
            Kind::Robust(RobustError::Condition { .. } | RobustError::Violated { .. }) => {
                "not-certified"
            }
            Kind::Robust(_) => "tube",
            Kind::Terminal(_) => "terminal-set",
            Kind::DeadEnd(_) => "dead-end",
            Kind::Other => "other",
        }
    }
}

fn of_scene(error: &SceneError) -> &'static str {
    match error {
        SceneError::Inside { .. } | SceneError::Limits { .. } | SceneError::Cut { .. } => {
            "start-or-goal"
        }
        SceneError::Replay { .. } => "not-certified",
        SceneError::Axes { .. }
        | SceneError::Normal { .. }
        | SceneError::Crossed { .. }
        | SceneError::NoExtent { .. }
        | SceneError::Course { .. }
        | SceneError::Surface { .. }
        | SceneError::Spin { .. }
        | SceneError::Forces { .. }
        | SceneError::Rule { .. }
        | SceneError::NoDamageLimitRange { .. } => "scene",
    }
}
