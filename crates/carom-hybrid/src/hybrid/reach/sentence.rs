//! Explanations as sentences.

use std::fmt;

use super::explain::{EmptinessReason, Finding, ReachExplanation};
use super::words::{Words, apart, number, range, two_numbers};
use crate::number::counted;

impl fmt::Display for EmptinessReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(&Words::default()))
    }
}

impl EmptinessReason {
    fn in_words(&self, words: &Words) -> String {
        match self {
            EmptinessReason::Limit { name, transition: None, limit, nearest } => {
                let (name, unit) = words.limit(name);
                format!("{name} is missed by at least {}{unit}", number(nearest - limit))
            }
            EmptinessReason::Limit { name, transition: Some(transition), limit, nearest } => {
                let miss = number(nearest - limit);
                let (undone, unit) = match words.undone(transition) {
                    Some((undone, unit)) => (undone.to_owned(), unit),
                    None => (format!("`{transition}` is impossible"), None),
                };
                match unit {
                    Some(unit) => format!("{undone}: at least {miss} {unit} are missing"),
                    None => format!("{undone}: `{name}` is missed by at least {miss}"),
                }
            }
            EmptinessReason::Range { state, reached, needed, given } => {
                let at = |(name, at): &(String, _)| {
                    format!("{} is {}", words.name(name), range(at, &words.unit(name)))
                };
                let given: Vec<String> = given.iter().map(at).collect();
                let place = match given.is_empty() {
                    true => String::new(),
                    false => format!("where {}, ", given.join(" and ")),
                };
                let (own, unit) = (words.name(state), words.unit(state));
                format!("{place}{own} is {}", apart(reached, needed, &unit))
            }
            EmptinessReason::Combination { factors, reached, needed } => {
                let term = |(name, factor): &(String, f64)| {
                    let own = words.name(name);
                    match *factor {
                        1.0 => own.to_owned(),
                        -1.0 => format!("- {own}"),
                        factor => format!("{} {own}", number(factor)),
                    }
                };
                let terms: Vec<String> = factors.iter().map(term).collect();
                let sum = terms.join(" + ").replace("+ -", "- ").replace("-  ", "- ");
                let (reached, needed) = two_numbers(*reached, *needed);
                format!("{sum} is at most {reached}, and at least {needed} is needed")
            }
        }
    }
}

impl Finding {
    fn in_words(&self, words: &Words) -> String {
        let mut text = String::new();
        match self.events {
            None => {}
            Some(0) if self.or_more => {}
            Some(events) => text = format!("{}, ", words.events(events, self.or_more)),
        }
        for (choice, mode) in &self.modes {
            text += &format!("with {choice} {mode}, ");
        }
        text + &self.reason.in_words(words)
    }
}

impl ReachExplanation {
    /// So many steps, with the time that they take.
    fn span(&self, steps: usize) -> String {
        let count = counted(steps, "step");
        format!("{count} ({} s)", number(steps as f64 * self.time_step))
    }
}

impl fmt::Display for ReachExplanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no plan has {}: ", self.span(self.steps))?;
        match self.sample {
            0 => write!(f, "at the start")?,
            sample if sample == self.steps => write!(f, "at the end")?,
            sample => write!(f, "after {}", self.span(sample))?,
        }
        for (k, finding) in self.findings.iter().enumerate() {
            let separator = if k == 0 { "," } else { ";" };
            write!(f, "{separator} {}", finding.in_words(&self.words))?;
        }
        if self.findings.is_empty() {
            f.write_str(", no state is left")?;
        }
        if !self.remedies.is_empty() {
            write!(f, ". It might be possible {}", self.remedies.join(", or "))?;
        }
        Ok(())
    }
}
