//! Comparisons of norms and of quadratic expressions as statements of a model.

use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::ConicConstraint;
use crate::model::logic::Logic;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::statement::{SealedStatement, Statement};
use crate::model::store::{ConicData, Model, StatementKind};

/// A comparison of a norm or of a quadratic expression, not yet added to a model.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a conic row does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConicRow {
    pub(crate) conic: StoredConic,
}

/// A conic row as a model stores it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum StoredConic {
    /// `|entries| <= bound`.
    Norm { entries: Vec<Affine>, bound: Affine },
    /// `expression <= 0`.
    Quadratic { expression: Quadratic },
}

impl ConicRow {
    pub(crate) fn new(conic: StoredConic) -> Self {
        ConicRow { conic }
    }
}

impl SealedStatement for ConicRow {}
impl Statement for ConicRow {
    type Handle = ConicConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<ConicConstraint, Error> {
        model.push_conic(name, None, self.conic)
    }
}

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

    pub(crate) fn conic(&self) -> &'a StoredConic {
        &self.data.conic
    }
}

impl Model {
    /// Number of conic rows: norms and quadratic rows.
    pub fn conic_constraint_count(&self) -> usize {
        self.stored.conic.len()
    }

    /// The conic rows in the order of creation.
    pub fn conic_constraints(&self) -> impl ExactSizeIterator<Item = ConicRef<'_>> {
        let data = self.stored.conic.iter().enumerate();
        data.map(|(i, data)| ConicRef { id: ConicConstraint::new(i, self.stored.tag), data })
    }

    /// Adds a conic row after checking that it is a cone within the bounds.
    pub(crate) fn push_conic(
        &mut self,
        name: Name,
        condition: Option<Logic>,
        conic: StoredConic,
    ) -> Result<ConicConstraint, Error> {
        self.standard_cone(&conic, &name)?;
        let id = ConicConstraint::new(self.stored.conic.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Conic, id.index))?;
        self.stored.conic.push(ConicData { name, condition, conic });
        Ok(id)
    }
}
