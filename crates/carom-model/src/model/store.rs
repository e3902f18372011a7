//! The model itself: storage, look-up by handle and name, changes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::conic::StoredConic;
use super::function::Function;
use super::ids::{
    Constraint, Disjunction, LogicalConstraint, ModelTag, SpecialOrderedSet, Variable,
};
use super::logic::Logic;
use super::name::Name;
use super::name_table::NameTable;
use super::quadratic::Quadratic;
use super::reformulation::{BigM, Method, Reformulation};
use super::sense::Sense;
use super::stored::{StoredRow, StoredTerm};
use super::variable::VariableKind;
use crate::error::{Error, ErrorKind};

/// A mixed-integer program with indicators, disjunctions, logic and ordered sets; see the [module
/// page](super).
///
/// A clone accepts the handles of its original.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredModel", into = "StoredModel"))]
pub struct Model {
    pub(super) stored: StoredModel,
    pub(super) variable_names: NameTable<u32>,
    pub(super) statement_names: NameTable<StatementIndex>,
    /// Changes with every modification except values of parameters, and is never used twice.
    pub(super) revision: u64,
    /// Whether the objective is convex, or has a convex form, only as far as bounds tell.
    pub(super) is_convex_within_bounds: bool,
    /// The words with which new names begin, empty for most models.
    pub(super) scope: String,
    /// The names of the handles of each system that it describes, by their tag.
    pub(super) systems: Vec<(ModelTag, Arc<[String]>)>,
}

/// The part of a model that is written to files; the look-up tables are derived from it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StoredModel {
    pub(super) name: String,
    pub(super) tag: ModelTag,
    pub(super) variables: Vec<VariableData>,
    pub(super) constraints: Vec<ConstraintData>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) conic: Vec<ConicData>,
    pub(super) indicators: Vec<IndicatorData>,
    pub(super) logic: Vec<LogicalData>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) disjunctions: Vec<DisjunctionData>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) sets: Vec<SosData>,
    pub(super) functions: Vec<FunctionData>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) reformulation: Reformulation,
    pub(super) sense: Sense,
    pub(super) objective: Quadratic,
    /// Families of statements that explanations never question.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) background: BTreeSet<String>,
    /// By family, what its statements say, in words.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) words: BTreeMap<String, String>,
    /// Something that depends on the step of a loop.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) by_step: Option<String>,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct VariableData {
    pub(super) name: Name,
    pub(super) kind: VariableKind,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub(super) lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub(super) upper: f64,
    /// For a parameter, its declared range; its bounds are its value.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) range: Option<(f64, f64)>,
    /// For a semi-continuous variable, its values other than 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) semicontinuous: Option<SemicontinuousRange>,
    /// Whether an integer need not be whole.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "std::ops::Not::not"))]
    pub(super) relaxed: bool,
}

impl VariableData {
    /// Whether its values must be whole.
    pub(super) fn must_be_whole(&self) -> bool {
        self.kind.is_integral() && !self.relaxed
    }
}

/// The values of a semi-continuous variable other than 0.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SemicontinuousRange {
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub(super) lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub(super) upper: f64,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ConstraintData {
    pub(super) name: Name,
    pub(super) row: StoredRow,
}

