//! Pictures of plans: on a line over time, in the plane with equal axes, still or moving.

use std::fmt::Write;

use super::body::Shape;
use super::geometry::{Side, corners, dot};
use super::plan::{BodyPath, ScenePlan};
use super::solid::Solid;
use super::statement::Scene;
use crate::error::Error;

/// Colours of bodies that colour-blind readers tell apart (M. Okabe and K. Ito, 2008).
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// The longer side of the drawing, and the space around it, in pixels.
const SIZE: f64 = 640.0;
const MARGIN: f64 = 56.0;

/// The length of the arrow of the largest impulse, in pixels.
const ARROW: f64 = 60.0;

/// How often an animation shows each step.
const FRAMES: usize = 4;

/// From metres (and seconds) to pixels.
struct View {
    low: [f64; 2],
    high: [f64; 2],
    scale: [f64; 2],
    /// Whether the first axis is time.
    is_line: bool,
}

impl View {
    fn new(scene: &Scene, plan: &ScenePlan) -> View {
        let is_line = scene.axes() == 1;
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let mut include = |axis: usize, value: f64| {
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        };
        let own = usize::from(is_line);
        for (body, path) in scene.bodies.iter().zip(&plan.bodies) {
            for (i, axis) in (own..2).enumerate() {
                let unit = |k: usize| if k == i { 1.0 } else { 0.0 };
                let along: Vec<f64> = (0..scene.axes()).map(unit).collect();
                let reach = body.shape.reach(&along);
                for place in &path.position {
                    include(axis, place[i] - reach);
                    include(axis, place[i] + reach);
                }
            }
        }
        // Obstacles with an inside of their own are shown whole.
        for solid in scene.obstacles.iter().filter(|solid| solid.faces.len() > 1) {
            for sample in [0, plan.steps()] {
                let sides = moved(solid, sample, scene.axes());
                for (corner, _) in corners(&sides, scene.axes()) {
                    (own..2).enumerate().for_each(|(i, axis)| include(axis, corner[i]));
                }
            }
        }
        if is_line {
            include(0, 0.0);
            include(0, plan.duration());
        }
        for axis in own..2 {
            let wide = 0.06 * (high[axis] - low[axis]).max(0.1);
            low[axis] -= wide;
            high[axis] += wide;
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let scale = match is_line {
            true => [SIZE / extent[0], 0.6 * SIZE / extent[1]],
            false => [SIZE / extent[0].max(extent[1]); 2],
        };
        View { low, high, scale, is_line }
    }

    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let across = MARGIN + (x - self.low[0]) * self.scale[0];
        (across, MARGIN + (self.high[1] - y) * self.scale[1])
    }

    /// A place at a time, in pixels.
    fn place(&self, time: f64, place: &[f64]) -> (f64, f64) {
        match self.is_line {
            true => self.at(time, place[0]),
            false => self.at(place[0], place[1]),
        }
    }

    fn width(&self) -> f64 {
        2.0 * MARGIN + (self.high[0] - self.low[0]) * self.scale[0]
    }

    fn height(&self) -> f64 {
        2.0 * MARGIN + (self.high[1] - self.low[1]) * self.scale[1]
    }

    /// The frame as sides, for clipping.
    fn sides(&self) -> Vec<Side> {
        vec![
            (vec![-1.0, 0.0], -self.low[0]),
            (vec![1.0, 0.0], self.high[0]),
            (vec![0.0, -1.0], -self.low[1]),
            (vec![0.0, 1.0], self.high[1]),
        ]
    }
}

/// The sides of an obstacle at a sample.
fn moved(solid: &Solid, sample: usize, axes: usize) -> Vec<Side> {
    let place = solid.displacement(sample, axes);
    let sides = solid.faces.iter();
    sides.map(|face| (face.normal.clone(), face.offset + dot(&face.normal, &place))).collect()
}

/// A round distance between about `count` marks.
fn spacing(extent: f64, count: f64) -> f64 {
    let rough = extent / count;
    let power = 10.0_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|f| f * power);
    steps.into_iter().find(|step| *step >= rough).unwrap_or(rough)
}

