//! Paths of bodies, with what happens along them.

use super::motion::{Goal, Motion, rectangle};
use super::obstacles;
use super::plans::ScenePicture;
use super::view::{MARGIN, SIZE, Track, View};
use super::words::{self, PathEnd, short};
use crate::hybrid::scene::body::Shape;
use crate::hybrid::scene::geometry::length;
use crate::interval::Interval;
use crate::picture::{Chart, GOAL_COLOUR, spacing};

/// The height of a picture over time, in pixels, and the most that one in the plane may have.
const OVER_TIME: f64 = 320.0;
const TALL: f64 = 520.0;

/// At about how many times bodies are shown, in one plan and in plans that race.
const TIMES: f64 = 11.0;
const RACE_TIMES: f64 = 6.0;

/// The length of the arrow of the largest impulse, as a part of the picture.
const ARROW: f64 = 0.09;

/// Marks nearer to each other than this part of the picture are one.
const APART: f64 = 0.05;

/// Paths in the plane of two axes.
pub(super) fn in_plane(picture: &ScenePicture, axes: [&str; 2]) -> Chart {
    let view = View::in_plane(picture);
    let [right, up] = axes.map(|axis| format!("{axis} (m)"));
    let mut chart = Chart::new(right, up)
        .with_size(SIZE, TALL)
        .with_equal_axes()
        .with_ranges((view.low[0]..=view.high[0]).into(), (view.low[1]..=view.high[1]).into());
    obstacles::in_plane(&mut chart, picture, &view);
    let size = (view.high[0] - view.low[0]).max(view.high[1] - view.low[1]);
    goals(&mut chart, picture, [0, 1].map(|i| (view.low[i]..=view.high[i]).into()));
    let times = if picture.plans.len() > 1 { RACE_TIMES } else { TIMES };
    let every = spacing(picture.duration(), times);
    let mut ends: Vec<(Vec<f64>, String)> = Vec::new();
    for (number, (motion, colour)) in picture.motions().into_iter().enumerate() {
        let name = words::beside(picture, number);
        let places = motion.places().into_iter().map(|(_, x)| [x[0], x[1]]);
        chart.line(name, colour, places);
        // Bodies at several times.
        let mut last: Option<Vec<f64>> = None;
        let apart = (APART * size).max(1.2 * motion.body.shape.reach(&[1.0, 0.0]));
        let count = (motion.plan.duration() / every + 1e-9) as usize;
        for k in 0..=count + 1 {
            let time = (k as f64 * every).min(motion.plan.duration());
            let place = motion.at(time);
            let near = last.as_ref().is_some_and(|last| distance(last, &place) < apart);
            if near && k <= count {
                continue;
            }
            let at_end = k == 0 || k > count;
            if !(at_end && ends.iter().any(|(own, _)| distance(own, &place) < 1e-6 * picture.unit))
            {
                ghost(&mut chart, &motion, (time, &place), colour);
            }
            if k > 0 && k <= count && time < motion.plan.duration() - 0.3 * every {
                chart.label_if_room(format!("{} s", short(time)), colour, [place[0], place[1]]);
            }
            last = Some(place);
        }
        hits(&mut chart, &motion, colour, size, |_, place| [place[0], place[1]]);
        // Plans that race have the same ends.
        for (end, text) in words::ends(&motion) {
            let sample = if end == PathEnd::Start { 0 } else { motion.plan.steps() };
            let place = motion.path.position[sample].clone();
            let known = ends.iter().any(|(own, word)| {
                distance(own, &place) < APART * size
                    && word.split(',').next() == text.split(',').next()
            });
            if known {
                continue;
            }
            let text = words::of(picture, &motion, &text);
            let at = [place[0], place[1]];
            if end == PathEnd::Goal {
                chart.goal(text.as_str(), GOAL_COLOUR, at);
            } else if end == PathEnd::Open {
                chart.dots("", colour, 4.5, [at]);
                chart.label(text.as_str(), colour, at);
            } else {
                let colour = if picture.plans.len() > 1 { "black" } else { colour };
                let v = &motion.path.velocity[0];
                let speed = motion.speed(0);
                if speed > 1e-9 * picture.unit {
                    let length = ARROW * size / speed;
                    chart.arrow(colour, at, [at[0] + length * v[0], at[1] + length * v[1]]);
                }
                chart.start(text.as_str(), colour, at);
            }
            ends.push((place, text));
        }
    }
    chart
}

