//! Sparse vectors that grow and shrink one entry at a time, side by side in one memory.

/// Free places behind a list that was moved because it had grown.
const SPARE_PLACES: usize = 4;

/// Lists of entries, by a number each.
#[derive(Debug, Clone, Default)]
pub(super) struct Lists {
    /// The first entry of each list, and the number of its entries.
    range: Vec<[u32; 2]>,
    capacity: Vec<u32>,
    index: Vec<u32>,
    value: Vec<f64>,
    entries: usize,
}

impl Lists {
    pub(super) fn empty(count: usize) -> Self {
        Lists { range: vec![[0; 2]; count], capacity: vec![0; count], ..Lists::default() }
    }

    /// The number of entries of all lists.
    pub(super) fn entry_count(&self) -> usize {
        self.entries
    }

    pub(super) fn get(&self, k: usize) -> (&[u32], &[f64]) {
        let [start, length] = self.range[k].map(|v| v as usize);
        let range = start..start + length;
        (&self.index[range.clone()], &self.value[range])
    }

    pub(super) fn indices(&self, k: usize) -> &[u32] {
        self.get(k).0
    }

    /// Puts these entries in place of those of a list.
    pub(super) fn replace(&mut self, k: usize, entries: impl Iterator<Item = (u32, f64)>) {
        let start = self.index.len();
        for (i, a) in entries {
            self.index.push(i);
            self.value.push(a);
        }
        let length = (self.index.len() - start) as u32;
        self.entries = self.entries + length as usize - self.range[k][1] as usize;
        (self.range[k], self.capacity[k]) = ([start as u32, length], length);
    }

    /// Adds a list behind the others.
    pub(super) fn append(&mut self, entries: impl Iterator<Item = (u32, f64)>) {
        self.range.push([0; 2]);
        self.capacity.push(0);
        self.replace(self.range.len() - 1, entries);
    }

    pub(super) fn clear(&mut self, k: usize) {
        self.entries -= std::mem::take(&mut self.range[k][1]) as usize;
    }

    pub(super) fn push(&mut self, k: usize, index: u32, value: f64) {
        if self.range[k][1] == self.capacity[k] {
            self.make_room(k);
        }
        let [start, length] = &mut self.range[k];
        let end = (*start + *length) as usize;
        *length += 1;
        (self.index[end], self.value[end]) = (index, value);
        self.entries += 1;
    }

    /// Moves a list to the end, where it has room.
    fn make_room(&mut self, k: usize) {
        let [start, length] = self.range[k].map(|v| v as usize);
        let capacity = 2 * length + SPARE_PLACES;
        self.range[k][0] = self.index.len() as u32;
        self.capacity[k] = capacity as u32;
        self.index.extend_from_within(start..start + length);
        self.value.extend_from_within(start..start + length);
        self.index.resize(self.index.len() + capacity - length, 0);
        self.value.resize(self.value.len() + capacity - length, 0.0);
    }

    /// Removes an entry that is there.
    pub(super) fn remove(&mut self, k: usize, index: u32) {
        let [start, length] = self.range[k].map(|v| v as usize);
        let Some(at) = self.index[start..start + length].iter().position(|&i| i == index) else {
            return;
        };
        let (at, last) = (start + at, start + length - 1);
        (self.index[at], self.value[at]) = (self.index[last], self.value[last]);
        self.range[k][1] -= 1;
        self.entries -= 1;
    }

    /// Empty lists with memory for so many entries each.
    pub(super) fn with_capacities(capacity: Vec<u32>) -> Self {
        let mut end = 0;
        let begin = |c: &u32| {
            end += c;
            end - c
        };
        let range = capacity.iter().map(begin).map(|start| [start, 0]).collect();
        Lists {
            index: vec![0; end as usize],
            value: vec![0.0; end as usize],
            entries: 0,
            range,
            capacity,
        }
    }

    /// The lists by the places of the entries, with room for one more entry each.
    pub(super) fn transposed(&self) -> Lists {
        let count = self.range.len();
        let mut capacity = vec![1_u32; count];
        for k in 0..count {
            self.indices(k).iter().for_each(|&i| capacity[i as usize] += 1);
        }
        let mut other = Lists::with_capacities(capacity);
        for k in 0..count {
            let (index, value) = self.get(k);
            index.iter().zip(value).for_each(|(&i, &a)| other.push(i as usize, k as u32, a));
        }
        other
    }
}
