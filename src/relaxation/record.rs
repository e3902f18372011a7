//! The records of methods: one that always gives up is asked less often.

/// A method that has given up so many times in a row is asked every so many times only.
const MAX_CONSECUTIVE_FAILURES: u32 = 16;
const RETRY_INTERVAL: u32 = 8;

/// The record of a method at the programs of a search.
#[derive(Debug, Clone, Copy, Default)]
pub struct Record {
    /// How often in a row it has given up.
    given_up: u32,
    /// How often it was left out since.
    left_out: u32,
}

impl Record {
    /// Whether the method is worth asking again; counts.
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
