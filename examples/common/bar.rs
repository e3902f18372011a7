//! A line on a terminal that shows how far a solve is: its best objective, bound and gap.

use carom::prelude::Event;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Solves that take less than this show nothing.
const PATIENCE: Duration = Duration::from_millis(500);

/// The line; nothing is drawn where the standard error is no terminal.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
            bar.set_style(style);
        }
        Bar(bar)
    }

    /// Shows the state of a solve.
    pub(crate) fn show(&self, event: &Event) {
        let progress = event.progress();
        if progress.elapsed < PATIENCE {
            return;
        }
        let best = match progress.incumbent {
            Some(best) => {
                format!("best {best:.6}, gap {:.3} %", 100.0 * progress.relative_gap())
            }
            None => "no point yet".into(),
        };
        self.0.set_message(format!(
            "{best}, bound {:.6}, {} nodes, {} open",
            progress.bound, progress.nodes, progress.open
        ));
        self.0.tick();
    }

    pub(crate) fn clear(&self) {
        self.0.finish_and_clear();
    }
}
