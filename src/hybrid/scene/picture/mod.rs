//! Pictures of plans: on a line over time, in the plane with equal axes, still or moving.

mod parts;
mod view;

use std::fmt::Write;

use parts::{begin, legend, outline, solids, walls};
use view::View;

use super::body::Shape;
use super::geometry::dot;
use super::plan::{BodyPath, ScenePlan};
use super::statement::Scene;
use crate::error::Error;
use crate::picture::{COLOURS, circle, plain, polygon, spacing};

/// The length of the arrow of the largest impulse, in pixels.
const ARROW: f64 = 60.0;

/// How often an animation shows each step.
const FRAMES: usize = 4;

/// The radius of a point that moves, in pixels.
const DOT: f64 = 7.0;

/// How long an animation rests at its end before it begins again, in s.
const REST: f64 = 1.0;

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
    /// the time that the plan takes, with a rest of a second.
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
        solids(&mut svg, &view, &scene, self, true);
        let shown = self.steps_shown();
        for (b, (body, path)) in scene.bodies.iter().zip(&self.bodies).enumerate() {
            let colour = COLOURS[b % COLOURS.len()];
            let line = self.line(&view, path);
            let _ = writeln!(
                svg,
                "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1\" \
                 stroke-opacity=\"0.4\"/>"
            );
            let frames: Vec<[f64; 2]> = (0..=shown * FRAMES)
                .map(|k| {
                    let k = k.min(self.steps() * FRAMES);
                    let (step, part) = (k / FRAMES, (k % FRAMES) as f64 / FRAMES as f64);
                    let place = self.between(path, step, part);
                    view.place(0.0, &place)
                })
                .collect();
            let values: Vec<String> =
                frames.iter().map(|[x, y]| format!("{x:.2} {y:.2}")).collect();
            let half: Vec<f64> = match &body.shape {
                Shape::Box(half) => half.clone(),
                Shape::Ball(radius) => vec![*radius; 2],
                Shape::Point => vec![DOT / view.frame.scale(0); 2],
            };
            let [w, h] = [half[0], half[1]].map(|half| half * view.frame.scale(0));
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
                plain(shown as f64 * self.time_step),
                values.join(";")
            );
        }
        legend(&mut svg, &view, &scene, false, None);
        svg.push_str("</g>\n</svg>\n");
        Ok(svg)
    }

    /// The number of steps that an animation takes, with the rest at its end.
    fn steps_shown(&self) -> usize {
        self.steps() + (REST / self.time_step).ceil() as usize
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
        let [x, y] = view.place(0.0, &path.position[0]);
        let mut line = format!("M{x:.2} {y:.2}");
        for step in 0..self.steps() {
            let time = step as f64 * dt;
            let [x, y] = view.place(time + dt, &path.position[step + 1]);
            // Writing into a string cannot fail.
            let _ = match self.hit(path, step) {
                Some((place, at)) => {
                    let [hx, hy] = view.place(at, place);
                    write!(line, "L{hx:.2} {hy:.2}L{x:.2} {y:.2}")
                }
                None => {
                    let from = path.position[step].iter().zip(&path.velocity[step]);
                    let middle: Vec<f64> = from.map(|(x, v)| x + 0.5 * dt * v).collect();
                    let [mx, my] = view.place(time + 0.5 * dt, &middle);
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
            let style = format!("fill=\"white\" stroke=\"{colour}\" stroke-width=\"1.5\"");
            circle(svg, view.place(0.0, &place), 3.2, &style);
        }
    }

    /// The impulses of the hits.
    fn arrows(&self, svg: &mut String, view: &View, scene: &Scene) {
        let size = |j: &[f64]| dot(j, j).sqrt();
        let largest = self.hits.iter().map(|hit| size(&hit.impulse)).fold(0.0, f64::max);
        for hit in self.hits.iter().filter(|hit| size(&hit.impulse) > 1e-3 * largest) {
            let [x, y] = view.place(hit.time, &hit.place);
            let length = ARROW * (0.35 + 0.65 * size(&hit.impulse) / largest);
            let unit: Vec<f64> = hit.impulse.iter().map(|j| j / size(&hit.impulse)).collect();
            let (dx, dy) = match scene.axes() {
                1 => (0.0, -unit[0]),
                _ => (unit[0], -unit[1]),
            };
            let (tx, ty) = (x + length * dx, y + length * dy);
            let corner = |along: f64, across: f64| {
                [tx - along * dx - across * dy, ty - along * dy + across * dx]
            };
            let head = polygon(&[corner(0.0, 0.0), corner(9.0, 3.5), corner(9.0, -3.5)]);
            let _ = writeln!(
                svg,
                "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"black\" \
                 stroke-width=\"1.6\"/><polygon points=\"{head}\" fill=\"black\"/>",
                tx - 6.0 * dx,
                ty - 6.0 * dy
            );
        }
    }
}
