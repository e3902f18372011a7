//! The rows of a file: its entries sorted, merged with constants and checked.

use super::read::{CbfBlock, CbfBlocks, CbfFile, Index};
use crate::error::Error;

/// `terms + offset`, which lies in a cone.
#[derive(Debug, Default)]
pub(super) struct CbfRow {
    /// Variables by position, in increasing order, without zeros.
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) offset: f64,
}

/// An entry of a cone.
#[derive(Debug, Clone, Copy)]
pub(super) enum CbfEntry<'r> {
    Constant(f64),
    /// A variable times a number other than 0.
    Scaled(usize, f64),
    Other(&'r CbfRow),
}

impl CbfRow {
    pub(super) fn entry(&self) -> CbfEntry<'_> {
        match self.terms[..] {
            [] => CbfEntry::Constant(self.offset),
            [(variable, factor)] if self.offset == 0.0 => CbfEntry::Scaled(variable, factor),
            _ => CbfEntry::Other(self),
        }
    }

    /// `offset / factor` of the only term, negated, if that is exact.
    pub(super) fn root(&self) -> Option<(usize, f64, f64)> {
        const TINY: f64 = 1e-200;
        let [(variable, factor)] = self.terms[..] else { return None };
        let root = -self.offset / factor;
        let exact = root.mul_add(factor, self.offset) == 0.0
            && (factor.abs() == 1.0 || root == 0.0 || root.abs().min(self.offset.abs()) > TINY)
            && root.abs() < crate::tolerance::INFINITE;
        exact.then_some((variable, factor, if root == 0.0 { 0.0 } else { root }))
    }
}

/// The rows that the file gives, after checking all indices and looking for entries given twice.
pub(super) fn rows(file: &CbfFile<'_>) -> Result<Vec<CbfRow>, Error> {
    let mut rows: Vec<CbfRow> = Vec::new();
    rows.resize_with(count(file.rows.as_ref()), CbfRow::default);
    let mut order: Vec<usize> = (0..file.matrix.len()).collect();
    for (row, variable, _) in &file.matrix {
        check(row, file.rows.as_ref(), ROW)?;
        check(variable, file.variables.as_ref(), VARIABLE)?;
    }
    let key = |at: usize| (file.matrix[at].0.index, file.matrix[at].1.index);
    order.sort_by_key(|&at| key(at));
    if let Some(pair) = order.windows(2).find(|pair| key(pair[0]) == key(pair[1])) {
        let ((row, variable), first) = (key(pair[1]), file.matrix[pair[0]].0.place);
        return Err(file.matrix[pair[1]].0.place.error(format!(
            "a second entry for row {row} and variable {variable}; the first one is in line {}, keep \
             one of them",
            first.line()
        )));
    }
    for (row, variable, value) in order.into_iter().map(|at| file.matrix[at]) {
        if value != 0.0 {
            rows[row.index].terms.push((variable.index, value));
        }
    }
    let offsets: Vec<_> = file.offsets.iter().map(|(row, _)| *row).collect();
    check_each(&offsets, file.rows.as_ref(), ROW)?;
    file.offsets.iter().for_each(|(row, value)| rows[row.index].offset = *value);
    Ok(rows)
}

/// A word for what an index counts, and its section.
pub(super) type Counted = (&'static str, &'static str);
pub(super) const VARIABLE: Counted = ("variable", "VAR");
const ROW: Counted = ("row", "CON");

/// Checks indices, each of which can stand once.
pub(super) fn check_each(
    indices: &[Index<'_>],
    blocks: Option<&CbfBlocks<'_>>,
    counted: Counted,
) -> Result<(), Error> {
    indices.iter().try_for_each(|index| check(index, blocks, counted))?;
    let mut first = vec![None; count(blocks)];
    for index in indices {
        if let Some(line) = first[index.index].replace(index.place.line()) {
            let (what, number) = (counted.0, index.index);
            return Err(index.place.error(format!(
                "a second entry for {what} {number}; the first one is in line {line}, keep one of them"
            )));
        }
    }
    Ok(())
}

fn check(
    index: &Index<'_>,
    blocks: Option<&CbfBlocks<'_>>,
    (what, section): Counted,
) -> Result<(), Error> {
    let number = index.index;
    match blocks {
        Some(blocks) if number < blocks.count => Ok(()),
        Some(blocks) => Err(index.place.error(format!(
            "there is no {what} {number}: by {section} in line {} there are {}, counted from 0; correct \
             the index or the number",
            blocks.place.line(),
            blocks.count
        ))),
        None => Err(index.place.error(format!(
            "there is no {what} {number}: the file has no section {section}; add it"
        ))),
    }
}

/// The number of entries of a section that may be missing.
pub(super) fn count(blocks: Option<&CbfBlocks<'_>>) -> usize {
    blocks.map_or(0, |blocks| blocks.count)
}

/// The blocks of a section that may be missing, each with the position of its first entry.
pub(super) fn blocks<'b, 'a>(
    blocks: Option<&'b CbfBlocks<'a>>,
) -> impl Iterator<Item = (usize, CbfBlock<'a>)> + 'b {
    blocks.into_iter().flat_map(|blocks| &blocks.blocks).scan(0, |next, block| {
        let first = *next;
        *next += block.size;
        Some((first, *block))
    })
}
