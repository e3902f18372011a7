//! One figure per figure of the paper: position, velocity and acceleration over time.

use std::path::{Path, PathBuf};

use carom::collision_tolerant::{Impact, Plan, Trajectory};
use carom::interval::Interval;
use carom::picture::{COLOURS, Chart, SOLID, WITH_COLLISION, WITHOUT_COLLISION};
use carom::prelude::*;

use super::cases::{Case, PAPER_RESTITUTIONS, SolvedCase};
use super::tube;

/// What the bars are.
const BARS: &str = "Bars: dark while it accelerates towards the wall, light away from it.";

type Curve<'a> = (String, &'a Trajectory);

/// Writes the figures into a folder and returns their paths.
pub(crate) fn write_all(
    results: &[SolvedCase],
    folder: &Path,
) -> Result<Vec<PathBuf>, Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    // Many plans are as short; those drawn push as hard as they can.
    let mut solver = BranchAndBound::default();
    let extreme = results.iter().map(|solved| match &solved.shortest.plan {
        Some(plan) => plan.extreme(&solved.scenario, &mut solver).map(Some),
        None => Ok(None),
    });
    let extreme: Vec<Option<Plan>> = extreme.collect::<Result<_, _>>()?;
    let curve = |plan: &Option<Plan>, label: String| -> Option<(String, Trajectory)> {
        Some((label, plan.as_ref()?.trajectory.clone()))
    };
    let (mut comparison, mut restitutions) = (Vec::new(), Vec::new());
    let (mut damage, mut destinations) = (Vec::new(), Vec::new());
    for (solved, plan) in results.iter().zip(&extreme) {
        match solved.case {
            Case::CollisionFree => {
                comparison.extend(curve(plan, "no collision".into()));
                restitutions.extend(curve(plan, "no collision".into()));
                damage.extend(curve(plan, "no collision".into()));
            }
            Case::CollisionTolerant { restitution } => {
                match restitutions.first_mut() {
                    // The same plan.
                    Some((label, _)) if solved.impacts() == Some(0) => {
                        *label = format!("{label}, e = {restitution}");
                    }
                    _ => restitutions.extend(curve(plan, format!("e = {restitution}"))),
                }
                if PAPER_RESTITUTIONS.contains(&restitution) {
                    comparison.extend(curve(plan, format!("collision, e = {restitution}")));
                }
                if restitution == 0.0 {
                    damage.extend(curve(plan, "no limit, e = 0".into()));
                }
            }
            Case::DamageLimited { restitution } => {
                let limit = solved.scenario.damage.per_hit.unwrap_or(f64::NAN);
                let label = format!("up to {limit:.2} m/s, e = {restitution}");
                damage.extend(curve(plan, label));
            }
            Case::Destination { goal } => {
                let hit = if solved.hits() { "hit" } else { "no hit" };
                destinations.extend(curve(plan, format!("{goal} m, {hit}")));
            }
        }
    }
    let figures = [
        ("collision_tolerant.svg", "Shortest plans with and without collisions", comparison),
        ("restitutions.svg", "Shortest plans beside walls of several restitutions", restitutions),
        ("damage_limited.svg", "Shortest plans under a limit on the impact speed", damage),
        (
            "destinations.svg",
            "Shortest plans to several goals, e = 0: the last second",
            destinations,
        ),
    ];
    let mut written = Vec::new();
    for (file, title, curves) in &figures {
        let path = folder.join(file);
        let curves: Vec<Curve<'_>> = curves.iter().map(|(l, t)| (l.clone(), t)).collect();
        // All start as far from the wall, and only differ beside it.
        let first = if *file == "destinations.svg" { 1.55 } else { 0.0 };
        std::fs::write(
            &path,
            Chart::to_svg(
                &figure(&curves, first),
                &format!("{title}\nAll start at rest, 10 m from the wall. {BARS}"),
            ),
        )?;
        written.push(path);
    }
    let shown = Case::CollisionTolerant { restitution: tube::RESTITUTION };
    if let Some(solved) = results.iter().find(|solved| solved.case == shown) {
        written.extend(tube::write(&solved.shortest, folder)?);
    }
    Ok(written)
}

