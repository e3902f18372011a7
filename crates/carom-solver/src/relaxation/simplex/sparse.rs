//! Vectors with few entries, whose places are listed.

/// Entries up to this magnitude are what rounding has left of zeros.
pub(super) const TINY_ENTRY: f64 = 1e-14;

/// A vector of full length and a list of its places that may not be zero.
#[derive(Debug, Clone, Default)]
pub(super) struct SparseVector {
    pub(super) value: Vec<f64>,
    /// Has every place whose value is not zero, once each where nothing else is said.
    pub(super) index: Vec<u32>,
}

impl SparseVector {
    pub(super) fn zeros(length: usize) -> Self {
        SparseVector { value: vec![0.0; length], index: Vec::new() }
    }

    /// Makes it a zero vector.
    pub(super) fn clear(&mut self) {
        if 4 * self.index.len() < self.value.len() {
            self.index.iter().for_each(|&k| self.value[k as usize] = 0.0);
        } else {
            self.value.fill(0.0);
        }
        self.index.clear();
    }

    /// Adds to an entry.
    pub(super) fn add(&mut self, place: usize, by: f64) {
        let value = &mut self.value[place];
        if *value == 0.0 {
            self.index.push(place as u32);
        }
        *value += by;
        if *value == 0.0 {
            // It is listed, so it may not look as if it were not.
            *value = f64::MIN_POSITIVE;
        }
    }

    /// Lists the places again, of a vector that was changed without its list.
    pub(super) fn list(&mut self) {
        self.index.clear();
        for (k, value) in self.value.iter_mut().enumerate() {
            if value.abs() > TINY_ENTRY {
                self.index.push(k as u32);
            } else {
                *value = 0.0;
            }
        }
    }

    pub(super) fn copy_from(&mut self, other: &SparseVector) {
        self.clear();
        for &k in &other.index {
            self.value[k as usize] = other.value[k as usize];
        }
        self.index.extend_from_slice(&other.index);
    }

    /// Pairs of place and entry.
    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.index.iter().map(|&k| (k as usize, self.value[k as usize]))
    }

    pub(super) fn square(&self) -> f64 {
        self.entries().map(|(_, v)| v * v).sum()
    }

    /// The share of places that are listed.
    pub(super) fn density(&self) -> f64 {
        self.index.len() as f64 / self.value.len().max(1) as f64
    }
}
