//! Options of an explanation: limits, and what is not questioned.

use web_time::Duration;

use crate::model::Name;
use crate::setters::setters;
use crate::solver::Interrupt;

/// Options of [`infeasibility`](super::infeasibility()).
///
/// The limits of the solver's own [options](crate::solver::Options) apply to each solve.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ExplainOptions {
    /// Statements that are not questioned, in addition to those that the model declares
    /// ([`Model::set_background`](crate::model::Model::set_background)). The name of a family
    /// stands for all its members. If there is no such family, the name stands for all families
    /// whose name begins with it and an underscore.
    pub background: Vec<Name>,
    /// Families are narrowed to steps until this many solves have been made in total; default 20.
    pub narrowing: usize,
    /// Limit on the number of solves; default none. When it is reached, the set found so far is
    /// returned.
    pub solve_limit: Option<usize>,
    /// Wall-clock limit of the whole explanation; default none.
    pub time_limit: Option<Duration>,
    /// Stops the explanation and any running solve.
    pub interrupt: Interrupt,
}

impl Default for ExplainOptions {
    fn default() -> Self {
        ExplainOptions {
            background: Vec::new(),
            narrowing: 20,
            solve_limit: None,
            time_limit: None,
            interrupt: Interrupt::new(),
        }
    }
}

impl ExplainOptions {
    /// Adds statements to the background.
    #[must_use]
    pub fn with_background<N: Into<Name>>(mut self, names: impl IntoIterator<Item = N>) -> Self {
        self.background.extend(names.into_iter().map(N::into));
        self
    }

    setters! {
        /// Sets the number of solves up to which families are narrowed to steps; 0 turns narrowing
        /// off.
        with_narrowing(solves: usize) => narrowing = solves;
        /// Sets the limit on the number of solves.
        with_solve_limit(solves: usize) => solve_limit = Some(solves);
        /// Sets the wall-clock limit of the whole explanation.
        with_time_limit(limit: Duration) => time_limit = Some(limit);
        /// Stops the explanation when the handle is triggered.
        with_interrupt(interrupt: &Interrupt) => interrupt = interrupt.clone();
    }
}