/// Position and velocity over time, and when each plan pushes towards the wall and away from it.
fn figure(curves: &[Curve<'_>], first: f64) -> [Chart; 3] {
    let last = curves.iter().map(|(_, t)| t.duration()).fold(0.0, f64::max);
    // To the right of the bars is how long they are.
    let time = Interval::new(first, last + 0.12 * (last - first));
    let seen = |t: f64| t >= first;
    let places = curves.iter().flat_map(|(_, t)| t.time.iter().zip(&t.position));
    let far = places.filter(|(t, _)| seen(**t)).map(|(_, x)| *x).fold(0.0, f64::max);
    let count = curves.len() as f64;
    let mut position = Chart::new("", "position (m)")
        .with_size(720.0, 230.0)
        .with_ranges(time, Interval::new(-0.08 * far, 1.08 * far));
    let mut velocity =
        Chart::new("", "velocity (m/s)").with_size(720.0, 190.0).with_horizontal_range(time);
    let mut push = Chart::new("time (s)", "")
        .with_size(720.0, 20.0 * count + 8.0)
        .with_ranges(time, Interval::new(0.0, count));
    let wall = [first, time.upper].map(|t| [t, 0.0]);
    let below = [time.upper, first].map(|t| [t, -far]);
    position.area("", SOLID, 0.5, wall.into_iter().chain(below));
    position.label("wall", COLOURS[6], [0.97 * time.upper + 0.03 * first, 0.0]);
    let mut speeds_said: Vec<String> = Vec::new();
    let (mut with, mut without) = (WITH_COLLISION.iter().cycle(), WITHOUT_COLLISION.iter().cycle());
    for (k, (label, trajectory)) in curves.iter().enumerate() {
        let next = if trajectory.impacts.is_empty() { without.next() } else { with.next() };
        let colour = *next.unwrap_or(&"black");
        let shown = |points: Vec<[f64; 2]>| points.into_iter().filter(move |[t, _]| seen(*t));
        let places = with_impacts(trajectory, &trajectory.position, |_| [0.0; 2]);
        position.line(label, colour, shown(places));
        let speeds = with_impacts(trajectory, &trajectory.velocity, |impact| {
            [-impact.speed_before, impact.speed_after]
        });
        velocity.line(label, colour, shown(speeds));
        for impact in &trajectory.impacts {
            position.dots("", colour, 4.0, [[impact.time, 0.0]]);
            let fastest = [impact.time, -impact.speed_before];
            velocity.dots("", colour, 3.5, [fastest]);
            let speed = format!("hit at {:.2} m/s", impact.speed_before);
            if !speeds_said.contains(&speed) {
                velocity.label(speed.as_str(), colour, fastest);
                speeds_said.push(speed);
            }
        }
        let row = count - 1.0 - k as f64;
        for (opacity, [from, to]) in pushes(trajectory) {
            let [from, to] = [from.max(first), to.max(first)];
            let bar = [[from, row + 0.15], [to, row + 0.15], [to, row + 0.85], [from, row + 0.85]];
            push.area("", colour, opacity, bar);
        }
        let end = trajectory.duration();
        push.label(format!("{end:.3} s"), colour, [end, row + 0.5]);
        if let Some(&place) = trajectory.position.last() {
            position.dots("", colour, 3.0, [[end, place]]);
        }
    }
    if let (0.0, Some((_, trajectory))) = (first, curves.first()) {
        let place = trajectory.position.first().copied().unwrap_or_default();
        position.start("start, at rest", "black", [0.0, place]);
    }
    [position, velocity, push]
}

/// From when to when a plan pushes towards the wall (dark) and away from it (light).
fn pushes(trajectory: &Trajectory) -> Vec<(f64, [f64; 2])> {
    let mut pushes: Vec<(f64, [f64; 2])> = Vec::new();
    for (t, &a) in trajectory.time.windows(2).zip(&trajectory.acceleration) {
        let opacity = if a < 0.0 { 0.75 } else { 0.2 };
        match pushes.last_mut() {
            Some((own, [_, end])) if *own == opacity => *end = t[1],
            _ => pushes.push((opacity, [t[0], t[1]])),
        }
    }
    pushes
}

/// Samples over time, with values before and after each impact.
fn with_impacts(
    trajectory: &Trajectory,
    samples: &[f64],
    at: impl Fn(&Impact) -> [f64; 2],
) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for (step, (&time, &value)) in trajectory.time.iter().zip(samples).enumerate() {
        points.push([time, value]);
        for impact in trajectory.impacts.iter().filter(|impact| impact.step == step) {
            points.extend(at(impact).map(|value| [impact.time, value]));
        }
    }
    points
}
