//! The missions that a program requires.

use super::formula::Mission;
use crate::model::Affine;

/// A mission of a program, which plans are checked for.
#[derive(Debug, Clone)]
pub(crate) struct RequiredMission {
    pub(super) name: String,
    pub(super) mission: Mission,
    /// Of the model's variables: the robustness that the rows promise.
    pub(super) margin: Affine,
    /// The largest unit in which its rows are computed.
    pub(super) unit: f64,
}
