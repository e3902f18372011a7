//! Which rows a propagation visited, and when rows changed last.
//!
//! A probing trial that found nothing need not be repeated while the bounds in the rows that it
//! visited are unchanged. Neighbouring rows form a block, so that a set of blocks fits in one word.

/// Blocks of rows; as many as a word has bits.
const ROW_BLOCKS: usize = 128;

pub(super) type RowBlockSet = u128;

/// When each block of rows changed, and which blocks propagation visits.
#[derive(Debug, Clone)]
pub(super) struct ChangeLog {
    /// The logarithm of the number of rows of a block.
    shift: u32,
    visited: RowBlockSet,
    /// By block, when it last changed.
    changed: Vec<u32>,
    now: u32,
    /// Whether changes are on trial, to be taken back.
    on_trial: bool,
}

impl ChangeLog {
    /// A log for this many rows.
    pub(super) fn new(rows: usize) -> Self {
        let shift = rows.div_ceil(ROW_BLOCKS).next_power_of_two().trailing_zeros();
        ChangeLog { shift, visited: 0, changed: vec![0; ROW_BLOCKS], now: 1, on_trial: false }
    }

    #[inline]
    fn block(&self, row: usize) -> usize {
        (row >> self.shift).min(ROW_BLOCKS - 1)
    }

    /// Notes that propagation visits a row.
    #[inline]
    pub(super) fn visit(&mut self, row: usize) {
        self.visited |= 1 << self.block(row);
    }

    pub(super) fn blocks_of(&self, row: usize) -> RowBlockSet {
        1 << self.block(row)
    }

    /// Notes that a bound of a column in these blocks changes.
    #[inline]
    pub(super) fn touch(&mut self, mut blocks: RowBlockSet) {
        if self.on_trial {
            return;
        }
        while blocks != 0 {
            self.changed[blocks.trailing_zeros() as usize] = self.now;
            blocks &= blocks - 1;
        }
    }

    /// Says whether changes from here on are on trial.
    pub(super) fn set_on_trial(&mut self, on_trial: bool) {
        self.on_trial = on_trial;
    }

    /// Forgets which rows were visited.
    pub(super) fn start(&mut self) {
        self.visited = 0;
    }

    /// The blocks visited since [`start`](ChangeLog::start), and the time; later changes have later
    /// times.
    pub(super) fn finish(&mut self) -> (RowBlockSet, u32) {
        let now = self.now;
        self.now = now.saturating_add(1);
        (self.visited, now)
    }

    /// Whether any of these blocks changed after a time.
    pub(super) fn has_changed(&self, mut blocks: RowBlockSet, time: u32) -> bool {
        while blocks != 0 {
            if self.changed[blocks.trailing_zeros() as usize] > time {
                return true;
            }
            blocks &= blocks - 1;
        }
        false
    }
}
