//! The entries of the condensed system, before they are ordered.

use super::parameters::{CONE_REGULARISATION, MAX_SHORT_TERMS, REGULARISATION};
use super::scaled::ScaledProgram;
use crate::presolve::refill;

/// The position of a term of a condensed row.
#[derive(Debug, Clone, Copy)]
pub(super) struct CondensedTerm {
    pub(super) position: usize,
    pub(super) row: usize,
    pub(super) product: f64,
}

/// The upper triangle of the system by columns: first the columns of the program, then equalities
/// and long rows, then the entries of cones.
#[derive(Debug, Default)]
pub(super) struct Condensed {
    pub(super) start: Vec<usize>,
    pub(super) index: Vec<usize>,
    /// By entry, its value without weights.
    pub(super) constant: Vec<f64>,
    /// By unknown, the entry on the diagonal.
    pub(super) diagonal: Vec<usize>,
    /// The terms of short rows, each added times the weight of its row.
    pub(super) terms: Vec<CondensedTerm>,
    /// The positions of the entries of the blocks of cones: by cone, column by column of an upper
    /// triangle.
    pub(super) blocks: Vec<usize>,
    /// Rows with an unknown of their own, after the equalities.
    pub(super) long: Vec<usize>,
    kinds: Vec<CondensedRow>,
    short: ShortRows,
    /// By column, where its entry of the current column is.
    slot: Vec<usize>,
    /// The entries of a row.
    sorted: Vec<(usize, f64)>,
}

impl Condensed {
    /// Becomes the system of another program, in the memory that it has.
    pub(super) fn load(&mut self, program: &ScaledProgram) {
        write_kinds(program, &mut self.kinds);
        self.short.load(program, &self.kinds);
        self.start.clear();
        self.start.push(0);
        self.index.clear();
        self.constant.clear();
        self.diagonal.clear();
        self.terms.clear();
        self.blocks.clear();
        self.long.clear();
        let rows = 0..program.rows.len();
        self.long.extend(rows.filter(|&i| self.kinds[i] == CondensedRow::Long));
        self.add_columns(program);
        self.add_rows(program);
        self.add_cones(program);
    }

    /// The number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.start.len() - 1
    }

    /// The block of the columns: curvature, regularisation, and the products of short rows.
    fn add_columns(&mut self, program: &ScaledProgram) {
        let n = program.column.len();
        let Condensed { short, slot, .. } = self;
        refill(slot, n, usize::MAX);
        for c in 0..n {
            let begin = self.index.len();
            let (above, curvature) = program.quadratic.vector(c);
            let mut visit = |i: usize, index: &mut Vec<usize>| {
                if slot[i] == usize::MAX {
                    slot[i] = 0;
                    index.push(i);
                }
            };
            visit(c, &mut self.index);
            above.iter().for_each(|&i| visit(i, &mut self.index));
            for &(row, _) in short.of(c) {
                let columns = program.rows.vector(row).0;
                columns.iter().filter(|i| **i <= c).for_each(|&i| visit(i, &mut self.index));
            }
            self.index[begin..].sort_unstable();
            for (k, &i) in self.index.iter().enumerate().skip(begin) {
                slot[i] = k;
            }
            self.constant.resize(self.index.len(), 0.0);
            above.iter().zip(curvature).for_each(|(&i, p)| self.constant[slot[i]] += p);
            self.constant[slot[c]] += REGULARISATION;
            for &(row, a) in short.of(c) {
                let (columns, values) = program.rows.vector(row);
                for (&i, b) in columns.iter().zip(values).filter(|(i, _)| **i <= c) {
                    self.terms.push(CondensedTerm { position: slot[i], row, product: a * b });
                }
            }
            self.diagonal.push(slot[c]);
            self.index[begin..].iter().for_each(|&i| slot[i] = usize::MAX);
            self.start.push(self.index.len());
        }
    }

    /// The columns of equalities and long rows.
    fn add_rows(&mut self, program: &ScaledProgram) {
        let n = program.column.len();
        let owned = program.equalities.iter().map(|e| e.0).chain(self.long.iter().copied());
        for (k, row) in owned.enumerate() {
            let (columns, values) = program.rows.vector(row);
            self.sorted.clear();
            self.sorted.extend(columns.iter().copied().zip(values.iter().copied()));
            self.sorted.sort_unstable_by_key(|entry| entry.0);
            for &(j, a) in &self.sorted {
                self.index.push(j);
                self.constant.push(a);
            }
            self.index.push(n + k);
            self.constant.push(-REGULARISATION);
            self.diagonal.push(self.index.len() - 1);
            self.start.push(self.index.len());
        }
    }

    /// The columns of the entries of cones.
    fn add_cones(&mut self, program: &ScaledProgram) {
        let (cones, before) = (&program.cones, self.diagonal.len());
        for cone in 0..cones.len() {
            let entries = cones.entries(cone);
            for e in entries.clone() {
                let (columns, values) = cones.rows.vector(e);
                self.sorted.clear();
                self.sorted.extend(columns.iter().copied().zip(values.iter().copied()));
                self.sorted.sort_unstable_by_key(|entry| entry.0);
                for &(j, g) in &self.sorted {
                    self.index.push(j);
                    self.constant.push(g);
                }
                for other in entries.start..=e {
                    self.blocks.push(self.index.len());
                    self.index.push(before + other);
                    self.constant.push(if other == e { -CONE_REGULARISATION } else { 0.0 });
                }
                self.start.push(self.index.len());
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CondensedRow {
    Short,
    Long,
    Equality,
}

fn write_kinds(program: &ScaledProgram, kinds: &mut Vec<CondensedRow>) {
    refill(kinds, program.rows.len(), CondensedRow::Short);
    program.equalities.iter().for_each(|&(i, _)| kinds[i] = CondensedRow::Equality);
    let room = program.quadratic.index.len();
    for (i, kind) in kinds.iter_mut().enumerate() {
        let length = program.rows.vector(i).0.len();
        if *kind == CondensedRow::Short
            && length > MAX_SHORT_TERMS
            && length * (length + 1) / 2 > room
        {
            *kind = CondensedRow::Long;
        }
    }
}

/// The entries of short rows by column.
#[derive(Debug, Default)]
struct ShortRows {
    /// By column, where its entries begin.
    first: Vec<usize>,
    /// By column, where the next entry goes.
    next: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

impl ShortRows {
    fn load(&mut self, program: &ScaledProgram, kinds: &[CondensedRow]) {
        let n = program.column.len();
        let ShortRows { first, next, entries } = self;
        let short = || (0..kinds.len()).filter(|&i| kinds[i] == CondensedRow::Short);
        refill(first, n + 1, 0);
        for i in short() {
            program.rows.vector(i).0.iter().for_each(|&j| first[j + 1] += 1);
        }
        (0..n).for_each(|j| first[j + 1] += first[j]);
        next.clone_from(first);
        refill(entries, first[n], (0, 0.0));
        for i in short() {
            let (columns, values) = program.rows.vector(i);
            for (&j, &a) in columns.iter().zip(values) {
                entries[next[j]] = (i, a);
                next[j] += 1;
            }
        }
    }

    /// Rows and coefficients of a column.
    fn of(&self, column: usize) -> &[(usize, f64)] {
        &self.entries[self.first[column]..self.first[column + 1]]
    }
}
