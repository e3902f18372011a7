//! The model itself: storage, look-up by handle and name, changes after the fact.

use std::collections::HashMap;

use super::affine::Affine;
use super::ids::{Constraint, Indicator, ModelTag, Variable};
use super::indicator::{BigM, Literal};
use super::name::Name;
use super::objective::Sense;
use super::quadratic::Quadratic;
use super::statement::{Statement, StoredRow, bounds, limits};
use super::variable::{Family, VariableKind};
use crate::error::Error;
use crate::interval::Interval;
use crate::tolerance;

/// A mixed-integer program with indicators; see the [module page](super).
///
/// A clone accepts the handles of its original.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Stored", into = "Stored"))]
pub struct Model {
    stored: Stored,
    variable_names: HashMap<Name, u32>,
    statement_names: HashMap<Name, StatementIndex>,
}

/// The part of a model that is written to files; the look-up tables are derived from it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Stored {
    name: String,
    tag: ModelTag,
    variables: Vec<VariableData>,
    constraints: Vec<ConstraintData>,
    indicators: Vec<IndicatorData>,
    sense: Sense,
    objective: Quadratic,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct VariableData {
    name: Name,
    kind: VariableKind,
    lower: f64,
    upper: f64,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct ConstraintData {
    name: Name,
    row: StoredRow,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct IndicatorData {
    name: Name,
    condition: Literal,
    row: StoredRow,
    big_m: BigM,
}

#[derive(Debug, Clone, Copy)]
enum StatementIndex {
    Constraint(u32),
    Indicator(u32),
}

impl From<Stored> for Model {
    fn from(stored: Stored) -> Self {
        let variable_names = (0u32..).zip(&stored.variables);
        let variable_names = variable_names.map(|(i, v)| (v.name.clone(), i)).collect();
        let constraints = (0u32..)
            .zip(&stored.constraints)
            .map(|(i, c)| (c.name.clone(), StatementIndex::Constraint(i)));
        let indicators = (0u32..)
            .zip(&stored.indicators)
            .map(|(i, c)| (c.name.clone(), StatementIndex::Indicator(i)));
        let statement_names = constraints.chain(indicators).collect();
        Model { stored, variable_names, statement_names }
    }
}

impl From<Model> for Stored {
    fn from(model: Model) -> Self {
        model.stored
    }
}

impl Model {
    /// An empty model: no variables, no rows, objective "minimise 0".
    pub fn new(name: impl Into<String>) -> Self {
        Model::from(Stored {
            name: name.into(),
            tag: ModelTag::fresh(),
            variables: Vec::new(),
            constraints: Vec::new(),
            indicators: Vec::new(),
            sense: Sense::Minimize,
            objective: Quadratic::zero(),
        })
    }

    /// The model's name.
    pub fn name(&self) -> &str {
        &self.stored.name
    }

    // -- variables ------------------------------------------------------------------------------

    /// Adds a continuous variable with bounds, either of which may be infinite.
    ///
    /// # Errors
    ///
    /// [`Error::DuplicateName`], [`Error::InvalidName`], [`Error::CrossedBounds`], and
    /// [`Error::NotFinite`] for NaN.
    pub fn continuous(
        &mut self,
        name: impl Into<Name>,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        self.variable(name, VariableKind::Continuous, lower, upper)
    }

    /// Adds a binary variable.
    ///
    /// # Errors
    ///
    /// [`Error::DuplicateName`] and [`Error::InvalidName`].
    pub fn binary(&mut self, name: impl Into<Name>) -> Result<Variable, Error> {
        self.variable(name, VariableKind::Binary, 0.0, 1.0)
    }

    /// Adds an integer variable with bounds, either of which may be infinite.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`].
    pub fn integer(
        &mut self,
        name: impl Into<Name>,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        self.variable(name, VariableKind::Integer, lower, upper)
    }

    /// Adds a variable of any kind; a binary's bounds must lie within `[0, 1]`.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`]; [`Error::OutOfRange`] for a binary outside `[0, 1]`.
    pub fn variable(
        &mut self,
        name: impl Into<Name>,
        kind: VariableKind,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        let name = name.into();
        name.check()?;
        let (lower, upper) = variable_bounds(&name, kind, lower, upper)?;
        let index = self.stored.variables.len();
        let variable = Variable::new(index, self.stored.tag);
        if self.variable_names.contains_key(&name) {
            return Err(Error::DuplicateName { name: name.to_string(), kind: "variable" });
        }
        self.variable_names.insert(name.clone(), variable.index);
        self.stored.variables.push(VariableData { name, kind, lower, upper });
        Ok(variable)
    }

    /// Adds continuous variables `name[0] .. name[count - 1]` with the same bounds.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`].
    pub fn continuous_family(
        &mut self,
        name: &str,
        count: usize,
        lower: f64,
        upper: f64,
    ) -> Result<Family, Error> {
        self.family(name, count, VariableKind::Continuous, lower, upper)
    }

    /// Adds binary variables `name[0] .. name[count - 1]`.
    ///
    /// # Errors
    ///
    /// As for [`Model::binary`].
    pub fn binary_family(&mut self, name: &str, count: usize) -> Result<Family, Error> {
        self.family(name, count, VariableKind::Binary, 0.0, 1.0)
    }

    /// Adds integer variables `name[0] .. name[count - 1]` with the same bounds.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`].
    pub fn integer_family(
        &mut self,
        name: &str,
        count: usize,
        lower: f64,
        upper: f64,
    ) -> Result<Family, Error> {
        self.family(name, count, VariableKind::Integer, lower, upper)
    }

    fn family(
        &mut self,
        name: &str,
        count: usize,
        kind: VariableKind,
        lower: f64,
        upper: f64,
    ) -> Result<Family, Error> {
        let member = |step| self.variable((name, step), kind, lower, upper);
        Ok(Family { members: (0..count).map(member).collect::<Result<_, _>>()? })
    }

    /// Number of variables.
    pub fn variable_count(&self) -> usize {
        self.stored.variables.len()
    }

    /// The variables in the order of creation.
    pub fn variables(&self) -> impl ExactSizeIterator<Item = VariableRef<'_>> {
        let data = self.stored.variables.iter().enumerate();
        data.map(|(i, data)| VariableRef { id: Variable::new(i, self.stored.tag), data })
    }

    /// Name, kind and bounds of a variable.
    ///
    /// # Errors
    ///
    /// [`Error::ForeignHandle`].
    pub fn variable_ref(&self, variable: Variable) -> Result<VariableRef<'_>, Error> {
        self.check_variable(variable, "a look-up")?;
        Ok(VariableRef { id: variable, data: &self.stored.variables[variable.index()] })
    }

    /// The variable of a name.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownName`].
    pub fn variable_by_name(&self, name: impl Into<Name>) -> Result<Variable, Error> {
        let name = name.into();
        match self.variable_names.get(&name) {
            Some(&index) => Ok(Variable { index, tag: self.stored.tag }),
            None => Err(Error::UnknownName { name: name.to_string(), kind: "variable" }),
        }
    }

    /// Changes the bounds of a variable. Automatic big-Ms follow at the next solve.
    ///
    /// # Errors
    ///
    /// [`Error::ForeignHandle`], [`Error::CrossedBounds`], [`Error::NotFinite`],
    /// [`Error::OutOfRange`] for a binary outside `[0, 1]`.
    pub fn set_bounds(&mut self, variable: Variable, lower: f64, upper: f64) -> Result<(), Error> {
        self.check_variable(variable, "set_bounds")?;
        let data = &mut self.stored.variables[variable.index()];
        (data.lower, data.upper) = variable_bounds(&data.name, data.kind, lower, upper)?;
        Ok(())
    }

    /// Fixes a variable to one value; [`set_bounds`](Model::set_bounds) frees it again.
    ///
    /// # Errors
    ///
    /// As for [`Model::set_bounds`].
    pub fn fix(&mut self, variable: Variable, value: f64) -> Result<(), Error> {
        self.set_bounds(variable, value, value)
    }

    // -- statements -----------------------------------------------------------------------------

    /// Adds a [`Row`](super::Row) (returns a [`Constraint`]) or an
    /// [`Implication`](super::Implication) (returns an [`Indicator`]).
    ///
    /// # Errors
    ///
    /// [`Error::DuplicateName`], [`Error::InvalidName`], [`Error::ForeignHandle`],
    /// [`Error::NotFinite`], [`Error::CrossedBounds`], [`Error::EmptyRow`],
    /// [`Error::UnlimitedRow`], [`Error::NotBinary`].
    pub fn add<S: Statement>(
        &mut self,
        name: impl Into<Name>,
        statement: S,
    ) -> Result<S::Handle, Error> {
        let name = name.into();
        name.check()?;
        statement.add_to(self, name)
    }

    /// Number of linear rows, indicators not counted.
    pub fn constraint_count(&self) -> usize {
        self.stored.constraints.len()
    }

    /// Number of indicators.
    pub fn indicator_count(&self) -> usize {
        self.stored.indicators.len()
    }

    /// The linear rows in the order of creation.
    pub fn constraints(&self) -> impl ExactSizeIterator<Item = ConstraintRef<'_>> {
        let data = self.stored.constraints.iter().enumerate();
        data.map(|(i, data)| ConstraintRef { id: Constraint::new(i, self.stored.tag), data })
    }

    /// The indicators in the order of creation.
    pub fn indicators(&self) -> impl ExactSizeIterator<Item = IndicatorRef<'_>> {
        let data = self.stored.indicators.iter().enumerate();
        data.map(|(i, data)| IndicatorRef { id: Indicator::new(i, self.stored.tag), data })
    }

    /// The linear row of a name.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownName`].
    pub fn constraint_by_name(&self, name: impl Into<Name>) -> Result<Constraint, Error> {
        let name = name.into();
        match self.statement_names.get(&name) {
            Some(&StatementIndex::Constraint(index)) => {
                Ok(Constraint { index, tag: self.stored.tag })
            }
            _ => Err(Error::UnknownName { name: name.to_string(), kind: "linear row" }),
        }
    }

    /// The indicator of a name.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownName`].
    pub fn indicator_by_name(&self, name: impl Into<Name>) -> Result<Indicator, Error> {
        let name = name.into();
        match self.statement_names.get(&name) {
            Some(&StatementIndex::Indicator(index)) => {
                Ok(Indicator { index, tag: self.stored.tag })
            }
            _ => Err(Error::UnknownName { name: name.to_string(), kind: "indicator" }),
        }
    }

    /// Changes the limits of a linear row. The limits apply to its terms without the constant,
    /// as the text form shows them.
    ///
    /// # Errors
    ///
    /// [`Error::ForeignHandle`], [`Error::CrossedBounds`], [`Error::NotFinite`],
    /// [`Error::UnlimitedRow`].
    pub fn set_limits(&mut self, row: Constraint, lower: f64, upper: f64) -> Result<(), Error> {
        if row.tag != self.stored.tag || row.index() >= self.stored.constraints.len() {
            return Err(foreign("constraint", row.index(), "set_limits"));
        }
        let data = &mut self.stored.constraints[row.index()];
        (data.row.lower, data.row.upper) = limits(lower, upper, &data.name)?;
        Ok(())
    }

    /// Changes the limits of an indicator's row.
    ///
    /// # Errors
    ///
    /// As for [`Model::set_limits`].
    pub fn set_indicator_limits(
        &mut self,
        indicator: Indicator,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        if indicator.tag != self.stored.tag || indicator.index() >= self.stored.indicators.len() {
            return Err(foreign("indicator", indicator.index(), "set_indicator_limits"));
        }
        let data = &mut self.stored.indicators[indicator.index()];
        (data.row.lower, data.row.upper) = limits(lower, upper, &data.name)?;
        Ok(())
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
    /// [`Error::ForeignHandle`].
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

    pub(crate) fn replace_objective(&mut self, sense: Sense, objective: Quadratic) {
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
        condition: Literal,
        row: StoredRow,
        big_m: BigM,
    ) -> Result<Indicator, Error> {
        let variable = self.variable_ref(condition.variable)?;
        if variable.kind() != VariableKind::Binary {
            return Err(Error::NotBinary {
                name: variable.name().to_string(),
                place: name.to_string(),
            });
        }
        if let BigM::Given(value) | BigM::Assumed(value) = big_m
            && !(value >= 0.0 && value < tolerance::INFINITE)
        {
            return Err(Error::OutOfRange {
                what: format!("the big-M of `{name}`"),
                value,
                range: "finite and not negative".into(),
            });
        }
        let id = Indicator::new(self.stored.indicators.len(), self.stored.tag);
        self.claim_statement(&name, StatementIndex::Indicator(id.index))?;
        self.stored.indicators.push(IndicatorData { name, condition, row, big_m });
        Ok(id)
    }

    /// The model without its indicators: what a reformulation adds its rows to. Variables,
    /// objective and rows stay, and so do their handles.
    pub(crate) fn without_indicators(&self) -> Model {
        let mut model = self.clone();
        for indicator in model.stored.indicators.drain(..) {
            model.statement_names.remove(&indicator.name);
        }
        model
    }

    fn claim_statement(&mut self, name: &Name, index: StatementIndex) -> Result<(), Error> {
        if self.statement_names.contains_key(name) {
            return Err(Error::DuplicateName { name: name.to_string(), kind: "statement" });
        }
        self.statement_names.insert(name.clone(), index);
        Ok(())
    }
}

