//! Whether a symmetric matrix is positive semidefinite, exactly.
//!
//! Symmetric elimination without fractions (E. H. Bareiss, Sylvester's identity and multistep
//! integer-preserving Gaussian elimination, Math. Comp. 22, 1968): a positive entry of the diagonal
//! is eliminated, which keeps the rest semidefinite or not; an entry 0 needs a row of zeros; a
//! negative one decides.

use crate::text::{Refusal, rejected};
use num_bigint::{BigInt, Sign};

/// Entries by pairs of indices; each pair off the diagonal counts on both sides.
pub(super) fn is_semidefinite(size: usize, entries: &[(usize, usize, f64)]) -> bool {
    let exponent = |value: f64| ((value.to_bits() >> 52) & 0x7ff) as i64;
    let least = entries.iter().map(|entry| exponent(entry.2).max(1)).min().unwrap_or(1);
    let whole = |value: f64| {
        let (biased, fraction) = (exponent(value), value.to_bits() & ((1 << 52) - 1));
        let mantissa = if biased == 0 { fraction } else { fraction | 1 << 52 };
        let whole = BigInt::from(mantissa) << (biased.max(1) - least) as u64;
        if value < 0.0 { -whole } else { whole }
    };
    let mut matrix = vec![vec![BigInt::ZERO; size]; size];
    for &(i, j, value) in entries {
        let value = whole(value);
        if i != j {
            matrix[j][i] += &value;
        }
        matrix[i][j] += value;
    }
    let mut left: Vec<usize> = (0..size).collect();
    let mut before = BigInt::from(1);
    while let Some(&first) = left.first() {
        let positive = left.iter().copied().find(|&k| matrix[k][k].sign() == Sign::Plus);
        let pivot = positive.unwrap_or(first);
        left.retain(|&k| k != pivot);
        match matrix[pivot][pivot].sign() {
            Sign::Minus => return false,
            Sign::NoSign => {
                if left.iter().any(|&k| matrix[pivot][k].sign() != Sign::NoSign) {
                    return false;
                }
            }
            Sign::Plus => {
                let diagonal = matrix[pivot][pivot].clone();
                for &i in &left {
                    for &j in left.iter().filter(|&&j| j <= i) {
                        let own = &diagonal * &matrix[i][j] - &matrix[i][pivot] * &matrix[pivot][j];
                        let value = own / &before;
                        matrix[j][i] = value.clone();
                        matrix[i][j] = value;
                    }
                }
                before = diagonal;
            }
        }
    }
    true
}

/// Splits a matrix into blocks that have no entries in common, and checks each.
pub(super) fn check_blocks(size: usize, entries: &[(usize, usize, f64)]) -> Result<(), Refusal> {
    let mut block: Vec<usize> = (0..size).collect();
    for &(i, j, value) in entries {
        if !value.is_finite() {
            return rejected("an entry of the cost is infinite");
        }
        let (from, to) = (block[i], block[j]);
        if from != to {
            block.iter_mut().filter(|own| **own == from).for_each(|own| *own = to);
        }
    }
    for name in 0..size {
        let members: Vec<usize> = (0..size).filter(|&j| block[j] == name).collect();
        let place = |j: usize| members.iter().position(|&own| own == j);
        let own = entries.iter().filter_map(|&(i, j, v)| Some((place(i)?, place(j)?, v)));
        let own: Vec<_> = own.collect();
        if !own.is_empty() && !is_semidefinite(members.len(), &own) {
            return rejected("the cost is not convex where the parameters are fixed");
        }
    }
    Ok(())
}
