//! Parallel rows (or columns): those with entries at the same positions of which one is a multiple
//! of the other.

/// The relative difference up to which two quotients of coefficients count as equal.
const RATIO_TOLERANCE: f64 = 1e-13;

const NO_VECTOR: usize = usize::MAX;

/// Vectors by the positions of their entries: a hash table that keeps no copy of the positions.
#[derive(Debug, Clone, Default)]
pub(super) struct Patterns {
    /// By bucket: the last vector in it.
    last: Vec<usize>,
    /// By vector: the vector before it in its bucket.
    before: Vec<usize>,
}

impl Patterns {
    /// An empty table for this many vectors.
    pub(super) fn new(count: usize) -> Self {
        let mut patterns = Patterns::default();
        patterns.clear(count);
        patterns
    }

    /// Empties the table and makes room for this many vectors.
    pub(super) fn clear(&mut self, count: usize) {
        self.last.clear();
        self.last.resize((2 * count).next_power_of_two(), NO_VECTOR);
        self.before.clear();
    }

    /// The bucket of a vector with entries at these positions.
    pub(super) fn bucket(&self, positions: impl Iterator<Item = usize>) -> usize {
        let mix = |(hash, length): (u64, u64), k: usize| {
            let hash = (hash ^ k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23);
            (hash, length + 1)
        };
        let (hash, length) = positions.fold((0, 0), mix);
        (hash ^ length) as usize & (self.last.len() - 1)
    }

    /// The vectors of a bucket, the latest first; their positions may differ.
    pub(super) fn candidates(&self, bucket: usize) -> impl Iterator<Item = usize> + '_ {
        let vector = |k: usize| (k != NO_VECTOR).then_some(k);
        std::iter::successors(vector(self.last[bucket]), move |&k| vector(self.before[k]))
    }

    pub(super) fn insert(&mut self, vector: usize, bucket: usize) {
        if self.before.len() <= vector {
            self.before.resize(vector + 1, NO_VECTOR);
        }
        self.before[vector] = std::mem::replace(&mut self.last[bucket], vector);
    }
}

/// The factor from the second to the first coefficient of all pairs; `None` if it differs.
pub(super) fn ratio(mut pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let (a, b) = pairs.clone().next()?;
    let ratio = a / b;
    pairs.all(|(a, b)| is_multiple(a, b, ratio)).then_some(ratio)
}

/// Whether `a = ratio b`, up to rounding.
pub(super) fn is_multiple(a: f64, b: f64, ratio: f64) -> bool {
    (a - ratio * b).abs() <= RATIO_TOLERANCE * a.abs()
}
