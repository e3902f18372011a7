//! Bounds of integral columns from divisibility.
//!
//! Takes an equality over whole numbers; leaves bounds at members of residue classes, or a
//! contradiction. The modular inverse reduction substitutes the column instead (Achterberg, Bixby,
//! Gu, Rothberg and Weninger, Presolve reductions in mixed integer programming, INFORMS Journal on
//! Computing 32, 2020).
//!
//! In `a'x = b` over whole numbers, all terms but one are multiples of the greatest common divisor
//! of their coefficients. This leaves the one column a residue class, so its bounds move to the
//! next members of the class, or there is no point at all: no `x`, `y` satisfy `6 x + 10 y = 5`,
//! and of `12345678 x - 87654321 y = 9` a relaxation knows nothing that would not take millions of
//! nodes.

use super::parameters::LARGEST_WHOLE;
use super::tightening::{Entry, PropagatedRow, Tightening};

/// The largest number of columns that are not fixed. The coefficients of more rarely have a
/// divisor.
const MAX_OPEN_COLUMNS: usize = 8;

/// Whether a row is an equality over whole numbers, and some of its coefficients may have a
/// divisor.
pub(super) fn is_whole_equality(line: &PropagatedRow, entries: &[Entry]) -> bool {
    let [lower, upper] = line.limits;
    let is_whole = |entry: &Entry| {
        let a = entry.coefficient;
        entry.exact && a == a.round() && a.abs() <= LARGEST_WHOLE
    };
    lower == upper
        && lower == lower.round()
        && lower.abs() <= LARGEST_WHOLE
        && entries.len() > 1
        && entries.iter().all(is_whole)
        && entries.iter().any(|entry| entry.coefficient.abs() > 1.0)
}

/// Moves bounds to the residue classes that a row leaves; `false` if no whole numbers satisfy it.
///
/// # Arguments
///
/// * `entries`, `right`: those of an equality for which [`is_whole_equality`] holds.
pub(super) fn tighten_residues(
    bounds: &[[f64; 2]],
    entries: &[Entry],
    right: f64,
    found: &mut Vec<Tightening>,
) -> bool {
    // Divisors of what is to the left and to the right of a column, then of both.
    let (mut open, mut count) = ([(0, 0_i128); MAX_OPEN_COLUMNS], 0);
    let mut rest = right as i128;
    for entry in entries {
        let [lower, upper] = bounds[entry.column()];
        if lower == upper {
            if lower.abs() > LARGEST_WHOLE {
                return true;
            }
            let term = entry.coefficient as i128 * lower as i128;
            let Some(left) = rest.checked_sub(term) else { return true };
            rest = left;
        } else if count == MAX_OPEN_COLUMNS {
            return true;
        } else {
            open[count] = (entry.column(), entry.coefficient as i128);
            count += 1;
        }
    }
    let open = &open[..count];
    for (k, &(column, a)) in open.iter().enumerate() {
        let others = open.iter().enumerate().filter(|(other, _)| *other != k);
        let divisor = others.fold(0, |divisor, (_, &(_, b))| common_divisor(divisor, b));
        if divisor == 1 {
            continue;
        }
        // `a x = rest` modulo the divisor; without other columns, exactly.
        let (shared, inverse) = bezout(a, divisor);
        if rest % shared != 0 {
            return false;
        }
        let modulus = (divisor / shared).abs();
        if modulus == 0 {
            let value = (rest / a) as f64;
            let [lower, upper] = bounds[column];
            if value.abs() > LARGEST_WHOLE {
                return true;
            }
            if value < lower || value > upper {
                return false;
            }
            found.push(Tightening { column, is_upper: false, value });
            found.push(Tightening { column, is_upper: true, value });
            continue;
        }
        // All three are reduced first, so that the products fit.
        let residue = (rest / shared).rem_euclid(modulus) * inverse.rem_euclid(modulus);
        let residue = residue.rem_euclid(modulus);
        let [lower, upper] = bounds[column];
        if lower.abs() <= LARGEST_WHOLE {
            let step = (residue - lower as i128).rem_euclid(modulus);
            push(found, column, false, lower as i128, step);
        }
        if upper.abs() <= LARGEST_WHOLE {
            let step = (upper as i128 - residue).rem_euclid(modulus);
            push(found, column, true, upper as i128, -step);
        }
    }
    count > 0 || rest == 0
}

fn push(found: &mut Vec<Tightening>, column: usize, is_upper: bool, bound: i128, step: i128) {
    let value = (bound + step) as f64;
    if step != 0 && value.abs() <= LARGEST_WHOLE {
        found.push(Tightening { column, is_upper, value });
    }
}

fn common_divisor(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The greatest common divisor `d` of two numbers, and `s` with `s a = d` modulo the second.
fn bezout(a: i128, b: i128) -> (i128, i128) {
    let ((mut old, mut new), (mut s, mut t)) = ((a, b), (1, 0));
    while new != 0 {
        let quotient = old / new;
        (old, new) = (new, old - quotient * new);
        (s, t) = (t, s - quotient * t);
    }
    if old < 0 { (-old, -s) } else { (old, s) }
}
