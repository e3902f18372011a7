//! Assembly of a [`Program`] from a model without indicators.

use std::sync::OnceLock;

use faer::sparse::{CreationError, SparseColMat, SparseRowMat, Triplet};

use super::Program;
use super::assemble_cones::{LongNorms, assemble_cones};
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::tolerance;

/// Rows and columns of a program that is being assembled.
pub(super) struct Entries {
    entries: Vec<Triplet<usize, usize, f64>>,
    row_lower: Vec<f64>,
    row_upper: Vec<f64>,
    pub(super) lower: Vec<f64>,
    upper: Vec<f64>,
    integral: Vec<bool>,
    step: Vec<Option<usize>>,
    /// As [`Program::spread`].
    spread: f64,
}

impl Entries {
    /// The variables and linear rows of a model.
    fn of(model: &Model) -> Self {
        let (m, n) = (model.constraint_count(), model.variable_count());
        let mut built = Entries {
            entries: Vec::new(),
            row_lower: Vec::with_capacity(m),
            row_upper: Vec::with_capacity(m),
            lower: Vec::with_capacity(n),
            upper: Vec::with_capacity(n),
            integral: Vec::with_capacity(n),
            step: Vec::with_capacity(n),
            spread: 1.0,
        };
        for row in model.constraints() {
            let (terms, limits) = (row.terms().iter(), row.limits());
            built.row(terms.map(|&(v, a)| (v.index(), a)), limits.lower, limits.upper);
        }
        for variable in model.variables() {
            let (mut bounds, whole) = (variable.bounds(), variable.kind().is_integral());
            if whole {
                bounds.lower = (bounds.lower - tolerance::INTEGRALITY).ceil();
                bounds.upper = (bounds.upper + tolerance::INTEGRALITY).floor();
            }
            built.lower.push(bounds.lower);
            built.upper.push(bounds.upper);
            built.integral.push(whole);
            built.step.push(variable.name().step());
        }
        built
    }

    /// Adds a continuous column.
    pub(super) fn column(&mut self, lower: f64, upper: f64) -> usize {
        self.lower.push(lower);
        self.upper.push(upper);
        self.integral.push(false);
        self.step.push(None);
        self.lower.len() - 1
    }

    /// The bounds of a column.
    pub(super) fn bounds(&self, column: usize) -> [f64; 2] {
        [self.lower[column], self.upper[column]]
    }

    /// Whether a column is integral.
    pub(super) fn is_integral(&self, column: usize) -> bool {
        self.integral[column]
    }

    /// Whether there is an integral column.
    pub(super) fn has_integers(&self) -> bool {
        self.integral.contains(&true)
    }

    /// Adds a column for an expression, with the row that makes it its value. It may be farther out
    /// than the columns of the expression.
    pub(super) fn expression(&mut self, terms: &[(usize, f64)], offset: f64, lower: f64) -> usize {
        let reach =
            |j: usize| self.lower[j].abs().max(self.upper[j].abs()).min(tolerance::FREE_RADIUS);
        let reach: f64 = terms.iter().map(|&(j, a)| a.abs() * reach(j)).sum();
        self.spread = self.spread.max((reach + offset.abs()) / tolerance::FREE_RADIUS);
        let column = self.column(lower, f64::INFINITY);
        self.row(terms.iter().copied().chain([(column, -1.0)]), -offset, -offset);
        column
    }

    /// Adds a row.
    pub(super) fn row(
        &mut self,
        terms: impl Iterator<Item = (usize, f64)>,
        lower: f64,
        upper: f64,
    ) {
        let row = self.row_lower.len();
        self.entries.extend(terms.map(|(j, a)| Triplet::new(row, j, a)));
        self.row_lower.push(lower);
        self.row_upper.push(upper);
    }
}

impl Program {
    /// Assembles the matrices of a model. Its variables are the first columns; those of cones
    /// follow.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`] when the model has anything but rows and cones,
    /// [`ErrorKind::Allocation`] when the matrices cannot be allocated.
    pub fn assemble(model: &Model) -> Result<Program, Error> {
        Program::assemble_norms(model, LongNorms::Parts)
    }

    /// As [`assemble`](Self::assemble), with long norms as towers where these suit.
    ///
    /// # Errors
    ///
    /// As for [`assemble`](Self::assemble).
    pub fn assemble_with_towers(model: &Model) -> Result<Program, Error> {
        Program::assemble_norms(model, LongNorms::Towers)
    }

    fn assemble_norms(model: &Model, norms: LongNorms) -> Result<Program, Error> {
        if !model.has_only_rows() {
            return Err(ErrorKind::Unsupported {
                solver: "the assembly of matrices".into(),
                what: "statements other than rows".into(),
                help: "lower the model first".into(),
            }
            .into());
        }
        let sign = model.sense().sign();
        let mut built = Entries::of(model);
        let cones = assemble_cones(model, norms, &mut built)?;
        let Entries { entries, row_lower, row_upper, lower, upper, integral, step, spread } = built;
        let (m, n) = (row_lower.len(), lower.len());

        let mut linear = vec![0.0; n];
        for (v, a) in model.objective().affine().terms() {
            linear[v.index()] = sign * a;
        }
        let mut products = Vec::new();
        for (a, b, q) in model.objective().products() {
            // x'Px / 2 holds q x_a x_b as P_ab = P_ba = q, and q x_a^2 as P_aa = 2 q.
            products.push(Triplet::new(a.index(), b.index(), sign * q));
            products.push(Triplet::new(b.index(), a.index(), sign * q));
        }

        let matrix = |error: CreationError| Error::with_source(ErrorKind::Allocation, error);
        Ok(Program {
            quadratic: SparseColMat::try_new_from_triplets(n, n, &products).map_err(matrix)?,
            linear,
            offset: sign * model.objective().affine().offset(),
            constant: sign * model.objective_constant(),
            sign,
            rows: SparseRowMat::try_new_from_triplets(m, n, &entries).map_err(matrix)?,
            columns: SparseColMat::try_new_from_triplets(m, n, &entries).map_err(matrix)?,
            row_lower,
            row_upper,
            lower,
            upper,
            integers: (0..n).filter(|&j| integral[j]).collect(),
            integral,
            cones,
            conic: OnceLock::new(),
            cone_cuts: None,
            step,
            spread,
            steepness: OnceLock::new(),
            squared: OnceLock::new(),
            widened: Default::default(),
        })
    }
}
