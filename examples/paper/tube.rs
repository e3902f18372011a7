//! The reach sets of the shortest plan, drawn in the plane of position and velocity.

use std::error::Error;
use std::path::{Path, PathBuf};

use carom::collision_tolerant::{ShortestPlan, Trajectory};
use carom::hybrid::reach::{ReachSet, Tube};
use plotters::prelude::*;

/// The restitution whose tube is drawn: the plan hits the wall and bounces off it.
pub(crate) const RESTITUTION: f64 = 0.5;

/// Steps between the sets that are drawn.
const EVERY: usize = 40;

/// The visible part of the plane, in m and m/s.
const VIEW: [std::ops::Range<f64>; 2] = [-0.4..13.0, -12.0..8.0];

/// The size of the picture, in pixels.
const SIZE: (u32, u32) = (900, 680);

const FORWARD: RGBColor = RGBColor(31, 119, 180);
const BACKWARD: RGBColor = RGBColor(230, 120, 20);
const PLAN: RGBColor = BLACK;
const IMPACT: RGBColor = RGBColor(214, 39, 40);

/// Writes the picture into a folder, if there is a tube and a plan.
pub(crate) fn write(
    shortest: &ShortestPlan,
    folder: &Path,
) -> Result<Option<PathBuf>, Box<dyn Error>> {
    let (Some(tube), Some(plan)) = (&shortest.tube, &shortest.plan) else { return Ok(None) };
    let path = folder.join("reach_sets.svg");
    draw(tube, &plan.trajectory, &path)?;
    Ok(Some(path))
}

fn draw(tube: &Tube, trajectory: &Trajectory, path: &Path) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!(
        "Reach sets of the shortest plan, e = {RESTITUTION}: {} steps of {} s",
        tube.steps(),
        trajectory.time_step
    );
    let [x, v] = VIEW;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 22))
        .margin(10)
        .margin_right(24)
        .x_label_area_size(44)
        .y_label_area_size(58)
        .build_cartesian_2d(x, v)?;
    chart
        .configure_mesh()
        .x_desc("position, distance from the wall (m)")
        .y_desc("velocity (m/s)")
        .label_style(("sans-serif", 15))
        .light_line_style(WHITE)
        .draw()?;

    let states: Vec<(f64, f64)> =
        trajectory.position.iter().copied().zip(trajectory.velocity.iter().copied()).collect();
    let samples: Vec<usize> = (0..=tube.steps()).step_by(EVERY).collect();
    let kinds = [
        (FORWARD, format!("reached from the start, every {EVERY} steps"), true),
        (BACKWARD, "leads to the goal in the steps that are left".into(), false),
    ];
    for (colour, label, forward) in kinds {
        let mut sets = Vec::new();
        for (&sample, &(x, v)) in samples.iter().filter_map(|t| Some((t, states.get(*t)?))) {
            let set = if forward {
                holding(tube.reached(sample), [x, v])?
            } else {
                holding(tube.to_go(sample), [x, v])?
            };
            sets.extend(set.map(in_view).filter(|outline| outline.len() > 2));
        }
        // All areas are below all lines, so that many sets stay readable.
        let fill = colour.mix(0.07).filled();
        chart.draw_series(sets.iter().map(|set| Polygon::new(set.clone(), fill)))?;
        let closed =
            |set: &[(f64, f64)]| -> Vec<_> { set.iter().chain(set.first()).copied().collect() };
        let outline = |set: &Vec<_>| PathElement::new(closed(set), colour.stroke_width(1));
        chart.draw_series(sets.iter().map(outline))?.label(label).legend(move |(x, y)| {
            Rectangle::new([(x, y - 5), (x + 18, y + 5)], colour.stroke_width(1))
        });
    }

    let thick = PLAN.stroke_width(2);
    chart
        .draw_series(LineSeries::new(states.iter().copied(), thick))?
        .label("the plan, with its states at the same steps")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], thick));
    let marks = samples.iter().filter_map(|&sample| states.get(sample));
    chart.draw_series(marks.map(|&state| Circle::new(state, 3, PLAN.filled())))?;

    // The impact turns the speed before it into the speed after it, at the wall.
    for impact in &trajectory.impacts {
        let ends = [(0.0, -impact.speed_before), (0.0, impact.speed_after)];
        let label = format!(
            "impact at {:.3} s: {:.2} m/s in, {:.2} m/s out",
            impact.time, impact.speed_before, impact.speed_after
        );
        chart
            .draw_series([PathElement::new(ends, IMPACT.stroke_width(3))])?
            .label(label)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], IMPACT.stroke_width(3)));
        chart.draw_series(ends.map(|end| Circle::new(end, 5, IMPACT.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font(("sans-serif", 14))
        .border_style(BLACK.mix(0.4))
        .background_style(WHITE.mix(0.9))
        .draw()?;
    root.present()?;
    Ok(())
}

/// The outline of the first set that contains a state. Sets are ordered by the number of impacts,
/// so this is the set of the plan's own number.
fn holding<'a>(
    sets: impl Iterator<Item = &'a ReachSet>,
    state: [f64; 2],
) -> Result<Option<Vec<[f64; 2]>>, Box<dyn Error>> {
    for set in sets {
        if set.contains(&state)? {
            return Ok(Some(set.outline(0, 1)?));
        }
    }
    Ok(None)
}

/// The visible part of an outline, without corners less than half a pixel from the previous one.
fn in_view(outline: Vec<[f64; 2]>) -> Vec<(f64, f64)> {
    let mut seen = outline;
    let mut pixel = [0.0; 2];
    for (axis, range) in VIEW.iter().enumerate() {
        pixel[axis] = (range.end - range.start) / f64::from([SIZE.0, SIZE.1][axis]);
        for (limit, side) in [(range.start, 1.0), (range.end, -1.0)] {
            seen = clipped(&seen, |corner| side * (corner[axis] - limit));
        }
    }
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for [x, v] in seen {
        let far = |&(a, b): &(f64, f64)| ((x - a) / pixel[0]).hypot((v - b) / pixel[1]) > 0.5;
        if kept.last().is_none_or(far) {
            kept.push((x, v));
        }
    }
    kept
}

/// The part of a convex outline where an affine function is not negative.
fn clipped(outline: &[[f64; 2]], inside: impl Fn([f64; 2]) -> f64) -> Vec<[f64; 2]> {
    let mut part = Vec::new();
    for (k, &here) in outline.iter().enumerate() {
        let next = outline[(k + 1) % outline.len()];
        let (a, b) = (inside(here), inside(next));
        if a >= 0.0 {
            part.push(here);
        }
        if a * b < 0.0 {
            let share = a / (a - b);
            part.push([0, 1].map(|axis| here[axis] + share * (next[axis] - here[axis])));
        }
    }
    part
}
