//! Names and their positions.

use std::collections::HashMap;

/// Positions of names in the order of declaration.
///
/// Files mostly go through their names in order, so a look-up first tries the name found last and
/// the one after it.
#[derive(Debug, Default)]
pub(crate) struct NameIndex<'a> {
    list: Vec<&'a str>,
    positions: HashMap<&'a str, usize>,
    last: usize,
}

impl<'a> NameIndex<'a> {
    /// Appends a name and returns its position, or the position that it already has.
    pub(crate) fn declare(&mut self, name: &'a str) -> Result<usize, usize> {
        let next = self.list.len();
        let position = *self.positions.entry(name).or_insert(next);
        if position < next {
            return Err(position);
        }
        self.list.push(name);
        Ok(position)
    }

    /// The position of a name, if it is known.
    pub(crate) fn find(&mut self, name: &str) -> Option<usize> {
        let near = [self.last, self.last + 1];
        let found = near.into_iter().find(|&position| self.list.get(position) == Some(&name));
        let found = found.or_else(|| self.positions.get(name).copied())?;
        self.last = found;
        Some(found)
    }
}
