//! Names of states, inputs and transitions in explanations, with units.

use crate::interval::Interval;
use crate::tolerance::margin_scale;

/// Words for a system whose states mean something: a scene's, or the paper's. Names without words
/// stand for themselves.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Words {
    /// Names of states and inputs, with words and units.
    pub(crate) quantities: Vec<(String, String, &'static str)>,
    /// By the name of a transition and its choice: a sentence that says what cannot be done without
    /// it, and the unit of what is missing, if that tells something.
    pub(crate) transitions: Vec<(String, String, Option<&'static str>)>,
    /// One event.
    pub(crate) event: Option<&'static str>,
}

impl Words {
    /// A state or an input in words.
    pub(super) fn name<'a>(&'a self, name: &'a str) -> &'a str {
        self.find(name).map_or(name, |(words, _)| words)
    }

    /// The label of an axis: the name of a state, with its unit if that is known.
    pub(super) fn label(&self, name: &str) -> String {
        match self.find(name) {
            Some((words, unit)) => {
                format!("{} ({unit})", words.strip_prefix("the ").unwrap_or(words))
            }
            None => name.to_owned(),
        }
    }

    fn find(&self, name: &str) -> Option<(&str, &'static str)> {
        let found = self.quantities.iter().find(|(own, _, _)| own == name)?;
        Some((&found.1, found.2))
    }

    /// The unit of a state or an input, after a space.
    pub(super) fn unit(&self, name: &str) -> String {
        match self.find(name) {
            Some((_, unit)) => format!(" {unit}"),
            None => String::new(),
        }
    }

    /// A limit in words, with the unit of the state that it limits: `the upper limit of x`.
    pub(super) fn limit(&self, name: &str) -> (String, String) {
        match name.split_once(" limit of ") {
            Some((which, state)) => {
                (format!("{which} limit of {}", self.name(state)), self.unit(state))
            }
            None => (name.to_owned(), String::new()),
        }
    }

    /// The sentence that says what cannot be done without a transition.
    pub(super) fn undone(&self, transition: &str) -> Option<(&str, Option<&'static str>)> {
        let found = self.transitions.iter().find(|(own, ..)| own == transition);
        found.map(|(_, words, unit)| (words.as_str(), *unit))
    }

    /// So many events.
    pub(super) fn events(&self, count: usize, or_more: bool) -> String {
        let one = self.event.unwrap_or("event");
        match (count, or_more) {
            (0, _) => match one.starts_with(['a', 'e', 'i', 'o', 'u']) {
                true => format!("without an {one}"),
                false => format!("without a {one}"),
            },
            (1, false) => format!("with 1 {one}"),
            (count, false) => format!("with {count} {one}s"),
            (count, true) => format!("with {count} or more {one}s"),
        }
    }
}

/// A number with so many digits after the point, without zeros at the end.
fn rounded(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = match digits {
        0 => text.as_str(),
        _ => text.trim_end_matches('0').trim_end_matches('.'),
    };
    if text == "-0" { "0".into() } else { text.into() }
}

/// The width up to which a range is a value: what the margin of sets makes of one (relative).
const VALUE_WIDTH: f64 = 2e-4;

/// The fewest digits of a number.
const FEWEST_DIGITS: usize = 2;

/// The most digits of a number.
const MOST_DIGITS: usize = 6;

/// A number for people: two digits after the point, and more if it would be 0 otherwise.
pub(super) fn number(value: f64) -> String {
    let shown =
        (FEWEST_DIGITS..=MOST_DIGITS).map(|digits| rounded(value, digits)).find(|text| text != "0");
    shown.unwrap_or_else(|| "0".into())
}

/// Two numbers that differ, with as many digits as it takes to see that.
pub(super) fn two_numbers(first: f64, second: f64) -> (String, String) {
    let pair = |digits| (rounded(first, digits), rounded(second, digits));
    let distinct = (FEWEST_DIGITS..=MOST_DIGITS).map(pair).find(|(first, second)| first != second);
    distinct.unwrap_or_else(|| pair(MOST_DIGITS))
}

/// Whether a range is a value, up to the margin of sets.
fn is_value(range: &Interval) -> bool {
    range.upper - range.lower <= VALUE_WIDTH * margin_scale(range.magnitude(), 0.0)
}

/// "0.3 m", or "between 0.2 and 0.4 m".
pub(super) fn range(range: &Interval, unit: &str) -> String {
    if is_value(range) {
        return format!("{}{unit}", number(0.5 * (range.lower + range.upper)));
    }
    let (lower, upper) = two_numbers(range.lower, range.upper);
    format!("between {lower} and {upper}{unit}")
}

/// The reached and the needed end of two ranges that do not meet.
pub(super) fn apart(reached: &Interval, needed: &Interval, unit: &str) -> String {
    let is_below = reached.upper < needed.lower;
    let (end, goal) = match is_below {
        true => (reached.upper, needed.lower),
        false => (reached.lower, needed.upper),
    };
    let (end, goal) = two_numbers(end, goal);
    let most = match (is_value(reached), is_below) {
        (true, _) => "",
        (_, true) => "at most ",
        (_, false) => "at least ",
    };
    let least = match (is_value(needed), is_below) {
        (true, _) => "",
        (_, true) => "at least ",
        (_, false) => "at most ",
    };
    format!("{most}{end}{unit}, and {least}{goal}{unit} is needed")
}
