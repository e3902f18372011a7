//! Background: families of statements that explanations never question.

use super::Model;
use super::name::Name;
use crate::error::{Error, ErrorKind};

/// The words for statements that describe a system.
const LAWS: &str = "the laws of the system";

impl Model {
    /// Declares a family of statements to be background. Background statements describe the system,
    /// such as its dynamics, and `explain` never blames them for infeasibility.
    /// This has no other effect. The builders of `hybrid` declare the dynamics
    /// that they add.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous_family("x", 2, 0.0, 5.0)?;
    /// model.add(("drift", 0), (x[1] - x[0]).equals(1.0))?;
    /// model.set_background("drift")?;
    /// assert!(model.is_background("drift[0]"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`] if the model has no statement of this family.
    pub fn set_background(&mut self, family: &str) -> Result<(), Error> {
        let scoped = self.scoped(Name::of_family(family));
        let family = scoped.family();
        if self.stored.background.contains(family) {
            return Ok(());
        }
        if !self.statement_names.has_family(family) {
            return Err(ErrorKind::UnknownName {
                name: family.into(),
                kind: "family of statements",
            }
            .into());
        }
        self.stored.background.insert(family.into());
        Ok(())
    }

    /// Declares a family to be background that describes a system, and that nobody knows by its
    /// name.
    #[doc(hidden)]
    pub fn set_law(&mut self, family: &str) -> Result<(), Error> {
        self.describe(family, LAWS.to_owned());
        self.set_background(family)
    }

    /// Says in words what a family states, for explanations.
    #[doc(hidden)]
    pub fn describe(&mut self, family: &str, words: String) {
        let family = self.scoped(Name::of_family(family)).family().to_owned();
        self.stored.words.insert(family, words);
    }

    /// Whether there is a statement of a family.
    #[doc(hidden)]
    pub fn has_family(&self, family: &str) -> bool {
        self.statement_names.has_family(family)
    }

    /// The statement of a family in words; its name if there are none.
    #[doc(hidden)]
    pub fn words<'a>(&'a self, family: &'a str) -> &'a str {
        self.stored.words.get(family).map_or(family, String::as_str)
    }

    /// Whether a statement's family was declared to be background.
    pub fn is_background(&self, name: impl Into<Name>) -> bool {
        self.stored.background.contains(name.into().family())
    }
}
