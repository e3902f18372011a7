//! Adding, finding and changing rows, indicators and logic.

use super::Model;
use super::checks::limits;
use super::ids::{Constraint, Disjunction, Indicator, LogicalConstraint};
use super::name::Name;
use super::refs::{ConstraintRef, IndicatorRef, LogicalConstraintRef};
use super::statement::Statement;
use super::store::{StatementKind, foreign};
use crate::error::{Error, ErrorKind};

impl Model {
    /// Adds a statement and returns its handle:
    ///
    /// * a [`Row`](super::Row): a [`Constraint`];
    /// * a [`ConicRow`](super::ConicRow): a [`ConicConstraint`](super::ConicConstraint);
    /// * an [`Implication`](super::Implication): an [`Indicator`], of a conic row a
    ///   `ConicConstraint`;
    /// * [`Implications`](super::Implications): the same for each row;
    /// * a [`Reification`](super::Reification): its [`Reified`](super::Reified) parts;
    /// * an [`Either`](super::Either): its [`Selected`](super::Selected) selectors;
    /// * a [`Logic`](super::Logic) formula or a [`Literal`](super::Literal): a
    ///   [`LogicalConstraint`]. One that holds for all values, such as `at_most(3, [a, b])`, is
    ///   accepted and has no rows;
    /// * a [`Sos`](super::Sos): a [`SpecialOrderedSet`](super::SpecialOrderedSet).
    ///
    /// An error leaves the model as it was.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::ForeignHandle`],
    /// [`ErrorKind::NotFinite`], [`ErrorKind::CrossedBounds`], [`ErrorKind::EmptyRow`],
    /// [`ErrorKind::UnlimitedRow`], [`ErrorKind::NotBinary`]; [`ErrorKind::EmptyLogic`] for a
    /// formula without variables, [`ErrorKind::NeverTrue`] for one that its own shape makes false,
    /// such as `at_least(3, [a, b])`, [`ErrorKind::TooDeep`]; [`ErrorKind::NotCone`],
    /// [`ErrorKind::UnknownSign`] and [`ErrorKind::NotConicRow`] for norms and quadratic rows that
    /// are no second-order cone; [`ErrorKind::OutOfRange`] for the margin of a reification, and for
    /// a set without members.
    #[doc(alias("constraint", "subject to"))]
    pub fn add<S: Statement>(
        &mut self,
        name: impl Into<Name>,
        statement: S,
    ) -> Result<S::Handle, Error> {
        let name = self.scoped(name.into());
        name.check()?;
        // A statement makes names of its own from this one.
        let scope = std::mem::take(&mut self.scope);
        let added = statement.add_to(self, name);
        self.scope = scope;
        added
    }

    /// Number of linear rows, without indicators.
    pub fn constraint_count(&self) -> usize {
        self.stored.constraints.len()
    }

    /// Number of indicators.
    pub fn indicator_count(&self) -> usize {
        self.stored.indicators.len()
    }

    /// The linear rows in the order of creation.
    pub fn constraints(
        &self,
    ) -> impl ExactSizeIterator<Item = ConstraintRef<'_>> + DoubleEndedIterator {
        let data = self.stored.constraints.iter().enumerate();
        data.map(|(i, data)| ConstraintRef { id: Constraint::new(i, self.stored.tag), data })
    }

    /// The indicators in the order of creation.
    pub fn indicators(&self) -> impl ExactSizeIterator<Item = IndicatorRef<'_>> {
        let data = self.stored.indicators.iter().enumerate();
        data.map(|(i, data)| IndicatorRef { id: Indicator::new(i, self.stored.tag), data })
    }

    /// Number of logic statements.
    pub fn logical_constraint_count(&self) -> usize {
        self.stored.logic.len()
    }

    /// The logic statements in the order of creation.
    pub fn logical_constraints(&self) -> impl ExactSizeIterator<Item = LogicalConstraintRef<'_>> {
        let data = self.stored.logic.iter().enumerate();
        data.map(|(i, data)| LogicalConstraintRef {
            id: LogicalConstraint::new(i, self.stored.tag),
            data,
        })
    }

    /// The disjunction with a name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn disjunction_by_name(&self, name: impl Into<Name>) -> Result<Disjunction, Error> {
        let index = self.named(name.into(), StatementKind::Disjunction, "disjunction")?;
        Ok(Disjunction { index, tag: self.tag() })
    }

    /// The linear row with a name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn constraint_by_name(&self, name: impl Into<Name>) -> Result<Constraint, Error> {
        let index = self.named(name.into(), StatementKind::Constraint, "linear row")?;
        Ok(Constraint { index, tag: self.tag() })
    }

    /// The indicator with a name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn indicator_by_name(&self, name: impl Into<Name>) -> Result<Indicator, Error> {
        let index = self.named(name.into(), StatementKind::Indicator, "indicator")?;
        Ok(Indicator { index, tag: self.tag() })
    }

    /// The logic statement with a name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn logical_constraint_by_name(
        &self,
        name: impl Into<Name>,
    ) -> Result<LogicalConstraint, Error> {
        let index = self.named(name.into(), StatementKind::Logical, "logic statement")?;
        Ok(LogicalConstraint { index, tag: self.tag() })
    }

    /// The position of the statement with a name, among those of its kind; `noun` is the kind in
    /// words.
    pub(super) fn named(
        &self,
        name: Name,
        kind: StatementKind,
        noun: &'static str,
    ) -> Result<u32, Error> {
        match self.statement_names.get(&name) {
            Some((of_kind, index)) if of_kind == kind => Ok(index),
            _ => Err(ErrorKind::UnknownName { name: name.to_string(), kind: noun }.into()),
        }
    }

    /// Changes the limits of a linear row. The limits apply to its terms without the constant,
    /// as the text form shows them.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`], [`ErrorKind::CrossedBounds`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::UnlimitedRow`].
    pub fn set_limits(&mut self, row: Constraint, lower: f64, upper: f64) -> Result<(), Error> {
        if row.tag != self.stored.tag || row.index() >= self.stored.constraints.len() {
            return Err(foreign("constraint", row.index(), "set_limits"));
        }
        let data = &mut self.stored.constraints[row.index()];
        (data.row.lower, data.row.upper) = limits(lower, upper, &data.name)?;
        self.touch();
        Ok(())
    }

    /// Changes the limits of an indicator's row.
    ///
    /// # Errors
    ///
    /// As for [`Model::set_limits`].
    pub fn set_indicator_limits(
        &mut self,
        indicator: Indicator,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        if indicator.tag != self.stored.tag || indicator.index() >= self.stored.indicators.len() {
            return Err(foreign("indicator", indicator.index(), "set_indicator_limits"));
        }
        let data = &mut self.stored.indicators[indicator.index()];
        (data.row.lower, data.row.upper) = limits(lower, upper, &data.name)?;
        self.touch();
        Ok(())
    }
}

/// A model is its own program, for functions that take a program with more than its model.
impl AsRef<Model> for Model {
    fn as_ref(&self) -> &Model {
        self
    }
}

impl AsMut<Model> for Model {
    fn as_mut(&mut self) -> &mut Model {
        self
    }
}
