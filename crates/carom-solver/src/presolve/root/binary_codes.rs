//! Binary codes: "exactly one of these" written with logarithmically many binaries.
//!
//! Takes an equality by which columns that are not negative add up to 1, and the binaries and rows
//! that code which of them is 1 (Vielma and Nemhauser, Modeling disjunctive constraints with a
//! logarithmic number of binary variables and constraints, Mathematical Programming 128, 2011);
//! leaves these columns as binaries, without the codes and their rows.
//!
//! If `z_1 + ... + z_k = 1` and binaries say in which half of the columns the 1 is (`sum of z over
//! S <= b` and `sum of the others <= 1 - b`), then each `b` is the sum over its `S`. If no two
//! columns have the same code, each `z` is whole wherever the `b` are. Branching on a `b` excludes
//! little, and rules for "exactly one of these" do not apply to it. Columns may be in
//! other units, and the row may have `1 - z` in the place of a `z`.

use super::complements::complement;
use super::postsolve::{Restored, Undo};
use super::units::{is_power, scale_column};
use super::working_program::WorkingProgram;

/// The largest number of columns that a code distinguishes here; codes have 64 bits.
const MAX_CODED_COLUMNS: usize = 1000;

/// A binary of a code, with its two rows and what their terms are multiplied by.
#[derive(Debug, Clone)]
struct Bit {
    column: usize,
    /// `sum of inside <= b`.
    inside: Option<(usize, f64)>,
    /// `sum of the others + b <= 1`.
    outside: Option<(usize, f64)>,
    members: Vec<usize>,
    others: Vec<usize>,
}

#[derive(Debug)]
struct BinaryCodes {
    row: usize,
    coefficient: f64,
    columns: Vec<usize>,
    bits: Vec<Bit>,
}

pub(super) fn apply(work: &mut WorkingProgram, row: usize) -> usize {
    // Of two columns, the complements of both are a choice, too.
    let by_sign = |&sign: &f64| replace_choice(work, row, sign);
    [1.0, -1.0].iter().map(by_sign).find(|changes| *changes > 0).unwrap_or(0)
}

/// Replaces the codes of a row whose complements have coefficients of the other sign. Returns the
/// number of changes.
fn replace_choice(work: &mut WorkingProgram, row: usize, sign: f64) -> usize {
    let Some(CodedChoice { units, complements }) = choice(work, row, sign) else { return 0 };
    let before = work.undos.len();
    units.iter().for_each(|&(j, unit)| scale_column(work, j, 1.0 / unit));
    complements.iter().for_each(|&j| complement(work, j));
    let changes = replace(work, row);
    if changes == 0 {
        // Nothing was rounded.
        complements.iter().for_each(|&j| complement(work, j));
        units.iter().for_each(|&(j, unit)| scale_column(work, j, unit));
        work.undos.truncate(before);
    }
    changes
}

/// "Exactly one of these" over columns in other units, and over complements.
struct CodedChoice {
    /// Columns that are `unit` times a column that is 0 or 1, and their units other than 1.
    units: Vec<(usize, f64)>,
    /// Columns whose complements are chosen from.
    complements: Vec<usize>,
}

/// The choice that an equality may be: `sum of x / unit = 1` with `unit - x` in the place of some
/// `x`. Units are powers of two.
fn choice(work: &WorkingProgram, row: usize, sign: f64) -> Option<CodedChoice> {
    let (entries, limit) = (&work.rows[row], work.row_lower[row]);
    let fits = work.is_equality(row)
        && (2..=MAX_CODED_COLUMNS).contains(&entries.len())
        && entries.iter().all(|&(j, _)| work.lower[j] == 0.0 && !work.is_held(j));
    if !fits {
        return None;
    }
    let turned = || entries.iter().filter(|(_, a)| sign * a < 0.0);
    let complements: Vec<usize> = turned().map(|e| e.0).collect();
    // What each term is if its column is chosen.
    let term = turned().next().map_or(sign * limit, |&(j, a)| a.abs() * work.upper[j]);
    let even = turned().all(|&(j, a)| a.abs() * work.upper[j] == term);
    let one = sign * limit == term * (1.0 - complements.len() as f64);
    let units: Vec<(usize, f64)> = entries.iter().map(|&(j, a)| (j, term / a.abs())).collect();
    let exact = |&(j, unit): &(usize, f64)| unit == 1.0 || !work.integral[j] && is_power(unit);
    (even && one && units.iter().all(exact)).then(|| CodedChoice {
        units: units.into_iter().filter(|(_, unit)| *unit != 1.0).collect(),
        complements,
    })
}

/// Replaces the codes of a row of columns that are 0 or 1. Returns the number of changes.
fn replace(work: &mut WorkingProgram, row: usize) -> usize {
    let Some((columns, coefficient)) = one_of(work, row) else { return 0 };
    let bits = bits(work, row, &columns);
    if bits.is_empty() || !are_distinct(&columns, &bits) {
        return 0;
    }
    for bit in &bits {
        for (row, _) in bit.inside.into_iter().chain(bit.outside) {
            work.drop_row(row);
        }
        work.drop_column(bit.column);
    }
    for &j in &columns {
        work.integral[j] = true;
        (work.lower[j], work.upper[j]) = (0.0, if work.upper[j] < 1.0 { 0.0 } else { 1.0 });
    }
    let changes = bits.len();
    work.push(BinaryCodes { row, coefficient, columns, bits });
    changes
}

