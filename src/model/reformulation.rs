//! How a model wants its switched rows written: a preference, never a part of its meaning.

use super::Model;

/// How a disjunction becomes rows. All methods have the same integer solutions; they differ in
/// size and in how tight the relaxation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Method {
    /// A row of a term is relaxed by one M where the term is not selected. Fewest rows and
    /// columns, weakest relaxation.
    #[default]
    BigM,
    /// A row of a term is relaxed by an M for each of the *other* terms, each from a linear
    /// program over that term. As many rows as big-M, never weaker.
    MultiM,
    /// The convex hull of the terms: a copy of the variables for each term. The tightest
    /// relaxation of a single disjunction, at the price of many columns.
    Hull,
}

impl Method {
    /// All methods, from the smallest to the tightest.
    pub const ALL: [Method; 3] = [Method::BigM, Method::MultiM, Method::Hull];

    /// The method in the field's words.
    pub fn word(self) -> &'static str {
        match self {
            Method::BigM => "big-M",
            Method::MultiM => "multi-M",
            Method::Hull => "hull",
        }
    }
}

/// How a model is to be lowered to rows. What is chosen here changes sizes, bounds and times,
/// never the set of solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[must_use = "a reformulation does nothing until it is given to `Model::set_reformulation`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reformulation {
    method: Method,
    linear_programs: bool,
}

impl Reformulation {
    /// The method of disjunctions that do not choose their own; [`Method::BigM`] by default.
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Whether every big-M is tightened by a linear program over the whole relaxation, beyond what
    /// the bounds of its own row prove. Off by default: it costs a linear program for each M each
    /// time the model is lowered, and pays where the search is long.
    pub fn with_linear_programs(mut self, on: bool) -> Self {
        self.linear_programs = on;
        self
    }

    /// The method of disjunctions that do not choose their own.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Whether big-Ms are tightened by linear programs.
    pub fn linear_programs(&self) -> bool {
        self.linear_programs
    }
}

impl Model {
    /// How the model is to be lowered.
    pub fn reformulation(&self) -> Reformulation {
        self.stored.reformulation
    }

    /// Chooses how the model is to be lowered.
    ///
    /// ```
    /// use carom::model::{Method, Reformulation};
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous("x", 0.0, 10.0)?;
    /// model.add("side", either(x.le(2.0)).or(x.ge(7.0)))?;
    /// model.set_reformulation(Reformulation::default().with_method(Method::Hull));
    /// model.minimize((x - 3.0).square())?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(x)? - 2.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn set_reformulation(&mut self, reformulation: Reformulation) {
        self.touch();
        self.stored.reformulation = reformulation;
    }
}
