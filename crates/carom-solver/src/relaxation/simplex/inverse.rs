//! Rows of the inverse of an optimal basis, from which cuts are made.

use super::program::LinearProgram;
use super::sparse::TINY_ENTRY;
use super::tableau::{NONBASIC, Tableau};
use super::{Basis, StartBasis};
use crate::presolve::Reduced;
use crate::relaxation::WarmState;

/// The rows of the inverse of the basis that a relaxation has left, at some columns: multipliers of
/// the program's rows, whose sum has the coefficient 1 at the column and 0 at the others of the
/// basis. Columns outside the basis, and those that need a row without a name, are left out.
pub(crate) fn inverse_rows(
    program: &Reduced,
    state: &WarmState,
    columns: impl Iterator<Item = usize>,
) -> Vec<Vec<(usize, f64)>> {
    let Some(basis) = state.get::<Basis>() else { return Vec::new() };
    let StartBasis { wanted, rest, .. } = StartBasis::of(program, Some(basis));
    let mut tableau = Tableau::new(LinearProgram::of(program), wanted, rest);
    let row = |k: usize| {
        let slot = tableau.slot[k];
        if slot == NONBASIC {
            return None;
        }
        tableau.solve_row(slot);
        let unit = tableau.program.column_unit(k);
        let entries = tableau.row.entries().filter(|e| e.1.abs() > TINY_ENTRY);
        let named = entries.map(|(i, a)| {
            let name = program.origin.get(i).copied().filter(|name| *name != usize::MAX);
            name.map(|name| (name, a * unit * tableau.program.row_unit(i)))
        });
        named.collect::<Option<Vec<_>>>()
    };
    columns.filter_map(row).collect()
}
