//! Special ordered sets: at most one member, or two that are next to each other, are other than 0.
//!
//! `reformulate` turns them into rows with binaries at each solve.
//! [`Verification`](crate::solution::Verification) counts the members that are other than 0.

use super::Model;
use super::checks::finite;
use super::ids::{SpecialOrderedSet, Variable};
use super::name::Name;
use super::refs::SpecialOrderedSetRef;
use super::statement::{SealedStatement, Statement};
use super::store::StatementKind;
use crate::error::Error;

/// A special ordered set, not yet added to a model; made by [`sos1`] and [`sos2`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a set does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sos {
    most: u8,
    members: Vec<(Variable, f64)>,
}

/// "At most one of these is other than 0": variables with weights (no unit), whose order is kept
/// for files.
///
/// To solve a model, each member needs finite bounds, unless it is a binary.
///
/// ```
/// use carom::model::sos1;
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let thrust = model.continuous_family("thrust", 3, -2.0, 2.0)?;
/// model.add("one_axis", sos1(thrust.iter().zip([1.0, 2.0, 3.0])))?;
/// let goal = [1.0, -1.5, 0.5];
/// let miss: Quadratic = (0..3).map(|i| (thrust[i] - goal[i]).square()).sum();
/// model.minimize(miss)?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!((solution.value(thrust[1])? + 1.5).abs() < 1e-6);
/// assert!(solution.value(thrust[0])?.abs() < 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
pub fn sos1(members: impl IntoIterator<Item = (Variable, f64)>) -> Sos {
    Sos { most: 1, members: members.into_iter().collect() }
}

/// "At most two of these are other than 0, and they are next to each other in the order of their
/// weights": variables with weights (no unit), all of them different.
///
/// To solve a model, each member needs finite bounds. For a piecewise-affine function,
/// [`Model::piecewise`] says it more directly.
///
/// ```
/// use carom::model::sos2;
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let share = model.continuous_family("share", 4, 0.0, 1.0)?;
/// model.add("neighbours", sos2(share.iter().zip([0.0, 1.0, 4.0, 9.0])))?;
/// model.add("one", share.iter().sum::<Affine>().equals(1.0))?;
/// let x = 1.0 * share[1] + 4.0 * share[2] + 9.0 * share[3];
/// model.add("place", x.equals(2.0))?;
/// model.minimize(share[0] + share[3])?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!((solution.value(share[2])? - 1.0 / 3.0).abs() < 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
pub fn sos2(members: impl IntoIterator<Item = (Variable, f64)>) -> Sos {
    Sos { most: 2, members: members.into_iter().collect() }
}

impl SealedStatement for Sos {}
impl Statement for Sos {
    type Handle = SpecialOrderedSet;

    fn add_to(self, model: &mut Model, name: Name) -> Result<SpecialOrderedSet, Error> {
        model.add_set(name, self.most, self.members)
    }
}

impl Model {
    /// Number of special ordered sets.
    pub fn special_ordered_set_count(&self) -> usize {
        self.stored.sets.len()
    }

    /// The special ordered sets in the order of creation.
    pub fn special_ordered_sets(&self) -> impl ExactSizeIterator<Item = SpecialOrderedSetRef<'_>> {
        let data = self.stored.sets.iter().enumerate();
        data.map(|(i, data)| SpecialOrderedSetRef {
            id: SpecialOrderedSet::new(i, self.stored.tag),
            data,
        })
    }

    /// The special ordered set with a name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`](crate::error::ErrorKind::UnknownName).
    pub fn special_ordered_set_by_name(
        &self,
        name: impl Into<Name>,
    ) -> Result<SpecialOrderedSet, Error> {
        let index = self.named(name.into(), StatementKind::Set, "special ordered set")?;
        Ok(SpecialOrderedSet { index, tag: self.tag() })
    }

    /// Adds a set after checking its members.
    pub(super) fn add_set(
        &mut self,
        name: Name,
        most: u8,
        mut members: Vec<(Variable, f64)>,
    ) -> Result<SpecialOrderedSet, Error> {
        name.check()?;
        if !(1..=2).contains(&most) {
            let (what, most) =
                (format!("the number of members other than 0 in `{name}`"), f64::from(most));
            return Err(Error::out_of_range_in_words(what, most, 1.0..=2.0, "1 or 2"));
        }
        if members.is_empty() {
            let what = format!("the number of members of `{name}`");
            return Err(Error::out_of_range(what, 0.0, 1.0..));
        }
        for &(variable, weight) in &members {
            self.check_variable(variable, &name)?;
            finite(weight, "a weight", &name)?;
        }
        members.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut known: Vec<Variable> = members.iter().map(|&(variable, _)| variable).collect();
        known.sort();
        if let Some(pair) = known.windows(2).find(|pair| pair[0] == pair[1]) {
            let what = format!("how often `{}` is in `{name}`", self.name_of(pair[0]));
            return Err(Error::out_of_range(what, 2.0, 1.0..=1.0));
        }
        let same = members.windows(2).find(|pair| pair[0].1 == pair[1].1);
        if let Some(&[(first, _), (second, weight)]) = same.filter(|_| most == 2) {
            let (first, second) = (self.name_of(first), self.name_of(second));
            let range = format!("different from that of `{first}`, because weights order the set");
            let what = format!("the weight of `{second}` in `{name}`");
            return Err(Error::out_of_range_in_words(what, weight, .., range));
        }
        self.push_set(name, most, members)
    }
}
