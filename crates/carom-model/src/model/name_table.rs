//! A table from names to positions.
//!
//! Families are looked up by their text and then by step. Consecutive steps are in a plain list, so
//! a large family stores its text once.

use std::collections::{BTreeMap, HashMap};

use super::name::Name;

/// Positions by name; the values are small and `Copy`.
#[derive(Debug, Clone)]
pub struct NameTable<T> {
    families: HashMap<String, FamilyMembers<T>>,
}

#[derive(Debug, Clone)]
struct FamilyMembers<T> {
    /// The name without a step.
    plain: Option<T>,
    /// Steps 0, 1, 2, ... as far as they came in order.
    dense: Vec<Option<T>>,
    /// All others.
    sparse: BTreeMap<usize, T>,
}

impl<T> Default for NameTable<T> {
    fn default() -> Self {
        NameTable { families: HashMap::new() }
    }
}

impl<T: Copy> NameTable<T> {
    /// Whether any member of a family, or the family's plain name, was ever claimed.
    pub(super) fn has_family(&self, family: &str) -> bool {
        self.families.contains_key(family)
    }

    /// The value of a name.
    pub fn get(&self, name: &Name) -> Option<T> {
        let members = self.families.get(name.family())?;
        match name.step() {
            None => members.plain,
            Some(step) => match members.dense.get(step) {
                Some(found) => *found,
                None => members.sparse.get(&step).copied(),
            },
        }
    }

    /// Gives a name a value. Returns `false` and changes nothing if it has one already.
    pub fn claim(&mut self, name: &Name, value: T) -> bool {
        if !self.families.contains_key(name.family()) {
            let none = FamilyMembers { plain: None, dense: Vec::new(), sparse: BTreeMap::new() };
            self.families.insert(name.family().to_owned(), none);
        }
        let Some(members) = self.families.get_mut(name.family()) else { return false };
        let Some(step) = name.step() else {
            let free = members.plain.is_none();
            members.plain = members.plain.or(Some(value));
            return free;
        };
        if step == members.dense.len() && !members.sparse.contains_key(&step) {
            members.dense.push(Some(value));
            return true;
        }
        if let Some(place) = members.dense.get_mut(step) {
            let free = place.is_none();
            *place = place.or(Some(value));
            return free;
        }
        let free = !members.sparse.contains_key(&step);
        members.sparse.entry(step).or_insert(value);
        free
    }

    /// Takes a name's value away.
    pub fn remove(&mut self, name: &Name) {
        let Some(members) = self.families.get_mut(name.family()) else { return };
        match name.step() {
            None => members.plain = None,
            Some(step) => match members.dense.get_mut(step) {
                Some(place) => *place = None,
                None => _ = members.sparse.remove(&step),
            },
        }
    }
}
