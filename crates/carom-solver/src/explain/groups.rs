//! The statements in question, by family.

use std::collections::BTreeMap;

use crate::error::{Error, ErrorKind};
use crate::model::{Model, Name, statements};

/// The statements of a model that are in question, by family. Positions are those of
/// [`statements`].
pub(super) struct Groups {
    pub(super) names: Vec<Name>,
    /// The families, in the order of their first statements.
    pub(super) families: Vec<StatementFamily>,
}

/// One family of statements in question.
pub(super) struct StatementFamily {
    pub(super) name: String,
    /// The positions of the members, ordered by step.
    pub(super) members: Vec<usize>,
}

impl Groups {
    /// All families but those in the background.
    pub(super) fn of(model: &Model, background: &[Name]) -> Result<Self, Error> {
        let names: Vec<Name> = statements(model).map(|s| s.name().clone()).collect();
        let mut asked: Vec<bool> = names.iter().map(|n| !model.is_background(n.clone())).collect();
        for name in background {
            for position in selected(&names, name)? {
                asked[position] = false;
            }
        }
        let mut families: Vec<StatementFamily> = Vec::new();
        let mut places = BTreeMap::new();
        for (position, name) in names.iter().enumerate().filter(|&(k, _)| asked[k]) {
            let place = *places.entry(name.family()).or_insert(families.len());
            if place == families.len() {
                families.push(StatementFamily { name: name.family().into(), members: Vec::new() });
            }
            families[place].members.push(position);
        }
        for family in &mut families {
            family.members.sort_by_key(|&member| names[member].step());
        }
        Ok(Groups { names, families })
    }

    /// Which statements are kept: the whole background and these members.
    pub(super) fn mask<'a>(&self, kept: impl Iterator<Item = &'a [usize]>) -> Vec<bool> {
        let mut keep = vec![true; self.names.len()];
        for &member in self.families.iter().flat_map(|family| &family.members) {
            keep[member] = false;
        }
        for &member in kept.flatten() {
            keep[member] = true;
        }
        keep
    }
}

/// The statements that a name stands for: one statement, a family, or, if there is no such family,
/// all families whose name begins with it and an underscore.
pub(super) fn selected(names: &[Name], of: &Name) -> Result<Vec<usize>, Error> {
    let all = |holds: &dyn Fn(&Name) -> bool| -> Vec<usize> {
        let found = names.iter().enumerate().filter(|(_, name)| holds(name));
        found.map(|(position, _)| position).collect()
    };
    let mut found = match of.step() {
        Some(_) => all(&|name| name == of),
        None => all(&|name| name.family() == of.family()),
    };
    if found.is_empty() && of.step().is_none() {
        let start = format!("{}_", of.family());
        found = all(&|name| name.family().starts_with(&start));
    }
    match found.is_empty() {
        true => Err(ErrorKind::UnknownName { name: of.to_string(), kind: "statement" }.into()),
        false => Ok(found),
    }
}
