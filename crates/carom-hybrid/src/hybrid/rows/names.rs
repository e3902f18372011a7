//! Names of families in the model.

use std::collections::{BTreeMap, BTreeSet};

use super::switch::Label;

/// Where the statement of a row holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Scope {
    /// In the transition of the row.
    Own,
    /// In every transition.
    Common,
    /// In every transition, with a largest value of its own in each.
    Support,
}

/// The subject of a statement of a choice: the numbers of the choice and the transition, the row,
/// and where the statement holds.
pub(super) type Key = (usize, usize, Option<Label>, Scope);

/// Gives every family of variables, or of statements, a name of its own.
#[derive(Debug, Clone)]
pub(super) struct Names {
    prefix: String,
    used: BTreeSet<String>,
    keyed: BTreeMap<Key, String>,
    /// The words for guards, by their families.
    words: BTreeMap<String, String>,
}

impl Names {
    pub(super) fn new(prefix: &str) -> Self {
        let (used, keyed, words) = Default::default();
        Names { prefix: prefix.to_owned(), used, keyed, words }
    }

    /// The words for families of guards.
    pub(super) fn words(self) -> BTreeMap<String, String> {
        self.words
    }

    /// The parts that are not empty, joined by underscores, after the prefix. White space becomes
    /// an underscore. A name that is taken gets a number.
    pub(super) fn family(&mut self, parts: &[&str]) -> String {
        let all = [&[&self.prefix[..]], parts].concat();
        let parts: Vec<&str> = all.into_iter().filter(|part| !part.is_empty()).collect();
        let plain = |c: char| if c.is_whitespace() || c.is_control() { '_' } else { c };
        let name: String = parts.join("_").chars().map(plain).collect();
        let mut numbers = 2..;
        let mut free = name.clone();
        while !self.used.insert(free.clone()) {
            free = format!("{name}_{}", numbers.next().unwrap_or(0));
        }
        free
    }

    /// The family of a key, made from the parts at its first use.
    pub(super) fn keyed(&mut self, key: Key, parts: &[&str]) -> String {
        if let Some(family) = self.keyed.get(&key) {
            return family.clone();
        }
        let family = self.family(parts);
        if let (Some(Label::Guard { .. }), Some((name, before))) = (key.2, parts.split_last()) {
            let owner: Vec<&str> = before.iter().copied().filter(|part| !part.is_empty()).collect();
            let words = match key.3 == Scope::Common || owner.is_empty() {
                true => format!("the limit `{name}`"),
                false => format!("the limit `{name}` of `{}`", owner.join(" ")),
            };
            self.words.insert(family.clone(), words);
        }
        self.keyed.insert(key, family.clone());
        family
    }
}
