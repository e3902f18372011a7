//! The condition of a row while a file is read.

use super::token::Token;
use crate::model::ids::Variable;
use crate::model::literal::Literal;

/// The condition of a row: a column and its value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowCondition<'a> {
    pub(crate) column: usize,
    pub(crate) on: bool,
    pub(crate) place: Token<'a>,
}

impl RowCondition<'_> {
    /// The condition in the model, whose variables are those of the columns.
    pub(crate) fn literal(&self, variables: &[Variable]) -> Literal {
        Literal { variable: variables[self.column], on: self.on }
    }
}
