//! Which rows, or columns, have their entries at the same positions.

use std::collections::HashMap;

/// Vectors seen so far, by the positions of their entries.
///
/// Only a fingerprint is kept of each: a copy of every pattern costs more to make and to free than
/// all comparisons do.
pub(super) struct Patterns {
    /// The vector seen last, by fingerprint.
    last: HashMap<u64, usize>,
    /// By vector: the one before with the same fingerprint.
    before: Vec<Option<usize>>,
}

impl Patterns {
    /// For vectors of these numbers at most.
    pub(super) fn new(count: usize) -> Self {
        Patterns { last: HashMap::new(), before: vec![None; count] }
    }

    /// A vector's fingerprint.
    pub(super) fn fingerprint(positions: impl Iterator<Item = usize>) -> u64 {
        positions.fold(0, |hash: u64, position| {
            (hash.rotate_left(23) ^ position as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        })
    }

    /// The vectors noted with a fingerprint, the latest first; their patterns may differ.
    pub(super) fn candidates(&self, fingerprint: u64) -> impl Iterator<Item = usize> {
        let last = self.last.get(&fingerprint).copied();
        std::iter::successors(last, |&vector| self.before.get(vector).copied().flatten())
    }

    /// Notes a vector.
    pub(super) fn note(&mut self, vector: usize, fingerprint: u64) {
        self.before[vector] = self.last.insert(fingerprint, vector);
    }
}
