//! The elimination of a basis: pivots are chosen for few new entries.
//!
//! Columns with one entry in the rows that are left come first, then rows with one entry in the
//! columns that are left: both take pivots without new entries, and leave a small nucleus. There,
//! Markowitz' product of the other entries of row and column chooses the pivot among a few columns
//! and rows with the fewest entries, and pivots that are small in their column are passed over
//! (Suhl and Suhl, Computing sparse LU factorizations for large-scale linear programming bases).

use super::super::parameters::MIN_FACTOR_PIVOT;
use super::super::sparse::TINY_ENTRY;
use super::buckets::Buckets;
use super::lists::Lists;

/// The smallest pivot relative to the largest entry of its column.
const THRESHOLD: f64 = 0.1;

/// The number of columns and rows that are searched for a pivot.
const SEARCHED: usize = 4;

/// No column.
const NO_PIVOT: u32 = u32::MAX;

/// The triangles of a basis. Both are stored by the rows of the pivots.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    pub(super) lower: Lists,
    /// Rows whose lower columns have entries, in order.
    pub(super) lower_order: Vec<u32>,
    pub(super) upper: Lists,
    pub(super) pivots: Vec<f64>,
    pub(super) order: Vec<u32>,
    /// By row, the column of its pivot; `NO_PIVOT` while there is none.
    column_of: Vec<u32>,
}

/// Eliminates columns, as many as rows or fewer, given by a function. Returns the triangles, and by
/// row the column whose pivot is there; `None` is the column with the only entry -1 in that row,
/// which takes the place of a column that depends on others.
pub(super) fn eliminate<'a>(
    rows: usize,
    columns: &[(&'a [usize], &'a [f64])],
) -> (Triangles, Vec<Option<usize>>) {
    let mut factors = Triangles {
        lower: Lists::empty(rows),
        upper: Lists::empty(rows),
        pivots: vec![0.0; rows],
        column_of: vec![NO_PIVOT; rows],
        ..Triangles::default()
    };
    let by_row = pattern(rows, columns);
    let mut is_open = vec![true; columns.len()];
    factors.take_columns(columns, &by_row, &mut is_open);
    factors.take_rows(columns, &by_row, &mut is_open);
    if is_open.contains(&true) {
        Nucleus::new(&factors, columns, &is_open).eliminate(&mut factors);
    }
    let column_of = std::mem::take(&mut factors.column_of);
    for row in (0..rows).filter(|&i| column_of[i] == NO_PIVOT) {
        factors.pivots[row] = -1.0;
        factors.order.push(row as u32);
    }
    (factors, column_of.into_iter().map(|c| (c != NO_PIVOT).then_some(c as usize)).collect())
}

/// By row, the columns with an entry there.
fn pattern(rows: usize, columns: &[(&[usize], &[f64])]) -> Lists {
    let mut length = vec![0_u32; rows];
    for column in columns {
        column.0.iter().for_each(|&i| length[i] += 1);
    }
    let mut lists = Lists::with_capacities(length);
    for (c, (index, value)) in columns.iter().enumerate() {
        index.iter().zip(*value).for_each(|(&i, &a)| lists.push(i, c as u32, a));
    }
    lists
}

impl Triangles {
    fn is_open(&self, row: usize) -> bool {
        self.column_of[row] == NO_PIVOT
    }

    /// Notes a pivot, with the entries of its column in rows before it and, as multiples of the
    /// pivot, in rows after it.
    fn take(
        &mut self,
        (row, column, pivot): (usize, usize, f64),
        above: impl Iterator<Item = (u32, f64)>,
        below: impl Iterator<Item = (u32, f64)>,
    ) {
        self.column_of[row] = column as u32;
        self.pivots[row] = pivot;
        self.order.push(row as u32);
        self.upper.replace(row, above);
        self.lower.replace(row, below.map(|(i, a)| (i, a / pivot)));
        if !self.lower.indices(row).is_empty() {
            self.lower_order.push(row as u32);
        }
    }

    /// Takes columns with one entry in the open rows, one after the other.
    fn take_columns(
        &mut self,
        columns: &[(&[usize], &[f64])],
        by_row: &Lists,
        is_open: &mut [bool],
    ) {
        let mut count: Vec<usize> = columns.iter().map(|c| c.0.len()).collect();
        let mut queue: Vec<usize> = (0..columns.len()).filter(|&c| count[c] == 1).collect();
        while let Some(c) = queue.pop() {
            let (index, value) = columns[c];
            let Some(at) = index.iter().position(|&i| self.is_open(i)) else { continue };
            let (row, pivot) = (index[at], value[at]);
            if pivot.abs() < MIN_FACTOR_PIVOT {
                continue;
            }
            is_open[c] = false;
            let entries = index.iter().zip(value).map(|(&i, &a)| (i as u32, a));
            let above = entries.filter(|e| e.0 as usize != row);
            self.take((row, c, pivot), above, std::iter::empty());
            for &other in by_row.indices(row) {
                let other = other as usize;
                count[other] -= 1;
                if is_open[other] && count[other] == 1 {
                    queue.push(other);
                }
            }
        }
    }

