//! The order of columns that a file needs, and the products that decide it.

use super::functions::arguments;
use crate::model::Model;
use crate::model::ids::Variable;
use crate::model::text::lines::FileLine;
use crate::model::variable::VariableKind;

/// Columns that stand together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Class {
    Both,
    BothInteger,
    Constraints,
    ConstraintsInteger,
    Objective,
    ObjectiveInteger,
    Linear,
    Binary,
    Integer,
}

/// The columns of a file in order.
#[derive(Debug)]
pub(super) struct Order {
    pub(super) columns: Vec<Variable>,
    /// By variable, its column.
    positions: Vec<usize>,
    classes: Vec<Class>,
}

impl Order {
    /// The order of the columns of a model, which has quadratic rows and no norms.
    pub(super) fn new(model: &Model, rows: &[FileLine<'_>]) -> Order {
        let count = model.variable_count();
        let (mut in_rows, mut in_objective) = (vec![false; count], vec![false; count]);
        for (a, b, _) in rows.iter().flat_map(|row| &row.products) {
            (in_rows[a.index()], in_rows[b.index()]) = (true, true);
        }
        for variable in rows.iter().filter_map(|row| row.function).flat_map(arguments) {
            in_rows[variable.index()] = true;
        }
        for (a, b, _) in model.objective().products() {
            (in_objective[a.index()], in_objective[b.index()]) = (true, true);
        }
        let class = |k: usize, kind: VariableKind| {
            let either = |of, whole| if kind.is_integral() { whole } else { of };
            match (in_rows[k], in_objective[k]) {
                (true, true) => either(Class::Both, Class::BothInteger),
                (true, false) => either(Class::Constraints, Class::ConstraintsInteger),
                (false, true) => either(Class::Objective, Class::ObjectiveInteger),
                (false, false) if kind == VariableKind::Binary => Class::Binary,
                (false, false) => either(Class::Linear, Class::Integer),
            }
        };
        let variables = model.variables();
        let mut columns: Vec<(Class, Variable)> =
            variables.map(|v| (class(v.id().index(), v.kind()), v.id())).collect();
        columns.sort();
        let mut positions = vec![0; count];
        columns.iter().enumerate().for_each(|(at, (_, v))| positions[v.index()] = at);
        let (classes, columns) = columns.into_iter().unzip();
        Order { columns, positions, classes }
    }

    /// The number of columns of a class.
    pub(super) fn count(&self, class: Class) -> usize {
        self.classes.iter().filter(|own| **own == class).count()
    }

    /// The column of a variable.
    pub(super) fn position(&self, variable: Variable) -> usize {
        self.positions[variable.index()]
    }
}
