//! When to stop, asked from inside loops.

use web_time::{Duration, Instant};

use super::Interrupt;

/// Work between two looks at the clock, in entries visited: some tens of microseconds.
const BETWEEN: usize = 10_000;

/// A moment to stop at and an interrupt, cheap to ask in every turn of a loop. Once over it stays
/// over, so that nothing that was left half done is taken for finished later.
#[derive(Debug, Clone, Default)]
pub struct Deadline {
    at: Option<Instant>,
    interrupt: Interrupt,
    /// Work since the last look at the clock.
    work: usize,
    over: bool,
}

impl Deadline {
    /// So long after a start; without a limit, only the interrupt counts.
    pub fn new(start: Instant, limit: Option<Duration>, interrupt: &Interrupt) -> Self {
        // A limit beyond the end of time is none.
        let at = limit.and_then(|limit| start.checked_add(limit));
        Deadline { at, interrupt: interrupt.clone(), work: 0, over: false }
    }

    /// The interrupt.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// The time left; nothing when it is not limited.
    pub fn left(&self) -> Option<Duration> {
        self.at.map(|at| at.saturating_duration_since(Instant::now()))
    }

    /// Whether it is over now.
    pub fn is_over(&self) -> bool {
        let late = || self.at.is_some_and(|at| Instant::now() >= at);
        self.over || self.interrupt.is_triggered() || late()
    }

    /// Notes work and tells whether it is over; the clock is read once in a while.
    ///
    /// # Arguments
    ///
    /// * `work`: about the number of matrix entries that were visited since it was last asked.
    pub fn spend(&mut self, work: usize) -> bool {
        self.work = self.work.saturating_add(work);
        if self.work >= BETWEEN {
            self.work = 0;
            self.over = self.is_over();
        }
        self.over
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn once_over_it_stays_over() {
        let interrupt = Interrupt::new();
        let mut deadline = Deadline::new(Instant::now(), None, &interrupt);
        assert!(!deadline.spend(usize::MAX) && deadline.left().is_none());
        interrupt.trigger();
        assert!(!deadline.spend(1) && deadline.is_over());
        assert!(deadline.spend(BETWEEN));
        interrupt.reset();
        assert!(deadline.spend(0) && deadline.is_over());
    }

    #[test]
    fn a_limit_of_nothing_is_over_at_once() {
        let (start, interrupt) = (Instant::now(), Interrupt::new());
        let mut deadline = Deadline::new(start, Some(Duration::ZERO), &interrupt);
        assert!(deadline.is_over() && deadline.spend(BETWEEN));
        assert_eq!(deadline.left(), Some(Duration::ZERO));
        assert!(!Deadline::new(start, Some(Duration::MAX), &interrupt).is_over());
    }
}
