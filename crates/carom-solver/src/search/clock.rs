//! The time that a worker spends on each activity: one reading of the clock per change of activity.

use web_time::{Duration, Instant};

use crate::solution::Times;

/// The activity of a worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Activity {
    Propagation,
    Probing,
    Reduction,
    Relaxation,
    Proof,
    Heuristic,
    Verification,
    Other,
}

/// The clock of one worker. Activities are exclusive: changing to an inner one stops the outer
/// one, until it is changed back.
#[derive(Debug)]
pub(super) struct ActivityClock {
    activity: Activity,
    since: Instant,
    times: Times,
}

impl ActivityClock {
    pub(super) fn new() -> Self {
        ActivityClock { activity: Activity::Other, since: Instant::now(), times: Times::default() }
    }

    /// Changes the activity; returns the one before, to change back to.
    pub(super) fn switch(&mut self, activity: Activity) -> Activity {
        let now = Instant::now();
        let spent = now.duration_since(self.since);
        *self.part() += spent;
        self.since = now;
        std::mem::replace(&mut self.activity, activity)
    }

    /// Moves time of the present activity to another one that measured itself.
    pub(super) fn transfer(&mut self, activity: Activity, time: Duration) {
        let present = self.switch(activity);
        *self.part() += time;
        self.activity = present;
        let own = self.part();
        *own = own.saturating_sub(time);
    }

    /// Stops measuring while another clock runs. Returns the activity before the pause.
    pub(super) fn pause(&mut self) -> Activity {
        self.switch(Activity::Other)
    }

    /// Goes on after a pause.
    pub(super) fn resume(&mut self, activity: Activity) {
        self.restart();
        self.activity = activity;
    }

    /// Starts measuring anew. The time since the last reading belongs to no activity.
    pub(super) fn restart(&mut self) {
        self.since = Instant::now();
    }

    /// The times since they were last taken.
    pub(super) fn take(&mut self) -> Times {
        self.switch(self.activity);
        std::mem::take(&mut self.times)
    }

    fn part(&mut self) -> &mut Duration {
        let times = &mut self.times;
        match self.activity {
            Activity::Propagation => &mut times.propagation,
            Activity::Probing => &mut times.probing,
            Activity::Reduction => &mut times.reduction,
            Activity::Relaxation => &mut times.relaxation,
            Activity::Proof => &mut times.proof,
            Activity::Heuristic => &mut times.heuristics,
            Activity::Verification => &mut times.verification,
            Activity::Other => &mut times.other,
        }
    }
}
