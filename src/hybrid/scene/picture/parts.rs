//! The parts of a picture around the paths: frame, obstacles, bodies, legend.

use std::fmt::Write;

use super::view::{MARGIN, View, moved};
use crate::hybrid::scene::body::Shape;
use crate::hybrid::scene::geometry::corners;
use crate::hybrid::scene::plan::ScenePlan;
use crate::hybrid::scene::statement::Scene;
use crate::picture::{self, COLOURS, plain, polygon};

/// The picture up to its axes.
pub(super) fn begin(view: &View, scene: &Scene) -> String {
    let lines = scene.bodies.len() as f64 + 1.0;
    let mut svg = picture::begin(view.width(), view.height() + 18.0 * lines);
    let labels = if view.is_line { ["time (s)", "position (m)"] } else { ["x (m)", "y (m)"] };
    view.frame.axes(&mut svg, labels);
    svg
}

/// Obstacles in the plane, clipped to the frame.
pub(super) fn solids(svg: &mut String, view: &View, scene: &Scene, plan: &ScenePlan, moving: bool) {
    for solid in &scene.obstacles {
        let moves = !solid.course.is_empty();
        let samples = match (moves, moving) {
            (true, false) => vec![0, plan.steps()],
            _ => vec![0],
        };
        for sample in samples {
            let mut sides = moved(solid, sample, 2);
            sides.extend(view.sides());
            let mut points: Vec<Vec<f64>> = corners(&sides, 2).into_iter().map(|c| c.0).collect();
            if points.len() < 3 {
                continue;
            }
            let middle = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64;
            let (cx, cy) = (middle(0), middle(1));
            let angle = |p: &Vec<f64>| (p[1] - cy).atan2(p[0] - cx);
            points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            let list: Vec<[f64; 2]> =
                points.iter().map(|p| view.frame.pixel([p[0], p[1]])).collect();
            let bounces = solid.faces.iter().any(|face| face.surface.restitution.is_some());
            let fill = if bounces { "#b8b8b8" } else { "#e3e3e3" };
            let faded = if moves && sample == 0 && !moving {
                " fill-opacity=\"0.35\""
            } else if moves && sample > 0 {
                " fill-opacity=\"0.35\" stroke-dasharray=\"4 3\""
            } else {
                ""
            };
            let _ = write!(
                svg,
                "<polygon points=\"{}\" fill=\"{fill}\" stroke=\"#555555\"{faded}>",
                polygon(&list)
            );
            if moves && moving {
                let shown = plan.steps_shown();
                let places = (0..=shown).map(|t| {
                    let place = solid.displacement(t.min(plan.steps()), 2);
                    let scale = view.frame.scale(0);
                    format!("{:.2} {:.2}", place[0] * scale, -place[1] * scale)
                });
                let _ = write!(
                    svg,
                    "<animateTransform attributeName=\"transform\" type=\"translate\" \
                     dur=\"{}s\" repeatCount=\"indefinite\" values=\"{}\"/>",
                    plain(shown as f64 * plan.time_step),
                    places.collect::<Vec<_>>().join(";")
                );
            }
            svg.push_str("</polygon>\n");
        }
    }
}

/// Obstacles on a line, over time.
pub(super) fn walls(svg: &mut String, view: &View, scene: &Scene, plan: &ScenePlan) {
    for solid in &scene.obstacles {
        for t in 0..plan.steps() {
            let range = |sample: usize| {
                let (mut low, mut high) = (view.frame.low[1], view.frame.high[1]);
                for (normal, limit) in moved(solid, sample, 1) {
                    match normal[0] > 0.0 {
                        true => high = high.min(limit),
                        false => low = low.max(-limit),
                    }
                }
                (low, high.max(low))
            };
            let times = [t, t + 1].map(|t| t as f64 * plan.time_step);
            let (from, to) = (range(t), range(t + 1));
            let points =
                [(times[0], from.0), (times[0], from.1), (times[1], to.1), (times[1], to.0)];
            let list = polygon(&points.map(|(x, y)| view.frame.pixel([x, y])));
            let _ = writeln!(svg, "<polygon points=\"{list}\" fill=\"#b8b8b8\"/>");
        }
    }
}

/// A body's shape at a place.
pub(super) fn outline(svg: &mut String, view: &View, shape: &Shape, place: &[f64], colour: &str) {
    let [x, y] = view.place(0.0, place);
    let style = format!("fill=\"{colour}\" fill-opacity=\"0.25\" stroke=\"{colour}\"");
    let _ = match shape {
        Shape::Point => Ok(()),
        Shape::Ball(radius) => writeln!(
            svg,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{:.2}\" {style}/>",
            radius * view.frame.scale(0)
        ),
        Shape::Box(half) => {
            let [w, h] = [half[0], half[1]].map(|half| half * view.frame.scale(0));
            writeln!(
                svg,
                "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" {style}/>",
                x - w,
                y - h,
                2.0 * w,
                2.0 * h
            )
        }
    };
}

/// Below the drawing, so that it never covers a path.
pub(super) fn legend(
    svg: &mut String,
    view: &View,
    scene: &Scene,
    has_hits: bool,
    marks: Option<f64>,
) {
    let mut y = view.height() - 6.0;
    for (b, body) in scene.bodies.iter().enumerate() {
        let colour = COLOURS[b % COLOURS.len()];
        let mark = format!("<line x2=\"26\" stroke=\"{colour}\" stroke-width=\"2\"/>");
        let entry = [(mark, body.name.clone())];
        y += picture::legend(svg, &entry, [MARGIN, y], view.frame.size[0]);
    }
    let mut notes = Vec::new();
    notes.extend(marks.map(|every| format!("a circle every {} s", plain(every))));
    let moves = scene.obstacles.iter().any(|solid| !solid.course.is_empty());
    if moves && marks.is_some() {
        notes.push("moving obstacles at the start, and dashed at the end".to_owned());
    }
    if has_hits {
        notes.push("arrows: impulses of hits".to_owned());
    }
    let note = [(String::new(), notes.join("; "))];
    picture::legend(svg, &note, [MARGIN, y], view.frame.size[0]);
}
