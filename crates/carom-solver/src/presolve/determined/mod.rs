//! Continuous columns that equalities determine, one after the other: the states of a system whose
//! start and inputs are fixed, the sums of fixed terms.
//!
//! Every equation multiplies what is missed in the ones before: over seven steps of `x+ = 1000 x`,
//! 1e-21 at the start becomes 1. No tolerance is small enough for that, so these columns are
//! computed from the numbers of the rows, with some 32 digits and a bound of the error ([`Ball`]).
//! A column that follows exactly from 0 stays 0.
//!
//! Which columns are determined is a question about the pattern of the equations: those that no
//! unmatched column reaches in a largest matching of equations and columns (Dulmage and Mendelsohn,
//! "Coverings of bipartite graphs", 1958). They are computed in the order of the strong components
//! of this part; see `structure`.

mod ball;
mod equations;
mod linear_block;
mod structure;

pub(crate) use ball::Ball;
pub(crate) use equations::ColumnKind;
use equations::Equations;
use linear_block::solve;
pub(crate) use structure::DeterminedBlock;
use structure::Structure;

use std::sync::OnceLock;

use crate::program::Program;

/// The growth of an error from which on columns are computed: below, tolerances need no help (no
/// unit).
const LEAST_GROWTH: f64 = 100.0;

/// The columns that the equalities of a program determine, in the order of their computation.
#[derive(Debug, Clone)]
pub(crate) struct DeterminedColumns {
    equations: Equations,
    blocks: Vec<DeterminedBlock>,
    /// By column, its position among the determined ones; past the end where it is none.
    place: Vec<usize>,
    count: usize,
}

/// The columns that the equalities of a program determine once its integers are fixed, found at the
/// first request. They hold for all bounds that leave the same columns fixed.
#[derive(Debug, Default)]
pub struct LeafColumns(OnceLock<Option<DeterminedColumns>>);

impl LeafColumns {
    /// Those of a program, always the same; `None` where they multiply no error visibly.
    pub(crate) fn of(&self, program: &Program) -> Option<&DeterminedColumns> {
        self.0.get_or_init(|| DeterminedColumns::of_leaf(program)).as_ref()
    }
}

impl DeterminedColumns {
    /// The columns that the equalities of a program determine once its integers are fixed; `None`
    /// where they multiply no error visibly.
    pub(crate) fn of_leaf(program: &Program) -> Option<Self> {
        let equalities = (0..program.row_count())
            .filter(|&row| program.row_lower[row] == program.row_upper[row])
            .map(|row| {
                let (columns, entries) = program.row(row);
                let terms = columns.iter().copied().zip(entries.iter().copied());
                (row, terms, program.row_lower[row])
            });
        let kind = |j: usize| match program.lower[j] == program.upper[j] || program.integral[j] {
            true => ColumnKind::Known,
            false => ColumnKind::Unknown,
        };
        DeterminedColumns::new(program.column_count(), equalities, kind)
    }

    /// The columns that some equalities determine; `None` where they multiply no error visibly.
    ///
    /// # Arguments
    ///
    /// * `equalities`: the number, the terms and the limit of each.
    pub(crate) fn new<T: Iterator<Item = (usize, f64)>>(
        columns: usize,
        equalities: impl Iterator<Item = (usize, T, f64)>,
        kind: impl Fn(usize) -> ColumnKind,
    ) -> Option<Self> {
        let equations = Equations::of(equalities, &kind);
        let order = Structure::new(columns, &equations, &kind).order();
        let mut place = vec![usize::MAX; columns];
        let mut growth: Vec<f64> = Vec::new();
        let mut blocks = Vec::with_capacity(order.len());
        for found in order {
            let known = |j: usize| place.get(j).and_then(|&k| growth.get(k)).copied();
            let grown = found.equations.iter().map(|&e| equations.growth(e, &found.columns, known));
            let many = if found.columns.len() > 1 { 2.0 } else { 1.0 };
            let grown = 1.0 + many * grown.fold(0.0, f64::max);
            for &column in &found.columns {
                place[column] = growth.len();
                growth.push(grown);
            }
            let rows = found.equations.iter().map(|&e| equations.row(e)).collect();
            blocks.push(DeterminedBlock { rows, ..found });
        }
        let grows = growth.iter().any(|&g| g >= LEAST_GROWTH);
        let count = growth.len();
        grows.then_some(DeterminedColumns { equations, blocks, place, count })
    }

    /// The columns that are determined together, in the order of their computation.
    pub(crate) fn blocks(&self) -> &[DeterminedBlock] {
        &self.blocks
    }

    /// The values of the determined columns, in the order of their blocks.
    ///
    /// # Arguments
    ///
    /// * `at`: the values of the known columns.
    pub(crate) fn values(&self, at: impl Fn(usize) -> f64) -> Vec<Ball> {
        let mut values = vec![Ball::UNKNOWN; self.count];
        for block in &self.blocks {
            let known = |j: usize| match self.place[j] {
                usize::MAX => Ball::from(at(j)),
                place => values[place],
            };
            let found = solve(&self.equations, &block.equations, &block.columns, known);
            for (&column, value) in block.columns.iter().zip(found) {
                values[self.place[column]] = value;
            }
        }
        values
    }

    /// Gives the determined columns of a point the values that follow from the others, where these
    /// are known to all digits of a float.
    pub(crate) fn follow(&self, point: &mut [f64]) {
        let values = self.values(|j| point[j]);
        for column in self.blocks.iter().flat_map(|block| &block.columns) {
            let value = values[self.place[*column]];
            if value.is_sharp() {
                point[*column] = value.value();
            }
        }
    }

    /// The value of a determined column among [`values`](Self::values).
    pub(crate) fn value_of(&self, values: &[Ball], column: usize) -> Ball {
        values.get(self.place[column]).copied().unwrap_or(Ball::UNKNOWN)
    }
}