/// A number without trailing zeros.
fn plain(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

impl ScenePlan {
    /// A picture of the plan: on a line, positions over time; in the plane, paths with marks of time
    /// among the obstacles, on equal axes. Arrows are the impulses of hits on the bodies.
    /// Coordinates are exact to a hundredth of a pixel, and paths are the parabolas of the plan.
    ///
    /// # Arguments
    ///
    /// * `scene`: the scene of the plan.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`](crate::ErrorKind::OutOfRange) for a plan in space;
    /// [`SceneError`](super::SceneError) for a scene that contradicts itself.
    pub fn to_svg(&self, scene: &Scene) -> Result<String, Error> {
        let scene = self.drawable(scene)?;
        let view = View::new(&scene, self);
        let mut svg = begin(&view, &scene);
        axes(&mut svg, &view);
        if view.is_line {
            walls(&mut svg, &view, &scene, self);
        } else {
            solids(&mut svg, &view, &scene, self, false);
        }
        let marks = spacing(self.duration(), 8.0);
        for (b, (body, path)) in scene.bodies.iter().zip(&self.bodies).enumerate() {
            let colour = COLOURS[b % COLOURS.len()];
            let line = self.line(&view, path);
            let _ = writeln!(
                svg,
                "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>"
            );
            if !view.is_line {
                self.time_marks(&mut svg, &view, path, marks, colour);
                for sample in [0, self.steps()] {
                    outline(&mut svg, &view, &body.shape, &path.position[sample], colour);
                }
            }
        }
        self.arrows(&mut svg, &view, &scene);
        legend(&mut svg, &view, &scene, !self.hits.is_empty(), (!view.is_line).then_some(marks));
        svg.push_str("</g>\n</svg>\n");
        Ok(svg)
    }

    /// The plan as a moving picture in the plane: one SVG file that browsers play, over and over, in
    /// the time that the plan takes.
    ///
    /// # Errors
    ///
    /// As for [`to_svg`](ScenePlan::to_svg); also for a plan on a line.
    pub fn to_animation(&self, scene: &Scene) -> Result<String, Error> {
        let scene = self.drawable(scene)?;
        if scene.axes() != 2 {
            return Err(Error::out_of_range("the number of axes of an animation", 1.0, "2"));
        }
        let view = View::new(&scene, self);
        let mut svg = begin(&view, &scene);
        axes(&mut svg, &view);
        solids(&mut svg, &view, &scene, self, true);
        for (b, (body, path)) in scene.bodies.iter().zip(&self.bodies).enumerate() {
            let colour = COLOURS[b % COLOURS.len()];
            let line = self.line(&view, path);
            let _ = writeln!(
                svg,
                "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1\" \
                 stroke-opacity=\"0.4\"/>"
            );
            let frames: Vec<(f64, f64)> = (0..=self.steps() * FRAMES)
                .map(|k| {
                    let (step, part) = (k / FRAMES, (k % FRAMES) as f64 / FRAMES as f64);
                    let place = self.between(path, step, part);
                    view.place(0.0, &place)
                })
                .collect();
            let values: Vec<String> =
                frames.iter().map(|(x, y)| format!("{x:.2} {y:.2}")).collect();
            let half: Vec<f64> = match &body.shape {
                Shape::Box(half) => half.clone(),
                Shape::Ball(radius) => vec![*radius; 2],
                Shape::Point => vec![3.0 / view.scale[0]; 2],
            };
            let [w, h] = [half[0] * view.scale[0], half[1] * view.scale[1]];
            let round = if matches!(body.shape, Shape::Box(_)) { 0.0 } else { w };
            let _ = writeln!(
                svg,
                "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" rx=\"{round:.2}\" \
                 fill=\"{colour}\"><animateTransform attributeName=\"transform\" \
                 type=\"translate\" dur=\"{}s\" repeatCount=\"indefinite\" values=\"{}\"/></rect>",
                -w,
                -h,
                2.0 * w,
                2.0 * h,
                plain(self.duration()),
                values.join(";")
            );
        }
        legend(&mut svg, &view, &scene, false, None);
        svg.push_str("</g>\n</svg>\n");
        Ok(svg)
    }

    /// The scene, checked.
    fn drawable(&self, scene: &Scene) -> Result<Scene, Error> {
        let scene = scene.checked()?;
        if scene.axes() > 2 {
            let what = "the number of axes of a picture";
            return Err(Error::out_of_range(what, 3.0, "1 or 2"));
        }
        if scene.bodies.len() != self.bodies.len() {
            let (found, expected) = (self.bodies.len() as f64, scene.bodies.len());
            let what = "the number of bodies of the plan";
            return Err(Error::out_of_range(what, found, format!("{expected}, as in the scene")));
        }
        Ok(scene)
    }

    /// Where a body is part of the way through a step.
    fn between(&self, path: &BodyPath, step: usize, part: f64) -> Vec<f64> {
        let Some(end) = path.position.get(step + 1) else { return path.position[step].clone() };
        let (from, v) = (&path.position[step], &path.velocity[step]);
        let dt = self.time_step;
        let hit = self.hit(path, step);
        let axes = 0..from.len();
        match hit {
            // To the place of the hit, and on.
            Some((place, time)) => {
                let at = ((time / dt) - step as f64).clamp(1e-6, 1.0 - 1e-6);
                let mix = |a: &[f64], b: &[f64], s: f64| -> Vec<f64> {
                    a.iter().zip(b).map(|(a, b)| a + s * (b - a)).collect()
                };
                match part < at {
                    true => mix(from, place, part / at),
                    false => mix(place, end, (part - at) / (1.0 - at)),
                }
            }
            None => axes
                .map(|i| {
                    let middle = from[i] + 0.5 * dt * v[i];
                    let (s, r) = (part, 1.0 - part);
                    r * r * from[i] + 2.0 * r * s * middle + s * s * end[i]
                })
                .collect(),
        }
    }

    /// Where and when a body hits in a step.
    fn hit(&self, path: &BodyPath, step: usize) -> Option<(&Vec<f64>, f64)> {
        let own = self.hits.iter().find(|hit| hit.step == step && hit.body == path.name)?;
        Some((&own.place, own.time))
    }

    /// The path as parabolas, with corners at hits.
    fn line(&self, view: &View, path: &BodyPath) -> String {
        let dt = self.time_step;
        let (x, y) = view.place(0.0, &path.position[0]);
        let mut line = format!("M{x:.2} {y:.2}");
        for step in 0..self.steps() {
            let time = step as f64 * dt;
            let (x, y) = view.place(time + dt, &path.position[step + 1]);
            // Writing into a string cannot fail.
            let _ = match self.hit(path, step) {
                Some((place, at)) => {
                    let (hx, hy) = view.place(at, place);
                    write!(line, "L{hx:.2} {hy:.2}L{x:.2} {y:.2}")
                }
                None => {
                    let from = path.position[step].iter().zip(&path.velocity[step]);
                    let middle: Vec<f64> = from.map(|(x, v)| x + 0.5 * dt * v).collect();
                    let (mx, my) = view.place(time + 0.5 * dt, &middle);
                    write!(line, "Q{mx:.2} {my:.2} {x:.2} {y:.2}")
                }
            };
        }
        line
    }

    /// Dots at round times.
    fn time_marks(&self, svg: &mut String, view: &View, path: &BodyPath, every: f64, colour: &str) {
        let count = (self.duration() / every + 1e-9) as usize;
        for k in 0..=count {
            let time = k as f64 * every / self.time_step;
            let step = (time as usize).min(self.steps());
            let place = self.between(path, step, time - step as f64);
            let (x, y) = view.place(0.0, &place);
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"3.2\" fill=\"white\" stroke=\"{colour}\" \
                 stroke-width=\"1.5\"/>"
            );
        }
    }

    /// The impulses of the hits.
    fn arrows(&self, svg: &mut String, view: &View, scene: &Scene) {
        let size = |j: &[f64]| dot(j, j).sqrt();
        let largest = self.hits.iter().map(|hit| size(&hit.impulse)).fold(0.0, f64::max);
        for hit in self.hits.iter().filter(|hit| size(&hit.impulse) > 1e-3 * largest) {
            let (x, y) = view.place(hit.time, &hit.place);
            let length = ARROW * (0.35 + 0.65 * size(&hit.impulse) / largest);
            let unit: Vec<f64> = hit.impulse.iter().map(|j| j / size(&hit.impulse)).collect();
            let (dx, dy) = match scene.axes() {
                1 => (0.0, -unit[0]),
                _ => (unit[0], -unit[1]),
            };
            let (tx, ty) = (x + length * dx, y + length * dy);
            let corner = |along: f64, across: f64| {
                format!("{:.2},{:.2}", tx - along * dx - across * dy, ty - along * dy + across * dx)
            };
            let _ = writeln!(
                svg,
                "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"black\" \
                 stroke-width=\"1.6\"/><polygon points=\"{} {} {}\" fill=\"black\"/>",
                tx - 6.0 * dx,
                ty - 6.0 * dy,
                corner(0.0, 0.0),
                corner(9.0, 3.5),
                corner(9.0, -3.5)
            );
        }
    }
}

