//! The model itself: storage, look-up by handle and name, changes.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};

use super::affine::Affine;
use super::disjunction::StoredTerm;
use super::function::Function;
use super::ids::{Constraint, Disjunction, Indicator, LogicalConstraint, ModelTag, Variable};
use super::indicator::BigM;
use super::logic::Logic;
use super::name::Name;
use super::name_table::NameTable;
use super::objective::Sense;
use super::quadratic::Quadratic;
use super::reformulation::{Method, Reformulation};
use super::statement::StoredRow;
use super::variable::VariableKind;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::tolerance;

/// A mixed-integer program with indicators, disjunctions and logic; see the [module page](super).
///
/// A clone accepts the handles of its original.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Stored", into = "Stored"))]
pub struct Model {
    pub(super) stored: Stored,
    pub(super) variable_names: NameTable<u32>,
    pub(super) statement_names: NameTable<StatementIndex>,
    /// Changes with every modification except values of parameters, and is never used twice.
    pub(super) revision: u64,
}

/// The part of a model that is written to files; the look-up tables are derived from it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Stored {
    pub(super) name: String,
    pub(super) tag: ModelTag,
    pub(super) variables: Vec<VariableData>,
    pub(super) constraints: Vec<ConstraintData>,
    pub(super) indicators: Vec<IndicatorData>,
    pub(super) logic: Vec<LogicalData>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) disjunctions: Vec<DisjunctionData>,
    pub(super) functions: Vec<FunctionData>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) reformulation: Reformulation,
    pub(super) sense: Sense,
    pub(super) objective: Quadratic,
    /// Families of statements that explanations never question.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) background: BTreeSet<String>,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct VariableData {
    pub(super) name: Name,
    pub(super) kind: VariableKind,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub(super) lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub(super) upper: f64,
    /// For a parameter, its declared range; its bounds are its value.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) range: Option<(f64, f64)>,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ConstraintData {
    pub(super) name: Name,
    pub(super) row: StoredRow,
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
pub(super) struct FunctionData {
    pub(super) result: Variable,
    pub(super) function: Function,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum StatementIndex {
    Constraint(u32),
    Indicator(u32),
    Logical(u32),
    Disjunction(u32),
}

/// A model from a file is checked like one that is written by hand.
#[cfg(feature = "serde")]
impl TryFrom<Stored> for Model {
    type Error = Error;

    fn try_from(stored: Stored) -> Result<Self, Error> {
        let mut model = Model::empty(stored.name, stored.tag);
        for VariableData { name, kind, lower, upper, range } in stored.variables {
            match range {
                Some(range) => model.push_stored_parameter(name, kind, (lower, upper), range)?,
                None => model.variable(name, kind, lower, upper)?,
            };
        }
        for ConstraintData { name, row } in stored.constraints {
            let row = row.checked(&model, &name)?;
            model.push_constraint(name, row)?;
        }
        for IndicatorData { name, condition, row, big_m } in stored.indicators {
            let row = row.checked(&model, &name)?;
            model.push_indicator(name, condition, row, big_m)?;
        }
        for LogicalData { name, logic } in stored.logic {
            model.add(name, logic)?;
        }
        for DisjunctionData { name, method, terms } in stored.disjunctions {
            let terms = super::disjunction::checked(terms, &model, &name, 1)?;
            model.push_disjunction(name, method, terms)?;
        }
        model.set_reformulation(stored.reformulation);
        for FunctionData { result, function } in stored.functions {
            model.push_stored_function(result, function)?;
        }
        model.set_objective(stored.sense, stored.objective)?;
        for family in stored.background {
            model.set_background(&family)?;
        }
        Ok(model)
    }
}

#[cfg(feature = "serde")]
impl From<Model> for Stored {
    fn from(model: Model) -> Self {
        model.stored
    }
}

impl Model {
    /// An empty model: no variables, no rows, objective "minimise 0".
    pub fn new(name: impl Into<String>) -> Self {
        Model::empty(name.into(), ModelTag::fresh())
    }

    pub(super) fn empty(name: String, tag: ModelTag) -> Self {
        let stored = Stored {
            name,
            tag,
            variables: Vec::new(),
            constraints: Vec::new(),
            indicators: Vec::new(),
            logic: Vec::new(),
            disjunctions: Vec::new(),
            functions: Vec::new(),
            reformulation: Reformulation::default(),
            sense: Sense::Minimize,
            objective: Quadratic::zero(),
            background: BTreeSet::new(),
        };
        let (variable_names, statement_names) = (NameTable::new(), NameTable::new());
        Model { stored, variable_names, statement_names, revision: fresh_revision() }
    }

    /// The model's name.
    pub fn name(&self) -> &str {
        &self.stored.name
    }

    // -- objective ------------------------------------------------------------------------------

    /// Direction of optimisation.
    pub fn sense(&self) -> Sense {
        self.stored.sense
    }

    /// The objective expression.
    pub fn objective(&self) -> &Quadratic {
        &self.stored.objective
    }

    // -- expressions over this model ------------------------------------------------------------

    /// Range of an affine expression over the current bounds, rounded outward.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn range(&self, expression: &Affine) -> Result<Interval, Error> {
        let mut range = Interval::point(expression.offset());
        for (variable, coefficient) in expression.terms() {
            range = range + self.variable_ref(variable)?.bounds() * coefficient;
        }
        Ok(range)
    }

