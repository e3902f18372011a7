//! Sparse vectors one after the other: the rows of a matrix, or its columns.

/// Where each vector begins, then positions and entries of all.
#[derive(Debug, Clone, Default)]
pub(super) struct SparseVectors {
    start: Vec<usize>,
    index: Vec<usize>,
    value: Vec<f64>,
}

impl SparseVectors {
    pub(super) fn new() -> Self {
        SparseVectors { start: vec![0], ..SparseVectors::default() }
    }

    /// No vectors yet, with memory for so many, and for their entries.
    pub(super) fn with_capacity(vectors: usize, entries: usize) -> Self {
        let mut start = Vec::with_capacity(vectors + 1);
        start.push(0);
        SparseVectors {
            start,
            index: Vec::with_capacity(entries),
            value: Vec::with_capacity(entries),
        }
    }

    pub(super) fn push(&mut self, entries: impl Iterator<Item = (usize, f64)>) {
        for (i, a) in entries {
            self.index.push(i);
            self.value.push(a);
        }
        self.start.push(self.index.len());
    }

    pub(super) fn len(&self) -> usize {
        self.start.len() - 1
    }

    pub(super) fn of(&self, k: usize) -> impl ExactSizeIterator<Item = (usize, f64)> {
        let range = self.start[k]..self.start[k + 1];
        self.index[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }

    /// The same entries by position, of which there are so many: positions become vectors.
    pub(super) fn transposed(&self, positions: usize) -> SparseVectors {
        let mut start = vec![0; positions + 1];
        self.index.iter().for_each(|&i| start[i + 1] += 1);
        (0..positions).for_each(|i| start[i + 1] += start[i]);
        let mut next = start.clone();
        let (mut index, mut value) = (vec![0; self.index.len()], vec![0.0; self.index.len()]);
        for k in 0..self.len() {
            for (i, a) in self.of(k) {
                (index[next[i]], value[next[i]]) = (k, a);
                next[i] += 1;
            }
        }
        SparseVectors { start, index, value }
    }
}
