//! Closed loops and their records.

use std::fmt::{self, Write as _};

use web_time::Duration;

use super::RecedingHorizon;
use super::step::{ControlMove, MoveSource};
use crate::error::{Error, check_finite, check_length};
use crate::interval::Interval;
use crate::number::{DIGITS, counted, rounded};
use crate::picture::{COLOURS, Chart};

/// The record of a controller in a loop with a plant.
///
/// `{}` prints a summary.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClosedLoop {
    /// The state at every sample, the first one included, in the states' units.
    pub states: Vec<Vec<f64>>,
    /// The moves, one per step.
    pub moves: Vec<ControlMove>,
}

/// A loop that an error ended: the error, and what happened until then.
///
/// `?` in a function that returns a [`carom::Error`](crate::error::Error) keeps the error alone.
#[derive(Clone)]
#[non_exhaustive]
pub struct BrokenLoop {
    /// The states and moves before the error; the last move too if the plant did not take it.
    pub record: ClosedLoop,
    /// Why the loop ended.
    pub error: Error,
}

impl fmt::Display for BrokenLoop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let step = self.record.states.len().saturating_sub(1);
        write!(f, "the loop ended in step {step}: {}", self.error)
    }
}

/// The words of the error, so that a program that ends with it says why.
impl fmt::Debug for BrokenLoop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BrokenLoop: {self}")
    }
}

impl std::error::Error for BrokenLoop {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}

impl From<BrokenLoop> for Error {
    fn from(broken: BrokenLoop) -> Self {
        broken.error
    }
}

impl RecedingHorizon<'_> {
    /// Runs the controller in a loop with a plant.
    ///
    /// # Arguments
    ///
    /// * `start`: the first state.
    /// * `plant`: the state after a move from a state: a simulation of the system with the whole
    ///   move, such as `system.simulate(state, next)?.end()`, or anything else with other dynamics,
    ///   noise (see [`Disturbance`](super::Disturbance)), or a delay according to
    ///   [`ControlMove::time`].
    ///   Modes with memory are taken to be those of the moves; where a plant measures them, call
    ///   [`step`](Self::step) and [`set_memory`](Self::set_memory) in a loop of your own.
    ///
    /// # Errors
    ///
    /// A [`BrokenLoop`] with what happened until then and one of the errors of [`step`](Self::step)
    /// and of the plant; [`ErrorKind::Length`](crate::error::ErrorKind::Length) and
    /// [`ErrorKind::NotFinite`](crate::error::ErrorKind::NotFinite) for the states that it returns.
    pub fn run(
        &mut self,
        start: &[f64],
        steps: usize,
        mut plant: impl FnMut(&[f64], &ControlMove) -> Result<Vec<f64>, Error>,
    ) -> Result<ClosedLoop, BrokenLoop> {
        let mut record = ClosedLoop { states: vec![start.to_vec()], moves: Vec::new() };
        let mut state = start.to_vec();
        for _ in 0..steps {
            let taken = self.step(&state).and_then(|next| {
                let after = plant(&state, &next);
                record.moves.push(next);
                let after = after?;
                check_length("the state of the plant", after.len(), state.len())?;
                check_finite("the state of the plant", "an entry", after.iter().copied())?;
                Ok(after)
            });
            match taken {
                Ok(after) => state = after,
                Err(error) => return Err(BrokenLoop { record, error }),
            }
            record.states.push(state.clone());
        }
        Ok(record)
    }
}

impl ClosedLoop {
    /// The number of moves from a source.
    pub fn count(&self, source: MoveSource) -> usize {
        self.moves.iter().filter(|next| next.source == source).count()
    }

    /// The time that no more than a part of the steps took longer than; zero without a step.
    ///
    /// # Arguments
    ///
    /// * `part`: from 0 (the longest step) to 1; 0.5 is the median.
    pub fn time_exceeded_by(&self, part: f64) -> Duration {
        let mut times: Vec<Duration> = self.moves.iter().map(|next| next.time).collect();
        times.sort_unstable_by(|a, b| b.cmp(a));
        let at = (part.clamp(0.0, 1.0) * times.len() as f64) as usize;
        times.get(at.min(times.len().saturating_sub(1))).copied().unwrap_or_default()
    }

