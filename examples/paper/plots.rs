//! One figure per figure of the paper: position, velocity and acceleration over time.

use std::path::{Path, PathBuf};

use carom::collision_tolerant::{Impact, Plan, Trajectory};
use carom::picture::{COLOURS, Chart};
use carom::prelude::*;

use super::cases::{Case, PAPER_RESTITUTIONS, Solved};
use super::tube;

type Curve<'a> = (String, &'a Trajectory);

/// Writes the figures into a folder and returns their paths.
pub(crate) fn write_all(
    results: &[Solved],
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
        ("destinations.svg", "Shortest plans to several goals, e = 0", destinations),
    ];
    let mut written = Vec::new();
    for (file, title, curves) in &figures {
        let path = folder.join(file);
        let curves: Vec<Curve<'_>> = curves.iter().map(|(l, t)| (l.clone(), t)).collect();
        figure(&path, title, &curves)?;
        written.push(path);
    }
    let shown = Case::CollisionTolerant { restitution: tube::RESTITUTION };
    if let Some(solved) = results.iter().find(|solved| solved.case == shown) {
        written.extend(tube::write(&solved.shortest, folder)?);
    }
    Ok(written)
}

fn figure(
    path: &Path,
    title: &str,
    curves: &[Curve<'_>],
) -> Result<(), Box<dyn std::error::Error>> {
    let mut panels = [
        Chart::new("", "position (m)"),
        Chart::new("", "velocity (m/s)"),
        Chart::new("time (s)", "acceleration (m/s²)"),
    ];
    for (k, (label, trajectory)) in curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let [position, velocity, acceleration] = &mut panels;
        position.line(label, colour, with_impacts(trajectory, &trajectory.position, |_| [0.0; 2]));
        let speeds = with_impacts(trajectory, &trajectory.velocity, |impact| {
            [-impact.speed_before, impact.speed_after]
        });
        velocity.line(label, colour, speeds);
        // Held over each step.
        let pushes = trajectory.time.windows(2).zip(&trajectory.acceleration);
        acceleration.line(label, colour, pushes.flat_map(|(t, &a)| [[t[0], a], [t[1], a]]));
        position.dots("", colour, 4.0, trajectory.impacts.iter().map(|impact| [impact.time, 0.0]));
    }
    std::fs::write(path, Chart::to_svg(&panels, title))?;
    Ok(())
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
