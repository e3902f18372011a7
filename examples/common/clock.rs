//! The time of a thread, where the system tells it: other work on the machine does not count.

use std::time::Instant;

/// A moment: by the wall clock, and the processor time of this thread (ms) where the system tells
/// it.
pub(crate) struct Clock(Instant, Option<f64>);

impl Clock {
    pub(crate) fn start() -> Self {
        let own = processor_milliseconds();
        Clock(Instant::now(), own)
    }

    /// Milliseconds by the wall clock.
    pub(crate) fn waited(&self) -> f64 {
        1e3 * self.0.elapsed().as_secs_f64()
    }

    /// Milliseconds of this thread. The wall clock is the finer one where nothing came between.
    pub(crate) fn spent(&self) -> f64 {
        let waited = self.waited();
        let own = processor_milliseconds().zip(self.1).map(|(end, begin)| end - begin);
        own.map_or(waited, |own| waited.min(own))
    }
}

fn processor_milliseconds() -> Option<f64> {
    std::thread::yield_now(); // brings the count up to date
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-6 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}