    /// A table with a line per step: state, input, source, nodes, relaxations, time in s.
    pub fn to_csv(&self) -> String {
        let width =
            |of: fn(&ControlMove) -> &Vec<f64>| self.moves.first().map_or(0, |m| of(m).len());
        let (states, inputs) = (width(|m| &m.state), width(|m| &m.input));
        let mut text = String::from("step");
        (0..states).for_each(|i| _ = write!(text, ",x{i}"));
        (0..inputs).for_each(|i| _ = write!(text, ",u{i}"));
        text.push_str(",source,objective,nodes,relaxations,seconds\n");
        for next in &self.moves {
            _ = write!(text, "{}", next.step);
            next.state.iter().chain(&next.input).for_each(|&v| {
                _ = write!(text, ",{}", rounded(v, DIGITS));
            });
            let objective = next.objective.map(|v| rounded(v, DIGITS)).unwrap_or_default();
            let (nodes, relaxations) = (next.nodes, next.relaxations);
            let seconds = rounded(next.time.as_secs_f64(), DIGITS);
            _ = writeln!(text, ",{},{objective},{nodes},{relaxations},{seconds}", next.source);
        }
        text
    }

    /// A picture: the [charts](ClosedLoop::charts) over the steps, with a title.
    pub fn to_svg(&self, title: &str) -> String {
        Chart::to_svg(&self.charts(1.0, "step", &[]), title)
    }

    /// A chart for each state and each input over time, one below the other, to be drawn by
    /// [`Chart::to_svg`]. Inputs that come from no plan have a dot.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt, in the unit of `time`.
    /// * `time`: what is along the axis, with its unit.
    /// * `labels`: states, then inputs, with their units. Those that are missing are called `x0`,
    ///   ..., `u0`, ....
    pub fn charts(&self, time_step: f64, time: &str, labels: &[&str]) -> Vec<Chart> {
        let states = self.states.first().map_or(0, Vec::len);
        let inputs = self.moves.first().map_or(0, |first| first.input.len());
        let end = Interval::new(0.0, time_step * self.states.len().saturating_sub(1) as f64);
        let mut charts = Vec::new();
        for k in 0..states + inputs {
            let is_state = k < states;
            let (letter, i) = if is_state { ("x", k) } else { ("u", k - states) };
            let label = labels.get(k).map_or_else(|| format!("{letter}{i}"), ToString::to_string);
            // All charts are over the same time, which is written once.
            let time = if k + 1 == states + inputs { time } else { "" };
            let mut chart =
                Chart::new(time, label).with_size(720.0, 150.0).with_horizontal_range(end);
            if is_state {
                let value = |state: &Vec<f64>| state.get(i).copied().unwrap_or(f64::NAN);
                let values = self.states.iter().map(value).enumerate();
                chart.line("", COLOURS[0], values.map(|(t, x)| [t as f64 * time_step, x]));
            } else {
                let at = |t: usize| self.moves[t].input.get(i).copied().unwrap_or(f64::NAN);
                // An input holds for a whole step.
                let ends = |t: usize| [t, t + 1].map(|end| [end as f64 * time_step, at(t)]);
                chart.line("", COLOURS[1], (0..self.moves.len()).flat_map(ends));
                let unplanned = (0..self.moves.len()).filter(|t| self.moves[*t].states.is_empty());
                let dots: Vec<[f64; 2]> = unplanned.map(|t| ends(t)[0]).collect();
                if !dots.is_empty() {
                    chart.dots("without a plan", "black", 3.0, dots);
                }
            }
            charts.push(chart);
        }
        charts
    }
}

impl fmt::Display for ClosedLoop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sum = |of: fn(&ControlMove) -> u64| self.moves.iter().map(of).sum::<u64>();
        let milliseconds = |part: f64| 1e3 * self.time_exceeded_by(part).as_secs_f64();
        let mut sources: Vec<MoveSource> = self.moves.iter().map(|next| next.source).collect();
        sources.sort_unstable();
        sources.dedup();
        let counts: Vec<String> =
            sources.iter().map(|&source| format!("{} {source}", self.count(source))).collect();
        writeln!(f, "{}: {}", counted(self.moves.len(), "step"), counts.join(", "))?;
        let (nodes, relaxations) = (sum(|m| m.nodes), sum(|m| m.relaxations));
        writeln!(f, "{}, {}", counted(nodes, "node"), counted(relaxations, "relaxation"))?;
        write!(
            f,
            "time per step: median {:.2} ms, 99.5 % within {:.2} ms, longest {:.2} ms",
            milliseconds(0.5),
            milliseconds(0.005),
            milliseconds(0.0)
        )
    }
}
