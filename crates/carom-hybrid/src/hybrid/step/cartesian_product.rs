//! Joint transitions: all ways to take one transition of each choice.

/// All ways to take one position of each of several lists, the last list first. There is one way
/// to take nothing of no list.
#[derive(Debug, Clone)]
pub(crate) struct CartesianProduct {
    counts: Vec<usize>,
    next: Option<Vec<usize>>,
}

impl CartesianProduct {
    /// # Arguments
    ///
    /// * `counts`: the lengths of the lists.
    pub(crate) fn new(counts: impl IntoIterator<Item = usize>) -> Self {
        let counts: Vec<usize> = counts.into_iter().collect();
        let next = counts.iter().all(|&count| count > 0).then(|| vec![0; counts.len()]);
        CartesianProduct { counts, next }
    }

    /// As [`new`](Self::new); `None` if there are more than so many.
    pub(crate) fn at_most(most: usize, counts: impl IntoIterator<Item = usize>) -> Option<Self> {
        let own = CartesianProduct::new(counts);
        let count = own
            .counts
            .iter()
            .try_fold(1_usize, |all, &count| all.checked_mul(count).filter(|&all| all <= most));
        count.map(|_| own)
    }
}

impl Iterator for CartesianProduct {
    type Item = Vec<usize>;

    fn next(&mut self) -> Option<Vec<usize>> {
        let taken = self.next.take()?;
        let last = (0..taken.len()).rfind(|&k| taken[k] + 1 < self.counts[k]);
        self.next = last.map(|last| {
            let mut next = taken.clone();
            next[last] += 1;
            next[last + 1..].fill(0);
            next
        });
        Some(taken)
    }
}
