//! Where the hits that a rule counts happen.

use super::contact::ContactPair;
use super::handles::{BodyHandle, ObstacleHandle};
use super::statement::Scene;
use crate::error::Error;

/// Bodies, an obstacle and a face of it: hits of all of those that are given.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Where {
    pub(super) bodies: [Option<BodyHandle>; 2],
    pub(super) obstacle: Option<ObstacleHandle>,
    pub(super) face: Option<usize>,
}

impl Where {
    /// Whether a hit of a contact at a face is there, in a scene in which this has been checked.
    pub(super) fn contains(&self, contact: &ContactPair, face: usize) -> bool {
        let bodies = [Some(contact.body), contact.other];
        self.bodies.iter().flatten().all(|own| bodies.contains(&Some(own.number)))
            && self.obstacle.is_none_or(|own| contact.obstacle == Some(own.number))
            && self.face.is_none_or(|own| own == face)
    }

    /// Refuses handles of other scenes and faces that the obstacle does not have.
    pub(super) fn check(&self, scene: &Scene, rule: &str) -> Result<(), Error> {
        let place = format!("the rule `{rule}`");
        for body in self.bodies.iter().flatten() {
            scene.body_number(*body, &place)?;
        }
        let Some(obstacle) = self.obstacle else { return Ok(()) };
        let faces = scene.obstacles[scene.obstacle_number(obstacle, &place)?].faces.len();
        match self.face {
            Some(face) if face >= faces => {
                let what = format!("the face of the rule `{rule}`");
                Err(Error::out_of_range(what, face as f64, format!("below {faces}")))
            }
            _ => Ok(()),
        }
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
