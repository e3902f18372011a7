//! Obstacles in the plane and over time.

use super::plans::ScenePicture;
use super::view::{MARGIN, Track, View, kind, moved};
use super::words::short;
use crate::hybrid::scene::geometry::{Side, corners, dot};
use crate::hybrid::scene::solid::Solid;
use crate::picture::{AVOIDED, COLOURS, Chart, Mover, Outline, SOLID};

/// An obstacle is named if it takes so large a part of the picture along both axes.
const NAMED_FROM: f64 = 0.12;

/// Grey, for outlines and names.
const GREY: &str = COLOURS[COLOURS.len() - 1];

/// A convex polygon, around its middle.
fn around(sides: &[Side]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> =
        corners(sides, 2).into_iter().map(|(corner, _)| [corner[0], corner[1]]).collect();
    let middle = centre(&points);
    let angle = |p: &[f64; 2]| (p[1] - middle[1]).atan2(p[0] - middle[0]);
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    points
}

fn centre(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len().max(1) as f64)
}

/// Obstacles in the plane.
pub(super) fn in_plane(chart: &mut Chart, picture: &ScenePicture, view: &View) {
    // Those that move are above the others.
    let (moving, still): (Vec<&Solid>, Vec<&Solid>) =
        picture.scene.obstacles.iter().partition(|solid| kind(solid).0);
    for solid in still {
        let points = around(&[moved(solid, 0, 2), view.sides()].concat());
        if points.len() < 3 {
            continue;
        }
        chart.area("", if kind(solid).1 { SOLID } else { AVOIDED }, 1.0, points.iter().copied());
        chart.line_of_width(1.0, "", GREY, points.iter().chain(points.first()).copied());
        let is_wide = |i: usize| {
            let low = points.iter().map(|p| p[i]).fold(f64::INFINITY, f64::min);
            let high = points.iter().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max);
            high - low > NAMED_FROM * (view.high[i] - view.low[i])
        };
        if is_wide(0) && is_wide(1) {
            chart.label_if_room(solid.name.as_str(), GREY, centre(&points));
        }
    }
    moving.into_iter().for_each(|solid| at_times(chart, picture, view, solid));
}

/// A moving obstacle: at the start, when a body is nearest, and at the end.
fn at_times(chart: &mut Chart, picture: &ScenePicture, view: &View, solid: &Solid) {
    let plan = &picture.plans[0].1;
    let (first, last) = (solid.displacement(0, 2), solid.displacement(plan.steps(), 2));
    let far = |sample: &usize| {
        let sides = moved(solid, *sample, 2);
        let places = plan.bodies.iter().map(|path| &path.position[*sample]);
        let outside = places.map(|x| {
            let own = sides.iter().map(|(normal, limit)| dot(normal, x) - limit);
            own.fold(f64::NEG_INFINITY, f64::max)
        });
        outside.fold(f64::INFINITY, f64::min)
    };
    let nearest = (0..=plan.steps()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
    for (sample, opacity) in [(0, 0.1), (plan.steps(), 0.1), (nearest, 0.4)] {
        let mut points = around(&[moved(solid, sample, 2), view.sides()].concat());
        if points.len() < 3 {
            continue;
        }
        chart.area("", GREY, opacity, points.iter().copied());
        // At its rear, which differs most from time to time.
        let ahead = |p: &[f64; 2]| p[0] * (last[0] - first[0]) + p[1] * (last[1] - first[1]);
        points.sort_by(|a, b| ahead(a).total_cmp(&ahead(b)).then(b[0].total_cmp(&a[0])));
        let time = short(sample as f64 * plan.time_step);
        chart.label(format!("{} at {time} s", solid.name), GREY, points[0]);
    }
}

/// Obstacles along a track, over time.
pub(super) fn over_time(chart: &mut Chart, picture: &ScenePicture, track: &Track) {
    let axes = picture.scene.axes();
    let steps = picture.plans.iter().map(|(_, plan)| plan.steps()).max().unwrap_or(0);
    let time = |sample: usize| sample as f64 * picture.plans[0].1.time_step;
    for solid in &picture.scene.obstacles {
        let (moves, bounces) = kind(solid);
        let fill = if bounces { SOLID } else { AVOIDED };
        let ends: Vec<(f64, [f64; 2])> = match moves {
            true => (0..=steps).map(|sample| (sample, time(sample))).collect(),
            false => vec![(0, -MARGIN * time(steps)), (0, (1.0 + MARGIN) * time(steps))],
        }
        .into_iter()
        .filter_map(|(sample, time)| Some((time, track.cut(&moved(solid, sample, axes))?)))
        .collect();
        let below = ends.iter().map(|(time, [low, _])| [*time, *low]);
        let above = ends.iter().rev().map(|(time, [_, high])| [*time, *high]);
        chart.area("", fill, 1.0, below.chain(above));
        if let Some((_, [low, high])) = ends.first() {
            let at = [0.5 * time(steps), 0.5 * (low + high)];
            chart.label_if_room(solid.name.as_str(), GREY, at);
        }
    }
}

/// Moving obstacles, as they move.
pub(super) fn animate(chart: &mut Chart, picture: &ScenePicture, period: f64) {
    let plan = &picture.plans[0].1;
    let view = View::in_plane(picture);
    for solid in picture.scene.obstacles.iter().filter(|solid| kind(solid).0) {
        let first = solid.displacement(0, 2);
        let displaced = solid.course.iter().map(|x| (x[0] - first[0]).hypot(x[1] - first[1]));
        // As much of it as may come into view.
        let beyond = displaced.fold(0.0, f64::max);
        let all = View {
            low: view.low.map(|low| low - beyond),
            high: view.high.map(|high| high + beyond),
        };
        let start = around(&[moved(solid, 0, 2), all.sides()].concat());
        if start.len() < 3 {
            continue;
        }
        let places = (0..=plan.steps()).map(|sample| {
            let place = solid.displacement(sample, 2);
            (sample as f64 * plan.time_step, [place[0] - first[0], place[1] - first[1]])
        });
        // Around the middle, as places are absolute.
        let middle = centre(&start);
        let corners = start.iter().map(|p| [p[0] - middle[0], p[1] - middle[1]]).collect();
        let places = places.map(|(t, p)| (t, [middle[0] + p[0], middle[1] + p[1]])).collect();
        chart.animate(Mover {
            colour: GREY.to_owned(),
            outline: Outline::Polygon(corners),
            opacity: 0.6,
            places,
            period,
        });
    }
}
