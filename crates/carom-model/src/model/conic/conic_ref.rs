//! Conic rows of a model, for reading.

use super::stored_conic::StoredConic;
use crate::error::Error;
use crate::model::ids::ConicConstraint;
use crate::model::logic::Logic;
use crate::model::name::Name;
use crate::model::reformulation::BigM;
use crate::model::store::{ConicData, Model, StatementKind};

/// A conic row of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct ConicRef<'a> {
    pub(in crate::model) id: ConicConstraint,
    pub(in crate::model) data: &'a ConicData,
}

impl<'a> ConicRef<'a> {
    /// The handle.
    pub fn id(&self) -> ConicConstraint {
        self.id
    }

    /// The name.
    pub fn name(&self) -> &'a Name {
        &self.data.name
    }

    /// The condition under which the row must hold; `None` if it always must.
    pub fn condition(&self) -> Option<&'a Logic> {
        self.data.condition.as_ref()
    }

    /// Where the big-M of its condition comes from.
    pub fn big_m(&self) -> BigM {
        self.data.big_m
    }

    #[doc(hidden)]
    pub fn conic(&self) -> &'a StoredConic {
        &self.data.conic
    }
}

impl Model {
    /// Number of conic rows: norms and quadratic rows.
    pub fn conic_constraint_count(&self) -> usize {
        self.stored.conic.len()
    }

    /// The conic rows in the order of creation.
    pub fn conic_constraints(
        &self,
    ) -> impl ExactSizeIterator<Item = ConicRef<'_>> + DoubleEndedIterator {
        let data = self.stored.conic.iter().enumerate();
        data.map(|(i, data)| ConicRef { id: ConicConstraint::new(i, self.stored.tag), data })
    }

    /// The conic row with a name.
    ///
    /// # Errors
    ///
    /// [`UnknownName`](crate::error::ErrorKind::UnknownName).
    pub fn conic_constraint_by_name(
        &self,
        name: impl Into<Name>,
    ) -> Result<ConicConstraint, Error> {
        let index = self.named(name.into(), StatementKind::Conic, "norm or quadratic row")?;
        Ok(ConicConstraint { index, tag: self.tag() })
    }
}
