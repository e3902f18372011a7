//! One figure per figure of the paper: position, velocity and acceleration over time.

use std::error::Error;
use std::path::{Path, PathBuf};

use carom::collision_tolerant::Trajectory;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::cases::{Case, PAPER_RESTITUTIONS, Solved};
use super::tube;

const COLOURS: [RGBColor; 7] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 39, 40),
    RGBColor(44, 160, 44),
    RGBColor(148, 103, 189),
    RGBColor(255, 127, 14),
    RGBColor(23, 190, 207),
    RGBColor(90, 90, 90),
];

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
    let root = SVGBackend::new(path, (860, 900)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, ("sans-serif", 22))?;
    let panels = root.split_evenly((3, 1));
    panel(&panels[0], "position (m)", curves, true, |t| &t.position)?;
    panel(&panels[1], "velocity (m/s)", curves, false, |t| &t.velocity)?;
    panel(&panels[2], "acceleration (m/s²)", curves, false, |t| &t.acceleration)?;
    root.present()?;
    Ok(())
}

fn panel<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    name: &str,
    curves: &[Curve<'_>],
    legend: bool,
    values: fn(&Trajectory) -> &Vec<f64>,
) -> Result<(), Box<dyn Error>>
where
    DB::ErrorType: 'static,
{
    let all = || curves.iter().flat_map(|(_, trajectory)| values(trajectory)).copied();
    let (low, high) =
        (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let margin = 0.06 * (high - low).max(1e-9);
    let end = curves.iter().map(|(_, trajectory)| trajectory.duration()).fold(0.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(34)
        .y_label_area_size(58)
        .build_cartesian_2d(0.0..end * 1.02, (low - margin)..(high + margin))?;
    chart.configure_mesh().x_desc("time (s)").y_desc(name).light_line_style(WHITE).draw()?;
    for (k, (label, trajectory)) in curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let series = values(trajectory);
        let points = trajectory.time.iter().copied().zip(series.iter().copied());
        let drawn = chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
        if legend {
            drawn.label(label.as_str()).legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2))
            });
        }
        // Impacts, where the vehicle meets the wall.
        let marks = trajectory.impacts.iter().filter_map(|impact| {
            let value = *series.get(impact.step)?;
            Some(Circle::new(
                (*trajectory.time.get(impact.step)?, value),
                5,
                colour.stroke_width(2),
            ))
        });
        chart.draw_series(marks)?;
    }
    if legend {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .border_style(BLACK.mix(0.4))
            .background_style(WHITE.mix(0.85))
            .draw()?;
    }
    Ok(())
}
