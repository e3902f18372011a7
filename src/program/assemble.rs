//! Assembly of a [`Program`] from a model without indicators.

use std::sync::OnceLock;

use faer::sparse::{CreationError, SparseColMat, SparseRowMat, Triplet};

use super::Program;
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::tolerance;

impl Program {
    /// Assembles the matrices of a model.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`] when the model has anything but rows, [`ErrorKind::Allocation`]
    /// when the matrices cannot be allocated.
    pub fn assemble(model: &Model) -> Result<Program, Error> {
        if !model.has_only_rows() {
            return Err(ErrorKind::Unsupported {
                solver: "the assembly of matrices".into(),
                what: "statements other than rows".into(),
                help: "lower the model first".into(),
            }
            .into());
        }
        let (m, n) = (model.constraint_count(), model.variable_count());
        let sign = model.sense().sign();

        let mut entries = Vec::new();
        let (mut row_lower, mut row_upper) = (Vec::with_capacity(m), Vec::with_capacity(m));
        for (i, row) in model.constraints().enumerate() {
            entries.extend(row.terms().iter().map(|&(v, a)| Triplet::new(i, v.index(), a)));
            row_lower.push(row.limits().lower);
            row_upper.push(row.limits().upper);
        }

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

        let (mut lower, mut upper) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let (mut integral, mut step) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for variable in model.variables() {
            let (mut bounds, whole) = (variable.bounds(), variable.kind().is_integral());
            if whole {
                bounds.lower = (bounds.lower - tolerance::INTEGRALITY).ceil();
                bounds.upper = (bounds.upper + tolerance::INTEGRALITY).floor();
            }
            lower.push(bounds.lower);
            upper.push(bounds.upper);
            integral.push(whole);
            step.push(variable.name().step());
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
            step,
            spread: 1.0,
            steepness: OnceLock::new(),
            widened: Default::default(),
        })
    }
}
