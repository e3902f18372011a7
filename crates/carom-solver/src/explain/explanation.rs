//! The result of an explanation, and its text.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;

use crate::model::Name;
use crate::solution::Point;

/// Why a model has no solution; made by [`infeasibility`](super::infeasibility()).
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct Explanation {
    pub(super) model: String,
    pub(super) status: ExplanationStatus,
    pub(super) groups: Vec<StatementGroup>,
    pub(super) background: Vec<String>,
    /// The background in words, each once.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) background_words: Vec<String>,
    pub(super) domains: Vec<Name>,
    /// By family of variables, what they are in words, where they have words.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) domain_words: BTreeMap<String, String>,
    pub(super) point: Option<Point>,
    pub(super) solves: usize,
    pub(super) propagations: usize,
}

/// The status of an [`Explanation`]: how much is known about its set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ExplanationStatus {
    /// The model has a solution; there is nothing to explain.
    Feasible,
    /// The families contradict each other, and without any one of them the rest has a solution.
    Irreducible,
    /// The families contradict each other; a limit was reached before it was known whether all of
    /// them are needed.
    Reducible,
    /// A limit was reached before it was known whether the model has a solution.
    Unknown,
}

/// A family of statements in a contradictory set, and the members that suffice.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StatementGroup {
    pub(super) name: String,
    /// The statement of the family in words; its name if there are none.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) words: String,
    pub(super) statements: Vec<Name>,
    pub(super) family_size: usize,
    pub(super) without: Option<Point>,
}

impl Explanation {
    /// The status: how much is known about the set.
    pub fn status(&self) -> ExplanationStatus {
        self.status
    }

    /// Whether the model is proved to have no solution.
    pub fn is_infeasible(&self) -> bool {
        matches!(self.status, ExplanationStatus::Irreducible | ExplanationStatus::Reducible)
    }

    /// Whether each of the families is proved to be needed.
    pub fn is_irreducible(&self) -> bool {
        self.status == ExplanationStatus::Irreducible
    }

    /// The families that contradict each other, in the order of the model; empty if the background
    /// contradicts itself or the bounds of its variables.
    pub fn groups(&self) -> &[StatementGroup] {
        &self.groups
    }

    /// The families that were not questioned.
    pub fn background(&self) -> &[String] {
        &self.background
    }

    /// The variables whose bounds contribute to the contradiction: with wider bounds, the set may
    /// have a solution. Known only if propagation alone refutes the set, and empty otherwise, or if
    /// the statements contradict each other whatever the bounds are.
    pub fn domains(&self) -> &[Name] {
        &self.domains
    }

    /// A solution of the model, if one was found.
    pub fn point(&self) -> Option<&Point> {
        self.point.as_ref()
    }

    /// Number of solves.
    pub fn solves(&self) -> usize {
        self.solves
    }

    /// Number of parts of the model that were refuted without a solve, by propagation and probing.
    pub fn propagations(&self) -> usize {
        self.propagations
    }
}

impl StatementGroup {
    /// The name of the family.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The members that suffice to contradict the rest, ordered by step.
    pub fn statements(&self) -> &[Name] {
        &self.statements
    }

    /// The number of members of the whole family.
    pub fn family_size(&self) -> usize {
        self.family_size
    }

    /// The steps of the members, as ranges of consecutive steps; empty for a statement without a
    /// step.
    pub fn steps(&self) -> Vec<RangeInclusive<usize>> {
        ranges(&self.statements)
    }

    /// A point that satisfies the background and all other families of the set. Always present if
    /// the set is irreducible.
    pub fn without(&self) -> Option<&Point> {
        self.without.as_ref()
    }
}

impl fmt::Display for StatementGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = if self.words.is_empty() { &self.name } else { &self.words };
        write_members(f, words, &self.statements)
    }
}

/// The steps of names, as ranges of consecutive steps.
fn ranges(names: &[Name]) -> Vec<RangeInclusive<usize>> {
    let mut ranges: Vec<RangeInclusive<usize>> = Vec::new();
    for step in names.iter().filter_map(Name::step) {
        match ranges.last_mut() {
            Some(range) if range.end() + 1 == step => *range = *range.start()..=step,
            _ => ranges.push(step..=step),
        }
    }
    ranges
}

/// Members of a family in words, `x at steps 0, 3 to 5 and 7`.
fn write_members(f: &mut fmt::Formatter<'_>, family: &str, members: &[Name]) -> fmt::Result {
    f.write_str(family)?;
    let steps = ranges(members);
    let Some((last, first)) = steps.split_last() else { return Ok(()) };
    let one = first.is_empty() && last.start() == last.end();
    f.write_str(if one { " at step " } else { " at steps " })?;
    for (k, range) in steps.iter().enumerate() {
        let joint = match (k, k == first.len()) {
            (0, _) => "",
            (_, true) => " and ",
            _ => ", ",
        };
        match (range.start(), range.end()) {
            (start, end) if start == end => write!(f, "{joint}{start}")?,
            (start, end) => write!(f, "{joint}{start} to {end}")?,
        }
    }
    Ok(())
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.status {
            ExplanationStatus::Feasible => write!(f, "`{}` has a solution", self.model)?,
            ExplanationStatus::Unknown => {
                write!(
                    f,
                    "it is not known whether `{}` has a solution: a limit came first",
                    self.model
                )?;
            }
            _ if self.groups.is_empty() => {
                f.write_str("the background contradicts itself or the bounds of its variables")?;
            }
            status => {
                f.write_str("these cannot hold together: ")?;
                for (k, group) in self.groups.iter().enumerate() {
                    write!(f, "{}{group}", if k == 0 { "" } else { "; " })?;
                }
                if status == ExplanationStatus::Reducible {
                    f.write_str(" (a limit came before it was known whether all are needed)")?;
                }
            }
        }
        if self.is_infeasible() && !self.background_words.is_empty() {
            write!(f, " (background: {})", self.background_words.join(", "))?;
        }
        if !self.domains.is_empty() {
            f.write_str("; the domains that play a part: ")?;
            let families = self.domains.chunk_by(|a, b| a.family() == b.family());
            for (k, members) in families.enumerate() {
                f.write_str(if k == 0 { "" } else { ", " })?;
                let family = members[0].family();
                let words = self.domain_words.get(family).map_or(family, String::as_str);
                write_members(f, words, members)?;
            }
        }
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let (solves, refuted) = (self.solves, self.propagations);
        write!(f, ". {solves} solve{}, ", plural(solves))?;
        write!(f, "{refuted} refutation{} by propagation alone", plural(refuted))
    }
}
