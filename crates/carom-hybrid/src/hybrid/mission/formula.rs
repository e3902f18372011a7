//! Formulas of signal temporal logic, and the operators that make them.

use std::ops::{BitAnd, BitOr, Not};

use super::window::{IntoWindow, Window};
use crate::error::Error;
use crate::hybrid::system::SystemRow;

/// Formulas nested deeper than this are refused.
pub(super) const MAX_DEPTH: u32 = 100;

/// A mission: what must be true of a run, and when, in signal temporal logic.
///
/// Its smallest parts are [`holds`](Mission::holds): rows of a system's handles at a sample, under
/// a name. A mission is read at sample 0, and what is inside a temporal operator at the samples of
/// its window, counted from the sample at which the operator is read.
///
/// | written | text | true at sample k if |
/// | --- | --- | --- |
/// | `Mission::holds("in A", rows)` | `in A` | all rows hold at k |
/// | `!a`, `a & b`, `a \| b`, `a.implies(b)` | `!a`, `a & b`, `a \| b`, `a -> b` | as usual |
/// | `a.always(0..=5)` | `G[0,5] a` | `a` is true at all samples of the window |
/// | `a.eventually(0.0..=2.5)` | `F[0,2.5s] a` | `a` is true at one of them |
/// | `a.until(0..=5, b)` | `a U[0,5] b` | `b` is true at one of them, and `a` from k to the sample before it |
/// | `a.release(0..=5, b)` | `a R[0,5] b` | `!(!a U[0,5] !b)` |
/// | `a.next()` | `X a` | `a` is true at k + 1 |
///
/// Windows are in steps, or in seconds as floats; `2..` lasts to the end of the run. See
/// the guide's page on missions for windows, the end of a run, robustness and negations.
///
/// ```
/// use carom::hybrid::Mission;
/// use carom::prelude::*;
///
/// let mut cart = HybridSystem::new(0.5); // s
/// let x = cart.state("x", -9.0, 9.0)?; // m
/// let u = cart.input("u", -2.0, 2.0)?; // m/s
/// cart.mode("roll")?.next([x.is(x + 0.5 * u)])?;
/// let depot = Mission::holds("at the depot", [x.within(-2.0, -1.0)]);
/// let far = Mission::holds("far", [x.ge(3.0)]);
/// // At the depot for a second within 4 s, and never far.
/// let mission = depot.always(0.0..=1.0).eventually(0.0..=3.0) & (!far).always(0..);
/// assert_eq!(mission.to_string(), "F[0,3s] G[0,1s] at the depot & G[0,] !far");
///
/// let mut program = cart.program(10)?;
/// program.start([x.equals(1.0)])?;
/// program.require_mission("mission", &mission)?;
/// program.maximize(program.end(x)?)?;
/// let plan = program.solve(&mut BranchAndBound::default())?;
/// assert!(plan.robustness(&mission)? >= -1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
#[doc(alias("STL", "signal temporal logic", "formula", "specification"))]
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a mission does nothing until a program requires it"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "MissionNode", into = "MissionNode"))]
pub struct Mission {
    pub(super) node: MissionNode,
    depth: u32,
}

/// The structure of a mission.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum MissionNode {
    Holds(Predicate),
    Not(Box<Mission>),
    And(Vec<Mission>),
    Or(Vec<Mission>),
    Always(Window, Box<Mission>),
    Eventually(Window, Box<Mission>),
    Until(Window, Box<Mission>, Box<Mission>),
    Release(Window, Box<Mission>, Box<Mission>),
    /// Replaces a mission that was nested too deep.
    TooDeep,
}

/// Named rows that all hold.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Predicate {
    pub(super) name: String,
    /// For all samples, or a list for each.
    pub(super) rows: PredicateRows,
}

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum PredicateRows {
    Same(Vec<SystemRow>),
    BySample(Vec<Vec<SystemRow>>),
}

impl Predicate {
    /// The rows at a sample; `None` beyond those that are given.
    pub(super) fn rows(&self, sample: usize) -> Option<&[SystemRow]> {
        match &self.rows {
            PredicateRows::Same(rows) => Some(rows),
            PredicateRows::BySample(rows) => rows.get(sample).map(Vec::as_slice),
        }
    }
}

impl From<MissionNode> for Mission {
    fn from(node: MissionNode) -> Self {
        let node = match node {
            // One part alone is that part.
            MissionNode::And(mut of) | MissionNode::Or(mut of) if of.len() == 1 => {
                return of.remove(0);
            }
            node => node,
        };
        let mission = Mission { node, depth: 0 };
        let depth = 1 + mission.parts().iter().map(|part| part.depth).max().unwrap_or(0);
        match depth <= MAX_DEPTH {
            true => Mission { depth, ..mission },
            false => Mission { node: MissionNode::TooDeep, depth: 1 },
        }
    }
}

impl From<Mission> for MissionNode {
    fn from(mission: Mission) -> Self {
        mission.node
    }
}

impl From<&Mission> for Mission {
    fn from(mission: &Mission) -> Self {
        mission.clone()
    }
}

impl Mission {
    /// Rows that all hold at the sample at which this is read, under a name of one or several
    /// words: a region of a scene's or a system's handles, as for
    /// [`require`](crate::hybrid::HybridProgram::require).
    ///
    /// A norm, as in `norm([x - 4.0, y - 1.0]).le(0.5)`, is a row too, but must not be negated.
    pub fn holds<R: Into<SystemRow>>(
        name: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
    ) -> Mission {
        let rows = PredicateRows::Same(rows.into_iter().map(R::into).collect());
        MissionNode::Holds(Predicate { name: name.into(), rows }).into()
    }

