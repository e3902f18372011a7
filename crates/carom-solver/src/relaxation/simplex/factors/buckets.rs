//! Things by a count that changes, in doubly linked lists.

const NONE: u32 = u32::MAX;

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
            head: vec![NONE; most + 1],
            next: vec![NONE; things],
            last: vec![NONE; things],
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
        (self.next[thing], self.last[thing]) = (old, NONE);
        if old != NONE {
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
            NONE => self.head[count] = next,
            last => self.next[last as usize] = next,
        }
        if next != NONE {
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
        let first = self.head.get(count).copied().unwrap_or(NONE);
        let step = |thing: &u32| Some(self.next[*thing as usize]).filter(|n| *n != NONE);
        std::iter::successors(Some(first).filter(|f| *f != NONE), step).map(|t| t as usize)
    }
}