fn foreign(kind: &'static str, index: usize, place: impl ToString) -> Error {
    Error::ForeignHandle { kind, index, place: place.to_string() }
}

fn variable_bounds(
    name: &Name,
    kind: VariableKind,
    lower: f64,
    upper: f64,
) -> Result<(f64, f64), Error> {
    let (lower, upper) = bounds(lower, upper, name)?;
    if kind == VariableKind::Binary && (lower < 0.0 || upper > 1.0) {
        return Err(Error::OutOfRange {
            what: format!("a bound of the binary `{name}`"),
            value: if lower < 0.0 { lower } else { upper },
            range: "within [0, 1]".into(),
        });
    }
    Ok((lower, upper))
}

/// A variable of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct VariableRef<'a> {
    id: Variable,
    data: &'a VariableData,
}

impl<'a> VariableRef<'a> {
    /// The handle.
    pub fn id(&self) -> Variable {
        self.id
    }

    /// The name.
    pub fn name(&self) -> &'a Name {
        &self.data.name
    }

    /// The kind.
    pub fn kind(&self) -> VariableKind {
        self.data.kind
    }

    /// Current bounds, in the variable's unit.
    pub fn bounds(&self) -> Interval {
        Interval::new(self.data.lower, self.data.upper)
    }
}