/// The columns of a row that says that they are not negative and their sum is 1.
fn one_of(work: &WorkingProgram, row: usize) -> Option<(Vec<usize>, f64)> {
    let entries = &work.rows[row];
    let &(_, first) = entries.first()?;
    let alike =
        entries.iter().all(|&(j, a)| a == first && work.lower[j] == 0.0 && !work.is_held(j));
    let one = work.is_equality(row) && work.row_lower[row] == first;
    let fits = alike && one && (2..=MAX_CODED_COLUMNS).contains(&entries.len());
    fits.then(|| (entries.iter().map(|e| e.0).collect(), first))
}

/// The binaries whose only rows are the two of a code over these columns.
fn bits(work: &WorkingProgram, row: usize, columns: &[usize]) -> Vec<Bit> {
    let is_one = |j: usize| columns.binary_search(&j).is_ok();
    let mut rows: Vec<usize> = columns.iter().flat_map(|&j| work.uses[j].iter().copied()).collect();
    rows.sort_unstable();
    rows.dedup();
    let mut bits: Vec<Bit> = Vec::new();
    for other in rows.into_iter().filter(|&other| other != row) {
        let Some((column, sign, factor)) = code_row(work, other, &is_one) else { continue };
        let members = work.rows[other].iter().map(|e| e.0).filter(|&j| j != column).collect();
        let at = bits.iter().position(|bit| bit.column == column).unwrap_or_else(|| {
            let (members, others) = (Vec::new(), Vec::new());
            bits.push(Bit { column, inside: None, outside: None, members, others });
            bits.len() - 1
        });
        let bit = &mut bits[at];
        if sign < 0.0 {
            (bit.inside, bit.members) = (Some((other, factor)), members);
        } else {
            (bit.outside, bit.others) = (Some((other, factor)), members);
        }
    }
    bits.retain(|bit| {
        let mut all: Vec<usize> = bit.members.iter().chain(&bit.others).copied().collect();
        all.sort_unstable();
        bit.inside.is_some() && bit.outside.is_some() && all == columns
    });
    bits.truncate(64);
    bits
}

/// The binary of a row that may be one of a code, its sign, and what the terms are multiplied by.
fn code_row(
    work: &WorkingProgram,
    row: usize,
    is_one: &dyn Fn(usize) -> bool,
) -> Option<(usize, f64, f64)> {
    let entries = &work.rows[row];
    let mut rest = entries.iter().filter(|e| !is_one(e.0));
    let (&(column, b), None) = (rest.next()?, rest.next()) else { return None };
    let &(_, a) = entries.iter().find(|e| is_one(e.0))?;
    let alike = entries.iter().all(|&(j, v)| j == column || v == a);
    let free = work.linear[column] == 0.0 && work.is_straight(column) && !work.is_held(column);
    let (limit, other) = if a > 0.0 {
        (work.row_upper[row], work.row_lower[row])
    } else {
        (work.row_lower[row], work.row_upper[row])
    };
    let sign = b / a;
    let right = (sign == -1.0 && limit == 0.0) || (sign == 1.0 && limit == a);
    let only = work.uses[column].len() == 2 && other.is_infinite();
    (alike && free && work.is_binary(column) && right && only).then_some((column, sign, a))
}

/// Whether no two columns have the same code.
fn are_distinct(columns: &[usize], bits: &[Bit]) -> bool {
    let code = |j: &usize| {
        let holds = |(k, bit): (usize, &Bit)| u64::from(bit.members.contains(j)) << k;
        bits.iter().enumerate().map(holds).sum::<u64>()
    };
    let mut codes: Vec<u64> = columns.iter().map(code).collect();
    codes.sort_unstable();
    codes.windows(2).all(|pair| pair[0] != pair[1])
}

impl Undo for BinaryCodes {
    fn primal(&self, x: &mut [f64]) {
        for bit in &self.bits {
            x[bit.column] = bit.members.iter().map(|&j| x[j]).sum::<f64>().round();
        }
    }

    /// The column that is 1 gets no reduced cost, and the rows of the codes press on the others.
    fn dual(&self, all: &mut Restored) {
        let by_value = |a: &&usize, b: &&usize| all.x[**a].total_cmp(&all.x[**b]);
        let Some(&chosen) = self.columns.iter().max_by(by_value) else { return };
        let base = all.d[chosen];
        all.y[self.row] -= base / self.coefficient;
        self.columns.iter().for_each(|&j| all.d[j] -= base);
        let most = self.columns.iter().fold(0.0_f64, |most, &j| most.max(-all.d[j]));
        for bit in &self.bits {
            let inside = bit.members.contains(&chosen);
            let (row, pressed) =
                if inside { (bit.outside, &bit.others) } else { (bit.inside, &bit.members) };
            let Some((row, factor)) = row else { continue };
            all.y[row] = most / factor;
            pressed.iter().for_each(|&j| all.d[j] += most);
            all.d[bit.column] = if inside { most } else { -most };
        }
    }
}
