//! The visible part of a scene.

use super::motion::Goal;
use super::plans::ScenePicture;
use crate::hybrid::scene::geometry::{Side, corners, dot};
use crate::hybrid::scene::solid::Solid;
use crate::hybrid::scene::statement::Scene;
use crate::interval::Interval;

/// The longer side of the drawing, in pixels.
pub(super) const SIZE: f64 = 640.0;

/// The time that is visible before and after a plan, as a part of its duration.
pub(super) const MARGIN: f64 = 0.03;

/// Obstacles are shown as far as this from the paths, as a part of the size of these.
const NEARBY: f64 = 0.5;

/// The shorter side of the plane, as a part of the longer one, at least.
const NARROW: f64 = 0.3;

/// Movement across a line below this is none, in m.
const STRAIGHT: f64 = 1e-6;

/// The visible part of the plane of two coordinates, or of time and one.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

/// A line along which all bodies move: its axis, and where it is along the other one, if there is
/// one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Track {
    pub(super) axis: usize,
    pub(super) across: Option<f64>,
    /// The visible range along the axis, in m.
    pub(super) range: [f64; 2],
}

impl View {
    /// The track, where all bodies move on one.
    pub(super) fn over_time(picture: &ScenePicture) -> Option<Track> {
        let scene = &picture.scene;
        let axes = scene.axes();
        let places = || {
            let paths = picture.plans.iter().flat_map(|(_, plan)| &plan.bodies);
            paths.flat_map(|path| &path.position)
        };
        let spread = |axis: usize| {
            let values = || places().map(|place| place[axis]);
            let low = values().fold(f64::INFINITY, f64::min);
            (low, values().fold(f64::NEG_INFINITY, f64::max))
        };
        let axis = (0..axes).max_by(|&a, &b| {
            let wide = |axis: usize| spread(axis).1 - spread(axis).0;
            wide(a).total_cmp(&wide(b)).then(b.cmp(&a))
        })?;
        let across = (axes > 1).then(|| spread(1 - axis));
        if across.is_some_and(|(low, high)| high - low > STRAIGHT * picture.unit) {
            return None;
        }
        let across = across.map(|(low, _)| low);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (motion, _) in picture.motions() {
            let reach = motion.body.shape.reach(&along(axes, axis));
            for place in &motion.path.position {
                (low, high) = (low.min(place[axis] - reach), high.max(place[axis] + reach));
            }
        }
        // Obstacles that are near.
        let size = (high - low).max(0.1 * picture.unit);
        let near = [low - NEARBY * size, high + NEARBY * size];
        let mut range = [low, high];
        for solid in &scene.obstacles {
            for sample in [0, picture.plans[0].1.steps()] {
                let track = Track { axis, across, range: near };
                let Some(ends) = track.cut(&moved(solid, sample, axes)) else { continue };
                for end in ends.into_iter().filter(|end| *end > near[0] && *end < near[1]) {
                    range = [range[0].min(end), range[1].max(end)];
                }
            }
        }
        let room = 0.1 * (range[1] - range[0]).max(0.1 * picture.unit);
        Some(Track { axis, across, range: [range[0] - room, range[1] + room] })
    }

    /// The visible part of the plane: the paths, and the obstacles that are near.
    pub(super) fn in_plane(picture: &ScenePicture) -> View {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut include = |place: [f64; 2]| {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        };
        for (motion, _) in picture.motions() {
            let reach = [0, 1].map(|axis| motion.body.shape.reach(&along(2, axis)));
            for (_, place) in motion.places() {
                for sign in [-1.0, 1.0] {
                    include([place[0] + sign * reach[0], place[1] + sign * reach[1]]);
                }
            }
        }
        let size = (high[0] - low[0]).max(high[1] - low[1]).max(0.1 * picture.unit);
        let near = [0, 1].map(|axis| (low[axis] - NEARBY * size, high[axis] + NEARBY * size));
        let motions = picture.motions();
        let goals = motions.iter().filter_map(|(motion, _)| match motion.goal()? {
            Goal::Extended(ranges) => Some(ranges),
            Goal::Place => None,
        });
        let ends = |ranges: Vec<Interval>| {
            [ranges.iter().map(|r| r.lower).collect(), ranges.iter().map(|r| r.upper).collect()]
        };
        let corners = nearby(&picture.scene, picture.plans[0].1.steps());
        for corner in corners.into_iter().chain(goals.flat_map(ends)) {
            for axis in 0..2 {
                let value = corner[axis];
                if value >= near[axis].0 && value <= near[axis].1 {
                    low[axis] = low[axis].min(value);
                    high[axis] = high[axis].max(value);
                }
            }
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let long = extent[0].max(extent[1]).max(0.1 * picture.unit);
        for axis in 0..2 {
            let missing = (NARROW * long - extent[axis]).max(0.0);
            low[axis] -= 0.5 * missing + 0.05 * long;
            high[axis] += 0.5 * missing + 0.05 * long;
        }
        View { low, high }
    }

    /// As sides, for clipping.
    pub(super) fn sides(&self) -> Vec<Side> {
        (0..2).flat_map(|i| [(along(2, i), self.high[i]), (against(2, i), -self.low[i])]).collect()
    }
}

impl Track {
    /// Where sides leave room for something solid along the track.
    pub(super) fn cut(&self, sides: &[Side]) -> Option<[f64; 2]> {
        let [mut low, mut high] = self.range;
        for (normal, limit) in sides {
            let own = normal[self.axis];
            let rest = limit - self.across.map_or(0.0, |across| normal[1 - self.axis] * across);
            if own > 1e-12 {
                high = high.min(rest / own);
            } else if own < -1e-12 {
                low = low.max(rest / own);
            } else if rest < 0.0 {
                return None;
            }
        }
        (low < high).then_some([low, high])
    }
}

/// The corners of obstacles within the domain of the bodies, at both ends of a plan.
fn nearby(scene: &Scene, steps: usize) -> Vec<Vec<f64>> {
    let mut places = Vec::new();
    for solid in &scene.obstacles {
        for sample in [0, steps] {
            let mut sides = moved(solid, sample, 2);
            for (i, range) in scene.bodies.iter().flat_map(|body| body.domain.iter().enumerate()) {
                if range.lower.is_finite() && range.upper.is_finite() {
                    sides.extend([(along(2, i), range.upper), (against(2, i), -range.lower)]);
                }
            }
            places.extend(corners(&sides, 2).into_iter().map(|(corner, _)| corner));
        }
    }
    places
}

fn along(axes: usize, axis: usize) -> Vec<f64> {
    (0..axes).map(|i| if i == axis { 1.0 } else { 0.0 }).collect()
}

fn against(axes: usize, axis: usize) -> Vec<f64> {
    (0..axes).map(|i| if i == axis { -1.0 } else { 0.0 }).collect()
}

/// The sides of an obstacle at a sample.
pub(super) fn moved(solid: &Solid, sample: usize, axes: usize) -> Vec<Side> {
    let place = solid.displacement(sample, axes);
    let sides = solid.faces.iter();
    sides.map(|face| (face.normal.clone(), face.offset + dot(&face.normal, &place))).collect()
}

/// Whether it moves, and whether bodies may bounce off it.
pub(super) fn kind(solid: &Solid) -> (bool, bool) {
    let bounces = solid.faces.iter().any(|face| face.surface.restitution.is_some());
    (!solid.course.is_empty(), bounces)
}
