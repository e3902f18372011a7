//! The reach sets of the shortest plan, drawn in the plane of position and velocity.

use std::error::Error;
use std::path::{Path, PathBuf};

use carom::collision_tolerant::{Plan, Trajectory};
use carom::hybrid::ShortestHorizon;
use carom::hybrid::reach::{ReachSet, Tube};
use carom::interval::Interval;
use carom::picture::{Chart, GOAL_COLOUR, REACHED, TO_GO, WITH_COLLISION};

/// The restitution whose tube is drawn: the plan hits the wall and bounces off it.
pub(crate) const RESTITUTION: f64 = 0.5;

/// Steps between the sets that are drawn.
const EVERY: usize = 40;

/// The visible part of the plane, in m and m/s.
const VIEW: [[f64; 2]; 2] = [[-0.4, 13.0], [-12.0, 8.0]];

/// The size of the plane, in pixels.
const SIZE: [f64; 2] = [800.0, 560.0];

const PLAN: &str = "black";
const IMPACT: &str = WITH_COLLISION[0];

/// Writes the picture into a folder, if there is a tube and a plan.
pub(crate) fn write(
    shortest: &ShortestHorizon<Plan>,
    folder: &Path,
) -> Result<Option<PathBuf>, Box<dyn Error>> {
    let (Some(tube), Some(plan)) = (&shortest.tube, &shortest.plan) else { return Ok(None) };
    let path = folder.join("reach_sets.svg");
    draw(tube, &plan.trajectory, &path)?;
    Ok(Some(path))
}

fn draw(tube: &Tube, trajectory: &Trajectory, path: &Path) -> Result<(), Box<dyn Error>> {
    let title = format!(
        "Reach sets of the shortest plan, e = {RESTITUTION}\n{} steps of {} s; sets every {EVERY} steps, \
         as dots on the plan.",
        tube.steps(),
        trajectory.time_step
    );
    let [x, v] = VIEW.map(|[low, high]| Interval::new(low, high));
    let mut chart = Chart::new("position, distance from the wall (m)", "velocity (m/s)")
        .with_size(SIZE[0], SIZE[1])
        .with_ranges(x, v);

    let states: Vec<[f64; 2]> =
        trajectory.position.iter().zip(&trajectory.velocity).map(|(x, v)| [*x, *v]).collect();
    let samples: Vec<usize> = (0..=tube.steps()).step_by(EVERY).collect();
    let kinds = [
        (REACHED, "reached from the start".to_owned(), true),
        (TO_GO, "leads to the goal in time".to_owned(), false),
    ];
    for (colour, label, forward) in kinds {
        for (&sample, &state) in samples.iter().filter_map(|t| Some((t, states.get(*t)?))) {
            let set = if forward {
                holding(tube.reached(sample), state)?
            } else {
                holding(tube.to_go(sample), state)?
            };
            if let Some(outline) = set.map(in_view).filter(|outline| outline.len() > 2) {
                chart.area(label.as_str(), colour, 0.07, outline);
            }
        }
    }

    chart.line_of_width(2.2, "the plan", PLAN, states.iter().copied());
    let marks = samples.iter().filter_map(|&sample| states.get(sample));
    chart.dots("", PLAN, 3.0, marks.copied());

    // The impact turns the speed before it into the speed after it, at the wall.
    for impact in &trajectory.impacts {
        let ends = [[0.0, -impact.speed_before], [0.0, impact.speed_after]];
        chart.line("", IMPACT, ends);
        chart.dots("", IMPACT, 5.0, ends);
        let [inward, outward] = [impact.speed_before, impact.speed_after];
        chart.label(format!("hit at {:.3} s with {inward:.2} m/s", impact.time), PLAN, ends[0]);
        chart.label(format!("{outward:.2} m/s"), PLAN, ends[1]);
    }
    if let (Some(start), Some(end)) = (states.first(), states.last()) {
        chart.start("start", PLAN, *start);
        chart.goal("goal", GOAL_COLOUR, *end);
    }
    std::fs::write(path, Chart::to_svg(&[chart], &title))?;
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
fn in_view(outline: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut seen = outline;
    let mut pixel = [0.0; 2];
    for (axis, [low, high]) in VIEW.into_iter().enumerate() {
        pixel[axis] = (high - low) / SIZE[axis];
        for (limit, side) in [(low, 1.0), (high, -1.0)] {
            seen = clipped(&seen, |corner| side * (corner[axis] - limit));
        }
    }
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for [x, v] in seen {
        let far = |&[a, b]: &[f64; 2]| ((x - a) / pixel[0]).hypot((v - b) / pixel[1]) > 0.5;
        if kept.last().is_none_or(far) {
            kept.push([x, v]);
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
