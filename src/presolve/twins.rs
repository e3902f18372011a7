//! Parallel rows of a reduced program, found by the columns that they are about.

use super::reduce::Compressed;

/// The finished rows by the columns that they are about.
#[derive(Debug, Clone, Default)]
pub(super) struct Twins {
    /// By bucket: the last row in it.
    last: Vec<usize>,
    /// By row: the row before it in its bucket.
    before: Vec<usize>,
}

impl Twins {
    /// Room for so many rows, and none of them there.
    pub(super) fn clear(&mut self, rows: usize) {
        self.last.clear();
        self.last.resize((2 * rows).next_power_of_two(), usize::MAX);
        self.before.clear();
    }

    pub(super) fn bucket(&self, columns: &[usize]) -> usize {
        let mix = |hash: u64, &k: &usize| {
            (hash ^ k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23)
        };
        let hash = columns.iter().fold(columns.len() as u64, mix);
        hash as usize & (self.last.len() - 1)
    }

    /// The rows of a bucket, the latest first.
    pub(super) fn rows_of(&self, bucket: usize) -> impl Iterator<Item = usize> + '_ {
        let row = |k: usize| (k != usize::MAX).then_some(k);
        std::iter::successors(row(self.last[bucket]), move |&k| row(self.before[k]))
    }

    /// The next finished row is in this bucket.
    pub(super) fn push(&mut self, bucket: usize) {
        let before = std::mem::replace(&mut self.last[bucket], self.before.len());
        self.before.push(before);
    }
}

/// A finished row parallel to the unfinished one from `begin` on, and the factor between them.
pub(super) fn find_twin(
    rows: &Compressed,
    mut bucket: impl Iterator<Item = usize>,
    begin: usize,
) -> Option<(usize, f64)> {
    let (index, value) = (&rows.index[begin..], &rows.value[begin..]);
    bucket.find_map(|other| {
        let (other_index, other_value) = rows.vector(other);
        if other_index != index {
            return None;
        }
        let ratio = value[0] / other_value[0];
        let parallel =
            value.iter().zip(other_value).all(|(&a, &b)| (a - ratio * b).abs() <= 1e-13 * a.abs());
        parallel.then_some((other, ratio))
    })
}
