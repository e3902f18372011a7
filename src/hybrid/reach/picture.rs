//! A picture of a tube and a run.

use std::fmt::Write as _;

use super::set::ReachSet;
use super::tube::Tube;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::rows::HybridRun;
use crate::interval::Interval;

/// Size of the picture and of the margins around the plane, in pixels.
const SIZE: [f64; 2] = [860.0, 620.0];
const MARGINS: [f64; 4] = [64.0, 24.0, 46.0, 40.0]; // left, right, bottom, top

/// Approximate number of samples whose sets are drawn.
const SAMPLES: usize = 12;

/// The room that the name of a transition takes, in pixels.
const LABEL: [f64; 2] = [70.0, 16.0];

const FORWARD: &str = "#1f77b4";
const BACKWARD: &str = "#e67814";

/// Maps the plane of two states to pixels.
struct Frame {
    x: Interval,
    y: Interval,
}

impl Frame {
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, right, bottom, top] = MARGINS;
        let share = |range: &Interval, value: f64| {
            ((value - range.lower) / (range.upper - range.lower)).clamp(-9.0, 10.0)
        };
        let (width, height) = (SIZE[0] - left - right, SIZE[1] - bottom - top);
        [left + share(&self.x, x) * width, SIZE[1] - bottom - share(&self.y, y) * height]
    }

    fn points(&self, corners: &[[f64; 2]]) -> String {
        let mut text = String::new();
        let mut last = [f64::NAN; 2];
        for &corner in corners {
            let [x, y] = self.pixel(corner);
            // Corners on the same half pixel are merged.
            if (x - last[0]).abs() < 0.5 && (y - last[1]).abs() < 0.5 {
                continue;
            }
            last = [x, y];
            let _ = write!(text, "{x:.1},{y:.1} ");
        }
        text
    }
}