    /// Takes rows with one entry in the open columns, one after the other.
    fn take_rows(&mut self, columns: &[(&[usize], &[f64])], by_row: &Lists, is_open: &mut [bool]) {
        let rows = self.pivots.len();
        let mut count = vec![0_usize; rows];
        for (column, _) in columns.iter().zip(&*is_open).filter(|c| *c.1) {
            column.0.iter().for_each(|&i| count[i] += 1);
        }
        let mut queue: Vec<usize> =
            (0..rows).filter(|&i| count[i] == 1 && self.is_open(i)).collect();
        while let Some(row) = queue.pop() {
            if !self.is_open(row) {
                continue;
            }
            let (list, entries) = by_row.get(row);
            let Some(at) = list.iter().position(|&c| is_open[c as usize]) else { continue };
            let (c, pivot) = (list[at] as usize, entries[at]);
            let (index, value) = columns[c];
            let largest = |(i, a): (&usize, &f64)| if self.is_open(*i) { a.abs() } else { 0.0 };
            let largest = index.iter().zip(value).map(largest).fold(0.0, f64::max);
            // A pivot that is small in its column would spoil the rows below.
            if pivot.abs() < MIN_FACTOR_PIVOT.max(0.01 * largest) {
                continue;
            }
            is_open[c] = false;
            let open: Vec<bool> = index.iter().map(|&i| self.is_open(i) && i != row).collect();
            let entries = || index.iter().zip(value).zip(&open).map(|((&i, &a), &o)| (i, a, o));
            let above = entries().filter(|e| !e.2 && e.0 != row).map(|e| (e.0 as u32, e.1));
            let below = entries().filter(|e| e.2).map(|e| (e.0 as u32, e.1));
            self.take((row, c, pivot), above, below);
            for &i in index {
                count[i] -= 1;
                if self.is_open(i) && count[i] == 1 {
                    queue.push(i);
                }
            }
        }
    }
}

/// The rest of a basis, and the factors that elimination makes of it.
struct Nucleus {
    /// By column of the nucleus: its number in the basis, its entries in rows that have pivots, and
    /// in those that have none.
    name: Vec<u32>,
    above: Vec<Vec<(u32, f64)>>,
    open: Vec<Vec<(u32, f64)>>,
    largest: Vec<f64>,
    /// By row of the basis, the columns of the nucleus with an entry there.
    by_row: Vec<Vec<u32>>,
    columns: Buckets,
    rows: Buckets,
    /// By row, its multiple of the pivot row, and the last column that met it.
    multiple: Vec<f64>,
    met: Vec<u32>,
}

impl Nucleus {
    fn new(factors: &Triangles, columns: &[(&[usize], &[f64])], is_open: &[bool]) -> Self {
        let rows = factors.pivots.len();
        let size = is_open.iter().filter(|o| **o).count();
        let mut nucleus = Nucleus {
            name: Vec::with_capacity(size),
            above: Vec::with_capacity(size),
            open: Vec::with_capacity(size),
            largest: Vec::with_capacity(size),
            by_row: vec![Vec::new(); rows],
            columns: Buckets::new(size, rows),
            rows: Buckets::new(rows, size),
            multiple: vec![0.0; rows],
            met: vec![NO_PIVOT; rows],
        };
        for (c, (index, value)) in columns.iter().enumerate().filter(|c| is_open[c.0]) {
            let k = nucleus.name.len();
            let entries = || index.iter().zip(*value).map(|(&i, &a)| (i as u32, a));
            let open: Vec<(u32, f64)> = entries()
                .filter(|e| factors.is_open(e.0 as usize) && e.1.abs() > TINY_ENTRY)
                .collect();
            open.iter().for_each(|e| nucleus.by_row[e.0 as usize].push(k as u32));
            nucleus.columns.insert(k, open.len());
            nucleus.above.push(entries().filter(|e| !factors.is_open(e.0 as usize)).collect());
            nucleus.largest.push(largest(&open));
            nucleus.open.push(open);
            nucleus.name.push(c as u32);
        }
        for (i, list) in nucleus.by_row.iter().enumerate().filter(|r| !r.1.is_empty()) {
            nucleus.rows.insert(i, list.len());
        }
        nucleus
    }

    fn eliminate(mut self, factors: &mut Triangles) {
        while let Some((row, column)) = self.choose() {
            self.pivot(row, column, factors);
        }
    }

