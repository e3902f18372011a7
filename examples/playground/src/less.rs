//! One step less than the shortest plan: the sets that do not meet.

use std::time::Duration;

use carom::collision_tolerant::Scenario;
use carom::hybrid::reach::{ReachSet, ReachSets};
use carom::hybrid::scene::Scene;
use carom::prelude::*;
use serde::Serialize;

use crate::scene_task::SceneTask;
use crate::search_options;
use crate::task::{Task, round};

/// The most samples of which sets are told.
const SAMPLES: usize = 60;
/// The longest horizon that is shown, in steps: of many that are refuted, a shorter one tells as
/// much.
const MOST_STEPS: usize = 600;
/// Position and velocity of the vehicle beside the wall, and the place of the first body of a
/// scene.
const PLANE: [usize; 2] = [0, 1];

/// Corners of a set in a plane of two states.
type Outline = Vec<[f64; 2]>;

/// For some samples of a horizon that sets refute: where the body can be after so many steps, and
/// from where its goal can be reached in the steps that are left. No state is in both.
#[derive(Debug, Serialize)]
pub struct Less {
    /// `free` or `tolerant`.
    side: &'static str,
    /// The horizon, in steps.
    steps: usize,
    /// The steps at the samples.
    at: Vec<usize>,
    /// Outlines from the start, by sample; several for different numbers of hits.
    forward: Vec<Vec<Outline>>,
    /// Outlines towards the goal.
    backward: Vec<Vec<Outline>>,
}

/// The sets of a task beside a wall, with collisions, and without if these are not refuted by sets.
///
/// # Arguments
///
/// * `free`, `tolerant`: the horizons that are refuted, in steps; 0 if there is none.
pub fn of_wall(task: &str, free: usize, tolerant: usize) -> Result<Option<Less>, String> {
    let scenario = Task::read(task)?.scenario().map_err(|error| error.to_string())?;
    let sets = |scenario: &Scenario| scenario.reach_sets();
    first(|| sets(&scenario), || sets(&scenario.clone().collision_free()), free, tolerant)
}

/// The same for a scene.
pub fn of_scene(task: &str, free: usize, tolerant: usize) -> Result<Option<Less>, String> {
    let task = SceneTask::read(task)?;
    // A search says with which sets it refutes.
    let sets = |scene: Scene| {
        let options = search_options(1).with_time_limit(Duration::ZERO);
        match scene.shortest_with(&options, &mut BranchAndBound::default())?.sets {
            Some(sets) => Ok(sets),
            None => scene.reach_sets(),
        }
    };
    first(|| sets(task.tolerant()?), || sets(task.free()?), free, tolerant)
}

fn first(
    tolerant_sets: impl FnOnce() -> Result<ReachSets, Error>,
    free_sets: impl FnOnce() -> Result<ReachSets, Error>,
    free: usize,
    tolerant: usize,
) -> Result<Option<Less>, String> {
    let find = || match Less::new("tolerant", tolerant_sets, tolerant)? {
        Some(less) => Ok(Some(less)),
        None => Less::new("free", free_sets, free),
    };
    find().map_err(|error: Error| error.to_string())
}

impl Less {
    /// The sets of a horizon; `None` if they do not refute it.
    fn new(
        side: &'static str,
        sets: impl FnOnce() -> Result<ReachSets, Error>,
        steps: usize,
    ) -> Result<Option<Less>, Error> {
        let steps = steps.min(MOST_STEPS);
        if steps == 0 {
            return Ok(None);
        }
        let mut sets = sets()?;
        if !sets.tube(steps)?.is_empty() {
            return Ok(None);
        }
        let every = steps.div_ceil(SAMPLES).max(1);
        let mut less =
            Less { side, steps, at: Vec::new(), forward: Vec::new(), backward: Vec::new() };
        for step in (0..=steps).step_by(every) {
            less.at.push(step);
            less.forward.push(outlines(&sets.forward(step)?)?);
            less.backward.push(outlines(&sets.backward(steps - step)?)?);
        }
        Ok(Some(less))
    }
}

fn outlines(sets: &[Option<ReachSet>]) -> Result<Vec<Outline>, Error> {
    let mut all: Vec<Outline> = Vec::new();
    let [i, j] = PLANE;
    for set in sets.iter().flatten() {
        let outline: Outline =
            set.outline(i, j)?.into_iter().map(|corner| corner.map(round)).collect();
        let is_finite = outline.iter().flatten().all(|value| value.is_finite());
        if is_finite && !all.contains(&outline) {
            all.push(outline);
        }
    }
    Ok(all)
}
