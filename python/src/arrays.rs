//! The arrays of a program, as Python's side hands them over: checked, and of one type each.

use pyo3::prelude::*;

use crate::numbers::{Floats, Places};

/// A sparse matrix by rows: where each row begins among the entries (and the last one ends), the
/// columns of the entries, and their values.
#[derive(Debug, Clone, FromPyObject)]
pub(crate) struct Sparse(Places, Places, Floats);

impl Sparse {
    /// The rows.
    pub(crate) fn rows(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64)>> {
        let Sparse(Places(starts), Places(columns), Floats(values)) = self;
        starts.windows(2).map(move |ends| {
            let place = ends[0]..ends[1].max(ends[0]);
            let columns = columns.get(place.clone()).unwrap_or_default();
            let values = values.get(place).unwrap_or_default();
            columns.iter().copied().zip(values.iter().copied())
        })
    }
}

/// Minimise `x'Px/2 + q'x + offset` with `l <= Ax <= u`, `lb <= x <= ub`, and `h + Gx` in the
/// product of second-order cones of these sizes, of each of which the first entry is at least the
/// norm of the others.
#[derive(Debug, Clone, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Arrays {
    #[pyo3(item("P"))]
    pub(crate) squares: Option<Sparse>,
    pub(crate) q: Floats,
    pub(crate) offset: f64,
    #[pyo3(item("A"))]
    pub(crate) matrix: Option<Sparse>,
    pub(crate) l: Floats,
    pub(crate) u: Floats,
    pub(crate) lb: Floats,
    pub(crate) ub: Floats,
    /// Other than 0 for integers.
    pub(crate) integrality: Places,
    #[pyo3(item("G"))]
    pub(crate) cones: Option<Sparse>,
    pub(crate) h: Floats,
    pub(crate) sizes: Places,
    /// Of the variables.
    pub(crate) names: Option<Vec<String>>,
}

/// Limits and bounds that change from solve to solve: the least and the largest value of each, or
/// nothing for arrays that stay.
#[derive(Debug, Clone, Default, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Ranges {
    pub(crate) l: Option<(Floats, Floats)>,
    pub(crate) u: Option<(Floats, Floats)>,
    pub(crate) lb: Option<(Floats, Floats)>,
    pub(crate) ub: Option<(Floats, Floats)>,
}
