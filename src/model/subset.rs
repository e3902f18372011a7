//! All statements of a model in one order, and the model with only some of them.
//!
//! This is the only list of the kinds of statements that can be dropped. Functions cannot, because
//! they define variables.

use super::Model;
use super::name::Name;
use super::name_table::NameTable;
use super::refs::{ConstraintRef, DisjunctionRef, IndicatorRef, LogicalConstraintRef};
use super::store::{StatementIndex, StatementKind, Stored};

/// A statement of any kind.
#[derive(Debug, Clone, Copy)]
pub(crate) enum AnyStatement<'a> {
    Row(ConstraintRef<'a>),
    Indicator(IndicatorRef<'a>),
    Disjunction(DisjunctionRef<'a>),
    Logic(LogicalConstraintRef<'a>),
}

impl<'a> AnyStatement<'a> {
    pub(crate) fn name(&self) -> &'a Name {
        match self {
            AnyStatement::Row(row) => row.name(),
            AnyStatement::Indicator(indicator) => indicator.name(),
            AnyStatement::Disjunction(disjunction) => disjunction.name(),
            AnyStatement::Logic(logical) => logical.name(),
        }
    }

    fn index(&self) -> StatementIndex {
        match self {
            AnyStatement::Row(row) => (StatementKind::Constraint, row.id().index),
            AnyStatement::Indicator(indicator) => (StatementKind::Indicator, indicator.id().index),
            AnyStatement::Disjunction(disjunction) => {
                (StatementKind::Disjunction, disjunction.id().index)
            }
            AnyStatement::Logic(logical) => (StatementKind::Logical, logical.id().index),
        }
    }
}

impl Model {
    /// The statements: rows, then indicators, disjunctions and logic, each in the order of creation.
    pub(crate) fn statements(&self) -> impl Iterator<Item = AnyStatement<'_>> {
        let rows = self.constraints().map(AnyStatement::Row);
        let indicators = self.indicators().map(AnyStatement::Indicator);
        let disjunctions = self.disjunctions().map(AnyStatement::Disjunction);
        let logic = self.logical_constraints().map(AnyStatement::Logic);
        rows.chain(indicators).chain(disjunctions).chain(logic)
    }

    /// The model without its objective and with only the statements that `keep` accepts, by
    /// position in [`statements`](Model::statements). Variables, bounds and functions stay. Handles
    /// of variables stay valid; handles of statements do not.
    pub(crate) fn subset(&self, keep: impl Fn(usize) -> bool) -> Model {
        let stored = &self.stored;
        let mut position = 0..;
        let mut next = move || position.next().is_some_and(&keep);
        let stored = Stored {
            variables: stored.variables.clone(),
            constraints: stored.constraints.iter().filter(|_| next()).cloned().collect(),
            indicators: stored.indicators.iter().filter(|_| next()).cloned().collect(),
            disjunctions: stored.disjunctions.iter().filter(|_| next()).cloned().collect(),
            logic: stored.logic.iter().filter(|_| next()).cloned().collect(),
            functions: stored.functions.clone(),
            background: stored.background.clone(),
            reformulation: stored.reformulation,
            ..Model::empty(stored.name.clone(), stored.tag).stored
        };
        let mut part =
            Model { stored, variable_names: self.variable_names.clone(), ..Model::new("") };
        let mut names = NameTable::new();
        for statement in part.statements() {
            names.claim(statement.name(), statement.index());
        }
        part.statement_names = names;
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::at_most;

    #[test]
    fn a_subset_keeps_variables_and_what_is_asked_for() {
        let mut model = Model::new("m");
        let x = model.continuous("x", 0.0, 4.0).unwrap();
        let z = model.binary_family("z", 2).unwrap();
        model.add("low", x.ge(1.0)).unwrap();
        model.add("high", x.le(3.0)).unwrap();
        model.add("if", z[0].on().implies(x.le(2.0))).unwrap();
        model.add("one", at_most(1, &z)).unwrap();
        model.maximize(x).unwrap();
        let names: Vec<_> = model.statements().map(|s| s.name().to_string()).collect();
        assert_eq!(names, ["low", "high", "if", "one"]);

        let part = model.subset(|k| k == 1 || k == 3);
        let wanted = [
            "minimize 0",
            "subject to",
            "  high: x <= 3",
            "  one: at_most(1, z[0], z[1])",
            "where",
            "  0 <= x <= 4",
            "  z[0] binary",
            "  z[1] binary",
        ];
        assert_eq!(part.to_string().lines().collect::<Vec<_>>(), wanted);
        assert!(part.constraint_by_name("high").is_ok() && part.constraint_by_name("low").is_err());
        assert!(part.variable_ref(x).is_ok());
    }
}
