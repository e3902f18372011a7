//! One figure per figure of the paper: position, velocity and acceleration over time.

use std::error::Error;
use std::path::{Path, PathBuf};

use carom::collision_tolerant::{Impact, Trajectory};
use carom::picture::{COLOURS, Chart};

use super::cases::{Case, PAPER_RESTITUTIONS, Solved};
use super::tube;

type Curve<'a> = (String, &'a Trajectory);

/// Writes the figures into a folder and returns their paths.
pub(crate) fn write_all(results: &[Solved], folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let curve = |solved: &'_ Solved, label: String| -> Option<(String, Trajectory)> {
        Some((label, solved.shortest.plan.as_ref()?.trajectory.clone()))
    };
    let (mut comparison, mut restitutions) = (Vec::new(), Vec::new());
    let (mut damage, mut destinations) = (Vec::new(), Vec::new());
    for solved in results {
        match solved.case {
            Case::CollisionFree => {
                comparison.extend(curve(solved, "no collision".into()));
                restitutions.extend(curve(solved, "no collision".into()));
                damage.extend(curve(solved, "no collision".into()));
            }
            Case::CollisionTolerant { restitution } => {
                let hit = if solved.impacts() == Some(0) { ", no hit" } else { "" };
                restitutions.extend(curve(solved, format!("e = {restitution}{hit}")));
                if PAPER_RESTITUTIONS.contains(&restitution) {
                    comparison.extend(curve(solved, format!("collision, e = {restitution}")));
                }
                if restitution == 0.0 {
                    damage.extend(curve(solved, "no limit, e = 0".into()));
                }
            }
            Case::DamageLimited { restitution } => {
                let limit = solved.scenario.damage.per_impact.unwrap_or(f64::NAN);
                let label = format!("up to {limit:.2} m/s, e = {restitution}");
                damage.extend(curve(solved, label));
            }
            Case::Destination { goal } => {
                let hit = if solved.hits() { "hit" } else { "no hit" };
                destinations.extend(curve(solved, format!("{goal} m, {hit}")));
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

fn figure(path: &Path, title: &str, curves: &[Curve<'_>]) -> Result<(), Box<dyn Error>> {
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
