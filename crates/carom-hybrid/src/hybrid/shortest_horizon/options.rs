//! Options of a search for the shortest horizon.

use web_time::Duration;

use super::statements::Statements;
use super::watch::Watch;
use crate::setters::setters;
use crate::solver::Interrupt;

/// Options of a shortest-horizon search.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ShortestOptions {
    /// The largest horizon tried, in steps (`1..=`[`MAX_STEPS`](crate::tolerance::MAX_STEPS));
    /// default 10 000.
    pub max_steps: usize,
    /// Wall-clock limit of the whole search; default none. Each solve gets the remaining time. The
    /// limits of the solver's own [`Options`](crate::solver::Options) are those of each solve, of
    /// which a search makes many: with a time limit there alone, a search may take many times as
    /// long.
    pub time_limit: Option<Duration>,
    /// A horizon that is probably feasible, in steps, such as that of a task that is harder. A good
    /// guess saves solves; a bad one only costs time. Used only if waiting is free.
    pub upper_hint: Option<usize>,
    /// Stops the search and the current solve.
    pub interrupt: Interrupt,
    /// Whether the builder's reach sets are used (default yes).
    pub reach_sets: bool,
    /// Whether a plan on the builder's coarser grid is used as a MIP start if binaries remain open
    /// (default yes).
    pub coarse_guess: bool,
    /// The receivers of the search's events.
    pub(super) watch: Watch,
    /// Statements that programs get besides the rows of their system.
    pub(super) statements: Statements,
}

impl Default for ShortestOptions {
    fn default() -> Self {
        ShortestOptions {
            max_steps: 10_000,
            time_limit: None,
            upper_hint: None,
            interrupt: Interrupt::new(),
            reach_sets: true,
            coarse_guess: true,
            watch: Watch::default(),
            statements: Statements::default(),
        }
    }
}

impl ShortestOptions {
    setters! {
        /// Sets the largest horizon tried, in steps.
        with_max_steps(steps: usize) => max_steps = steps;
        /// Sets the wall-clock limit of the whole search; the solver has one for each solve.
        with_time_limit(limit: Duration) => time_limit = Some(limit);
        /// Sets a horizon that is probably feasible, in steps.
        with_upper_hint(steps: usize) => upper_hint = Some(steps);
        /// Sets whether reach sets are used.
        with_reach_sets(wanted: bool) => reach_sets = wanted;
        /// Sets whether a coarser grid is used.
        with_coarse_guess(wanted: bool) => coarse_guess = wanted;
        /// Lets a handle stop the search.
        with_interrupt(interrupt: &Interrupt) => interrupt = interrupt.clone();
    }
}
