//! Families of variables with one index or two.

use super::store::Model;
use super::variable::{Family, VariableKind};
use crate::error::Error;

/// How many members a family has: a number, or a pair of numbers for two indices. Sealed.
pub trait FamilyShape: SealedShape {
    /// A [`Family`], or one for each first index.
    type Families;

    #[doc(hidden)]
    fn add_to(
        self,
        model: &mut Model,
        name: &str,
        range: (VariableKind, f64, f64),
    ) -> Result<Self::Families, Error>;
}

/// Keeps [`FamilyShape`] to the types of this crate.
pub trait SealedShape {}

impl SealedShape for usize {}
impl FamilyShape for usize {
    type Families = Family;

    fn add_to(
        self,
        model: &mut Model,
        name: &str,
        (kind, lower, upper): (VariableKind, f64, f64),
    ) -> Result<Family, Error> {
        (0..self).map(|step| model.variable((name, step), kind, lower, upper)).collect()
    }
}

impl SealedShape for (usize, usize) {}
impl FamilyShape for (usize, usize) {
    type Families = Vec<Family>;

    fn add_to(
        self,
        model: &mut Model,
        name: &str,
        range: (VariableKind, f64, f64),
    ) -> Result<Vec<Family>, Error> {
        let (rows, columns) = self;
        (0..rows).map(|i| columns.add_to(model, &format!("{name}[{i}]"), range)).collect()
    }
}
