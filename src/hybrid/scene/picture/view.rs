//! From metres and seconds to pixels.

use crate::hybrid::scene::geometry::{Side, corners, dot};
use crate::hybrid::scene::plan::ScenePlan;
use crate::hybrid::scene::solid::Solid;
use crate::hybrid::scene::statement::Scene;
use crate::picture::Frame;

/// The longer side of the drawing, and the space around it, in pixels.
const SIZE: f64 = 640.0;
pub(super) const MARGIN: f64 = 56.0;

/// From metres (and seconds) to pixels.
pub(super) struct View {
    pub(super) frame: Frame,
    /// Whether the first axis is time.
    pub(super) is_line: bool,
}

impl View {
    pub(super) fn new(scene: &Scene, plan: &ScenePlan) -> View {
        let is_line = scene.axes() == 1;
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let mut include = |axis: usize, value: f64| {
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        };
        let own = usize::from(is_line);
        for (body, path) in scene.bodies.iter().zip(&plan.bodies) {
            for (i, axis) in (own..2).enumerate() {
                let unit = |k: usize| if k == i { 1.0 } else { 0.0 };
                let along: Vec<f64> = (0..scene.axes()).map(unit).collect();
                let reach = body.shape.reach(&along);
                for place in &path.position {
                    include(axis, place[i] - reach);
                    include(axis, place[i] + reach);
                }
            }
        }
        // Obstacles with an inside of their own are shown whole.
        for solid in scene.obstacles.iter().filter(|solid| solid.faces.len() > 1) {
            for sample in [0, plan.steps()] {
                let sides = moved(solid, sample, scene.axes());
                for (corner, _) in corners(&sides, scene.axes()) {
                    (own..2).enumerate().for_each(|(i, axis)| include(axis, corner[i]));
                }
            }
        }
        if is_line {
            include(0, 0.0);
            include(0, plan.duration());
        }
        for axis in own..2 {
            let wide = 0.06 * (high[axis] - low[axis]).max(0.1);
            low[axis] -= wide;
            high[axis] += wide;
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let size = match is_line {
            true => [SIZE, 0.6 * SIZE],
            false => extent.map(|side| SIZE * side / extent[0].max(extent[1])),
        };
        let frame = Frame { low, high, corner: [MARGIN; 2], size, is_logarithmic: false };
        View { frame, is_line }
    }

    /// A place at a time, in pixels.
    pub(super) fn place(&self, time: f64, place: &[f64]) -> [f64; 2] {
        match self.is_line {
            true => self.frame.pixel([time, place[0]]),
            false => self.frame.pixel([place[0], place[1]]),
        }
    }

    pub(super) fn width(&self) -> f64 {
        2.0 * MARGIN + self.frame.size[0]
    }

    pub(super) fn height(&self) -> f64 {
        2.0 * MARGIN + self.frame.size[1]
    }

    /// The frame as sides, for clipping.
    pub(super) fn sides(&self) -> Vec<Side> {
        let Frame { low, high, .. } = &self.frame;
        vec![
            (vec![-1.0, 0.0], -low[0]),
            (vec![1.0, 0.0], high[0]),
            (vec![0.0, -1.0], -low[1]),
            (vec![0.0, 1.0], high[1]),
        ]
    }
}

/// The sides of an obstacle at a sample.
pub(super) fn moved(solid: &Solid, sample: usize, axes: usize) -> Vec<Side> {
    let place = solid.displacement(sample, axes);
    let sides = solid.faces.iter();
    sides.map(|face| (face.normal.clone(), face.offset + dot(&face.normal, &place))).collect()
}
