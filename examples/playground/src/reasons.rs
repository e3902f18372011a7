//! Why there is no shorter plan, or none at all.

use std::time::Duration;

use carom::hybrid::reach::{EmptinessReason, Finding, ReachExplanation};
use carom::hybrid::{ShortestHorizon, ShortestStatus};
use carom::interval::Interval;
use serde::Serialize;

use crate::words;

/// Time for a reason that comes with the answer.
const QUICK: Duration = Duration::from_millis(100);

/// Why one step less is not enough.
#[derive(Debug, Default, Serialize)]
pub struct Reasons {
    /// Without collisions.
    pub free: Option<Reason>,
    /// With collisions.
    pub tolerant: Option<Reason>,
}

/// A reason in words, and as a barrier between what can be and what has to be.
#[derive(Debug, Serialize)]
pub struct Reason {
    words: String,
    /// One for each number of hits with which a plan gets that far.
    barriers: Vec<Barrier>,
}

/// Two ranges of a quantity that do not meet. An end without a number is open.
#[derive(Debug, Serialize)]
struct Barrier {
    /// The quantity.
    what: String,
    unit: &'static str,
    /// Of which plans this is said, if it is not said of all.
    plans: Option<String>,
    reached: [Option<f64>; 2],
    needed: [Option<f64>; 2],
}

impl From<&ReachExplanation> for Reason {
    fn from(explained: &ReachExplanation) -> Self {
        let words = explained.to_string();
        let is_in_plane = words.contains(" along ");
        let barrier = |finding| Barrier::new(finding, is_in_plane);
        let barriers = explained.findings.iter().filter_map(barrier).collect();
        Reason { words, barriers }
    }
}

impl From<String> for Reason {
    fn from(words: String) -> Self {
        Reason { words, barriers: Vec::new() }
    }
}

impl Barrier {
    /// A combination of several quantities is left to the words.
    fn new(finding: &Finding, is_in_plane: bool) -> Option<Self> {
        let (name, reached, needed) = match &finding.reason {
            EmptinessReason::Range { state, reached, needed, .. } => (state, *reached, *needed),
            EmptinessReason::Limit { name, limit, nearest, .. } => {
                let [infinite, finite] = [f64::NEG_INFINITY, f64::INFINITY];
                (name, Interval::new(*nearest, finite), Interval::new(infinite, *limit))
            }
            _ => return None,
        };
        let ends = |range: Interval| {
            [range.lower, range.upper].map(|end| Some(end).filter(|end| end.is_finite()))
        };
        let plans = finding.events.map(|hits| match (hits, finding.or_more) {
            (0, false) => "without a hit".to_owned(),
            (1, false) => "with 1 hit".to_owned(),
            (_, false) => format!("with {hits} hits"),
            (_, true) => format!("with {hits} or more hits"),
        });
        let (what, unit) = quantity(name, is_in_plane);
        Some(Barrier { what, unit, plans, reached: ends(reached), needed: ends(needed) })
    }
}

/// A state or a limited quantity in words, and its unit.
fn quantity(name: &str, is_in_plane: bool) -> (String, &'static str) {
    let (of, last) = name.rsplit_once(' ').unwrap_or(("", name));
    match last {
        "x" | "y" => (format!("{last} of {of}"), "m"),
        "vx" | "vy" if is_in_plane => (format!("velocity of {of} along {}", &last[1..]), "m/s"),
        "vx" => (format!("velocity of {of}"), "m/s"),
        "speed" => (name.to_owned(), "m/s"),
        "impulse" => (name.to_owned(), "N s"),
        _ => (name.to_owned(), ""),
    }
}

/// Why there is no plan at all, on one side or on both.
///
/// # Arguments
///
/// * `free`: the search without collisions.
/// * `tolerant`: the search with collisions, if there was one.
pub fn reason<P>(
    free: &ShortestHorizon<P>,
    tolerant: Option<&ShortestHorizon<P>>,
) -> Option<String> {
    if free.steps.is_some() {
        return None;
    }
    let both = tolerant.and_then(refuted);
    let one = || refuted(free).map(|reason| format!("without collisions: {reason}"));
    both.or_else(one).map(|reason| words::sentence(&reason))
}

/// Why a search found that there is no plan at all.
fn refuted<P>(found: &ShortestHorizon<P>) -> Option<String> {
    let ShortestStatus::NoneWithin { max_steps } = found.status else { return None };
    Some(found.sets.clone()?.explain_within(max_steps, QUICK).ok()??.to_string())
}
