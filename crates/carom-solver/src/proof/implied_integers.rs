//! Columns that are whole because binaries are: those of which exactly one is 1, with a code of
//! binaries that says which. See the rule `i` of the checker.
//!
//! For each of them, the binaries that it shares rows with are split one after another. On one side
//! of each, the column is 0; where all others are left, the column is 1.

use super::bounds::Clash;
use super::tree::{Limit, ProofWriter};
use crate::search::Decision;

/// Most binaries of a code.
const MOST_BITS: usize = 16;

/// Most columns of which exactly one is 1 by a code.
const LONGEST_CODED_ROW: usize = 1000;

/// The end of a context in which a column is at no whole number.
#[derive(Debug, Clone, Copy)]
enum WholeEnd {
    /// The bounds of the column are a whole number.
    Fixed(usize),
    Clash(Clash),
}

impl ProofWriter<'_, '_> {
    /// Proves that the columns of codes are whole.
    pub(super) fn imply_codes(&mut self) -> Result<(), Limit> {
        for fact in 0..self.facts.len() as u32 {
            self.bounds.enqueue(fact);
        }
        if self.bounds.propagate(&self.facts).is_err() {
            return Ok(());
        }
        for row in 0..self.relaxer.program.row_count() {
            if self.relaxer.token.is_over() {
                return Err(Limit);
            }
            let (mut bits, columns) = (Vec::new(), self.coded_columns(row));
            for &column in &columns {
                let Some(path) = self.bit_path(column, &columns) else {
                    bits.clear();
                    break;
                };
                self.log.imply(column);
                self.write_path(column, &path);
                self.take_as_integral(column);
                bits.extend(path.iter().map(|bit| bit.column));
            }
            self.leave_to_code(bits, &columns);
        }
        Ok(())
    }

    /// Lets splits be about the columns of a code, not about its binaries, whose splits exclude
    /// little. Binaries without other rows are whole where the columns are.
    fn leave_to_code(&mut self, mut bits: Vec<usize>, columns: &[usize]) {
        let is_coded = |j: usize| columns.contains(&j) || self.width(j) == 0.0;
        bits.retain(|&bit| {
            let mut facts = self.facts.of_column(bit).iter();
            facts.all(|f| self.facts.terms(*f as usize).all(|(j, _)| j == bit || is_coded(j)))
        });
        if bits.is_empty() {
            return;
        }
        bits.sort_unstable();
        bits.dedup();
        for program in [&mut self.relaxer.program, &mut self.relaxer.within] {
            bits.iter().for_each(|&bit| program.integral[bit] = false);
            program.integers.retain(|j| bits.binary_search(j).is_err());
        }
    }

    /// The continuous columns of a row that says that they are not negative, and that their sum is
    /// 1.
    fn coded_columns(&self, row: usize) -> Vec<usize> {
        let program = &self.relaxer.program;
        let is_open = |j: usize| !program.integral[j] && self.width(j) > 0.0;
        let is_round = |bound: f64| bound.is_infinite() || bound == bound.round();
        let (mut columns, mut others) = (Vec::new(), 0.0);
        let [limit, upper] = self.facts.limits(row);
        let own = self.facts.terms(row).find(|(j, _)| is_open(*j));
        let Some((_, own)) = own.filter(|_| limit == upper) else { return Vec::new() };
        let mut free = 0;
        for (j, a) in self.facts.terms(row) {
            let [lower, upper] = self.bounds.of(j);
            if lower == upper {
                others += a * lower;
            } else if is_open(j) && a == own && lower == 0.0 && is_round(program.upper[j]) {
                columns.push(j);
            } else {
                free += 1;
            }
        }
        let is_one = free == 0 && limit - others == own;
        let fits = is_one && (2..=LONGEST_CODED_ROW).contains(&columns.len());
        if fits { columns } else { Vec::new() }
    }

    /// Decisions of binaries on whose other sides a column is whole, as it is behind the last one.
    fn bit_path(&mut self, column: usize, columns: &[usize]) -> Option<Vec<Decision>> {
        let ground = self.bounds.mark();
        let mut path = Vec::new();
        let found = loop {
            let Some(bit) = self.open_bit(column, columns).filter(|_| path.len() < MOST_BITS)
            else {
                break None;
            };
            let sides = [true, false].map(|is_upper| Decision {
                column: bit,
                is_upper,
                value: if is_upper { 0.0 } else { 1.0 },
            });
            let [is_low_open, is_high_open] = sides.map(|side| {
                let mark = self.bounds.mark();
                let end = self.whole_end(column, side);
                self.bounds.undo_to(mark);
                end.is_none()
            });
            if is_low_open && is_high_open {
                break None;
            }
            let next = sides[usize::from(is_high_open)];
            path.push(next);
            if self.whole_end(column, next).is_some() {
                break Some(path);
            }
        };
        self.bounds.undo_to(ground);
        found
    }

    /// A binary that shares a row with a column, and is none of those of the code.
    fn open_bit(&self, column: usize, columns: &[usize]) -> Option<usize> {
        let facts = self.facts.of_column(column).iter();
        let mut near = facts.flat_map(|fact| self.facts.terms(*fact as usize)).map(|(j, _)| j);
        let is_binary = |j| self.relaxer.program.integral[j] && self.bounds.of(j) == [0.0, 1.0];
        near.find(|&j| is_binary(j) && !columns.contains(&j))
    }

    /// Goes to a side, and returns why a column is whole there.
    fn whole_end(&mut self, column: usize, side: Decision) -> Option<WholeEnd> {
        if let Some(clash) = self.enter(side) {
            return Some(WholeEnd::Clash(clash));
        }
        let [lower, upper] = self.bounds.of(column);
        (lower == upper && lower == lower.round()).then_some(WholeEnd::Fixed(column))
    }

    fn write_path(&mut self, column: usize, path: &[Decision]) {
        let Some((next, rest)) = path.split_first() else { return };
        self.log.split(next.column, 0.0);
        // The context with the upper bound comes first.
        for is_upper in [true, false] {
            let mark = self.bounds.mark();
            let value = if is_upper { 0.0 } else { 1.0 };
            let end = self.whole_end(column, Decision { is_upper, value, ..*next });
            match end {
                Some(WholeEnd::Fixed(j)) => self.write_conflict(Clash::Column(j)),
                Some(WholeEnd::Clash(clash)) => self.write_conflict(clash),
                None => self.write_path(column, rest),
            }
            self.bounds.undo_to(mark);
        }
    }
}