impl Tube {
    /// Draws the projection of the tube on two states as an SVG picture: the forward and backward
    /// sets of about a dozen samples, and a run with the names of its transitions where they change.
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let tube = scenario.reach_sets()?.tube(47)?;
    /// let svg = tube.to_svg(0, 1, None)?;
    /// assert!(svg.starts_with("<svg") && svg.contains(">x</text>"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `first`, `second`: indices of the states on the horizontal and the vertical axis.
    /// * `run`: a run of the system; may be shorter or longer than the tube.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for states that do not exist or are the same,
    /// [`ErrorKind::UnknownName`] for a run of another system, [`ErrorKind::NotFinite`] for values
    /// that are not finite.
    pub fn to_svg(
        &self,
        first: usize,
        second: usize,
        run: Option<&HybridRun>,
    ) -> Result<String, Error> {
        let path = self.path(first, second, run)?;
        let samples: Vec<usize> = (0..=self.steps()).step_by(1 + self.steps() / SAMPLES).collect();
        let mut outlines = Vec::new();
        for &sample in &samples {
            for (colour, sets) in [
                (FORWARD, self.reached(sample).collect::<Vec<&ReachSet>>()),
                (BACKWARD, self.to_go(sample).collect()),
            ] {
                for set in sets {
                    outlines.push((colour, set.outline(first, second)?));
                }
            }
        }
        let frame = self.frame(first, second, &path, &outlines);
        let mut svg = String::new();
        let [width, height] = SIZE;
        let _ = writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\" font-size=\"13\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>"
        );
        self.draw_axes(&mut svg, &frame, [first, second]);
        svg.push_str("<g clip-path=\"url(#plane)\">\n");
        for (colour, outline) in &outlines {
            let _ = writeln!(
                svg,
                "<polygon points=\"{}\" fill=\"{colour}\" fill-opacity=\"0.05\" \
                 stroke=\"{colour}\"/>",
                frame.points(outline).trim_end()
            );
        }
        if !path.is_empty() {
            let points = frame.points(&path);
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"black\" stroke-width=\"2\"/>",
                points.trim_end()
            );
        }
        for state in samples.iter().filter_map(|&sample| path.get(sample)) {
            let [x, y] = frame.pixel(*state);
            let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>");
        }
        svg.push_str("</g>\n");
        draw_transitions(&mut svg, &frame, &path, run);
        svg.push_str("</svg>\n");
        Ok(svg)
    }

    /// The run, projected on two states.
    fn path(
        &self,
        first: usize,
        second: usize,
        run: Option<&HybridRun>,
    ) -> Result<Vec<[f64; 2]>, Error> {
        let states = self.system.states.len();
        if first >= states || second >= states || first == second {
            let range = format!("two different ones below {states}");
            return Err(Error::out_of_range("the number of a state to draw", second as f64, range));
        }
        let Some(run) = run else { return Ok(Vec::new()) };
        let values = |state: usize| run.state(&self.system.states[state].0);
        let (x, y) = (values(first)?, values(second)?);
        check_finite("the run", "a state", x.iter().chain(y).copied())?;
        Ok(x.iter().zip(y).map(|(&x, &y)| [x, y]).collect())
    }

    /// The visible part of the plane: the plan and the tube's bounds, or everything that is drawn.
    fn frame(
        &self,
        first: usize,
        second: usize,
        path: &[[f64; 2]],
        outlines: &[(&str, Vec<[f64; 2]>)],
    ) -> Frame {
        let mut corners: Vec<[f64; 2]> = path.to_vec();
        for bounds in (0..=self.steps()).filter_map(|sample| self.bounds(sample)) {
            let (x, y) = (bounds[first], bounds[second]);
            corners.extend([[x.lower, y.lower], [x.upper, y.upper]]);
        }
        if corners.is_empty() {
            corners = outlines.iter().flat_map(|(_, outline)| outline.iter().copied()).collect();
        }
        let range = |axis: usize| {
            let values = || corners.iter().map(|corner| corner[axis]);
            let (low, high) = (
                values().fold(f64::INFINITY, f64::min),
                values().fold(f64::NEG_INFINITY, f64::max),
            );
            let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
            let room = (0.06 * (high - low)).max(1e-9 * (1.0 + low.abs()));
            Interval::new(low - room, high + room)
        };
        Frame { x: range(0), y: range(1) }
    }

    fn draw_axes(&self, svg: &mut String, frame: &Frame, states: [usize; 2]) {
        let [left, right, bottom, top] = MARGINS;
        let (width, height) = (SIZE[0] - left - right, SIZE[1] - bottom - top);
        let _ = writeln!(
            svg,
            "<clipPath id=\"plane\"><rect x=\"{left}\" y=\"{top}\" width=\"{width}\" \
             height=\"{height}\"/></clipPath>\n\
             <rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" \
             stroke=\"#888\"/>"
        );
        for tick in ticks(&frame.x) {
            let [x, y] = frame.pixel([tick, frame.y.lower]);
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{tick}</text>",
                y + 17.0
            );
        }
        for tick in ticks(&frame.y) {
            let [x, y] = frame.pixel([frame.x.lower, tick]);
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{tick}</text>",
                x - 6.0,
                y + 4.0
            );
        }
        let name = |state: usize| escaped(&self.system.states[state].0);
        let (x, y) = (left + 0.5 * width, SIZE[1] - 8.0);
        let (across, up) = (name(states[0]), name(states[1]));
        let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{across}</text>");
        let (x, y) = (16.0, top + 0.5 * height);
        let _ = writeln!(
            svg,
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" \
             transform=\"rotate(-90 {x} {y})\">{up}</text>"
        );
        let steps = self.steps();
        let _ = writeln!(
            svg,
            "<text x=\"{left}\" y=\"24\">{steps} steps: <tspan fill=\"{FORWARD}\">reached from the \
             start</tspan>, <tspan fill=\"{BACKWARD}\">leads to the goal</tspan></text>"
        );
    }
}

/// The names of the transitions at the samples from which on they are taken, where there is room.
fn draw_transitions(svg: &mut String, frame: &Frame, path: &[[f64; 2]], run: Option<&HybridRun>) {
    let taken = |t: usize| -> Vec<&str> {
        let choices = run.iter().flat_map(|run| &run.transitions);
        choices.filter_map(|(_, names)| names.get(t)).map(String::as_str).collect()
    };
    let mut last = [f64::NEG_INFINITY; 2];
    for (t, &state) in path.iter().enumerate() {
        let names = taken(t);
        let [x, y] = frame.pixel(state);
        let is_free = (x - last[0]).abs() > LABEL[0] || (y - last[1]).abs() > LABEL[1];
        if names.is_empty() || t > 0 && names == taken(t - 1) || !is_free {
            continue;
        }
        last = [x, y];
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"white\" stroke=\"black\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            x + 7.0,
            y - 7.0,
            escaped(&names.join(" and "))
        );
    }
}

/// Round numbers within a range, about half a dozen.
fn ticks(range: &Interval) -> Vec<f64> {
    let width = range.upper - range.lower;
    let power = 10.0_f64.powf((width / 6.0).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    let step = step.into_iter().find(|step| width / step <= 8.0).unwrap_or(width);
    let (first, last) = ((range.lower / step).ceil(), (range.upper / step).floor());
    let count =
        if (last - first).is_finite() { (last - first).clamp(0.0, 20.0) as usize } else { 0 };
    // Decimal ticks, without rounding noise.
    let digits = (-power.log10().floor()).clamp(0.0, 12.0) as i32;
    let scale = 10.0_f64.powi(digits);
    (0..=count).map(|k| ((first + k as f64) * step * scale).round() / scale).collect()
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
