//! The rows that propagation has yet to visit, in sweeps.
//!
//! Rows are visited in the order of their numbers, alternately up and down, so that a change
//! travels along a whole chain of steps in one sweep. A queue or a stack needs more visits.

/// Rows by number; a set with a position and a direction.
#[derive(Debug, Clone)]
pub(super) struct Worklist {
    /// By level, from the rows up: a bit a row, a bit a word below, and so on.
    levels: Vec<Vec<u64>>,
    at: usize,
    falling: bool,
}

const BITS: usize = u64::BITS as usize;

impl Worklist {
    /// For so many rows.
    pub(super) fn new(rows: usize) -> Self {
        let mut levels = vec![vec![0; rows.div_ceil(BITS).max(1)]];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            levels.push(vec![0; last.len().div_ceil(BITS)]);
        }
        Worklist { levels, at: 0, falling: false }
    }

    #[inline]
    pub(super) fn insert(&mut self, row: usize) {
        let mut k = row;
        for level in &mut self.levels {
            let word = &mut level[k / BITS];
            let was = *word;
            *word |= 1 << (k % BITS);
            if was != 0 {
                break;
            }
            k /= BITS;
        }
    }

    fn remove(&mut self, row: usize) {
        let mut k = row;
        for level in &mut self.levels {
            let word = &mut level[k / BITS];
            *word &= !(1 << (k % BITS));
            if *word != 0 {
                break;
            }
            k /= BITS;
        }
    }

    /// Takes the next row of the sweep, which turns where there is none. What is put in once the list
    /// has been empty begins with a sweep up.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<usize> {
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
            let rest = level.get(k / BITS)? & (u64::MAX << (k % BITS));
            if rest != 0 {
                let mut found = k / BITS * BITS + rest.trailing_zeros() as usize;
                for level in self.levels[..depth].iter().rev() {
                    found = found * BITS + level[found].trailing_zeros() as usize;
                }
                return Some(found);
            }
            k = k / BITS + 1;
        }
        None
    }

    fn at_most(&self, row: usize) -> Option<usize> {
        let mut k = row;
        for (depth, level) in self.levels.iter().enumerate() {
            let rest = level[k / BITS] & (u64::MAX >> (BITS - 1 - k % BITS));
            if rest != 0 {
                let mut found = k / BITS * BITS + rest.ilog2() as usize;
                for level in self.levels[..depth].iter().rev() {
                    found = found * BITS + level[found].ilog2() as usize;
                }
                return Some(found);
            }
            k = (k / BITS).checked_sub(1)?;
        }
        None
    }

    /// Takes all rows, in their order.
    pub(super) fn drain(&mut self, each: impl FnMut(usize)) {
        self.rewind();
        std::iter::from_fn(|| self.pop()).for_each(each);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_sweep_takes_what_lies_ahead_and_turns() {
        let mut list = Worklist::new(300_000);
        [5, 299_999, 70, 4096].into_iter().for_each(|row| list.insert(row));
        assert_eq!(list.pop(), Some(5));
        assert_eq!(list.pop(), Some(70));
        // Ahead of the sweep, behind it, and where it is.
        [80, 3, 70].into_iter().for_each(|row| list.insert(row));
        let order: Vec<usize> = std::iter::from_fn(|| list.pop()).collect();
        assert_eq!(order, [70, 80, 4096, 299_999, 3]);
        // An empty list begins again from below.
        [9, 2].into_iter().for_each(|row| list.insert(row));
        assert_eq!(list.pop(), Some(2));
        let mut rest = Vec::new();
        list.drain(|row| rest.push(row));
        assert_eq!(rest, [9]);
        assert_eq!(list.pop(), None);
    }

    proptest! {
        #[test]
        fn it_is_a_set_in_the_order_of_sweeps(
            rows in 1usize..10_000,
            steps in proptest::collection::vec((0usize..4, any::<usize>()), 1..300),
        ) {
            let (mut list, mut set) = (Worklist::new(rows), BTreeSet::new());
            let (mut at, mut falling) = (0, false);
            for (what, row) in steps {
                if what > 0 {
                    list.insert(row % rows);
                    set.insert(row % rows);
                    continue;
                }
                let next = |set: &BTreeSet<usize>, falling: bool| match falling {
                    true => set.range(..=at).next_back().copied(),
                    false => set.range(at..).next().copied(),
                };
                let mut expected = next(&set, falling);
                if expected.is_none() {
                    falling = !falling;
                    expected = next(&set, falling);
                }
                prop_assert_eq!(list.pop(), expected);
                match expected {
                    Some(row) => (at, _) = (row, set.remove(&row)),
                    None => (at, falling) = (0, false),
                }
            }
        }
    }
}
