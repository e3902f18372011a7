//! One step less than the shortest plan: the sets that do not meet.

use carom::Error;
use carom::hybrid::Shortest;
use carom::hybrid::reach::ReachSet;
use serde::Serialize;

use crate::task::round;

/// The most samples of which sets are told.
const SAMPLES: usize = 120;

/// Corners of a set in a plane of two states.
type Outline = Vec<[f64; 2]>;

/// For some samples of a horizon that sets refute: where the body can be after so many steps, and from
/// where its goal can be reached in the steps that are left. No state is in both.
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

impl Less {
    /// The sets of the horizon that is one step too short; `None` if sets do not refute it.
    ///
    /// # Arguments
    ///
    /// * `plane`: the numbers of the two states of the outlines.
    pub fn new<P>(
        side: &'static str,
        found: &Shortest<P>,
        plane: [usize; 2],
    ) -> Result<Option<Less>, Error> {
        let (Some(steps), Some(sets)) = (found.refuted_steps, &found.sets) else { return Ok(None) };
        let mut sets = sets.clone();
        if !sets.tube(steps)?.is_empty() {
            return Ok(None);
        }
        let every = steps.div_ceil(SAMPLES).max(1);
        let mut less =
            Less { side, steps, at: Vec::new(), forward: Vec::new(), backward: Vec::new() };
        for step in (0..=steps).step_by(every) {
            less.at.push(step);
            less.forward.push(outlines(&sets.forward(step)?, plane)?);
            less.backward.push(outlines(&sets.backward(steps - step)?, plane)?);
        }
        Ok(Some(less))
    }
}

fn outlines(sets: &[Option<ReachSet>], [i, j]: [usize; 2]) -> Result<Vec<Outline>, Error> {
    let mut all: Vec<Outline> = Vec::new();
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
