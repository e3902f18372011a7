//! All statements of a model in one order, and the model with only some of them.
//!
//! This is the only list of the kinds of statements that can be dropped. Functions cannot, because
//! they define variables.

use super::Model;
use super::conic::ConicRef;
use super::name::Name;
use super::name_table::NameTable;
use super::refs::{
    ConstraintRef, DisjunctionRef, IndicatorRef, LogicalConstraintRef, SpecialOrderedSetRef,
};
use super::store::{StatementIndex, StatementKind, StoredModel};

/// A statement of any kind.
#[derive(Debug, Clone, Copy)]
pub enum AnyStatement<'a> {
    /// A linear row.
    Row(ConstraintRef<'a>),
    /// A row that holds under a condition.
    Indicator(IndicatorRef<'a>),
    /// A norm or a quadratic row, with or without a condition.
    Conic(ConicRef<'a>),
    /// Sets of rows, one of which holds.
    Disjunction(DisjunctionRef<'a>),
    /// A formula.
    Logic(LogicalConstraintRef<'a>),
    /// A special ordered set.
    Set(SpecialOrderedSetRef<'a>),
}

impl<'a> AnyStatement<'a> {
    /// The name of the statement.
    pub fn name(&self) -> &'a Name {
        match self {
            AnyStatement::Row(row) => row.name(),
            AnyStatement::Indicator(indicator) => indicator.name(),
            AnyStatement::Conic(conic) => conic.name(),
            AnyStatement::Disjunction(disjunction) => disjunction.name(),
            AnyStatement::Logic(logical) => logical.name(),
            AnyStatement::Set(set) => set.name(),
        }
    }

    fn index(&self) -> StatementIndex {
        match self {
            AnyStatement::Row(row) => (StatementKind::Constraint, row.id().index),
            AnyStatement::Indicator(indicator) => (StatementKind::Indicator, indicator.id().index),
            AnyStatement::Conic(conic) => (StatementKind::Conic, conic.id().index),
            AnyStatement::Disjunction(disjunction) => {
                (StatementKind::Disjunction, disjunction.id().index)
            }
            AnyStatement::Logic(logical) => (StatementKind::Logical, logical.id().index),
            AnyStatement::Set(set) => (StatementKind::Set, set.id().index),
        }
    }
}

/// The statements: rows, then indicators, conic rows, disjunctions, logic and sets, each in the
/// order of creation.
pub fn statements(model: &Model) -> impl Iterator<Item = AnyStatement<'_>> {
    let rows = model.constraints().map(AnyStatement::Row);
    let indicators = model.indicators().map(AnyStatement::Indicator);
    let conic = model.conic_constraints().map(AnyStatement::Conic);
    let disjunctions = model.disjunctions().map(AnyStatement::Disjunction);
    let logic = model.logical_constraints().map(AnyStatement::Logic);
    let sets = model.special_ordered_sets().map(AnyStatement::Set);
    rows.chain(indicators).chain(conic).chain(disjunctions).chain(logic).chain(sets)
}

/// The model without its objective and with only the statements that `keep` accepts, by position in
/// [`statements`]. Variables, bounds and functions stay. Handles of variables stay valid; handles
/// of statements do not.
pub fn subset(model: &Model, keep: impl Fn(usize) -> bool) -> Model {
    let stored = &model.stored;
    let mut position = 0..;
    let mut next = move || position.next().is_some_and(&keep);
    let stored = StoredModel {
        variables: stored.variables.clone(),
        constraints: stored.constraints.iter().filter(|_| next()).cloned().collect(),
        indicators: stored.indicators.iter().filter(|_| next()).cloned().collect(),
        conic: stored.conic.iter().filter(|_| next()).cloned().collect(),
        disjunctions: stored.disjunctions.iter().filter(|_| next()).cloned().collect(),
        logic: stored.logic.iter().filter(|_| next()).cloned().collect(),
        sets: stored.sets.iter().filter(|_| next()).cloned().collect(),
        functions: stored.functions.clone(),
        background: stored.background.clone(),
        words: stored.words.clone(),
        by_step: stored.by_step.clone(),
        reformulation: stored.reformulation,
        ..Model::empty(stored.name.clone(), stored.tag).stored
    };
    let mut part = Model { stored, variable_names: model.variable_names.clone(), ..Model::new("") };
    let mut names = NameTable::default();
    for statement in statements(&part) {
        names.claim(statement.name(), statement.index());
    }
    part.statement_names = names;
    part
}