/// Goals that have an extent, once for each body, as far as they are visible.
fn goals(chart: &mut Chart, picture: &ScenePicture, visible: [Interval; 2]) {
    for (motion, _) in picture.motions().into_iter().take(picture.scene.bodies.len()) {
        let Some(Goal::Extended(ranges)) = motion.goal() else { continue };
        let [x, y] = [0, 1].map(|i| {
            let (own, seen) = (ranges[i], visible[i]);
            [own.lower.max(seen.lower), own.upper.min(seen.upper)]
        });
        if x[0] > x[1] || y[0] > y[1] {
            continue;
        }
        let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        chart.area("", GOAL_COLOUR, 0.2, corners);
        let text = words::of(picture, &motion, "goal");
        chart.label(text, GOAL_COLOUR, [0.5 * (x[0] + x[1]), y[1]]);
    }
}

/// Paths along a track, over time.
pub(super) fn over_time(picture: &ScenePicture, track: &Track) -> Chart {
    let label =
        if track.across.is_some() { ["x (m)", "y (m)"][track.axis] } else { "position (m)" };
    let end = picture.duration().max(1e-9);
    let [low, high] = track.range;
    let mut chart = Chart::new("time (s)", label)
        .with_size(SIZE, OVER_TIME)
        .with_ranges((-MARGIN * end..=(1.0 + MARGIN) * end).into(), (low..=high).into());
    obstacles::over_time(&mut chart, picture, track);
    let axis = track.axis;
    for (number, (motion, colour)) in picture.motions().into_iter().enumerate() {
        let places = motion.places();
        let direction: Vec<f64> =
            (0..picture.scene.axes()).map(|i| if i == axis { 1.0 } else { 0.0 }).collect();
        let reach = motion.body.shape.reach(&direction);
        if reach > 0.0 {
            let below = places.iter().map(|(time, x)| [*time, x[axis] - reach]);
            let above = places.iter().rev().map(|(time, x)| [*time, x[axis] + reach]);
            chart.area("", colour, 0.15, below.chain(above));
        }
        let name = words::beside(picture, number);
        chart.line(name, colour, places.iter().map(|(time, x)| [*time, x[axis]]));
        hits(&mut chart, &motion, colour, 0.0, |time, place| [time, place[axis]]);
        for (end, text) in words::ends(&motion) {
            let sample = if end == PathEnd::Start { 0 } else { motion.plan.steps() };
            let time = sample as f64 * motion.plan.time_step;
            let (text, at) =
                (words::of(picture, &motion, &text), [time, motion.path.position[sample][axis]]);
            match end {
                PathEnd::Start => chart.start(text, colour, at),
                PathEnd::Goal => chart.goal(text, GOAL_COLOUR, at),
                PathEnd::Open => {
                    chart.dots("", colour, 4.5, [at]);
                    chart.label(text, colour, at);
                }
            }
        }
    }
    chart
}

/// A body's shape at a time and a place, with a radius if it spins.
fn ghost(chart: &mut Chart, motion: &Motion<'_>, (time, place): (f64, &[f64]), colour: &str) {
    let at = [place[0], place[1]];
    match &motion.body.shape {
        Shape::Point => chart.dots("", colour, 3.5, [at]),
        Shape::Ball(radius) => {
            chart.discs("", colour, 0.14, *radius, [at]);
            if let Some((sin, cos)) = motion.turned(time).map(f64::sin_cos) {
                chart.line("", colour, [at, [at[0] + radius * cos, at[1] + radius * sin]]);
            }
        }
        Shape::Box(half) => chart.area("", colour, 0.14, rectangle(place, half)),
    }
}

/// Hits with their speeds, and impulses as arrows where these have a length.
fn hits(
    chart: &mut Chart,
    motion: &Motion<'_>,
    colour: &str,
    size: f64,
    at: impl Fn(f64, &[f64]) -> [f64; 2],
) {
    let largest = motion.plan.hits.iter().map(|hit| length(&hit.impulse)).fold(0.0, f64::max);
    let mut last: Option<[f64; 2]> = None;
    for hit in motion.hits() {
        let place = at(hit.time, &hit.place);
        let own = length(&hit.impulse);
        if own > 1e-3 * largest && size > 0.0 {
            let long = ARROW * size * (0.4 + 0.6 * own / largest) / own;
            let to = [place[0] + long * hit.impulse[0], place[1] + long * hit.impulse[1]];
            chart.arrow("black", place, to);
        }
        chart.dots("", colour, 4.5, [place]);
        let text = format!("hit at {} m/s", short(hit.speed));
        let near = last.is_some_and(|last| distance(&last, &place) < APART * size.max(1e-9));
        match near || hit.speed < 0.005 {
            true => {}
            false => chart.label(text, "black", place),
        }
        last = Some(place);
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
