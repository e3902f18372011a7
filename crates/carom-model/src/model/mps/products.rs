//! The sections QUADOBJ, QMATRIX, QSECTION and QCMATRIX: products in the objective and in rows.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::read::MpsFile;
use super::section::MpsSection;
use crate::error::Error;
use crate::model::ids::Variable;
use crate::model::quadratic::Quadratic;
use crate::model::text::read::Warning;
use crate::model::text::token::{self, Token};

/// The entries of a matrix Q.
#[derive(Debug)]
pub(super) struct MpsMatrix<'a> {
    pub(super) form: MatrixForm,
    pub(super) products: Vec<MpsProduct<'a>>,
    /// The name of the section, or of its row.
    pub(super) place: Token<'a>,
}

/// The meaning of the entries of a matrix Q.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MatrixForm {
    /// `1/2 x'Qx`, each pair once.
    HalfTriangle,
    /// `1/2 x'Qx`, each pair in both orders.
    HalfSquare,
    /// `x'Qx`, each pair in both orders.
    Square,
}

/// Two columns and a value.
#[derive(Debug)]
pub(super) struct MpsProduct<'a> {
    first: usize,
    second: usize,
    value: f64,
    place: Token<'a>,
}

impl MatrixForm {
    /// The form of a section.
    fn of(section: MpsSection) -> MatrixForm {
        match section {
            MpsSection::Qmatrix => MatrixForm::HalfSquare,
            MpsSection::Qcmatrix => MatrixForm::Square,
            _ => MatrixForm::HalfTriangle,
        }
    }

    /// The name of the section with pairs in both orders.
    fn name(self) -> &'static str {
        if self == MatrixForm::Square { "QCMATRIX" } else { "QMATRIX" }
    }

    fn is_mirrored(self) -> bool {
        self != MatrixForm::HalfTriangle
    }

    /// The coefficient of a product for an entry of 1, which stands for both orders.
    fn factor(self, is_square: bool) -> f64 {
        let half = if self == MatrixForm::Square { 1.0 } else { 0.5 };
        if is_square { half } else { 2.0 * half }
    }
}

impl<'a> MpsFile<'a> {
    /// Begins the matrix of the objective, or of the row that the line of the section names.
    pub(super) fn begin_matrix(
        &mut self,
        section: MpsSection,
        head: Token<'a>,
        name: Option<&Token<'a>>,
    ) -> Result<(), Error> {
        let form = MatrixForm::of(section);
        let row = name.map(|name| self.find_row(name)).transpose()?;
        let place = *name.unwrap_or(&head);
        let row = match row {
            Some(row) if self.objective != Some(row) => row,
            _ if section == MpsSection::Qcmatrix => {
                return Err(place.error(match name {
                    Some(_) => format!(
                        "row `{}` is the objective; write its products as QMATRIX (with Q of `1/2 x'Qx`)",
                        place.text
                    ),
                    None => "expected the name of a row behind QCMATRIX".into(),
                }));
            }
            _ => {
                self.matrix_row = None;
                match &self.matrix {
                    Some(matrix) if !matrix.products.is_empty() && matrix.form != form => {
                        return Err(head.error("QUADOBJ and QMATRIX cannot both be given"));
                    }
                    Some(matrix) if matrix.form == form => {}
                    _ => self.matrix = Some(MpsMatrix { form, products: Vec::new(), place }),
                }
                return Ok(());
            }
        };
        if let Some(earlier) = &self.rows[row].matrix {
            let line = earlier.place.line();
            return Err(place.error(format!(
                "row `{}` already has products, given from line {line} on; keep one section",
                place.text
            )));
        }
        self.rows[row].matrix = Some(MpsMatrix { form, products: Vec::new(), place });
        self.matrix_row = Some(row);
        Ok(())
    }

    /// A line of a matrix.
    pub(super) fn product(&mut self, [first, second, value]: [Token<'a>; 3]) -> Result<(), Error> {
        let product = MpsProduct {
            first: self.find_column(&first)?,
            second: self.find_column(&second)?,
            value: value.raw()?,
            place: first,
        };
        let matrix = match self.matrix_row {
            Some(row) => &mut self.rows[row].matrix,
            None => &mut self.matrix,
        };
        if let Some(matrix) = matrix {
            let factor = matrix.form.factor(product.first == product.second);
            if token::or_infinite(factor * product.value).is_infinite() {
                value.finite()?;
                return Err(value.error(format!(
                    "twice `{}` counts as infinite (1e20 and beyond do); a finite number is needed here",
                    value.text
                )));
            }
            matrix.products.push(product);
        }
        Ok(())
    }

    /// Adds the products of a matrix to an expression.
    pub(super) fn add_products(
        &self,
        matrix: &MpsMatrix<'_>,
        variables: &[Variable],
        expression: &mut Quadratic,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), Error> {
        let (form, mirrored) = (matrix.form, matrix.form.is_mirrored());
        let names = |a: usize, b: usize| (self.columns[a].name.text, self.columns[b].name.text);
        let mut seen = HashMap::with_capacity(matrix.products.len());
        for product in &matrix.products {
            let (a, b) = (product.first, product.second);
            let key = if mirrored { (a, b) } else { (a.min(b), a.max(b)) };
            if seen.insert(key, product.value).is_some() {
                let (a, b) = names(a, b);
                let message = format!("a second entry for `{a}` and `{b}`");
                if mirrored {
                    return Err(product.place.error(message));
                }
                warnings.push(product.place.warning(message + "; their sum counts"));
            }
        }
        for product in &matrix.products {
            let (a, b) = (product.first, product.second);
            if mirrored && seen.get(&(b, a)).copied().unwrap_or(0.0) != product.value {
                let ((a, b), section) = (names(a, b), form.name());
                return Err(product.place.error(format!(
                    "{section} is not symmetric: the entry for `{b}` and `{a}` differs or is missing"
                )));
            }
            let coefficient = form.factor(a == b) * product.value;
            match a.cmp(&b) {
                Ordering::Greater if mirrored => {}
                _ => expression.add_product(coefficient, variables[a], variables[b]),
            }
        }
        Ok(())
    }
}
