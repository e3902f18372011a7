//! Special ordered sets while a file is read.

use super::read::Warning;
use super::token::Token;
use crate::error::Error;
use crate::model::Model;
use crate::model::ids::Variable;
use crate::model::name::Name;

/// A set as a file has it.
#[derive(Debug)]
pub(crate) struct Set<'a> {
    /// Its name, or where it begins.
    pub(crate) place: Token<'a>,
    pub(crate) is_named: bool,
    /// How many neighbours may be other than 0.
    pub(crate) most: u8,
    /// Columns and weights.
    pub(crate) members: Vec<(usize, f64)>,
}

impl Set<'_> {
    /// Adds the set to a model. `name` is how the format reads names.
    pub(crate) fn add(
        &self,
        model: &mut Model,
        variables: &[Variable],
        position: usize,
        name: impl Fn(&str) -> Name,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), Error> {
        let wanted =
            if self.is_named { name(self.place.text) } else { Name::from(format!("s{position}")) };
        let free = unused(model, &wanted);
        if self.is_named && free != wanted {
            let text = format!("the name `{wanted}` is taken; the set is called `{free}`");
            warnings.push(self.place.warning(text));
        }
        let members = self.members.iter().map(|&(column, weight)| (variables[column], weight));
        let mut members: Vec<(Variable, f64)> = members.collect();
        members.sort_by(|a, b| a.1.total_cmp(&b.1));
        if self.most == 2 && members.windows(2).any(|pair| pair[0].1 == pair[1].1) {
            warnings.push(self.place.warning(format!(
                "`{free}` has a weight twice; members of the same weight keep their order, and the \
                 weights are 1, 2, ..."
            )));
            (1_u32..).zip(&mut members).for_each(|(k, member)| member.1 = f64::from(k));
        }
        let added = model.add_set(free, self.most, members);
        added.map(|_| ()).map_err(|error| self.place.error(error.to_string()))
    }
}

/// The name, with underscores if a statement of the model has it.
pub(crate) fn unused(model: &Model, name: &Name) -> Name {
    name.free(|name| model.has_statement(name))
}
