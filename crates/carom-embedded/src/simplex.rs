//! Where a state is: in one of Kuhn's simplices of the box, and then in ever smaller halves.
//!
//! A state in a simplex is a mean of the corners with the weights `w >= 0`, in units. In Kuhn's
//! simplices, weights are the differences of the sorted coordinates. Where an edge (i, j) is cut in
//! the middle m, the state is `w_i i + w_j j = (w_i - w_j) i + 2 w_j m`, if `w_i >= w_j`. So a cut
//! takes a comparison and a subtraction of whole numbers, and rounds nothing.

/// The most corners of a cell.
pub(crate) const MOST_CORNERS: usize = 7;

/// The weights of the corners of a cell, in units.
pub(crate) struct Weights {
    /// Zero behind the corners of the cell.
    pub(crate) of: [u32; MOST_CORNERS],
}

impl Weights {
    /// The weights in Kuhn's simplex of a point of the box, and the number of the order of its
    /// axes, of all orders in lexicographic order.
    ///
    /// Coordinates come in units, axis by axis. There are at most six; others are left out.
    pub(crate) fn locate(units: u32, coordinates: impl Iterator<Item = u32>) -> (Self, u32) {
        let mut of = [0; MOST_CORNERS];
        // Sorted from the largest to the smallest coordinate; the earlier axis first if they are
        // the same.
        let mut sorted = [(0, 0); MOST_CORNERS];
        let mut count = 0;
        for coordinate in coordinates.take(MOST_CORNERS - 1) {
            let mut moving = (coordinate, count);
            for place in sorted.iter_mut().take(count) {
                if place.0 < moving.0 {
                    core::mem::swap(place, &mut moving);
                }
            }
            if let Some(place) = sorted.get_mut(count) {
                *place = moving;
            }
            count += 1;
        }
        let mut number = 0;
        let mut before = units;
        let mut weights = of.iter_mut();
        for (k, (coordinate, axis)) in sorted.iter().enumerate().take(count) {
            if let Some(weight) = weights.next() {
                *weight = before.saturating_sub(*coordinate);
            }
            before = *coordinate;
            // Of the axes that are left, how many are before this one.
            let left = sorted.get(k..count).unwrap_or_default();
            let earlier = left.iter().filter(|other| other.1 < *axis).count();
            number = number * (count - k) + earlier;
        }
        if let Some(weight) = weights.next() {
            *weight = before;
        }
        (Weights { of }, number as u32)
    }

    /// Goes on in a half of the cell, and says which one: that of corner i, with 0, or that of
    /// corner j. `None` if there are no such corners.
    pub(crate) fn halve(&mut self, [i, j]: [u8; 2]) -> Option<usize> {
        let first = *self.of.get(usize::from(i))?;
        let second = *self.of.get(usize::from(j))?;
        // The weights have one sum for ever, so that twice the smaller one is no overflow.
        let (near, side) = match first >= second {
            true => ([first.wrapping_sub(second), second.wrapping_mul(2)], 0),
            false => ([first.wrapping_mul(2), second.wrapping_sub(first)], 1),
        };
        *self.of.get_mut(usize::from(i))? = near[0];
        *self.of.get_mut(usize::from(j))? = near[1];
        Some(side)
    }
}