fn begin(view: &View, scene: &Scene) -> String {
    let lines = scene.bodies.len() as f64 + 1.0;
    let (width, height) = (view.width(), view.height() + 18.0 * lines);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.2} {height:.2}\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n<g font-family=\"sans-serif\" font-size=\"13\">\n"
    )
}

fn axes(svg: &mut String, view: &View) {
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
    for axis in 0..2 {
        let (low, high) = (view.low[axis], view.high[axis]);
        let step = spacing(high - low, (pixels[axis] / 90.0).max(2.0));
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
fn solids(svg: &mut String, view: &View, scene: &Scene, plan: &ScenePlan, moving: bool) {
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
            let faded = if moves && sample > 0 {
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
                let places = (0..=plan.steps()).map(|t| {
                    let place = solid.displacement(t, 2);
                    format!("{:.2} {:.2}", place[0] * view.scale[0], -place[1] * view.scale[1])
                });
                let _ = write!(
                    svg,
                    "<animateTransform attributeName=\"transform\" type=\"translate\" \
                     dur=\"{}s\" repeatCount=\"indefinite\" values=\"{}\"/>",
                    plain(plan.duration()),
                    places.collect::<Vec<_>>().join(";")
                );
            }
            svg.push_str("</polygon>\n");
        }
    }
}

/// Obstacles on a line, over time.
fn walls(svg: &mut String, view: &View, scene: &Scene, plan: &ScenePlan) {
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
fn outline(svg: &mut String, view: &View, shape: &Shape, place: &[f64], colour: &str) {
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
fn legend(svg: &mut String, view: &View, scene: &Scene, has_hits: bool, marks: Option<f64>) {
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
    if has_hits {
        notes.push("arrows: impulses of hits".to_owned());
    }
    let _ = writeln!(svg, "<text x=\"{MARGIN}\" y=\"{:.2}\">{}</text>", y + 4.5, notes.join("; "));
}
