//! Quadratic programs whose integers the cell gives.
//!
//! With the integers fixed, a strictly convex program has slacks `s = M l + b` of its rows at
//! multipliers `l`, and its optimum is where `s >= 0`, `l >= 0`, and one of each pair is 0. That
//! is a linear complementarity problem, of which only `b` depends on the state. The least-index
//! criss-cross method solves it (D. den Hertog, C. Roos, T. Terlaky, The linear complementarity
//! problem, sufficient matrices, and the criss-cross method, Linear Algebra Appl. 187, 1993). The
//! slack of the first row with a negative entry of `b` changes places with its multiplier; if the
//! diagonal of `M` is 0 there, a pair with a positive entry in that row does so before. Only signs
//! decide, so that whoever writes the table can follow all ways that the states of a cell may
//! take, and count them.

use crate::real::LookupNumber;

/// A quadratic program with fixed integers.
///
/// It begins with the rows active that are so at most corners of its cells: the slack of an active
/// row has changed places with its multiplier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookupProgram<T> {
    /// The number of rows.
    pub rows: u32,
    /// The place of its first number among those of the table: `M`, row by row, with a row for each
    /// input, which is how it changes with what is 0 at the optimum; then `b`, and the inputs: for
    /// each, a constant, and a factor for each state as a share of the side of the box.
    pub first: u32,
    /// The most exchanges, each of one pair or two.
    pub exchanges: u32,
    /// An entry of `b` counts as negative below this number, which is negative.
    pub negative: T,
    /// An entry of `M` counts as positive above this number.
    pub positive: T,
}

/// The most rows, inputs and exchanges, so that no length overflows and each solve ends.
const MOST_COUNT: usize = 1 << 12;

impl<T> LookupProgram<T> {
    /// The numbers of work space that a solve takes.
    pub(crate) const fn work(&self, inputs: usize) -> usize {
        let rows = self.rows as usize;
        rows.saturating_mul(rows.saturating_add(inputs).saturating_add(2))
    }

    /// Whether the table has all of its numbers, with so many states and inputs.
    pub(crate) const fn is_sound(&self, numbers: usize, states: usize, inputs: usize) -> bool {
        let rows = self.rows as usize;
        if rows > MOST_COUNT || inputs > MOST_COUNT || self.exchanges as usize > MOST_COUNT {
            return false;
        }
        let own = (rows + inputs) * (rows + states + 1);
        let first = self.first as usize;
        first <= numbers && own <= numbers - first
    }
}

fn is_at_least<T: PartialOrd>(value: T, limit: T) -> bool {
    value >= limit
}

/// Changes the places of the pair p: the slack of a row and its multiplier.
fn exchange<T: LookupNumber>(
    p: usize,
    matrix: &mut [T],
    own: &mut [T],
    right: &mut [T],
    inputs: &mut [T],
) -> Option<()> {
    let rows = own.len();
    let first = p.wrapping_mul(rows);
    let row = matrix.get(first..)?.get(..rows)?;
    // Without zeros of their own sign, as in the C code, which calls no `memcpy` so.
    own.iter_mut().zip(row).for_each(|(own, &value)| *own = value + T::ZERO);
    let diagonal = *own.get(p)?;
    let at = *right.get(p)?;
    let mut rest = &mut *matrix;
    for (i, value) in right.iter_mut().chain(inputs.iter_mut()).enumerate() {
        let (row, others) = core::mem::take(&mut rest).split_at_mut_checked(rows)?;
        rest = others;
        if i == p {
            continue;
        }
        let ratio = *row.get(p)? / diagonal;
        for (entry, &own) in row.iter_mut().zip(own.iter()) {
            *entry = *entry - ratio * own;
        }
        *row.get_mut(p)? = ratio;
        *value = *value - ratio * at;
    }
    let row = matrix.get_mut(first..)?.get_mut(..rows)?;
    for (entry, &own) in row.iter_mut().zip(own.iter()) {
        *entry = T::ZERO - own / diagonal;
    }
    *row.get_mut(p)? = T::ONE / diagonal;
    *right.get_mut(p)? = T::ZERO - at / diagonal;
    Some(())
}

impl<T: LookupNumber> LookupProgram<T> {
    /// Solves the program at a state, as shares of the sides of the box. `None` if slices do not
    /// fit together, or if there are more exchanges than there may be.
    pub(crate) fn solve(
        &self,
        numbers: &[T],
        state: &[T],
        inputs: &mut [T],
        work: &mut [T],
    ) -> Option<()> {
        if !self.is_sound(numbers.len(), state.len(), inputs.len()) {
            return None;
        }
        let rows = self.rows as usize;
        let numbers = numbers.get(self.first as usize..)?;
        let size = rows.wrapping_add(inputs.len()).wrapping_mul(rows);
        let (stored, mut rest) = numbers.split_at_checked(size)?;
        let (right, work) = work.split_at_mut_checked(rows)?;
        let (own, work) = work.split_at_mut_checked(rows)?;
        let matrix = work.get_mut(..size)?;
        for value in right.iter_mut().chain(inputs.iter_mut()) {
            let (first, others) = rest.split_first()?;
            let (factors, others) = others.split_at_checked(state.len())?;
            rest = others;
            *value = *first;
            for (&factor, &share) in factors.iter().zip(state) {
                // In this order, and without fused operations, as in the C code.
                *value = *value + factor * share;
            }
        }
        for count in 0..=self.exchanges {
            // NaN counts as negative, so that there is no answer with one.
            let is_negative = |value: &T| !is_at_least(*value, self.negative);
            let Some(k) = right.iter().position(is_negative) else {
                let is_finite = |value: &T| *value * T::ZERO == T::ZERO;
                return inputs.iter().all(is_finite).then_some(());
            };
            if count == self.exchanges {
                break;
            }
            if count == 0 {
                matrix.iter_mut().zip(stored).for_each(|(own, &value)| *own = value + T::ZERO);
            }
            let row = matrix.get(k.wrapping_mul(rows)..)?.get(..rows)?;
            let is_positive = |value: &T| *value > self.positive;
            if !is_positive(row.get(k)?) {
                let other = row.iter().position(is_positive)?;
                exchange(other, matrix, own, right, inputs)?;
            }
            exchange(k, matrix, own, right, inputs)?;
        }
        None
    }
}
