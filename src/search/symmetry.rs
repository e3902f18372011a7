//! Interchangeable columns, and the order imposed on them.
//!
//! Two columns are interchangeable if swapping them only reorders the rows of the program: two
//! machines, two parts of one kind, two steps without dynamics between them. Points that differ
//! only by such swaps are equally good, so integral columns of a class can be required to have
//! non-increasing values. A swap is checked on every row and product that it touches. The swaps of
//! a class generate all of its orders, so sorting reaches one of the remaining points.

use std::collections::{BTreeMap, HashMap};

use crate::program::Program;

/// Columns in more rows than this are passed over: each swap is checked row by row.
const MOST_ROWS: usize = 200;

/// Most checks of swaps, over all classes.
const MOST_CHECKS: usize = 20_000;

/// A row or a column of the objective's matrix as a key: its entries by column, and its limits, as
/// bits.
type Key = (Vec<(usize, u64)>, [u64; 2]);

/// What interchangeable columns have in common: their numbers, and their coefficients with the lengths
/// of the rows.
type Signature = (Vec<u64>, Vec<(u64, usize)>);

/// A row `x_a >= x_b` for neighbours of a class.
pub(super) type Ordering = (usize, usize);

/// Classes of interchangeable integral columns, each sorted; those of one column are left out.
pub fn classes(program: &Program) -> Vec<Vec<usize>> {
    let mut alike: BTreeMap<Signature, Vec<usize>> = BTreeMap::new();
    for &j in &program.integers {
        let (rows, values) = program.column(j);
        if rows.is_empty() || rows.len() > MOST_ROWS || program.lower[j] == program.upper[j] {
            continue;
        }
        let mut entries: Vec<(u64, usize)> = rows
            .iter()
            .zip(values)
            .map(|(&row, a)| (a.to_bits(), program.row(row).0.len()))
            .collect();
        entries.sort_unstable();
        let (products, squares) = program.quadratic_column(j);
        let own = products.iter().zip(squares).find(|(i, _)| **i == j).map_or(0.0, |(_, p)| *p);
        let numbers = [program.lower[j], program.upper[j], program.linear[j], own];
        let mut numbers: Vec<u64> = numbers.iter().map(|v| v.to_bits()).collect();
        numbers.push(products.len() as u64);
        alike.entry((numbers, entries)).or_default().push(j);
    }
    alike.retain(|_, columns| columns.len() > 1);
    if alike.is_empty() {
        return Vec::new();
    }
    let mut count: HashMap<Key, usize> = HashMap::new();
    for row in 0..program.row_count() {
        *count.entry(key(program, row, |j| j)).or_default() += 1;
    }
    let (mut classes, mut checks) = (Vec::new(), 0);
    for columns in alike.into_values() {
        let mut found: Vec<Vec<usize>> = Vec::new();
        for j in columns {
            let mut fits = |class: &&mut Vec<usize>| {
                checks += 1;
                checks <= MOST_CHECKS && is_swap(program, &count, class[0], j)
            };
            match found.iter_mut().find(|class| fits(class)) {
                Some(class) => class.push(j),
                None => found.push(vec![j]),
            }
        }
        classes.extend(found.into_iter().filter(|class| class.len() > 1));
    }
    classes.sort();
    classes
}

/// The rows `x_a >= x_b` that keep one of the points that differ by swaps.
pub(super) fn orderings(program: &Program) -> Vec<Ordering> {
    let pairs = |class: Vec<usize>| -> Vec<Ordering> {
        class.windows(2).map(|pair| (pair[0], pair[1])).collect()
    };
    classes(program).into_iter().flat_map(pairs).collect()
}

/// A row after its columns were renamed.
fn key(program: &Program, row: usize, rename: impl Fn(usize) -> usize) -> Key {
    let (columns, values) = program.row(row);
    let named = columns.iter().zip(values).filter(|(_, a)| **a != 0.0);
    let mut entries: Vec<(usize, u64)> = named.map(|(&j, a)| (rename(j), a.to_bits())).collect();
    entries.sort_unstable();
    (entries, [program.row_lower[row].to_bits(), program.row_upper[row].to_bits()])
}

/// Whether swapping two columns maps the program to itself, up to the order of rows.
fn is_swap(program: &Program, count: &HashMap<Key, usize>, a: usize, b: usize) -> bool {
    let swap = |j: usize| match j {
        j if j == a => b,
        j if j == b => a,
        j => j,
    };
    let mut rows: Vec<usize> = [program.column(a).0, program.column(b).0].concat();
    rows.sort_unstable();
    rows.dedup();
    let mirrored = |&row: &usize| {
        let (before, after) = (key(program, row, |j| j), key(program, row, swap));
        before == after || count.get(&before) == count.get(&after)
    };
    let product = |i: usize, j: usize| {
        let (rows, values) = program.quadratic_column(j);
        rows.iter().position(|&row| row == i).map_or(0.0, |k| values[k])
    };
    let others = [program.quadratic_column(a).0, program.quadratic_column(b).0].concat();
    let squares = others.iter().all(|&i| product(i, a) == product(swap(i), b));
    squares && rows.iter().all(mirrored)
}
