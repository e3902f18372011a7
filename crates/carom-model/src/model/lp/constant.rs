//! The constant of the objective as a column that is fixed to 1.

use super::defined;
use super::function::LpArgument;
use super::names::CONSTANT;
use super::read::LpFile;
use crate::model::text::row_condition::RowCondition;

impl LpFile<'_> {
    /// Makes a column `Constant` that is fixed to 1, and that the objective alone mentions, the
    /// constant that it stands for.
    pub(super) fn take_constant(&mut self) {
        let found = self.columns.iter().position(|column| column.name.text == CONSTANT);
        let Some(index) = found.filter(|&index| self.is_constant(index)) else { return };
        let column = self.columns.remove(index);
        let (own, others) = self.objective.terms.iter().partition(|(at, _)| *at == index);
        let (own, mut others): (Vec<_>, Vec<(usize, f64)>) = (own, others);
        let number = self.objective.constant.map(|(value, _)| value);
        let sum = own.into_iter().map(|(_, value)| value).chain(number).reduce(|a, b| a + b);
        self.objective.constant = sum.map(|sum| (sum, column.name));
        others.iter_mut().for_each(|(at, _)| close(at, index));
        self.objective.terms = others;
        for (first, second, _) in &mut self.objective.products {
            close(first, index);
            close(second, index);
        }
        for row in &mut self.rows {
            row.terms.iter_mut().for_each(|(at, _)| close(at, index));
            for (first, second, _) in &mut row.products {
                close(first, index);
                close(second, index);
            }
            if let Some(RowCondition { column, .. }) = &mut row.condition {
                close(column, index);
            }
        }
        let members = self.sets.iter_mut().flat_map(|set| &mut set.members);
        members.for_each(|(at, _)| close(at, index));
        for function in &mut self.functions {
            close(&mut function.result, index);
            for argument in &mut function.arguments {
                if let LpArgument::Column(at) = argument {
                    close(at, index);
                }
            }
        }
    }

    fn is_constant(&self, index: usize) -> bool {
        let column = &self.columns[index];
        let is_fixed = column.ends.lower == Some(1.0) && column.ends.upper == Some(1.0);
        let is_plain = !column.integer && !column.binary && !column.semicontinuous;
        let objective = &self.objective;
        let mut products = objective.products.iter().flat_map(|&(a, b, _)| [a, b]);
        let mut rows = self.rows.iter().flat_map(|row| {
            let condition = row.condition.map(|condition| condition.column);
            let products = row.products.iter().flat_map(|&(a, b, _)| [a, b]);
            row.terms.iter().map(|(at, _)| *at).chain(products).chain(condition)
        });
        let mut sets = self.sets.iter().flat_map(|set| set.members.iter().map(|(at, _)| *at));
        let mut functions =
            self.functions.iter().flat_map(|f| defined::columns(f).chain([f.result]));
        is_fixed
            && is_plain
            && !functions.any(|at| at == index)
            && objective.terms.iter().any(|(at, _)| *at == index)
            && !products.any(|at| at == index)
            && !rows.any(|at| at == index)
            && !sets.any(|at| at == index)
    }
}

/// Where a column is once another one is gone.
fn close(at: &mut usize, gone: usize) {
    if *at > gone {
        *at -= 1;
    }
}
