//! The length of a vector of affine expressions.

use super::conic_row::{ConicRow, Refused};
use super::stored_conic::StoredConic;
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::store::Model;
use crate::model::variable::VariableKind;

/// The Euclidean norm of a vector of affine expressions, in their unit; made by [`norm`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a norm does nothing until it is compared"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Norm {
    entries: Vec<Affine>,
}

/// The Euclidean norm of a vector of affine expressions.
///
/// ```
/// use carom::model::norm;
/// use carom::prelude::*;
///
/// let mut model = Model::new("disc");
/// let v = model.continuous_family("v", 2, -5.0, 5.0)?;
/// model.add("speed", norm([v[0], v[1]]).le(3.0))?;
/// assert!(model.to_string().contains("speed: |(v[0], v[1])| <= 3\n"));
/// # Ok::<(), carom::Error>(())
/// ```
pub fn norm<T: Into<Affine>>(entries: impl IntoIterator<Item = T>) -> Norm {
    Norm { entries: entries.into_iter().map(T::into).collect() }
}

impl Norm {
    /// The length, where no entry has a variable.
    pub(crate) fn constant(&self) -> Option<f64> {
        let is_constant = |entry: &Affine| entry.terms().is_empty();
        let length = |entries: &[Affine]| entries.iter().fold(0.0_f64, |l, e| l.hypot(e.offset()));
        let is_any = !self.entries.is_empty() && self.entries.iter().all(is_constant);
        is_any.then(|| length(&self.entries))
    }

    pub(super) fn into_entries(self) -> Vec<Affine> {
        self.entries
    }

    /// The norm of other expressions.
    pub(crate) fn try_map(
        &self,
        entry: impl FnMut(&Affine) -> Result<Affine, Error>,
    ) -> Result<Norm, Error> {
        Ok(Norm { entries: self.entries.iter().map(entry).collect::<Result<_, _>>()? })
    }

    /// The statement that the norm is at most an affine expression, which is then at least 0.
    pub fn le(&self, bound: impl Into<Affine>) -> ConicRow {
        ConicRow::new(StoredConic::Norm { entries: self.entries.clone(), bound: bound.into() })
    }

    /// No model accepts this, because it is not convex; the error of
    /// [`Model::add`](crate::model::Model::add) says what to write instead.
    pub fn ge(&self, bound: impl Into<Affine>) -> ConicRow {
        self.le(bound).refused(Refused::NormAtLeast)
    }

    /// No model accepts this, because it is not convex; the error of
    /// [`Model::add`](crate::model::Model::add) says what to write instead.
    pub fn equals(&self, value: impl Into<Affine>) -> ConicRow {
        self.le(value).refused(Refused::NormEquals)
    }
}

impl Model {
    /// Adds a variable that is at least the Euclidean norm of some expressions, in their unit, and
    /// the norm as a row of the same name: for costs such as fuel, and their sums.
    ///
    /// The variable equals the norm where the objective or other rows push it down, as in
    /// `model.minimize(...)` of a sum of such variables; nothing else keeps it from being larger.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("ferry");
    /// let dock = model.continuous("dock", 0.0, 6.0)?;
    /// let islands = [(0.0, 3.0), (6.0, 1.0)];
    /// let mut way = Affine::zero();
    /// for (k, (x, y)) in islands.into_iter().enumerate() {
    ///     way += model.norm(("way", k), [dock - x, Affine::constant(y)])?;
    /// }
    /// model.minimize(way)?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(dock)? - 4.5).abs() < 1e-3);
    /// assert!((solution.objective().unwrap() - 52.0_f64.sqrt()).abs() < 1e-5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`Model::add`]; [`ErrorKind::EmptyRow`](crate::error::ErrorKind::EmptyRow) without
    /// expressions.
    pub fn norm<T: Into<Affine>>(
        &mut self,
        name: impl Into<Name>,
        entries: impl IntoIterator<Item = T>,
    ) -> Result<Variable, Error> {
        let (name, entries) = (name.into(), norm(entries));
        self.all_or_nothing(|model| {
            let length =
                model.variable(name.clone(), VariableKind::Continuous, 0.0, f64::INFINITY)?;
            model.add(name, entries.le(length))?;
            Ok(length)
        })
    }
}
