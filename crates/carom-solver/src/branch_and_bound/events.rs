//! The events of several searches as those of one solve.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

use crate::solver::{Control, Event, Incumbent, Progress, StopToken, TreeExchange};

/// The place of one search within a whole solve.
pub(super) struct PartOfSolve<'a> {
    /// Whether no other search came before.
    pub(super) is_first: bool,
    /// The figures of the solve, from those of the search. Without an incumbent, the solve has
    /// none.
    pub(super) figures: &'a dyn Fn(&Progress) -> Progress,
    /// The objective of the solve's point behind a point of the search; `None` if there is none.
    pub(super) objective: &'a dyn Fn(f64) -> Option<f64>,
    /// The objectives that the user was told of; `None` if every point of the search is news.
    pub(super) told: Option<&'a Told>,
    /// Ended when the user stops the solve.
    pub(super) token: &'a StopToken,
}

/// The best (minimised) objectives that the user was told of, as an event and as a point.
#[derive(Debug)]
pub(super) struct Told {
    /// 1 for minimisation, -1 for maximisation.
    sign: f64,
    event: Cell<f64>,
    point: Cell<f64>,
}

impl Told {
    pub(super) fn nothing(sign: f64) -> Self {
        let [event, point] = [(); 2].map(|()| Cell::new(f64::INFINITY));
        Told { sign, event, point }
    }

    /// With an objective that the user was told of, both as an event and as a point.
    pub(super) fn up_to(sign: f64, objective: Option<f64>) -> Self {
        let told = Told::nothing(sign);
        for told in [&told.event, &told.point] {
            told.set(objective.map_or(f64::INFINITY, |objective| sign * objective));
        }
        told
    }

    /// Whether an objective is better than all those told before. Counts it as told.
    fn is_news(&self, told: &Cell<f64>, objective: f64) -> bool {
        let minimised = self.sign * objective;
        let is_better = minimised < told.get();
        told.set(told.get().min(minimised));
        is_better
    }

    fn is_new_event(told: Option<&Told>, objective: f64) -> bool {
        told.is_none_or(|told| told.is_news(&told.event, objective))
    }

    fn is_new_point(told: Option<&Told>, objective: f64) -> bool {
        told.is_none_or(|told| told.is_news(&told.point, objective))
    }
}

impl PartOfSolve<'_> {
    /// Runs a search whose events and points the user sees as those of the solve.
    pub(super) fn run<T>(
        &self,
        control: &mut Control<'_>,
        run: impl FnOnce(&mut Control<'_>) -> T,
    ) -> T {
        self.run_together(control, None, run)
    }

    /// Runs a search of one of the trees that other processes search as well.
    pub(super) fn run_together<T>(
        &self,
        control: &mut Control<'_>,
        exchange: Option<&mut dyn TreeExchange>,
        run: impl FnOnce(&mut Control<'_>) -> T,
    ) -> T {
        let watches = control.watches_incumbents();
        let control = RefCell::new(control);
        let mut on_event = |event: &Event| {
            let figures = (self.figures)(event.progress());
            let is_new = |objective| Told::is_new_event(self.told, objective);
            let event = match event {
                Event::Presolved(size, _) if self.is_first => Event::Presolved(*size, figures),
                // The bound of a part is not that of the whole.
                Event::Relaxed(_) if self.is_first && figures.bound.is_finite() => {
                    Event::Relaxed(figures)
                }
                Event::Root(_) if self.is_first => Event::Root(figures),
                Event::BegunAgain(counts, _) => Event::BegunAgain(*counts, figures),
                Event::Incumbent(_) if figures.incumbent.is_some_and(is_new) => {
                    Event::Incumbent(figures)
                }
                _ => Event::Progress(figures),
            };
            control.borrow_mut().report(&event);
        };
        let mut on_incumbent = |found: &Incumbent<'_>| {
            let objective = (self.objective)(found.objective);
            let is_new = |objective: &f64| Told::is_new_point(self.told, *objective);
            let Some(objective) = objective.filter(is_new) else {
                return ControlFlow::Continue(());
            };
            let figures = (self.figures)(&found.progress);
            let whole = Incumbent::new(found.point, objective, found.found_by, figures);
            let flow = control.borrow_mut().report_incumbent(&whole);
            if flow.is_break() {
                self.token.stop();
            }
            flow
        };
        let mut inner = Control::default().with_progress(&mut on_event);
        if watches {
            inner = inner.with_incumbent(&mut on_incumbent);
        }
        if let Some(exchange) = exchange {
            inner = inner.with_exchange(exchange);
        }
        run(&mut inner)
    }
}