/// A linear row of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct ConstraintRef<'a> {
    id: Constraint,
    data: &'a ConstraintData,
}

impl<'a> ConstraintRef<'a> {
    /// The handle.
    pub fn id(&self) -> Constraint {
        self.id
    }

    /// The name.
    pub fn name(&self) -> &'a Name {
        &self.data.name
    }

    /// The terms, sorted by variable.
    pub fn terms(&self) -> &'a [(Variable, f64)] {
        &self.data.row.terms
    }

    /// The limits of the terms' sum.
    pub fn limits(&self) -> Interval {
        Interval::new(self.data.row.lower, self.data.row.upper)
    }
}

/// An indicator of a model, for reading.
#[derive(Debug, Clone, Copy)]
pub struct IndicatorRef<'a> {
    id: Indicator,
    data: &'a IndicatorData,
}

impl<'a> IndicatorRef<'a> {
    /// The handle.
    pub fn id(&self) -> Indicator {
        self.id
    }

    /// The name.
    pub fn name(&self) -> &'a Name {
        &self.data.name
    }

    /// The condition.
    pub fn condition(&self) -> Literal {
        self.data.condition
    }

    /// The terms of the implied row, sorted by variable.
    pub fn terms(&self) -> &'a [(Variable, f64)] {
        &self.data.row.terms
    }

    /// The limits of the implied row.
    pub fn limits(&self) -> Interval {
        Interval::new(self.data.row.lower, self.data.row.upper)
    }

    /// Where its big-M comes from.
    pub fn big_m(&self) -> BigM {
        self.data.big_m
    }
}
