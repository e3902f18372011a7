//! The sentences and names in a picture.

use super::motion::{Goal, Motion};
use super::plans::ScenePicture;
use crate::picture::plain;

/// Slower is at rest, in m/s.
const AT_REST: f64 = 0.005;

/// A number with at most two digits after the point.
pub(super) fn short(value: f64) -> String {
    plain((100.0 * value).round() / 100.0)
}

/// The name of a path: the plan where several race, and the body where there are several.
pub(super) fn name(picture: &ScenePicture, number: usize) -> String {
    let bodies = picture.scene.bodies.len();
    let (plan, body) =
        (&picture.plans[number / bodies].0, &picture.scene.bodies[number % bodies].name);
    match (plan.is_empty(), bodies > 1) {
        (true, _) => body.clone(),
        (false, true) => format!("{body}, {plan}"),
        (false, false) => plan.clone(),
    }
}

/// The names beside a path. Where there are several bodies, their ends have their names.
pub(super) fn beside(picture: &ScenePicture, number: usize) -> String {
    let is_named = picture.plans.len() == 1 && picture.scene.bodies.len() > 1;
    if is_named { String::new() } else { name(picture, number) }
}

/// With the name of the body, where there are several.
pub(super) fn of(picture: &ScenePicture, motion: &Motion<'_>, text: &str) -> String {
    match picture.scene.bodies.len() > 1 {
        true => format!("{}: {text}", motion.path.name),
        false => text.to_owned(),
    }
}

fn moving(speed: f64) -> String {
    if speed < AT_REST { "at rest".to_owned() } else { format!("{} m/s", short(speed)) }
}

/// An end of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PathEnd {
    Start,
    /// A goal that is one place.
    Goal,
    /// Anywhere, or somewhere in a goal that has an extent.
    Open,
}

/// Both ends, with the speeds there.
pub(super) fn ends(motion: &Motion<'_>) -> [(PathEnd, String); 2] {
    let start = format!("start, {}", moving(motion.speed(0)));
    let last = moving(motion.speed(motion.plan.steps()));
    let end = match motion.goal() {
        Some(Goal::Place) => (PathEnd::Goal, format!("goal, {last}")),
        Some(Goal::Extended(_)) | None => (PathEnd::Open, format!("end, {last}")),
    };
    [(PathEnd::Start, start), end]
}

/// How long the plans take.
pub(super) fn title(picture: &ScenePicture) -> String {
    let names: Vec<&str> = picture.scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let times: Vec<String> =
        picture.plans.iter().map(|(_, plan)| format!("{} s", short(plan.duration()))).collect();
    format!("{}: {}", names.join(" and "), times.join(" against "))
}

/// The picture in words.
pub(super) fn about(picture: &ScenePicture) -> String {
    let mut parts = Vec::new();
    for (number, (motion, _)) in picture.motions().into_iter().enumerate() {
        let place = |x: &[f64]| {
            let x: Vec<String> = x.iter().map(|x| short(*x)).collect();
            format!("({}) m", x.join(", "))
        };
        let hits = motion.hits().map(|hit| {
            let (time, speed) = (short(hit.time), short(hit.speed));
            format!(", hits at {} after {time} s with {speed} m/s", place(&hit.place))
        });
        let steps = motion.plan.steps();
        parts.push(format!(
            "{} starts at {}, {}{}, and is at {}, {}, after {} s.",
            name(picture, number),
            place(&motion.path.position[0]),
            moving(motion.speed(0)),
            hits.take(6).collect::<String>(),
            place(&motion.path.position[steps]),
            moving(motion.speed(steps)),
            short(motion.plan.duration())
        ));
    }
    parts.join(" ")
}
