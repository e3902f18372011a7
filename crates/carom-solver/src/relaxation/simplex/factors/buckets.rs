//! Things by a count that changes, in doubly linked lists.

const NO_THING: u32 = u32::MAX;

/// Lists of numbers, one for each count. What has the count 0 is in no list.
#[derive(Debug)]
pub(super) struct Buckets {
    head: Vec<u32>,
    next: Vec<u32>,
    last: Vec<u32>,
    count: Vec<u32>,
}

impl Buckets {
    pub(super) fn new(things: usize, most: usize) -> Self {
        Buckets {
            head: vec![NO_THING; most + 1],
            next: vec![NO_THING; things],
            last: vec![NO_THING; things],
            count: vec![0; things],
        }
    }

    /// The largest count that is possible.
    pub(super) fn most(&self) -> usize {
        self.head.len() - 1
    }

    pub(super) fn count(&self, thing: usize) -> usize {
        self.count[thing] as usize
    }

    pub(super) fn insert(&mut self, thing: usize, count: usize) {
        self.count[thing] = count as u32;
        if count == 0 {
            return;
        }
        let Some(head) = self.head.get_mut(count) else { return };
        let old = std::mem::replace(head, thing as u32);
        (self.next[thing], self.last[thing]) = (old, NO_THING);
        if old != NO_THING {
            self.last[old as usize] = thing as u32;
        }
    }

    pub(super) fn remove(&mut self, thing: usize) {
        let count = std::mem::take(&mut self.count[thing]) as usize;
        if count == 0 {
            return;
        }
        let (next, last) = (self.next[thing], self.last[thing]);
        match last {
            NO_THING => self.head[count] = next,
            last => self.next[last as usize] = next,
        }
        if next != NO_THING {
            self.last[next as usize] = last;
        }
    }

    pub(super) fn move_to(&mut self, thing: usize, count: usize) {
        if self.count[thing] as usize != count {
            self.remove(thing);
            self.insert(thing, count);
        }
    }

    /// The things with a count.
    pub(super) fn with(&self, count: usize) -> impl Iterator<Item = usize> + '_ {
        let first = self.head.get(count).copied().unwrap_or(NO_THING);
        let step = |thing: &u32| Some(self.next[*thing as usize]).filter(|n| *n != NO_THING);
        std::iter::successors(Some(first).filter(|f| *f != NO_THING), step).map(|t| t as usize)
    }
}