    // -- inside the crate -----------------------------------------------------------------------

    pub(crate) fn tag(&self) -> ModelTag {
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
            Err(foreign("variable", variable.index(), place))
        }
    }

    /// Marks lowered forms of this model as out of date.
    pub(crate) fn touch(&mut self) {
        self.revision = fresh_revision();
    }

    /// Changes with every modification except values of parameters. A clone shares its original's
    /// until either is modified.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn replace_objective(&mut self, sense: Sense, objective: Quadratic) {
        self.touch();
        self.stored.sense = sense;
        self.stored.objective = objective;
    }

    pub(crate) fn push_constraint(
        &mut self,
        name: Name,
        row: StoredRow,
    ) -> Result<Constraint, Error> {
        let id = Constraint::new(self.stored.constraints.len(), self.stored.tag);
        self.claim_statement(&name, StatementIndex::Constraint(id.index))?;
        self.stored.constraints.push(ConstraintData { name, row });
        Ok(id)
    }

    pub(crate) fn push_indicator(
        &mut self,
        name: Name,
        condition: impl Into<Logic>,
        row: StoredRow,
        big_m: BigM,
    ) -> Result<Indicator, Error> {
        let condition = condition.into();
        condition.check(self, &name)?;
        if let BigM::Given(value) | BigM::Assumed(value) = big_m
            && !(0.0..tolerance::INFINITE).contains(&value)
        {
            return Err(ErrorKind::OutOfRange {
                what: format!("the big-M of `{name}`"),
                value,
                range: "finite and not negative".into(),
            }
            .into());
        }
        let id = Indicator::new(self.stored.indicators.len(), self.stored.tag);
        self.claim_statement(&name, StatementIndex::Indicator(id.index))?;
        self.stored.indicators.push(IndicatorData { name, condition, row, big_m });
        Ok(id)
    }

    pub(crate) fn push_logical(
        &mut self,
        name: Name,
        logic: Logic,
    ) -> Result<LogicalConstraint, Error> {
        let id = LogicalConstraint::new(self.stored.logic.len(), self.stored.tag);
        self.claim_statement(&name, StatementIndex::Logical(id.index))?;
        self.stored.logic.push(LogicalData { name, logic });
        Ok(id)
    }

    pub(crate) fn push_disjunction(
        &mut self,
        name: Name,
        method: Option<Method>,
        terms: Vec<StoredTerm>,
    ) -> Result<Disjunction, Error> {
        let id = Disjunction::new(self.stored.disjunctions.len(), self.stored.tag);
        self.claim_statement(&name, StatementIndex::Disjunction(id.index))?;
        self.stored.disjunctions.push(DisjunctionData { name, method, terms });
        Ok(id)
    }

    /// The model with only its variables, objective and rows, to which a reformulation adds. Their
    /// handles stay valid.
    pub(crate) fn with_rows_only(&self) -> Model {
        let stored = Stored {
            variables: self.stored.variables.clone(),
            constraints: self.stored.constraints.clone(),
            objective: self.stored.objective.clone(),
            sense: self.stored.sense,
            reformulation: self.stored.reformulation,
            ..Model::empty(self.stored.name.clone(), self.stored.tag).stored
        };
        let mut statement_names = NameTable::new();
        for (row, k) in stored.constraints.iter().zip(0..) {
            statement_names.claim(&row.name, StatementIndex::Constraint(k));
        }
        let variable_names = self.variable_names.clone();
        Model { stored, variable_names, statement_names, revision: fresh_revision() }
    }

    /// The model with every variable continuous. If it has only rows, this is its relaxation.
    pub(crate) fn with_integrality_relaxed(&self) -> Model {
        let mut model = self.clone();
        model.stored.variables.iter_mut().for_each(|data| data.kind = VariableKind::Continuous);
        model.touch();
        model
    }

    /// Makes several additions, or none if one of them fails.
    pub(super) fn all_or_nothing<T>(
        &mut self,
        add: impl FnOnce(&mut Model) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let stored = &self.stored;
        let (variables, rows) = (stored.variables.len(), stored.constraints.len());
        let (indicators, logic) = (stored.indicators.len(), stored.logic.len());
        let disjunctions = stored.disjunctions.len();
        let result = add(self);
        if result.is_err() {
            let Model { stored, variable_names, statement_names, .. } = self;
            for data in stored.variables.drain(variables..) {
                variable_names.remove(&data.name);
            }
            let rows = stored.constraints.drain(rows..).map(|data| data.name);
            let indicators = stored.indicators.drain(indicators..).map(|data| data.name);
            let logic = stored.logic.drain(logic..).map(|data| data.name);
            let disjunctions = stored.disjunctions.drain(disjunctions..).map(|data| data.name);
            for name in rows.chain(indicators).chain(logic).chain(disjunctions) {
                statement_names.remove(&name);
            }
        }
        result
    }

    /// Whether a statement has this name.
    pub(crate) fn has_statement(&self, name: &Name) -> bool {
        self.statement_names.get(name).is_some()
    }

    fn claim_statement(&mut self, name: &Name, index: StatementIndex) -> Result<(), Error> {
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
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    COUNTER.fetch_add(1, Ordering::Relaxed)
}

pub(super) fn foreign(kind: &'static str, index: usize, place: impl ToString) -> Error {
    Error::from(ErrorKind::ForeignHandle { kind, index, place: place.to_string() })
}
