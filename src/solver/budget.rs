//! What a facility that solves several models may spend in all.

use web_time::{Duration, Instant};

use super::{Control, Event, Interrupt, Solver};
use crate::error::Error;
use crate::model::Model;
use crate::solution::{Solution, Termination};

/// A wall-clock limit and an interrupt, shared by a series of solves.
#[derive(Debug, Clone)]
pub(crate) struct Budget {
    began: Instant,
    time_limit: Option<Duration>,
    interrupt: Interrupt,
}

impl Budget {
    /// A budget whose clock starts now.
    pub(crate) fn new(time_limit: Option<Duration>, interrupt: &Interrupt) -> Self {
        Budget { began: Instant::now(), time_limit, interrupt: interrupt.clone() }
    }

    /// Time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    /// Why nothing more may be solved, if so.
    pub(crate) fn exhausted(&self) -> Option<Termination> {
        if self.interrupt.is_triggered() {
            return Some(Termination::Interrupted);
        }
        (self.remaining() == Some(Duration::ZERO)).then_some(Termination::TimeLimit)
    }

    /// Solves a model within what is left: the solver's own time limit still holds, and is the
    /// same afterwards as before.
    pub(crate) fn solve(
        &self,
        solver: &mut dyn Solver,
        model: &Model,
        progress: &mut dyn FnMut(&Event),
    ) -> Result<Solution, Error> {
        let own_limit = solver.options().time_limit;
        let limits = [own_limit, self.remaining()];
        solver.options_mut().time_limit = limits.into_iter().flatten().min();
        let mut control =
            Control::default().with_progress(progress).with_interrupt(&self.interrupt);
        let solution = solver.solve_with(model, &mut control);
        solver.options_mut().time_limit = own_limit;
        solution
    }

    /// What is left of the time; nothing when it is not limited.
    pub(crate) fn remaining(&self) -> Option<Duration> {
        self.time_limit.map(|limit| limit.saturating_sub(self.elapsed()))
    }
}