    /// The pivot with the fewest possible new entries among a few columns and rows.
    fn choose(&mut self) -> Option<(usize, usize)> {
        loop {
            let mut best = (usize::MAX, None);
            let mut searched = 0;
            let mut useless = None;
            let most = self.columns.most().max(self.rows.most());
            'search: for count in 1..=most {
                for k in self.columns.with(count) {
                    if self.largest[k] < MIN_FACTOR_PIVOT {
                        useless = Some(k);
                        break 'search;
                    }
                    for &(i, a) in &self.open[k] {
                        let i = i as usize;
                        let product = (count - 1) * (self.rows.count(i) - 1);
                        if product < best.0 && a.abs() >= THRESHOLD * self.largest[k] {
                            best = (product, Some((i, k)));
                        }
                    }
                    searched += 1;
                    if best.0 <= (count - 1) * (count - 1) || searched >= SEARCHED {
                        break 'search;
                    }
                }
                for i in self.rows.with(count) {
                    for &k in &self.by_row[i] {
                        let k = k as usize;
                        let product = (count - 1) * (self.columns.count(k) - 1);
                        if product >= best.0 {
                            continue;
                        }
                        let entry = self.open[k].iter().find(|e| e.0 as usize == i);
                        let size = entry.map_or(0.0, |e| e.1.abs());
                        if size >= (THRESHOLD * self.largest[k]).max(MIN_FACTOR_PIVOT) {
                            best = (product, Some((i, k)));
                        }
                    }
                    searched += 1;
                    if best.0 <= count * (count - 1) || (searched >= SEARCHED && best.1.is_some()) {
                        break 'search;
                    }
                }
            }
            match useless {
                Some(k) => self.drop_column(k),
                None => return best.1,
            }
        }
    }

    /// Leaves out a column that depends on others.
    fn drop_column(&mut self, column: usize) {
        self.columns.remove(column);
        for (i, _) in std::mem::take(&mut self.open[column]) {
            self.forget(i as usize, column);
        }
    }

    /// Takes a column from the list of a row.
    fn forget(&mut self, row: usize, column: usize) {
        let list = &mut self.by_row[row];
        if let Some(at) = list.iter().position(|&k| k as usize == column) {
            list.swap_remove(at);
        }
        self.rows.move_to(row, list.len());
    }

    fn pivot(&mut self, row: usize, column: usize, factors: &mut Triangles) {
        self.columns.remove(column);
        self.rows.remove(row);
        let mut entries = std::mem::take(&mut self.open[column]);
        let Some(at) = entries.iter().position(|e| e.0 as usize == row) else { return };
        let pivot = entries.swap_remove(at).1;
        for &(i, a) in &entries {
            self.multiple[i as usize] = a / pivot;
            self.forget(i as usize, column);
        }
        for k in std::mem::take(&mut self.by_row[row]) {
            if k as usize != column {
                self.eliminate_from(k as usize, row, &entries);
            }
        }
        entries.iter().for_each(|e| self.multiple[e.0 as usize] = 0.0);
        let above = std::mem::take(&mut self.above[column]);
        let place = (row, self.name[column] as usize, pivot);
        factors.take(place, above.into_iter(), entries.into_iter());
    }

    /// Subtracts the pivot column from another one, such that its entry in the pivot row vanishes.
    fn eliminate_from(&mut self, k: usize, row: usize, pivot_column: &[(u32, f64)]) {
        let mut open = std::mem::take(&mut self.open[k]);
        let Some(at) = open.iter().position(|e| e.0 as usize == row) else {
            self.open[k] = open;
            return;
        };
        let factor = open.swap_remove(at).1;
        self.above[k].push((row as u32, factor));
        let mut at = 0;
        while at < open.len() {
            let i = open[at].0 as usize;
            if self.multiple[i] != 0.0 {
                self.met[i] = k as u32;
                open[at].1 -= self.multiple[i] * factor;
                if open[at].1.abs() <= TINY_ENTRY {
                    open.swap_remove(at);
                    self.forget(i, k);
                    continue;
                }
            }
            at += 1;
        }
        for &(i, _) in pivot_column {
            let entry = -self.multiple[i as usize] * factor;
            if self.met[i as usize] != k as u32 && entry.abs() > TINY_ENTRY {
                open.push((i, entry));
                let list = &mut self.by_row[i as usize];
                list.push(k as u32);
                self.rows.move_to(i as usize, list.len());
            }
        }
        // The same column meets the rows of later pivots again.
        pivot_column.iter().for_each(|e| self.met[e.0 as usize] = NO_PIVOT);
        self.largest[k] = largest(&open);
        self.columns.move_to(k, open.len());
        self.open[k] = open;
    }
}

fn largest(entries: &[(u32, f64)]) -> f64 {
    entries.iter().map(|e| e.1.abs()).fold(0.0, f64::max)
}
