//! Handles, expressions and rows, with Python's operators.

use carom::hybrid::{Input, State, SystemRow};
use carom::model::{self, Affine, Quadratic, Variable};
use pyo3::basic::CompareOp;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// The value of an expression.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Affine(Affine),
    Quadratic(Quadratic),
}

/// What a handle stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Handle {
    State(State),
    Input(Input),
    Other(Variable),
}

impl Handle {
    pub(crate) fn variable(self) -> Variable {
        match self {
            Handle::State(state) => state.into(),
            Handle::Input(input) => input.into(),
            Handle::Other(variable) => variable,
        }
    }
}

/// An expression of handles; a handle itself is one.
#[pyclass(frozen, module = "carom._carom")]
#[derive(Debug, Clone)]
pub(crate) struct Expression {
    value: Value,
    handle: Option<(Handle, String)>,
}

/// An expression or a number.
#[derive(Debug, Clone)]
pub(crate) struct Operand(pub(crate) Value);

impl<'a, 'py> FromPyObject<'a, 'py> for Operand {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(expression) = object.cast::<Expression>() {
            return Ok(Operand(expression.get().value.clone()));
        }
        let number: f64 = object.extract()?;
        Ok(Operand(Value::Affine(Affine::constant(number))))
    }
}

impl Operand {
    /// The expression, if it is affine.
    pub(crate) fn affine(self) -> PyResult<Affine> {
        match self.0 {
            Value::Affine(affine) => Ok(affine),
            Value::Quadratic(_) => Err(PyValueError::new_err(
                "a product of handles where an affine expression is needed; squares can be costs, \
                 and rows such as `x**2 + y**2 <= 4`",
            )),
        }
    }

    pub(crate) fn quadratic(self) -> Quadratic {
        match self.0 {
            Value::Affine(affine) => affine.into(),
            Value::Quadratic(quadratic) => quadratic,
        }
    }
}

impl Expression {
    pub(crate) fn of(handle: Handle, name: &str) -> Self {
        let value = Value::Affine(handle.variable().into());
        Expression { value, handle: Some((handle, name.to_owned())) }
    }

    pub(crate) fn affine(value: Affine) -> Self {
        Expression { value: Value::Affine(value), handle: None }
    }

    pub(crate) fn quadratic(value: Quadratic) -> Self {
        Expression { value: Value::Quadratic(value), handle: None }
    }

    /// The handle; an error for any other expression.
    pub(crate) fn handle(&self) -> PyResult<Handle> {
        self.handle.as_ref().map(|(handle, _)| *handle).ok_or_else(|| {
            PyTypeError::new_err(
                "an expression where a handle is needed, such as a state or a mode",
            )
        })
    }

    /// The state; an error for any other handle.
    pub(crate) fn state(&self) -> PyResult<State> {
        match self.handle()? {
            Handle::State(state) => Ok(state),
            _ => Err(PyTypeError::new_err(format!("{} is no state", self.__repr__()))),
        }
    }

    fn sum(&self, other: Operand, sign: f64) -> Expression {
        match (self.value.clone(), other.0) {
            (Value::Affine(a), Value::Affine(b)) => Expression::affine(a + sign * b),
            (a, b) => {
                let [a, b] = [Operand(a), Operand(b)].map(Operand::quadratic);
                Expression::quadratic(a + sign * b)
            }
        }
    }

    fn times(&self, factor: f64) -> Expression {
        match self.value.clone() {
            Value::Affine(affine) => Expression::affine(factor * affine),
            Value::Quadratic(quadratic) => Expression::quadratic(factor * quadratic),
        }
    }

    fn product(&self, other: Operand) -> PyResult<Expression> {
        let constant = |value: &Value| match value {
            Value::Affine(affine) if affine.terms().is_empty() => Some(affine.offset()),
            _ => None,
        };
        if let Some(factor) = constant(&other.0) {
            return Ok(self.times(factor));
        }
        if let Some(factor) = constant(&self.value) {
            return Ok(Expression { value: other.0, handle: None }.times(factor));
        }
        match (self.value.clone(), other.0) {
            (Value::Affine(a), Value::Affine(b)) => Ok(Expression::quadratic(a * b)),
            _ => Err(PyValueError::new_err("a product of more than two handles")),
        }
    }
}

#[pymethods]
impl Expression {
    fn __add__(&self, other: Operand) -> Expression {
        self.sum(other, 1.0)
    }

    fn __radd__(&self, other: Operand) -> Expression {
        self.sum(other, 1.0)
    }

