//! Kinds of variables and families of them over a step index.

use std::ops::Index;
use std::slice;

use super::ids::Variable;

/// The values that a variable may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VariableKind {
    /// Any real number within the bounds.
    Continuous,
    /// 0 or 1.
    Binary,
    /// A whole number within the bounds.
    Integer,
}

impl VariableKind {
    /// Whether only integers are allowed.
    pub fn is_integral(self) -> bool {
        self != VariableKind::Continuous
    }
}

/// Variables `name[0], name[1], ...` over a step index, made by
/// [`Model::continuous_family`](super::Model::continuous_family) and its siblings.
///
/// Indexing works as for a slice: `family[t]` panics when `t` is out of range, `family.get(t)`
/// does not.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Family {
    pub(crate) members: Vec<Variable>,
}

impl Family {
    /// The member at a step, or `None` if the step is out of range.
    pub fn get(&self, step: usize) -> Option<Variable> {
        self.members.get(step).copied()
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The members in the order of steps.
    pub fn iter(&self) -> std::iter::Copied<slice::Iter<'_, Variable>> {
        self.members.iter().copied()
    }

    /// The members as a slice.
    pub fn as_slice(&self) -> &[Variable] {
        &self.members
    }
}

/// Variables of any names, in the order of their steps.
impl FromIterator<Variable> for Family {
    fn from_iter<I: IntoIterator<Item = Variable>>(variables: I) -> Self {
        Family { members: variables.into_iter().collect() }
    }
}

impl Index<usize> for Family {
    type Output = Variable;

    fn index(&self, step: usize) -> &Variable {
        &self.members[step]
    }
}

impl<'a> IntoIterator for &'a Family {
    type Item = Variable;
    type IntoIter = std::iter::Copied<slice::Iter<'a, Variable>>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
