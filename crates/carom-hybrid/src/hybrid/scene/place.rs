//! Where the hits that a rule counts happen.

use super::handles::{BodyHandle, ObstacleHandle};

/// Bodies, an obstacle and a face of it: hits of all of those that are given.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Where {
    pub(super) bodies: [Option<BodyHandle>; 2],
    pub(super) obstacle: Option<ObstacleHandle>,
    pub(super) face: Option<usize>,
}

impl Where {
    /// Whether a hit of some bodies at a face of an obstacle is there, all by their numbers.
    pub(super) fn contains(
        &self,
        bodies: [Option<usize>; 2],
        obstacle: Option<usize>,
        face: usize,
    ) -> bool {
        self.bodies.iter().flatten().all(|own| bodies.contains(&Some(own.number)))
            && self.obstacle.is_none_or(|own| obstacle == Some(own.number))
            && self.face.is_none_or(|own| own == face)
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_everywhere(&self) -> bool {
        *self == Where::default()
    }

    /// Handles mean something in their scene alone.
    #[cfg(feature = "serde")]
    pub(super) fn refused<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        let text = "a rule about some bodies or obstacles belongs to its scene; store the rule without \
                    them and state them again where it is read";
        Err(serde::ser::Error::custom(text))
    }
}
