//! Progress events: which to send, and when.

use web_time::{Duration, Instant};

use super::pause::Pauses;
use super::tree::Tree;
use crate::solution::Termination;
use crate::solver::{Control, Event, Incumbent, TreeExchange};

/// Decides when to send events.
pub(super) struct Reporter<'w, 'c> {
    control: &'w mut Control<'c>,
    /// The exchange with other processes, if the tree is searched together with them.
    pub(super) exchange: Option<&'c mut dyn TreeExchange>,
    /// Whether the nodes below the root are another process's.
    pub(super) drops_nodes: bool,
    pub(super) pauses: Option<Pauses<'w>>,
    root_done: bool,
    incumbent: Option<f64>,
    last: Instant,
}

impl<'w, 'c> Reporter<'w, 'c> {
    pub(super) fn new(control: &'w mut Control<'c>) -> Self {
        let last = Instant::now();
        Reporter {
            control,
            exchange: None,
            drops_nodes: false,
            pauses: None,
            root_done: false,
            incumbent: None,
            last,
        }
    }

    /// The best point so far was reported before.
    pub(super) fn skip_incumbent(&mut self, tree: &Tree<'_>) {
        self.incumbent = tree.progress().incumbent;
    }

    pub(super) fn report(&mut self, tree: &Tree<'_>) {
        let progress = tree.progress();
        let control = &mut *self.control;
        if !self.root_done && progress.nodes > 0 {
            self.root_done = true;
            control.report(&Event::Root(progress));
        }
        for accepted in tree.take_news() {
            if !control.watches_incumbents() {
                continue;
            }
            let Some(point) = tree.task.judge.point(&accepted.point) else { continue };
            let objective = tree.task.program.sign * accepted.value;
            let incumbent = Incumbent::new(&point, objective, accepted.found_by, progress);
            if control.report_incumbent(&incumbent).is_break() {
                tree.task.token.stop();
                tree.stop(Termination::Interrupted);
            }
        }
        if progress.incumbent != self.incumbent {
            self.incumbent = progress.incumbent;
            control.report(&Event::Incumbent(progress));
        }
        if self.last.elapsed() >= Duration::from_millis(200) {
            self.last = Instant::now();
            control.report(&Event::Progress(progress));
        }
        if let Some(pauses) = &mut self.pauses
            && tree.lock().stop.is_none()
            && pauses.is_end(&progress)
        {
            tree.stop(Termination::NodeLimit);
        }
    }
}
