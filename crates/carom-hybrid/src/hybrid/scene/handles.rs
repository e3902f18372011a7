//! Handles of a scene: its rules, pairs, expressions and rows are stated with them.

use crate::hybrid::system::State;
use crate::model::{ModelTag, Variable};

/// A body of a [`Scene`](super::Scene), made by [`Scene::body`](super::Scene::body).
///
/// Its positions, velocities and accelerations stand in expressions of the scene's
/// [programs](super::Scene::program), as those of a [system](crate::hybrid::HybridSystem) do. An
/// axis that the body does not have gives a handle that programs refuse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BodyHandle {
    pub(super) tag: ModelTag,
    pub(super) number: usize,
    pub(super) axes: usize,
}

impl BodyHandle {
    /// The position along an axis, 0, 1 or 2, in m.
    pub fn position(self, axis: usize) -> State {
        State::of(self.handle(axis, 2 * axis))
    }

    /// The velocity along an axis, 0, 1 or 2, in m/s.
    pub fn velocity(self, axis: usize) -> State {
        State::of(self.handle(axis, 2 * (self.axes + axis)))
    }

    /// The input along an axis, 0, 1 or 2, in m/s².
    pub fn acceleration(self, axis: usize) -> Variable {
        self.handle(axis, 4 * self.axes + axis)
    }

    /// A handle of the body by its place in the order of [`Scene::declared`](super::Scene): each
    /// state, followed by its prediction, the inputs, then the spin, its prediction and its torque,
    /// and the heading and its prediction.
    pub(super) fn handle(self, axis: usize, place: usize) -> Variable {
        let own = axis < self.axes;
        let index = if own { (5 * self.axes + 5) * self.number + place } else { usize::MAX };
        Variable::new(index, self.tag)
    }
}

/// An obstacle of a [`Scene`](super::Scene), made by [`Scene::obstacle`](super::Scene::obstacle).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ObstacleHandle {
    pub(super) tag: ModelTag,
    pub(super) number: usize,
}