    fn __sub__(&self, other: Operand) -> Expression {
        self.sum(other, -1.0)
    }

    fn __rsub__(&self, other: Operand) -> Expression {
        self.times(-1.0).sum(other, 1.0)
    }

    fn __neg__(&self) -> Expression {
        self.times(-1.0)
    }

    fn __mul__(&self, other: Operand) -> PyResult<Expression> {
        self.product(other)
    }

    fn __rmul__(&self, other: Operand) -> PyResult<Expression> {
        self.product(other)
    }

    fn __truediv__(&self, divisor: f64) -> PyResult<Expression> {
        match divisor == 0.0 {
            true => Err(PyValueError::new_err("an expression divided by 0")),
            false => Ok(self.times(1.0 / divisor)),
        }
    }

    fn __pow__(&self, exponent: f64, _modulus: Option<f64>) -> PyResult<Expression> {
        match exponent == 2.0 {
            true => self.product(Operand(self.value.clone())),
            false => Err(PyValueError::new_err(format!(
                "an expression to the power {exponent}; only squares are possible"
            ))),
        }
    }

    fn __richcmp__(&self, other: Operand, op: CompareOp) -> PyResult<Row> {
        let (left, right) = (self.value.clone(), other.0);
        let row = match (left, right) {
            (Value::Affine(a), Value::Affine(b)) => SystemRow::from(match op {
                CompareOp::Le => a.le(b),
                CompareOp::Ge => a.ge(b),
                CompareOp::Eq => a.equals(b),
                _ => return Err(strict()),
            }),
            (a, b) => {
                let [a, b] = [Operand(a), Operand(b)].map(Operand::quadratic);
                SystemRow::from(match op {
                    CompareOp::Le => a.le(b),
                    CompareOp::Ge => a.ge(b),
                    CompareOp::Eq => a.equals(b),
                    _ => return Err(strict()),
                })
            }
        };
        Ok(Row { row })
    }

    /// The row that the expression is from a lower to an upper limit.
    fn within(&self, lower: f64, upper: f64) -> Row {
        let row = match &self.value {
            Value::Affine(affine) => affine.within(lower, upper).into(),
            Value::Quadratic(quadratic) => quadratic.within(lower, upper).into(),
        };
        Row { row }
    }

    /// The state at the end of the step, as the flow predicts it, before a reset.
    fn predicted(&self) -> PyResult<Expression> {
        let state = self.state()?;
        let name = self.handle.as_ref().map_or("", |(_, name)| name);
        Ok(Expression::of(Handle::Other(state.predicted()), &format!("{name} predicted")))
    }

    fn __hash__(&self) -> isize {
        match &self.handle {
            Some((handle, _)) => isize::try_from(handle.variable().index()).unwrap_or(0),
            None => std::ptr::from_ref(self).addr() as isize,
        }
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err("an expression has no truth value"))
    }

    fn __repr__(&self) -> String {
        match &self.handle {
            Some((_, name)) => name.clone(),
            None => "<an expression of handles>".to_owned(),
        }
    }
}

fn strict() -> PyErr {
    PyTypeError::new_err("rows are closed: write <=, >= or ==")
}

/// A row of handles: a comparison.
#[pyclass(frozen, module = "carom._carom")]
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub(crate) row: SystemRow,
}

#[pymethods]
impl Row {
    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err(
            "a row has no truth value; write `x.within(0, 1)` for `0 <= x <= 1`",
        ))
    }
}

/// The rows of Python objects.
pub(crate) fn rows(given: &[PyRef<'_, Row>]) -> Vec<SystemRow> {
    given.iter().map(|row| row.row.clone()).collect()
}

/// The length of a vector of expressions.
#[pyclass(frozen, module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct Norm {
    entries: Vec<Affine>,
}

/// The Euclidean length of a vector of expressions, which can be at most something.
#[pyfunction]
pub(crate) fn norm(entries: Vec<Operand>) -> PyResult<Norm> {
    let entries = entries.into_iter().map(Operand::affine).collect::<PyResult<_>>()?;
    Ok(Norm { entries })
}

#[pymethods]
impl Norm {
    fn __richcmp__(&self, other: Operand, op: CompareOp) -> PyResult<Row> {
        let norm = model::norm(self.entries.iter().cloned());
        match op {
            CompareOp::Le => Ok(Row { row: norm.le(other.affine()?).into() }),
            _ => Err(PyTypeError::new_err("a norm can be at most something: write <=")),
        }
    }
}
