//! A picture of a tube and a run.

use super::set::ReachSet;
use super::tube::Tube;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::rows::HybridRun;
use crate::interval::Interval;
use crate::picture::{Chart, GOAL_COLOUR, REACHED, TO_GO};

/// Size of the plane, in pixels.
const SIZE: [f64; 2] = [760.0, 520.0];

/// Approximate number of samples whose sets are drawn.
const SAMPLES: usize = 12;

impl Tube {
    /// An SVG picture of the [chart](Tube::chart), with the number of steps as its title.
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let tube = scenario.reach_sets()?.tube(47)?;
    /// let svg = tube.to_svg(0, 1, None)?;
    /// assert!(svg.starts_with("<svg") && svg.contains(">x of vehicle (m)</text>"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`chart`](Tube::chart).
    pub fn to_svg(
        &self,
        first: usize,
        second: usize,
        run: Option<&HybridRun>,
    ) -> Result<String, Error> {
        let chart = self.chart(first, second, run)?;
        let title = format!("Sets of {} steps", self.steps());
        Ok(Chart::to_svg(&[chart], &title))
    }

    /// Draws the projection of the tube on two states: the forward and backward sets of about a
    /// dozen samples, and a run with its start and its end, and the names of its transitions where
    /// they change. The axes of scenes and of the paper have units. Those of a system of your own
    /// have the names of its states; [`Chart::with_labels`] adds units.
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
    pub fn chart(
        &self,
        first: usize,
        second: usize,
        run: Option<&HybridRun>,
    ) -> Result<Chart, Error> {
        let states = self.path(first, second, run)?;
        let samples: Vec<usize> = (0..=self.steps()).step_by(1 + self.steps() / SAMPLES).collect();
        let mut outlines = Vec::new();
        for &sample in &samples {
            for (colour, name, sets) in [
                (
                    REACHED,
                    "reached from the start",
                    self.reached(sample).collect::<Vec<&ReachSet>>(),
                ),
                (TO_GO, "leads to the goal", self.to_go(sample).collect()),
            ] {
                for set in sets {
                    outlines.push((colour, name, set.outline(first, second)?));
                }
            }
        }
        let [x, v] = self.ranges(first, second, &states, &outlines);
        let [across, up] =
            [first, second].map(|state| self.words.label(&self.system.states[state].0));
        let mut chart = Chart::new(across, up).with_size(SIZE[0], SIZE[1]).with_ranges(x, v);
        for (colour, name, outline) in outlines {
            chart.area(name, colour, 0.07, outline);
        }
        if let (Some(start), Some(end)) = (states.first(), states.last()) {
            chart.line_of_width(2.2, "", "black", states.iter().copied());
            chart.dots(
                "",
                "black",
                3.0,
                samples.iter().filter_map(|&sample| states.get(sample)).copied(),
            );
            chart.start("start", "black", *start);
            chart.goal("end", GOAL_COLOUR, *end);
        }
        label_transitions(&mut chart, &states, run);
        Ok(chart)
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
            let (what, value) = ("the number of a state to draw", second as f64);
            return Err(Error::out_of_range_in_words(what, value, ..states as f64, range));
        }
        let Some(run) = run else { return Ok(Vec::new()) };
        let values = |state: usize| run.state(&self.system.states[state].0);
        let (x, y) = (values(first)?, values(second)?);
        check_finite("the run", "a state", x.iter().chain(y).copied())?;
        Ok(x.iter().zip(y).map(|(&x, &y)| [x, y]).collect())
    }

    /// The visible part of the plane: the plan and the tube's bounds, or everything that is drawn.
    fn ranges(
        &self,
        first: usize,
        second: usize,
        path: &[[f64; 2]],
        outlines: &[(&str, &str, Vec<[f64; 2]>)],
    ) -> [Interval; 2] {
        let mut corners: Vec<[f64; 2]> = path.to_vec();
        for bounds in (0..=self.steps()).filter_map(|sample| self.bounds(sample)) {
            let (x, y) = (bounds[first], bounds[second]);
            corners.extend([[x.lower, y.lower], [x.upper, y.upper]]);
        }
        if corners.is_empty() {
            corners = outlines.iter().flat_map(|(.., outline)| outline.iter().copied()).collect();
        }
        [0, 1].map(|axis| {
            let values = || corners.iter().map(|corner| corner[axis]);
            let (low, high) = (
                values().fold(f64::INFINITY, f64::min),
                values().fold(f64::NEG_INFINITY, f64::max),
            );
            let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
            let room = (0.06 * (high - low)).max(1e-9 * (1.0 + low.abs()));
            Interval::new(low - room, high + room)
        })
    }
}

/// The names of the transitions at the samples from which on they are taken: the first time, and
/// again where there is room.
fn label_transitions(chart: &mut Chart, states: &[[f64; 2]], run: Option<&HybridRun>) {
    let taken = |t: usize| -> Vec<&str> {
        let choices = run.iter().flat_map(|run| &run.transitions);
        choices.filter_map(|(_, names)| names.get(t)).map(String::as_str).collect()
    };
    let mut known: Vec<Vec<&str>> = Vec::new();
    for (t, state) in states.iter().enumerate() {
        let names = taken(t);
        if names.is_empty() || t > 0 && names == taken(t - 1) {
            continue;
        }
        // The start has a mark of its own.
        if t > 0 {
            chart.dots("", "black", 4.5, [*state]);
        }
        let text = names.join(" and ");
        if known.contains(&names) {
            chart.label_if_room(text, "black", *state);
        } else {
            chart.label(text, "black", *state);
            known.push(names);
        }
    }
}
