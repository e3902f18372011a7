//! Views of a model's variables and statements, for reading.

use super::conic::StoredConic;
use super::function::Function;
use super::ids::{
    Constraint, Disjunction, Indicator, LogicalConstraint, SpecialOrderedSet, Variable,
};
use super::literal::Literal;
use super::logic::Logic;
use super::name::Name;
use super::reformulation::{BigM, Method};
use super::store::{
    ConstraintData, DisjunctionData, FunctionData, IndicatorData, LogicalData, SemicontinuousRange,
    SosData, VariableData,
};
use super::stored::StoredTerm;
use super::variable::VariableKind;
use crate::interval::Interval;

/// The methods that every view of a variable or a statement has.
macro_rules! id_and_name {
    ($($view:ident: $handle:ident),*) => {$(
        impl<'a> $view<'a> {
            /// The handle.
            #[inline]
            pub fn id(&self) -> $handle {
                self.id
            }

            /// The name.
            #[inline]
            pub fn name(&self) -> &'a Name {
                &self.data.name
            }
        }
    )*};
}

id_and_name! {
    VariableRef: Variable,
    ConstraintRef: Constraint,
    IndicatorRef: Indicator,
    DisjunctionRef: Disjunction,
    LogicalConstraintRef: LogicalConstraint,
    SpecialOrderedSetRef: SpecialOrderedSet
}

/// A variable of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct VariableRef<'a> {
    pub(super) id: Variable,
    pub(super) data: &'a VariableData,
}

impl<'a> VariableRef<'a> {
    /// The kind.
    #[inline]
    pub fn kind(&self) -> VariableKind {
        self.data.kind
    }

    /// Current bounds, in the variable's unit. For a parameter, both are its value.
    #[inline]
    pub fn bounds(&self) -> Interval {
        Interval::new(self.data.lower, self.data.upper)
    }

    /// For a semi-continuous variable: the values that it may take besides 0, in its unit. They may
    /// reach beyond [`bounds`](Self::bounds), which hold as well.
    pub fn semicontinuous(&self) -> Option<Interval> {
        self.data
            .semicontinuous
            .map(|SemicontinuousRange { lower, upper }| Interval::new(lower, upper))
    }

    /// For a parameter: the declared range of its values, in its unit.
    #[inline]
    pub fn parameter_range(&self) -> Option<Interval> {
        self.data.range.map(|(lower, upper)| Interval::new(lower, upper))
    }
}

/// A linear row of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct ConstraintRef<'a> {
    pub(super) id: Constraint,
    pub(super) data: &'a ConstraintData,
}

impl<'a> ConstraintRef<'a> {
    /// The terms, sorted by variable.
    #[inline]
    pub fn terms(&self) -> &'a [(Variable, f64)] {
        &self.data.row.terms
    }

    /// The limits of the terms' sum.
    #[inline]
    pub fn limits(&self) -> Interval {
        Interval::new(self.data.row.lower, self.data.row.upper)
    }
}

/// An indicator of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct IndicatorRef<'a> {
    pub(super) id: Indicator,
    pub(super) data: &'a IndicatorData,
}

impl<'a> IndicatorRef<'a> {
    /// The condition; [`Logic::as_literal`] returns `Some` for a plain literal.
    #[inline]
    pub fn condition(&self) -> &'a Logic {
        &self.data.condition
    }

    /// The terms of the implied row, sorted by variable.
    #[inline]
    pub fn terms(&self) -> &'a [(Variable, f64)] {
        &self.data.row.terms
    }

    /// The limits of the implied row.
    #[inline]
    pub fn limits(&self) -> Interval {
        Interval::new(self.data.row.lower, self.data.row.upper)
    }

    /// Where its big-M comes from.
    #[inline]
    pub fn big_m(&self) -> BigM {
        self.data.big_m
    }
}

/// A disjunction of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct DisjunctionRef<'a> {
    pub(super) id: Disjunction,
    pub(super) data: &'a DisjunctionData,
}

impl<'a> DisjunctionRef<'a> {
    /// The method chosen for this disjunction, if any.
    #[inline]
    pub fn method(&self) -> Option<Method> {
        self.data.method
    }

    /// The terms in the order they were written.
    #[inline]
    pub fn terms(&self) -> impl ExactSizeIterator<Item = TermRef<'a>> + use<'a> {
        self.data.terms.iter().map(|data| TermRef { data })
    }

    #[doc(hidden)]
    #[inline]
    pub fn stored_terms(&self) -> &'a [StoredTerm] {
        &self.data.terms
    }
}

/// A term of a disjunction, for reading.
#[derive(Debug, Clone, Copy)]
pub struct TermRef<'a> {
    data: &'a StoredTerm,
}

impl<'a> TermRef<'a> {
    /// The condition that selects the term.
    #[inline]
    pub fn selector(&self) -> Literal {
        self.data.selector
    }

    /// Terms and limits of each row.
    pub fn rows(
        &self,
    ) -> impl ExactSizeIterator<Item = (&'a [(Variable, f64)], Interval)> + use<'a> {
        self.data.rows.iter().map(|row| (&row.terms[..], Interval::new(row.lower, row.upper)))
    }

    #[inline]
    pub(crate) fn conic(&self) -> &'a [StoredConic] {
        &self.data.conic
    }

    /// The terms of each disjunction inside this term.
    #[inline]
    pub fn nested(&self) -> impl ExactSizeIterator<Item = Vec<TermRef<'a>>> + use<'a> {
        self.data.nested.iter().map(|terms| terms.iter().map(|data| TermRef { data }).collect())
    }
}

/// A logic statement of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct LogicalConstraintRef<'a> {
    pub(super) id: LogicalConstraint,
    pub(super) data: &'a LogicalData,
}

impl<'a> LogicalConstraintRef<'a> {
    /// The formula.
    #[inline]
    pub fn logic(&self) -> &'a Logic {
        &self.data.logic
    }
}

/// A special ordered set of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct SpecialOrderedSetRef<'a> {
    pub(super) id: SpecialOrderedSet,
    pub(super) data: &'a SosData,
}

impl<'a> SpecialOrderedSetRef<'a> {
    /// How many members may be other than 0: 1, or 2 that are next to each other.
    #[inline]
    pub fn most(&self) -> usize {
        usize::from(self.data.most)
    }

    /// The members and their weights (no unit), sorted by weight.
    #[inline]
    pub fn members(&self) -> &'a [(Variable, f64)] {
        &self.data.members
    }
}

/// A variable of a model that is a function of others, for reading.
#[derive(Debug, Clone, Copy)]
pub struct FunctionRef<'a> {
    pub(super) variable: &'a VariableData,
    pub(super) data: &'a FunctionData,
}

impl<'a> FunctionRef<'a> {
    /// The variable.
    #[inline]
    pub fn result(&self) -> Variable {
        self.data.result
    }

    /// The variable's name.
    #[inline]
    pub fn name(&self) -> &'a Name {
        &self.variable.name
    }

    /// The function.
    #[inline]
    pub fn function(&self) -> &'a Function {
        &self.data.function
    }
}
