//! Half-spaces of states and inputs: limits and guards.

use super::schedule::Schedule;

/// A named half-space `normal . (state, input) <= limit`; without coefficients of inputs, it does
/// not depend on them.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Halfspace {
    pub name: String,
    pub normal: Vec<f64>,
    /// By step; infinite at steps at which nothing is limited.
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::serialized::write_limits"))]
    #[cfg_attr(feature = "serde", serde(deserialize_with = "super::serialized::read_limits"))]
    pub limit: Schedule<f64>,
    /// Whether an explanation may drop it.
    pub is_limit: bool,
}

impl Halfspace {
    pub fn new(
        name: impl Into<String>,
        normal: impl Into<Vec<f64>>,
        limit: impl Into<Schedule<f64>>,
    ) -> Self {
        let (name, normal, limit) = (name.into(), normal.into(), limit.into());
        Halfspace { name, normal, limit, is_limit: false }
    }

    pub fn limit(
        name: impl Into<String>,
        normal: impl Into<Vec<f64>>,
        limit: impl Into<Schedule<f64>>,
    ) -> Self {
        Halfspace { is_limit: true, ..Halfspace::new(name, normal, limit) }
    }

    /// `normal . (state, input) = value`, as two half-spaces with the same name.
    pub fn equality(
        name: impl Into<String>,
        normal: impl Into<Vec<f64>>,
        value: f64,
    ) -> [Halfspace; 2] {
        let (name, normal) = (name.into(), normal.into());
        let opposite: Vec<f64> = normal.iter().map(|n| -n).collect();
        [Halfspace::new(name.clone(), normal, value), Halfspace::new(name, opposite, -value)]
    }

    /// The coefficients of the states and of the inputs; the latter may be empty.
    pub(crate) fn parts(&self, states: usize) -> (&[f64], &[f64]) {
        self.normal.split_at(states.min(self.normal.len()))
    }

    /// Whether an input has a coefficient other than 0.
    pub(crate) fn is_joint(&self, states: usize) -> bool {
        self.parts(states).1.iter().any(|&n| n != 0.0)
    }

    /// The limit at a step of a half-space that has been checked.
    pub(crate) fn limit_at(&self, step: usize) -> f64 {
        self.limit.get(step).copied().unwrap_or(f64::INFINITY)
    }
}
