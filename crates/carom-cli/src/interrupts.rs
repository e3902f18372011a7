//! Ctrl-C for tools that run long: the first one ends the search and keeps what was found, the
//! second one ends the process as if nobody listened. A request to terminate counts as Ctrl-C.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use carom::prelude::Interrupt;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// How long a signal waits until the search hears of it.
const HEARING: Duration = Duration::from_millis(10);

/// The exit status of a tool whose search was ended.
pub(crate) const INTERRUPTED: u8 = 3;

/// The signals that are caught.
pub(crate) struct Signals {
    caught: Arc<AtomicBool>,
}

impl Signals {
    /// Catches signals from now on; the first one triggers the interrupt.
    pub(crate) fn catch(interrupt: &Interrupt) -> io::Result<Self> {
        let caught = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // In this order, so that a signal does not find the flag that it sets itself.
            flag::register_conditional_default(signal, Arc::clone(&caught))?;
            flag::register(signal, Arc::clone(&caught))?;
        }
        let (heard, interrupt) = (Arc::clone(&caught), interrupt.clone());
        thread::spawn(move || {
            while !heard.load(Ordering::Relaxed) {
                thread::sleep(HEARING);
            }
            interrupt.trigger();
        });
        Ok(Signals { caught })
    }

    /// Whether a signal has come.
    pub(crate) fn came(&self) -> bool {
        self.caught.load(Ordering::Relaxed)
    }
}