    /// The same with rows of their own for each sample, from 0: for things that move, and for
    /// families of variables of a [`Model`](crate::model::Model) without a system.
    pub fn holds_by_sample<R: Into<SystemRow>, L: IntoIterator<Item = R>>(
        name: impl Into<String>,
        rows: impl IntoIterator<Item = L>,
    ) -> Mission {
        let list = |rows: L| rows.into_iter().map(R::into).collect();
        let rows = PredicateRows::BySample(rows.into_iter().map(list).collect());
        MissionNode::Holds(Predicate { name: name.into(), rows }).into()
    }

    /// All of these are true.
    pub fn all(of: impl IntoIterator<Item = Mission>) -> Mission {
        MissionNode::And(of.into_iter().collect()).into()
    }

    /// At least one of these is true.
    pub fn any(of: impl IntoIterator<Item = Mission>) -> Mission {
        MissionNode::Or(of.into_iter().collect()).into()
    }

    /// True if `then` is true or this is not.
    pub fn implies(self, then: impl Into<Mission>) -> Mission {
        !self | then.into()
    }

    /// True at every sample of a window.
    #[doc(alias = "globally")]
    pub fn always(self, window: impl IntoWindow) -> Mission {
        MissionNode::Always(window.window(), Box::new(self)).into()
    }

    /// True at some sample of a window.
    #[doc(alias = "finally")]
    pub fn eventually(self, window: impl IntoWindow) -> Mission {
        MissionNode::Eventually(window.window(), Box::new(self)).into()
    }

    /// `goal` is true at some sample of the window, and this at all samples before it, from the one
    /// at which the operator is read.
    pub fn until(self, window: impl IntoWindow, goal: impl Into<Mission>) -> Mission {
        MissionNode::Until(window.window(), Box::new(self), Box::new(goal.into())).into()
    }

    /// At each sample of the window `kept` is true, or this was true at a sample before it, from
    /// the one at which the operator is read: the negation of [`until`](Mission::until) of the
    /// negations.
    pub fn release(self, window: impl IntoWindow, kept: impl Into<Mission>) -> Mission {
        MissionNode::Release(window.window(), Box::new(self), Box::new(kept.into())).into()
    }

    /// True at the next sample.
    pub fn next(self) -> Mission {
        self.always(1..=1)
    }

    /// The missions of which this is made.
    pub(super) fn parts(&self) -> Vec<&Mission> {
        match &self.node {
            MissionNode::Holds(_) | MissionNode::TooDeep => Vec::new(),
            MissionNode::Not(of) | MissionNode::Always(_, of) | MissionNode::Eventually(_, of) => {
                vec![&**of]
            }
            MissionNode::And(of) | MissionNode::Or(of) => of.iter().collect(),
            MissionNode::Until(_, a, b) | MissionNode::Release(_, a, b) => vec![&**a, &**b],
        }
    }

    /// The window of a temporal operator.
    pub(super) fn window(&self) -> Option<&Window> {
        match &self.node {
            MissionNode::Always(window, _)
            | MissionNode::Eventually(window, _)
            | MissionNode::Until(window, ..)
            | MissionNode::Release(window, ..) => Some(window),
            _ => None,
        }
    }

    /// Refuses windows without samples, also those that are never read.
    pub(super) fn check_windows(&self, time_step: f64) -> Result<(), Error> {
        let mut checked = Ok(());
        self.visit(&mut |part| {
            if let (Some(window), true) = (part.window(), checked.is_ok()) {
                checked = window.steps(time_step).map(drop);
            }
        });
        checked
    }

    pub(super) fn visit<'a>(&'a self, visit: &mut dyn FnMut(&'a Mission)) {
        visit(self);
        self.parts().into_iter().for_each(|part| part.visit(visit));
    }

    /// The same for steps of half the length.
    pub(crate) fn halved(&self) -> Mission {
        let one = |of: &Mission| Box::new(of.halved());
        let all = |of: &[Mission]| of.iter().map(Mission::halved).collect();
        match &self.node {
            MissionNode::Holds(_) | MissionNode::TooDeep => return self.clone(),
            MissionNode::Not(of) => MissionNode::Not(one(of)),
            MissionNode::And(of) => MissionNode::And(all(of)),
            MissionNode::Or(of) => MissionNode::Or(all(of)),
            MissionNode::Always(w, of) => MissionNode::Always(w.halved(), one(of)),
            MissionNode::Eventually(w, of) => MissionNode::Eventually(w.halved(), one(of)),
            MissionNode::Until(w, a, b) => MissionNode::Until(w.halved(), one(a), one(b)),
            MissionNode::Release(w, a, b) => MissionNode::Release(w.halved(), one(a), one(b)),
        }
        .into()
    }
}

impl Not for Mission {
    type Output = Mission;

    fn not(self) -> Mission {
        match self.node {
            MissionNode::Not(of) => *of,
            node => MissionNode::Not(Box::new(Mission { node, depth: self.depth })).into(),
        }
    }
}

impl Not for &Mission {
    type Output = Mission;

    fn not(self) -> Mission {
        !self.clone()
    }
}

impl<T: Into<Mission>> BitAnd<T> for Mission {
    type Output = Mission;

    fn bitand(self, right: T) -> Mission {
        let open = |mission: Mission| match mission.node {
            MissionNode::And(of) if !of.is_empty() => of,
            _ => vec![mission],
        };
        let mut of = open(self);
        of.extend(open(right.into()));
        MissionNode::And(of).into()
    }
}

impl<T: Into<Mission>> BitOr<T> for Mission {
    type Output = Mission;

    fn bitor(self, right: T) -> Mission {
        let open = |mission: Mission| match mission.node {
            MissionNode::Or(of) if !of.is_empty() => of,
            _ => vec![mission],
        };
        let mut of = open(self);
        of.extend(open(right.into()));
        MissionNode::Or(of).into()
    }
}
