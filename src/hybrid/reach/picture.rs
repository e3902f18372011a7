//! A picture of a tube and a run.

use std::fmt::Write as _;

use super::set::ReachSet;
use super::tube::Tube;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::rows::HybridRun;
use crate::picture::{Frame, begin, circle, escaped, path, polygon};

/// Size of the picture and of the margins around the plane, in pixels.
const SIZE: [f64; 2] = [860.0, 620.0];
const MARGINS: [f64; 4] = [64.0, 24.0, 46.0, 40.0]; // left, right, bottom, top

/// Approximate number of samples whose sets are drawn.
const SAMPLES: usize = 12;

/// The room that the name of a transition takes, in pixels.
const LABEL: [f64; 2] = [70.0, 16.0];

const FORWARD: &str = "#1f77b4";
const BACKWARD: &str = "#e67814";

/// The corners of an outline; those on the same half pixel are merged.
fn corners(frame: &Frame, outline: &[[f64; 2]]) -> String {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for &corner in outline {
        let [x, y] = frame.pixel(corner);
        if kept.last().is_none_or(|last| (x - last[0]).abs() >= 0.5 || (y - last[1]).abs() >= 0.5) {
            kept.push([x, y]);
        }
    }
    polygon(&kept)
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
        let states = self.path(first, second, run)?;
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
        let frame = self.frame(first, second, &states, &outlines);
        let mut svg = begin(SIZE[0], SIZE[1]);
        self.draw_axes(&mut svg, &frame, [first, second]);
        svg.push_str("<g clip-path=\"url(#plane)\">\n");
        for (colour, outline) in &outlines {
            let _ = writeln!(
                svg,
                "<polygon points=\"{}\" fill=\"{colour}\" fill-opacity=\"0.05\" \
                 stroke=\"{colour}\"/>",
                corners(&frame, outline)
            );
        }
        let pixels: Vec<[f64; 2]> = states.iter().map(|state| frame.pixel(*state)).collect();
        let _ = writeln!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"black\" stroke-width=\"2\"/>",
            path(&pixels)
        );
        for pixel in samples.iter().filter_map(|&sample| pixels.get(sample)) {
            circle(&mut svg, *pixel, 3.0, "");
        }
        svg.push_str("</g>\n");
        draw_transitions(&mut svg, &pixels, run);
        svg.push_str("</g>\n</svg>\n");
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
            (low - room, high + room)
        };
        let ((x, u), (y, v)) = (range(0), range(1));
        let [left, right, bottom, top] = MARGINS;
        Frame {
            low: [x, y],
            high: [u, v],
            corner: [left, top],
            size: [SIZE[0] - left - right, SIZE[1] - bottom - top],
            is_logarithmic: false,
        }
    }

    fn draw_axes(&self, svg: &mut String, frame: &Frame, states: [usize; 2]) {
        let ([left, top], [width, height]) = (frame.corner, frame.size);
        let _ = writeln!(
            svg,
            "<clipPath id=\"plane\"><rect x=\"{left}\" y=\"{top}\" width=\"{width}\" \
             height=\"{height}\"/></clipPath>"
        );
        frame.axes(svg, states.map(|state| self.system.states[state].0.as_str()));
        let steps = self.steps();
        let _ = writeln!(
            svg,
            "<text x=\"{left}\" y=\"24\">{steps} steps: <tspan fill=\"{FORWARD}\">reached from the \
             start</tspan>, <tspan fill=\"{BACKWARD}\">leads to the goal</tspan></text>"
        );
    }
}

/// The names of the transitions at the samples from which on they are taken, where there is room.
fn draw_transitions(svg: &mut String, pixels: &[[f64; 2]], run: Option<&HybridRun>) {
    let taken = |t: usize| -> Vec<&str> {
        let choices = run.iter().flat_map(|run| &run.transitions);
        choices.filter_map(|(_, names)| names.get(t)).map(String::as_str).collect()
    };
    let mut last = [f64::NEG_INFINITY; 2];
    for (t, &[x, y]) in pixels.iter().enumerate() {
        let names = taken(t);
        let is_free = (x - last[0]).abs() > LABEL[0] || (y - last[1]).abs() > LABEL[1];
        if names.is_empty() || t > 0 && names == taken(t - 1) || !is_free {
            continue;
        }
        last = [x, y];
        // Within the picture.
        let (side, anchor) = match x + LABEL[0] > SIZE[0] {
            true => (-7.0, " text-anchor=\"end\""),
            false => (7.0, ""),
        };
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"white\" stroke=\"black\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\"{anchor}>{}</text>",
            x + side,
            y - 7.0,
            escaped(&names.join(" and "))
        );
    }
}
