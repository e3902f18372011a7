//! Windows of temporal operators, in steps or in seconds.

use std::fmt;
use std::ops::{RangeFrom, RangeInclusive};

use crate::error::Error;
use crate::number::{DIGITS, rounded};

/// The window of a temporal operator, counted from the sample at which the operator is read.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub enum Window {
    /// Steps, ends included; `None` lasts to the end of the run.
    Steps(usize, Option<usize>),
    /// The same in s.
    Seconds(f64, Option<f64>),
}

/// A window of a [`Mission`](super::Mission)'s operator: `0..=5` and `2..` in steps, `0.0..=2.5`
/// and `1.0..` in seconds.
///
/// Seconds are rounded inwards: the window's samples are those whose times are in it.
pub trait IntoWindow {
    #[doc(hidden)]
    fn window(self) -> Window;
}

impl IntoWindow for RangeInclusive<usize> {
    fn window(self) -> Window {
        Window::Steps(*self.start(), Some(*self.end()))
    }
}

impl IntoWindow for RangeFrom<usize> {
    fn window(self) -> Window {
        Window::Steps(self.start, None)
    }
}

impl IntoWindow for RangeInclusive<f64> {
    fn window(self) -> Window {
        Window::Seconds(*self.start(), Some(*self.end()))
    }
}

impl IntoWindow for RangeFrom<f64> {
    fn window(self) -> Window {
        Window::Seconds(self.start, None)
    }
}

#[doc(hidden)]
impl IntoWindow for Window {
    fn window(self) -> Window {
        self
    }
}

/// Fractions of a step by which a time in s may miss a sample and still be at it.
const SAME: f64 = 1e-9;

impl Window {
    /// The window in steps of some length (s): the first step and the last, `None` for the end of
    /// the run.
    pub(super) fn steps(&self, time_step: f64) -> Result<(usize, Option<usize>), Error> {
        let named = |what: &str| format!("the {what} of the window {self}");
        let (first, last) = match *self {
            Window::Steps(first, last) => (first, last),
            Window::Seconds(first, last) => {
                for (what, value) in [("beginning", Some(first)), ("end", last)] {
                    let value = value.unwrap_or(0.0);
                    if !(value >= 0.0 && value.is_finite()) {
                        let range = 0.0..f64::INFINITY;
                        return Err(Error::out_of_range_with(named(what), value, range, " s"));
                    }
                }
                let count = |seconds: f64| seconds / time_step;
                let near = |value: f64| SAME * value.max(1.0);
                let first = count(first);
                let begin = (first - near(first)).ceil().max(0.0) as usize;
                let end = last.map(count).map(|last| (last + near(last)).floor() as usize);
                (begin, end)
            }
        };
        match last {
            Some(last) if last < first => {
                let range = format!(
                    "at least step {first}, its first one with {} s a step; no sample is in the window",
                    rounded(time_step, DIGITS)
                );
                let (last, first) = (last as f64, first as f64);
                Err(Error::out_of_range_in_words(named("last step"), last, first.., range))
            }
            _ => Ok((first, last)),
        }
    }

    /// Whether the window lasts to the end of the run.
    pub(super) fn is_open(&self) -> bool {
        matches!(self, Window::Steps(_, None) | Window::Seconds(_, None))
    }

    /// The samples of the window at a sample of a run that ends at `end`, and whether it reaches
    /// beyond.
    pub(super) fn samples(
        &self,
        time_step: f64,
        sample: usize,
        end: Option<usize>,
    ) -> Result<(RangeInclusive<usize>, bool), Error> {
        let (first, last) = self.steps(time_step)?;
        let begin = sample.saturating_add(first);
        let stop = last.map(|last| sample.saturating_add(last));
        // An empty range for a run without samples.
        let Some(end) = end else { return Ok((RangeInclusive::new(1, 0), true)) };
        match stop {
            Some(stop) => Ok((begin..=stop.min(end), stop > end)),
            None => Ok((begin..=end, begin > end)),
        }
    }

    /// The same window for steps of half the length.
    pub(super) fn halved(self) -> Window {
        match self {
            Window::Steps(first, last) => {
                Window::Steps(first.saturating_mul(2), last.map(|last| last.saturating_mul(2)))
            }
            seconds => seconds,
        }
    }

    /// The part of the window from one step to another, in the window's own unit.
    pub(super) fn narrowed(self, time_step: f64, first: usize, last: usize) -> Window {
        match self {
            Window::Steps(..) => Window::Steps(first, Some(last)),
            Window::Seconds(..) => {
                Window::Seconds(first as f64 * time_step, Some(last as f64 * time_step))
            }
        }
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: f64| rounded(value, DIGITS);
        match *self {
            Window::Steps(first, Some(last)) => write!(f, "[{first},{last}]"),
            Window::Steps(first, None) => write!(f, "[{first},]"),
            Window::Seconds(first, Some(last)) => {
                write!(f, "[{},{}s]", number(first), number(last))
            }
            Window::Seconds(first, None) => write!(f, "[{}s,]", number(first)),
        }
    }
}
