//! The rows that propagation has yet to visit, in sweeps.
//!
//! Rows are visited in the order of their numbers, alternately up and down, so that a change
//! travels along a whole chain of steps in one sweep. A queue or a stack needs more visits.

/// Rows by number; a set with a position and a direction.
#[derive(Debug, Clone)]
pub struct Worklist {
    /// By level, from the rows up: a bit a row, a bit a word below, and so on.
    levels: Vec<Vec<u64>>,
    at: usize,
    falling: bool,
}

const WORD_BITS: usize = u64::BITS as usize;

impl Worklist {
    /// For so many rows.
    pub fn new(rows: usize) -> Self {
        let mut levels = vec![vec![0; rows.div_ceil(WORD_BITS).max(1)]];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            levels.push(vec![0; last.len().div_ceil(WORD_BITS)]);
        }
        Worklist { levels, at: 0, falling: false }
    }

    /// Puts a row in.
    #[inline]
    pub fn insert(&mut self, row: usize) {
        let mut k = row;
        for level in &mut self.levels {
            let word = &mut level[k / WORD_BITS];
            let was = *word;
            *word |= 1 << (k % WORD_BITS);
            if was != 0 {
                break;
            }
            k /= WORD_BITS;
        }
    }

    fn remove(&mut self, row: usize) {
        let mut k = row;
        for level in &mut self.levels {
            let word = &mut level[k / WORD_BITS];
            *word &= !(1 << (k % WORD_BITS));
            if *word != 0 {
                break;
            }
            k /= WORD_BITS;
        }
    }

    /// Takes the next row of the sweep, which turns at its end. After the list was empty, sweeps
    /// begin upward.
    #[inline]
    pub fn pop(&mut self) -> Option<usize> {
        let found = self.next().or_else(|| {
            self.falling = !self.falling;
            self.next()
        });
        match found {
            Some(row) => {
                self.remove(row);
                self.at = row;
            }
            None => self.rewind(),
        }
        found
    }

    fn rewind(&mut self) {
        (self.at, self.falling) = (0, false);
    }

    fn next(&self) -> Option<usize> {
        if self.falling { self.at_most(self.at) } else { self.at_least(self.at) }
    }

    fn at_least(&self, row: usize) -> Option<usize> {
        let mut k = row;
        for (depth, level) in self.levels.iter().enumerate() {
            let rest = level.get(k / WORD_BITS)? & (u64::MAX << (k % WORD_BITS));
            if rest != 0 {
                let mut found = k / WORD_BITS * WORD_BITS + rest.trailing_zeros() as usize;
                for level in self.levels[..depth].iter().rev() {
                    found = found * WORD_BITS + level[found].trailing_zeros() as usize;
                }
                return Some(found);
            }
            k = k / WORD_BITS + 1;
        }
        None
    }

    fn at_most(&self, row: usize) -> Option<usize> {
        let mut k = row;
        for (depth, level) in self.levels.iter().enumerate() {
            let rest = level[k / WORD_BITS] & (u64::MAX >> (WORD_BITS - 1 - k % WORD_BITS));
            if rest != 0 {
                let mut found = k / WORD_BITS * WORD_BITS + rest.ilog2() as usize;
                for level in self.levels[..depth].iter().rev() {
                    found = found * WORD_BITS + level[found].ilog2() as usize;
                }
                return Some(found);
            }
            k = (k / WORD_BITS).checked_sub(1)?;
        }
        None
    }

    /// Takes all rows, in their order.
    pub fn drain(&mut self, each: impl FnMut(usize)) {
        self.rewind();
        std::iter::from_fn(|| self.pop()).for_each(each);
    }
}
