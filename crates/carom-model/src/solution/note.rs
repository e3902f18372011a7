//! Remarks about a search: why it takes long, or has come to no end, and what to change.

use std::fmt;

use super::{Solution, Termination};
use crate::number::{counted, percent};
use crate::tolerance::FREE_RADIUS;

/// Fewest nodes, splits or relaxations that a remark is made about.
const MIN_REMARKED: u64 = 100;

/// The relative gap above which a bound counts as far from the best point (no unit).
const WIDE_GAP: f64 = 0.05;

/// A remark about a search, for people: why it has not ended or takes long, and what to change.
///
/// [`Solution::notes`] makes them, [`Log::finish`](crate::solver::Log::finish) prints them, and
/// the guide's page "My search does not finish" explains them. `{}` ends with the
/// [code](Self::code) in brackets.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// The best points are farther from 0 than bounds are proved, in variables without bounds.
    FarFromZero,
    /// A limit came before any point was found.
    NoPoint {
        /// Nodes processed until then.
        nodes: u64,
    },
    /// A limit came while the proved bound was far from the best point.
    WideGap {
        /// The relative gap (no unit), as in [`Solution::relative_gap`].
        gap: f64,
    },
    /// The first method of most relaxations was not good enough, and a second one was asked.
    MethodGivesUp {
        /// The number of times.
        times: u64,
        /// The number of nodes and trials.
        relaxations: u64,
    },
    /// Many nodes were split although all integers of their relaxed points were whole: what
    /// separates the bound from the best point is rounding, not integrality.
    WholeSplits {
        /// Such nodes.
        nodes: u64,
        /// All nodes that were split.
        splits: u64,
    },
    /// The whole ranges of some variables are below the tolerance, beside values that are not
    /// small: rows that depend on them mean little.
    BelowTolerance {
        /// The number of these variables.
        variables: usize,
    },
}

impl Solution {
    /// Remarks about the search: why it has not ended or takes long, if that can be told from what
    /// was counted. Empty if nothing is remarkable.
    ///
    /// ```
    /// use carom::prelude::*;
    /// use carom::solution::Note;
    ///
    /// // Whether 40 different weights fall into two equal halves, after 200 nodes.
    /// let mut model = Model::new("halves");
    /// let x = model.binary_family("x", 40)?;
    /// let weight = |k: usize| (1_000_003 * (k + 1) * (k + 7) % 99_991) as f64;
    /// let all: f64 = (0..40).map(weight).sum();
    /// let half: Affine = x.iter().enumerate().map(|(k, x)| weight(k) * x).sum();
    /// model.add("half", half.equals((all / 2.0).floor()))?;
    ///
    /// let solution = BranchAndBound::new(Options::default().with_node_limit(200)).solve(&model)?;
    /// for note in solution.notes() {
    ///     println!("{note}");
    /// }
    /// assert!(solution.point().is_some() || solution.notes() == [Note::NoPoint { nodes: 200 }]);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn notes(&self) -> Vec<Note> {
        let counts = self.statistics();
        let mut notes = Vec::new();
        if self.termination() == Termination::Stalled && counts.beyond_radius > 0 {
            notes.push(Note::FarFromZero);
        }
        if self.termination().is_limit() && counts.nodes >= MIN_REMARKED {
            let gap = self.relative_gap();
            if self.point().is_none() {
                notes.push(Note::NoPoint { nodes: counts.nodes });
            } else if gap > WIDE_GAP {
                notes.push(Note::WideGap { gap });
            }
        }
        let methods = &counts.relaxation_counts;
        let (times, relaxations) = (methods.given_up, methods.total() - methods.given_up);
        if times >= MIN_REMARKED && 2 * times > relaxations {
            notes.push(Note::MethodGivesUp { times, relaxations });
        }
        let (nodes, splits) = (counts.whole_splits, counts.split);
        if nodes >= MIN_REMARKED && 4 * nodes > splits {
            notes.push(Note::WholeSplits { nodes, splits });
        }
        if self.narrow > 0 {
            notes.push(Note::BelowTolerance { variables: self.narrow });
        }
        notes
    }
}

impl Note {
    /// The section of the guide's page "Help" about it, such as `wide-gap`.
    pub fn code(&self) -> &'static str {
        match self {
            Note::FarFromZero => "far-from-zero",
            Note::NoPoint { .. } => "no-point",
            Note::WideGap { .. } => "wide-gap",
            Note::MethodGivesUp { .. } => "method-gives-up",
            Note::WholeSplits { .. } => "whole-splits",
            Note::BelowTolerance { .. } => "below-tolerance",
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Note::FarFromZero => write!(
                f,
                "the best points have variables without bounds that are farther than {FREE_RADIUS:e} \
                 from 0, where bounds are not proved; give all variables finite bounds, or measure \
                 them in larger units"
            ),
            Note::NoPoint { nodes } => write!(
                f,
                "no point was found in {nodes} nodes; give a start, soften limits that may be too \
                 tight, or ask `explain::infeasibility` whether there is any point"
            ),
            Note::WideGap { gap } => write!(
                f,
                "the proved bound is far from the best point ({} %), so relaxations say little; give \
                 variables tighter bounds, say in each mode what it cannot do, or use reach sets",
                percent(*gap)
            ),
            Note::MethodGivesUp { times, relaxations } => write!(
                f,
                "the first method gave up on {times} of {relaxations} relaxations, which were solved \
                 twice; measure variables in units that make their values about 1, or set \
                 `Options::relaxation` to the second method"
            ),
            Note::WholeSplits { nodes, splits } => write!(
                f,
                "{nodes} of {splits} nodes were split although their integers were whole, so the \
                 search proves digits; allow a larger gap, or leave out cuts"
            ),
            Note::BelowTolerance { variables } => write!(
                f,
                "the whole range of {} is below the tolerance; measure them from one of their bounds, \
                 or in smaller units",
                counted(*variables, "variable")
            ),
        }?;
        write!(f, " [{}]", self.code())
    }
}
