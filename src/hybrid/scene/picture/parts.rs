//! The parts of a picture around the paths: frame, obstacles, bodies, legend.

use std::fmt::Write;

use super::view::{MARGIN, View, moved, plain, spacing};
use crate::hybrid::scene::body::Shape;
use crate::hybrid::scene::geometry::corners;
use crate::hybrid::scene::plan::ScenePlan;
use crate::hybrid::scene::statement::Scene;

/// Colours of bodies that colour-blind readers tell apart (M. Okabe and K. Ito, 2008).
pub(super) const COLOURS: [&str; 6] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

pub(super) fn begin(view: &View, scene: &Scene) -> String {
    let lines = scene.bodies.len() as f64 + 1.0;
    let (width, height) = (view.width(), view.height() + 18.0 * lines);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.2} {height:.2}\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n<g font-family=\"sans-serif\" font-size=\"13\">\n"
    )
}

pub(super) fn axes(svg: &mut String, view: &View) {
    let (left, top) = view.at(view.low[0], view.high[1]);
    let (right, bottom) = view.at(view.high[0], view.low[1]);
    let _ = writeln!(
        svg,
        "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"none\" \
         stroke=\"#888888\"/>",
        right - left,
        bottom - top
    );
    let pixels = [right - left, bottom - top];
    for (axis, extent) in pixels.into_iter().enumerate() {
        let (low, high) = (view.low[axis], view.high[axis]);
        let step = spacing(high - low, (extent / 90.0).max(2.0));
        let first = (low / step).ceil() as i64;
        for k in first..=(high / step).floor() as i64 {
            let value = k as f64 * step;
            let (x, y) =
                if axis == 0 { view.at(value, view.low[1]) } else { view.at(view.low[0], value) };
            let _ = match axis {
                0 => writeln!(
                    svg,
                    "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{x:.2}\" y2=\"{:.2}\" \
                     stroke=\"#888888\"/><text x=\"{x:.2}\" y=\"{:.2}\" \
                     text-anchor=\"middle\">{}</text>",
                    y + 4.0,
                    y + 18.0,
                    plain(value)
                ),
                _ => writeln!(
                    svg,
                    "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{:.2}\" y2=\"{y:.2}\" \
                     stroke=\"#888888\"/><text x=\"{:.2}\" y=\"{:.2}\" \
                     text-anchor=\"end\">{}</text>",
                    x - 4.0,
                    x - 7.0,
                    y + 4.0,
                    plain(value)
                ),
            };
        }
    }
    let names = if view.is_line { ["time (s)", "position (m)"] } else { ["x (m)", "y (m)"] };
    let (middle, centre) = (0.5 * (left + right), 0.5 * (top + bottom));
    let _ = writeln!(
        svg,
        "<text x=\"{middle:.2}\" y=\"{:.2}\" text-anchor=\"middle\">{}</text><text \
         transform=\"translate(16 {centre:.2}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        bottom + 36.0,
        names[0],
        names[1]
    );
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
            let list = points.iter().map(|p| view.at(p[0], p[1]));
            let list: Vec<String> = list.map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
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
                list.join(" ")
            );
            if moves && moving {
                let shown = plan.steps_shown();
                let places = (0..=shown).map(|t| {
                    let place = solid.displacement(t.min(plan.steps()), 2);
                    format!("{:.2} {:.2}", place[0] * view.scale[0], -place[1] * view.scale[1])
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
                let (mut low, mut high) = (view.low[1], view.high[1]);
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
            let list = points.map(|(x, y)| view.at(x, y));
            let list = list.map(|(x, y)| format!("{x:.2},{y:.2}")).join(" ");
            let _ = writeln!(svg, "<polygon points=\"{list}\" fill=\"#b8b8b8\"/>");
        }
    }
}

/// A body's shape at a place.
pub(super) fn outline(svg: &mut String, view: &View, shape: &Shape, place: &[f64], colour: &str) {
    let (x, y) = view.place(0.0, place);
    let style = format!("fill=\"{colour}\" fill-opacity=\"0.25\" stroke=\"{colour}\"");
    let _ = match shape {
        Shape::Point => Ok(()),
        Shape::Ball(radius) => writeln!(
            svg,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{:.2}\" {style}/>",
            radius * view.scale[0]
        ),
        Shape::Box(half) => {
            let [w, h] = [half[0] * view.scale[0], half[1] * view.scale[1]];
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
        let name = body.name.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(
            svg,
            "<line x1=\"{MARGIN}\" y1=\"{y:.2}\" x2=\"{}\" y2=\"{y:.2}\" stroke=\"{colour}\" \
             stroke-width=\"2\"/><text x=\"{}\" y=\"{:.2}\">{name}</text>",
            MARGIN + 26.0,
            MARGIN + 34.0,
            y + 4.5
        );
        y += 18.0;
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
    let _ = writeln!(svg, "<text x=\"{MARGIN}\" y=\"{:.2}\">{}</text>", y + 4.5, notes.join("; "));
}
