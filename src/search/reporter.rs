//! Progress events: when to send which.

use web_time::{Duration, Instant};

use super::tree::Tree;
use crate::solver::{Control, Event};

/// Decides when to send events.
pub(super) struct Reporter {
    root_done: bool,
    incumbent: Option<f64>,
    last: Instant,
}

impl Reporter {
    pub(super) fn new() -> Self {
        Reporter { root_done: false, incumbent: None, last: Instant::now() }
    }

    pub(super) fn report(&mut self, tree: &Tree<'_>, control: &mut Control<'_>) {
        let progress = tree.progress();
        if !self.root_done && progress.nodes > 0 {
            self.root_done = true;
            control.report(&Event::Root(progress));
        }
        if progress.incumbent != self.incumbent {
            self.incumbent = progress.incumbent;
            control.report(&Event::Incumbent(progress));
        }
        if self.last.elapsed() >= Duration::from_millis(200) {
            self.last = Instant::now();
            control.report(&Event::Progress(progress));
        }
    }
}
