//! Plans of one body at one obstacle on a line.

use super::plan::{BodyPath, SceneHit};
use super::replay::SceneCertificate;
pub use super::replay::advance_line;
use super::statement::Scene;
use super::units::SceneUnits;
use crate::error::{Error, check_finite};
use crate::hybrid::horizon::Horizon;

/// The samples of a plan of one body on a line over τ steps.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// x(0), ..., x(τ), in m.
    pub position: &'a [f64],
    /// v(0), ..., v(τ), in m/s.
    pub velocity: &'a [f64],
    /// a(0), ..., a(τ-1), in m/s².
    pub acceleration: &'a [f64],
    /// Whether the body hits the obstacle, by step.
    pub contact: &'a [bool],
}

/// Replays samples through a scene of one body and one obstacle on a line, in the user's units.
///
/// # Errors
///
/// As for [`Scene::replay`], and for numbers that are not finite.
pub fn replay_line(
    scene: &Scene,
    samples: &Samples<'_>,
) -> Result<(Vec<SceneHit>, SceneCertificate), Error> {
    let (scene, path) = checked_path(scene, samples)?;
    let mut hits = Vec::new();
    if let Some(obstacle) = scene.obstacles.first() {
        let name = format!("{} at {}", path.name, obstacle.name);
        let steps = samples.contact.iter().enumerate().filter(|(_, hits)| **hits);
        hits.extend(steps.map(|(t, _)| SceneHit::new(t, name.clone(), &path.name, 0)));
    }
    let certificate = SceneUnits::plain().replayed(&scene, &[path], &mut hits)?;
    Ok((hits, certificate))
}

/// A checked scene of one body, and the path of that body.
fn checked_path(scene: &Scene, samples: &Samples<'_>) -> Result<(Scene, BodyPath), Error> {
    let Samples { position, velocity, acceleration, .. } = *samples;
    Horizon::new(acceleration.len(), scene.time_step)?;
    for (what, values) in
        [("a position", position), ("a velocity", velocity), ("an acceleration", acceleration)]
    {
        check_finite("the plan", what, values.iter().copied())?;
    }
    let scene = scene.checked_as_stated()?;
    let column = |values: &[f64]| values.iter().map(|&x| vec![x]).collect();
    let path = BodyPath {
        name: scene.bodies.first().map_or_else(String::new, |body| body.name.clone()),
        position: column(position),
        velocity: column(velocity),
        acceleration: column(acceleration),
        spin: Vec::new(),
        torque: Vec::new(),
        heading: Vec::new(),
    };
    scene.check_paths(std::slice::from_ref(&path))?;
    Ok((scene, path))
}
