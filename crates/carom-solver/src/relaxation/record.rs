//! The records of methods: a method that keeps giving up is used less often.

/// The number of consecutive failures after which a method is left out.
const MAX_CONSECUTIVE_FAILURES: u32 = 16;

/// The number of programs after which a method that is left out is tried again.
const RETRY_INTERVAL: u32 = 8;

/// The record of a method at the programs of a search.
#[derive(Debug, Clone, Copy, Default)]
pub struct Record {
    /// The number of consecutive programs on which it has given up.
    given_up: u32,
    /// The number of programs for which it was left out since.
    left_out: u32,
}

impl Record {
    /// Whether the method is to be used for the next program, which is counted.
    pub fn asks(&mut self) -> bool {
        if self.given_up < MAX_CONSECUTIVE_FAILURES || self.left_out + 1 >= RETRY_INTERVAL {
            self.left_out = 0;
            return true;
        }
        self.left_out += 1;
        false
    }

    /// Whether the method has given up the last time.
    pub fn note(&mut self, gave_up: bool) {
        self.given_up = if gave_up { self.given_up.saturating_add(1) } else { 0 };
    }
}
