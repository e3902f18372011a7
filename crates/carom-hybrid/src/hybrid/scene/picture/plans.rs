//! The scene and the plans that a picture shows.

use super::motion::Motion;
use crate::error::{Error, check_length};
use crate::hybrid::scene::plan::ScenePlan;
use crate::hybrid::scene::statement::Scene;
use crate::hybrid::scene::units::SceneUnits;
use crate::picture::{WITH_COLLISION, WITHOUT_COLLISION};
use crate::setters::setters;

/// A picture of a plan of a scene, or of several plans that race, from
/// [`ScenePlan::picture`].
///
/// In the plane: paths among the obstacles on equal axes, with bodies at several times, start,
/// goal, and hits with their speeds and impulses. On a line, and where all bodies move along the
/// same line in the plane: positions over time. In space: the paths from above and from the side,
/// where obstacles are the shadows that they cast.
///
/// ```
/// use carom::hybrid::scene::{Body, Scene};
/// use carom::prelude::*;
///
/// let puck = Body::new("puck", [0.0..=2.0, 0.0..=1.0], 3.0, 4.0)
///     .with_start([0.2, 0.5, 0.0, 0.0])
///     .with_goal([0.4, 0.5, 0.0, 0.0]);
/// let scene = Scene::new(0.1).with_body(puck);
/// let found = scene.shortest(&mut BranchAndBound::default())?;
/// let plan = found.plan.expect("there is one");
/// let svg = plan.picture(&scene)?.with_title("A puck on a table").to_svg();
/// assert!(svg.contains("A puck on a table"));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScenePicture {
    pub(super) scene: Scene,
    /// The unit of length in which small lengths are told, in m.
    pub(super) unit: f64,
    /// Plans and what they are called.
    pub(super) plans: Vec<(String, ScenePlan)>,
    pub(super) title: String,
}

impl ScenePicture {
    setters! {
        /// Sets the title; further lines are smaller. By default it says how long the plan takes.
        with_title(title: impl Into<String>) => title = title.into();
    }

    /// Calls the plan a name, which stands beside its path.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.plans[0].0 = name.into();
        self
    }

    /// Draws another plan into the same picture, in another colour, and how long both take below
    /// it. The plan may be of a scene with other surfaces and rules.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::error::ErrorKind::Length) for a plan of other bodies or along
    /// other axes.
    pub fn with_rival(mut self, name: impl Into<String>, plan: &ScenePlan) -> Result<Self, Error> {
        check(&self.scene, plan)?;
        self.plans.push((name.into(), plan.clone()));
        Ok(self)
    }

    pub(super) fn new(scene: &Scene, plan: &ScenePlan) -> Result<Self, Error> {
        let (scene, unit) = (scene.checked()?, SceneUnits::of(scene).length);
        check(&scene, plan)?;
        let plans = vec![(String::new(), plan.clone())];
        Ok(ScenePicture { scene, unit, plans, title: String::new() })
    }

    /// The longest duration, in s.
    pub(super) fn duration(&self) -> f64 {
        self.plans.iter().map(|(_, plan)| plan.duration()).fold(0.0, f64::max)
    }

    /// All bodies of all plans, with their colours: those of plans with collisions, or without.
    pub(super) fn motions(&self) -> Vec<(Motion<'_>, &'static str)> {
        let (mut with, mut without) =
            (WITH_COLLISION.iter().cycle(), WITHOUT_COLLISION.iter().cycle());
        let mut all = Vec::new();
        for (_, plan) in &self.plans {
            for (body, path) in self.scene.bodies.iter().zip(&plan.bodies) {
                let next = if plan.hits.is_empty() { without.next() } else { with.next() };
                all.push((Motion { plan, body, path }, *next.unwrap_or(&"black")));
            }
        }
        all
    }
}

/// Refuses plans of other bodies or along other axes, and samples that are missing.
fn check(scene: &Scene, plan: &ScenePlan) -> Result<(), Error> {
    check_length("the bodies of the plan", plan.bodies.len(), scene.bodies.len())?;
    let steps = plan.steps();
    for path in &plan.bodies {
        check_length("the positions of a body", path.position.len(), steps + 1)?;
        check_length("the velocities of a body", path.velocity.len(), steps + 1)?;
        if !path.spin.is_empty() {
            check_length("the spins of a body", path.spin.len(), steps + 1)?;
        }
        for row in path.position.iter().chain(&path.velocity) {
            check_length("the axes of a body", row.len(), scene.axes())?;
        }
    }
    Ok(())
}
