//! Lower triangles stored row by row, and the products that they are solved with.

/// A lower triangle; row `i` has `i + 1` entries, the last of them positive.
#[derive(Debug, Clone, Default)]
pub(super) struct LowerTriangle {
    entries: Vec<f64>,
    len: usize,
    /// By row, how many entries are 0 at its begin; empty if that is not used.
    zeros: Vec<usize>,
}

impl LowerTriangle {
    fn row(&self, i: usize) -> &[f64] {
        let begin = i * (i + 1) / 2;
        &self.entries[begin..=begin + i]
    }

    /// Adds a last row.
    ///
    /// # Arguments
    ///
    /// * `row`: its entries left of the diagonal.
    pub(super) fn push(&mut self, row: &[f64], diagonal: f64) {
        debug_assert_eq!(row.len(), self.len);
        self.entries.extend_from_slice(row);
        self.entries.push(diagonal);
        self.len += 1;
    }

    /// Adds a last row that begins with so many zeros.
    pub(super) fn push_sparse(&mut self, row: &[f64], diagonal: f64, zeros: usize) {
        self.zeros.push(zeros);
        self.push(row, diagonal);
    }

    fn zeros(&self, i: usize) -> usize {
        self.zeros.get(i).copied().unwrap_or(0)
    }

    /// Solves `T z = b` in place, where the first `zeros` entries of `b` are zero.
    pub(super) fn solve(&self, b: &mut [f64], zeros: usize) {
        for i in zeros..b.len() {
            let row = self.row(i);
            let first = zeros.max(self.zeros(i)).min(i);
            b[i] = (b[i] - dot(&row[first..i], &b[first..i])) / row[i];
        }
    }

    /// Solves `T'z = b` in place.
    pub(super) fn solve_transposed(&self, b: &mut [f64]) {
        for i in (0..b.len()).rev() {
            let row = self.row(i);
            b[i] /= row[i];
            let (head, tail) = b.split_at_mut(i);
            let first = self.zeros(i).min(i);
            add_multiple(&mut head[first..], -tail[0], &row[first..i]);
        }
    }

    /// Removes a row and the column of the same number from `T T'`. Rotations of columns make the
    /// following rows triangular again.
    pub(super) fn remove(&mut self, at: usize) {
        let mut rotations: Vec<(f64, f64)> = Vec::with_capacity(self.len - at);
        let mut write = at * (at + 1) / 2;
        for i in at + 1..self.len {
            let read = i * (i + 1) / 2;
            self.entries.copy_within(read..=read + i, write);
            let row = &mut self.entries[write..=write + i];
            for (k, &(c, s)) in rotations.iter().enumerate() {
                let (left, right) = (row[at + k], row[at + k + 1]);
                (row[at + k], row[at + k + 1]) = (c * left + s * right, c * right - s * left);
            }
            let (left, right) = (row[i - 1], row[i]);
            let size = left.hypot(right);
            row[i - 1] = size;
            rotations.push((left / size, right / size));
            write += i;
        }
        self.len -= 1;
        self.entries.truncate(write);
    }
}

/// The product of two vectors, summed in eight parts.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for k in 0..8 {
            parts[k] += a[k] * b[k];
        }
    }
    let [p, q, r, s, t, u, v, w] = parts;
    ((p + q) + (r + s)) + ((t + u) + (v + w)) + rest
}

/// `a += factor b`.
pub(super) fn add_multiple(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}
