//! What an explanation may spend, and what it must not question.

use web_time::Duration;

use crate::model::Name;
use crate::solver::Interrupt;

/// Options of [`infeasibility`](super::infeasibility()).
///
/// The limits of the solver's own [options](crate::solver::Options) hold for every single solve.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ExplainOptions {
    /// Statements that are not in question, besides those that the model itself declares
    /// ([`Model::set_background`](crate::model::Model::set_background)). The name of a family
    /// stands for all its members; where there is no such family, it stands for all families that
    /// begin with it and an underscore.
    pub background: Vec<Name>,
    /// The families found are narrowed to steps as long as fewer solves than this have been made in
    /// all; default 20.
    pub narrowing: usize,
    /// Hard limit on the solves; default none. When it is reached, the set found so far is returned
    /// as it is.
    pub solve_limit: Option<usize>,
    /// Wall-clock limit of the whole explanation; default none.
    pub time_limit: Option<Duration>,
    /// Stops the explanation and the solve that is running.
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
    /// Puts statements into the background, besides those that are there.
    #[must_use]
    pub fn with_background<N: Into<Name>>(mut self, names: impl IntoIterator<Item = N>) -> Self {
        self.background.extend(names.into_iter().map(N::into));
        self
    }

    /// Sets the number of solves up to which families are narrowed to steps; 0 for not at all.
    #[must_use]
    pub fn with_narrowing(mut self, solves: usize) -> Self {
        self.narrowing = solves;
        self
    }

    /// Sets the hard limit on the solves.
    #[must_use]
    pub fn with_solve_limit(mut self, solves: usize) -> Self {
        self.solve_limit = Some(solves);
        self
    }

    /// Sets the wall-clock limit of the whole explanation.
    #[must_use]
    pub fn with_time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Stops the explanation when the handle is triggered.
    #[must_use]
    pub fn with_interrupt(mut self, interrupt: &Interrupt) -> Self {
        self.interrupt = interrupt.clone();
        self
    }
}
