//! Bodies among obstacles.

use carom::hybrid::scene::{self, Body, ScenePlan, Solid, Surface};
use carom::hybrid::{Restitution, ShortestHorizon, ShortestOptions};
use carom::interval::Interval;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use super::plan::answer;
use super::solve;
use crate::errors::exception;
use crate::numbers::bytes;
use crate::settings::{Settings, seconds};

/// Bodies among obstacles.
#[pyclass(module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct Scene {
    scene: scene::Scene,
}

/// Bounces with a restitution, or is to be avoided.
fn surface(restitution: Option<f64>) -> PyResult<Surface> {
    match restitution {
        None => Ok(Surface::avoid()),
        Some(e) => Ok(Surface::bounce(Restitution::new(e).map_err(|error| exception(&error))?)),
    }
}

/// Lower and upper ends.
fn ranges(given: &[(f64, f64)]) -> Vec<std::ops::RangeInclusive<f64>> {
    given.iter().map(|(lower, upper)| *lower..=*upper).collect()
}

fn intervals(given: &[(f64, f64)]) -> Vec<Interval> {
    given.iter().map(|&(lower, upper)| Interval::new(lower, upper)).collect()
}

#[pymethods]
impl Scene {
    #[new]
    fn new(time_step: f64) -> Self {
        Scene { scene: scene::Scene::new(time_step) }
    }

    #[expect(clippy::too_many_arguments, reason = "Python's side names them")]
    fn body(
        &mut self,
        name: &str,
        domain: Vec<(f64, f64)>,
        speed: f64,
        acceleration: f64,
        start: Vec<(f64, f64)>,
        goal: Vec<(f64, f64)>,
        first_acceleration: Option<Vec<f64>>,
    ) {
        let [start, goal] = [start, goal].map(|given| intervals(&given));
        let mut body =
            Body::new(name, ranges(&domain), speed, acceleration).with_start(start).with_goal(goal);
        if let Some(first) = first_acceleration {
            body = body.with_first_acceleration(first);
        }
        self.scene = self.scene.clone().with_body(body);
    }

    fn room(
        &mut self,
        name: &str,
        walls: Vec<(f64, f64)>,
        restitution: Option<f64>,
    ) -> PyResult<()> {
        let surface = surface(restitution)?;
        self.scene = self.scene.clone().with_room(name, ranges(&walls), surface);
        Ok(())
    }

    fn cuboid(
        &mut self,
        name: &str,
        sides: Vec<(f64, f64)>,
        restitution: Option<f64>,
    ) -> PyResult<()> {
        let solid = Solid::cuboid(name, ranges(&sides), surface(restitution)?);
        self.scene = self.scene.clone().with_obstacle(solid);
        Ok(())
    }

    fn polytope(
        &mut self,
        name: &str,
        faces: Vec<(Vec<f64>, f64)>,
        restitution: Option<f64>,
    ) -> PyResult<()> {
        let solid = Solid::polytope(name, faces, surface(restitution)?);
        self.scene = self.scene.clone().with_obstacle(solid);
        Ok(())
    }

    /// The plan with the fewest steps.
    fn shortest(
        &self,
        py: Python<'_>,
        max_steps: Option<usize>,
        total_time_limit: Option<f64>,
        settings: Settings,
    ) -> PyResult<ShortestInScene> {
        let mut options = ShortestOptions::default();
        options.max_steps = max_steps.unwrap_or(options.max_steps);
        options.time_limit = seconds(total_time_limit)?;
        let scene = self.scene.clone();
        let found = solve(py, &settings, move |interrupt, solver| {
            scene.shortest_with(&options.with_interrupt(interrupt), solver)
        })?;
        let text = found.to_string();
        let ShortestHorizon { steps, refuted_steps, plan, .. } = found;
        let scene = self.scene.clone();
        Ok(ShortestInScene { scene, steps, refuted_steps, text, plan })
    }
}

/// What a search for the shortest plan of a scene has found.
#[pyclass(frozen, module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct ShortestInScene {
    scene: scene::Scene,
    steps: Option<usize>,
    refuted_steps: Option<usize>,
    text: String,
    plan: Option<ScenePlan>,
}

/// Position, velocity and acceleration of a body, by sample and by step.
type Path<'py> = (String, usize, [Bound<'py, PyByteArray>; 3]);

#[pymethods]
impl ShortestInScene {
    #[getter]
    fn steps(&self) -> Option<usize> {
        self.steps
    }

    #[getter]
    fn refuted_steps(&self) -> Option<usize> {
        self.refuted_steps
    }

    fn answer(&self) -> Option<(Option<f64>, f64, bool)> {
        self.plan.as_ref().map(|plan| answer(&plan.solution))
    }

    fn paths<'py>(&self, py: Python<'py>) -> Vec<Path<'py>> {
        let bodies = self.plan.iter().flat_map(|plan| &plan.bodies);
        let path = |body: &scene::BodyPath| {
            let axes = body.position.first().map_or(0, Vec::len);
            let all = [&body.position, &body.velocity, &body.acceleration];
            (body.name.clone(), axes, all.map(|rows| bytes(py, &rows.concat())))
        };
        bodies.map(path).collect()
    }

    /// Hits: step, contact and body.
    fn hits(&self) -> Vec<(usize, String, String)> {
        let hits = self.plan.iter().flat_map(|plan| &plan.hits);
        hits.map(|hit| (hit.step, hit.contact.clone(), hit.body.clone())).collect()
    }

    fn svg(&self) -> PyResult<Option<String>> {
        let svg = self.plan.as_ref().map(|plan| plan.to_svg(&self.scene)).transpose();
        svg.map_err(|error| exception(&error))
    }

    fn __str__(&self) -> String {
        self.text.clone()
    }
}