/// A conic row, and the condition under which it must hold.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ConicData {
    pub(super) name: Name,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) condition: Option<Logic>,
    pub(super) conic: StoredConic,
    /// The M of the condition.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) big_m: BigM,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct IndicatorData {
    pub(super) name: Name,
    pub(super) condition: Logic,
    pub(super) row: StoredRow,
    pub(super) big_m: BigM,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct LogicalData {
    pub(super) name: Name,
    pub(super) logic: Logic,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct DisjunctionData {
    pub(super) name: Name,
    pub(super) method: Option<Method>,
    pub(super) terms: Vec<StoredTerm>,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SosData {
    pub(super) name: Name,
    /// How many members, next to each other, may be other than 0: 1 or 2.
    pub(super) most: u8,
    /// Sorted by weight.
    pub(super) members: Vec<(Variable, f64)>,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FunctionData {
    pub(super) result: Variable,
    pub(super) function: Function,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StatementKind {
    Constraint,
    Conic,
    Indicator,
    Logical,
    Disjunction,
    Set,
}

/// A statement: its kind, and its position among the statements of this kind.
pub(super) type StatementIndex = (StatementKind, u32);

impl Model {
    /// An empty model: no variables, no rows, objective "minimise 0".
    #[inline]
    pub fn new(name: impl Into<String>) -> Self {
        Model::empty(name.into(), ModelTag::fresh())
    }

    pub(super) fn empty(name: String, tag: ModelTag) -> Self {
        let stored = StoredModel {
            name,
            tag,
            variables: Vec::new(),
            constraints: Vec::new(),
            conic: Vec::new(),
            indicators: Vec::new(),
            logic: Vec::new(),
            disjunctions: Vec::new(),
            sets: Vec::new(),
            functions: Vec::new(),
            reformulation: Reformulation::default(),
            sense: Sense::Minimize,
            objective: Quadratic::zero(),
            background: BTreeSet::new(),
            words: BTreeMap::new(),
            by_step: None,
        };
        let (variable_names, statement_names) = (NameTable::default(), NameTable::default());
        Model {
            stored,
            variable_names,
            statement_names,
            revision: fresh_revision(),
            is_convex_within_bounds: false,
            scope: String::new(),
            systems: Vec::new(),
        }
    }

    /// The model's name.
    #[inline]
    pub fn name(&self) -> &str {
        &self.stored.name
    }

    // -- objective ------------------------------------------------------------------------------

    /// Direction of optimisation.
    #[inline]
    pub fn sense(&self) -> Sense {
        self.stored.sense
    }

    /// The objective expression.
    #[inline]
    pub fn objective(&self) -> &Quadratic {
        &self.stored.objective
    }

    /// How the model is to be lowered.
    #[inline]
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

    // -- inside the crate -----------------------------------------------------------------------

    #[doc(hidden)]
    #[inline]
    pub fn tag(&self) -> ModelTag {
        self.stored.tag
    }

    pub(crate) fn check_variable(
        &self,
        variable: Variable,
        place: impl ToString,
    ) -> Result<(), Error> {
        if variable.tag == self.stored.tag && variable.index() < self.stored.variables.len() {
            Ok(())
        } else {
            let known = self.systems.iter().find(|(tag, _)| *tag == variable.tag);
            let name = known.and_then(|(_, names)| names.get(variable.index())).cloned();
            let (kind, index, place) = ("variable", variable.index(), place.to_string());
            Err(ErrorKind::ForeignHandle { kind, index, place, name }.into())
        }
    }

    /// Lets errors name the handles of a system where they stand for variables of the model.
    #[doc(hidden)]
    pub fn name_handles(&mut self, tag: ModelTag, names: Vec<String>) {
        self.systems.push((tag, names.into()));
    }

    /// Whether it holds systems, whose units are chosen by their domains: bounds that sets have
    /// made narrow say nothing about them.
    #[doc(hidden)]
    #[inline]
    pub fn has_systems(&self) -> bool {
        !self.systems.is_empty()
    }

    /// Marks lowered forms of this model as out of date.
    #[doc(hidden)]
    pub fn touch(&mut self) {
        self.revision = fresh_revision();
    }

    /// Changes with every modification except values of parameters. A clone shares its original's
    /// until either is modified.
    #[doc(hidden)]
    #[inline]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn replace_objective(&mut self, sense: Sense, objective: Quadratic) {
        self.touch();
        self.stored.sense = sense;
        self.stored.objective = objective;
    }

    /// Replaces the expression of the objective by one that is proved to be convex.
    #[doc(hidden)]
    pub fn replace_convex_objective(&mut self, objective: Quadratic) {
        self.replace_objective(self.stored.sense, objective);
        self.is_convex_within_bounds = false;
    }

    #[doc(hidden)]
    pub fn push_constraint(&mut self, name: Name, row: StoredRow) -> Result<Constraint, Error> {
        let id = Constraint::new(self.stored.constraints.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Constraint, id.index))?;
        self.stored.constraints.push(ConstraintData { name, row });
        Ok(id)
    }

    #[doc(hidden)]
    pub fn push_logical(&mut self, name: Name, logic: Logic) -> Result<LogicalConstraint, Error> {
        let id = LogicalConstraint::new(self.stored.logic.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Logical, id.index))?;
        self.stored.logic.push(LogicalData { name, logic });
        Ok(id)
    }

    #[doc(hidden)]
    pub fn push_disjunction(
        &mut self,
        name: Name,
        method: Option<Method>,
        terms: Vec<StoredTerm>,
    ) -> Result<Disjunction, Error> {
        let id = Disjunction::new(self.stored.disjunctions.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Disjunction, id.index))?;
        self.stored.disjunctions.push(DisjunctionData { name, method, terms });
        Ok(id)
    }

    pub(super) fn push_set(
        &mut self,
        name: Name,
        most: u8,
        members: Vec<(Variable, f64)>,
    ) -> Result<SpecialOrderedSet, Error> {
        let id = SpecialOrderedSet::new(self.stored.sets.len(), self.stored.tag);
        self.claim_statement(&name, (StatementKind::Set, id.index))?;
        self.stored.sets.push(SosData { name, most, members });
        Ok(id)
    }

    /// Whether the objective is convex only as far as the bounds of a solve tell.
    #[doc(hidden)]
    #[inline]
    pub fn is_convex_within_bounds(&self) -> bool {
        self.is_convex_within_bounds
    }

    /// Whether there is nothing to reformulate: rows only, and conic rows without a condition.
    #[doc(hidden)]
    pub fn has_only_rows(&self) -> bool {
        let StoredModel { variables, indicators, disjunctions, logic, functions, sets, .. } =
            &self.stored;
        let semicontinuous = variables.iter().any(|data| data.semicontinuous.is_some());
        indicators.len() + disjunctions.len() + logic.len() + functions.len() + sets.len() == 0
            && !semicontinuous
            && self.stored.conic.iter().all(|data| data.condition.is_none())
    }

    /// The model with only its variables, objective and rows, to which a reformulation adds. Their
    /// handles stay valid. Semi-continuous variables may take all values within their bounds.
    #[doc(hidden)]
    pub fn with_rows_only(&self) -> Model {
        let mut stored = StoredModel {
            variables: self.stored.variables.clone(),
            constraints: self.stored.constraints.clone(),
            objective: self.stored.objective.clone(),
            sense: self.stored.sense,
            reformulation: self.stored.reformulation,
            ..Model::empty(self.stored.name.clone(), self.stored.tag).stored
        };
        stored.variables.iter_mut().for_each(|data| data.semicontinuous = None);
        let mut statement_names = NameTable::default();
        for (row, k) in stored.constraints.iter().zip(0..) {
            statement_names.claim(&row.name, (StatementKind::Constraint, k));
        }
        let variable_names = self.variable_names.clone();
        Model {
            stored,
            variable_names,
            statement_names,
            revision: fresh_revision(),
            is_convex_within_bounds: self.is_convex_within_bounds,
            scope: String::new(),
            systems: Vec::new(),
        }
    }

    /// Makes several additions, or none if one of them fails.
    #[doc(hidden)]
    pub fn all_or_nothing<T>(
        &mut self,
        add: impl FnOnce(&mut Model) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let stored = &self.stored;
        let (variables, rows) = (stored.variables.len(), stored.constraints.len());
        let (indicators, logic) = (stored.indicators.len(), stored.logic.len());
        let conic = stored.conic.len();
        let (disjunctions, sets) = (stored.disjunctions.len(), stored.sets.len());
        let functions = stored.functions.len();
        let result = add(self);
        if result.is_err() {
            let Model { stored, variable_names, statement_names, .. } = self;
            stored.functions.truncate(functions);
            for data in stored.variables.drain(variables..) {
                variable_names.remove(&data.name);
            }
            let rows = stored.constraints.drain(rows..).map(|data| data.name);
            let indicators = stored.indicators.drain(indicators..).map(|data| data.name);
            let logic = stored.logic.drain(logic..).map(|data| data.name);
            let disjunctions = stored.disjunctions.drain(disjunctions..).map(|data| data.name);
            let sets = stored.sets.drain(sets..).map(|data| data.name);
            let conic = stored.conic.drain(conic..).map(|data| data.name);
            let rows = rows.chain(conic);
            for name in rows.chain(indicators).chain(logic).chain(disjunctions).chain(sets) {
                statement_names.remove(&name);
            }
        }
        result
    }

    /// Lets all new names begin with a word, which says what they are of; none if it is empty.
    #[doc(hidden)]
    pub fn set_scope(&mut self, word: &str) {
        self.scope = word.to_owned();
    }

    /// The name that the model gives to what is to be called so.
    #[inline]
    pub(super) fn scoped(&self, name: Name) -> Name {
        if self.scope.is_empty() { name } else { name.prefixed(&self.scope) }
    }

    #[doc(hidden)]
    pub fn has_statement(&self, name: &Name) -> bool {
        match self.scope.is_empty() {
            true => self.statement_names.get(name).is_some(),
            false => self.statement_names.get(&name.prefixed(&self.scope)).is_some(),
        }
    }

    pub(super) fn claim_statement(
        &mut self,
        name: &Name,
        index: StatementIndex,
    ) -> Result<(), Error> {
        if !self.statement_names.claim(name, index) {
            return Err(
                ErrorKind::DuplicateName { name: name.to_string(), kind: "statement" }.into()
            );
        }
        self.touch();
        Ok(())
    }
}

fn fresh_revision() -> u64 {
    static REVISIONS: AtomicU64 = AtomicU64::new(0);
    REVISIONS.fetch_add(1, Ordering::Relaxed)
}

#[inline]
pub(super) fn foreign(kind: &'static str, index: usize, place: impl ToString) -> Error {
    Error::from(ErrorKind::ForeignHandle { kind, index, place: place.to_string(), name: None })
}
