//! The model of arrays, and where its parts are in them.

use carom::Error;
use carom::model::{Affine, Constraint, Model, Quadratic, Variable, VariableKind, norm};

use crate::arrays::{Arrays, Ranges, Sparse};
use crate::numbers::Floats;

/// Where the columns and rows of the arrays are in a model. Names begin with `row`, `cone`, `lb` or
/// `ub` and a number, see [`Layout::statement`].
#[derive(Debug, Default)]
pub(crate) struct Layout {
    /// The columns; the model may have more variables, after these.
    pub(crate) variables: Vec<Variable>,
    /// The rows; one whose limits are parameters may be two of the model's, one that holds for all
    /// points is none.
    pub(crate) rows: Vec<[Option<Constraint>; 2]>,
    /// Rows of the model that are bounds of columns.
    pub(crate) bounds: Vec<(usize, Constraint)>,
    /// Whether the model was read from a file, and has names of its own.
    pub(crate) is_read: bool,
}

/// A part of the arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Row(usize),
    Cone(usize),
    Bound(usize),
}

/// An array whose numbers may be parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    RowLower,
    RowUpper,
    /// The two limits of an equation.
    RowBoth,
    Lower,
    Upper,
}

/// A number of the arrays that is a parameter of the model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parameter {
    pub(crate) side: Side,
    pub(crate) index: usize,
    pub(crate) variable: Variable,
    pub(crate) range: (f64, f64),
}

/// A model with parameters.
pub(crate) struct Built {
    pub(crate) model: Model,
    pub(crate) layout: Layout,
    pub(crate) parameters: Vec<Parameter>,
}

impl Layout {
    /// The layout of a model from a file: all its variables and linear rows.
    pub(crate) fn of(model: &Model) -> Self {
        Layout {
            variables: model.variables().map(|variable| variable.id()).collect(),
            rows: model.constraints().map(|row| [Some(row.id()), None]).collect(),
            bounds: Vec::new(),
            is_read: true,
        }
    }

    /// The part of the arrays that a statement of the model stands for.
    pub(crate) fn statement(&self, name: &str) -> Option<Part> {
        let number = |prefix| {
            let rest: &str = name.strip_prefix(prefix)?;
            rest.split('_').next()?.parse::<usize>().ok()
        };
        let cone = || number("cone").map(Part::Cone);
        let bound = || number("lb").or_else(|| number("ub")).map(Part::Bound);
        let part = || number("row").map(Part::Row).or_else(cone).or_else(bound);
        if self.is_read { None } else { part() }
    }
}

/// The model of arrays.
pub(crate) fn build(arrays: &Arrays, ranges: &Ranges) -> Result<Built, Error> {
    let model = Model::new("carom");
    let mut built = Built { model, layout: Layout::default(), parameters: Vec::new() };
    built.add_columns(arrays, ranges)?;
    let Floats(q) = &arrays.q;
    let costs = objective(arrays.squares.as_ref(), q, arrays.offset, &built.layout.variables);
    built.model.minimize(costs)?;
    if let Some(matrix) = &arrays.matrix {
        for (row, terms) in matrix.rows().enumerate() {
            let sum = affine(terms, 0.0, &built.layout.variables);
            built.add_row(row, &sum, arrays, ranges)?;
        }
    }
    built.add_cones(arrays)?;
    Ok(built)
}

/// `x'Px/2 + q'x + offset`.
fn objective(
    squares: Option<&Sparse>,
    q: &[f64],
    offset: f64,
    variables: &[Variable],
) -> Quadratic {
    let terms = q.iter().copied().enumerate();
    let mut sum = Quadratic::from(affine(terms, offset, variables));
    if let Some(squares) = squares {
        for (row, entries) in squares.rows().enumerate() {
            for (column, value) in entries {
                sum.add_product(0.5 * value, variables[row], variables[column]);
            }
        }
    }
    sum
}

/// An affine expression of columns.
pub(crate) fn affine(
    terms: impl Iterator<Item = (usize, f64)>,
    constant: f64,
    variables: &[Variable],
) -> Affine {
    let mut sum = Affine::constant(constant);
    terms.filter(|term| term.1 != 0.0).for_each(|(j, a)| sum.add_term(a, variables[j]));
    sum
}

/// The range of one number, if it may change.
fn range(of: Option<&(Floats, Floats)>, index: usize) -> Option<(f64, f64)> {
    let (Floats(low), Floats(high)) = of?;
    Some((*low.get(index)?, *high.get(index)?)).filter(|(low, high)| low != high)
}

impl Built {
    /// Adds a parameter, with a value in its range.
    fn parameter(
        &mut self,
        side: Side,
        index: usize,
        value: f64,
        range: (f64, f64),
    ) -> Result<Variable, Error> {
        let word = match side {
            Side::RowLower => "l",
            Side::RowUpper | Side::RowBoth => "u",
            Side::Lower => "lb",
            Side::Upper => "ub",
        };
        let (low, high) = range;
        let variable = self.model.parameter(format!("{word}_{index}"), value, low, high)?;
        self.parameters.push(Parameter { side, index, variable, range });
        Ok(variable)
    }

    fn add_columns(&mut self, arrays: &Arrays, ranges: &Ranges) -> Result<(), Error> {
        let (Floats(lower), Floats(upper)) = (&arrays.lb, &arrays.ub);
        for (j, integrality) in arrays.integrality.0.iter().enumerate() {
            let low = range(ranges.lb.as_ref(), j);
            let high = range(ranges.ub.as_ref(), j);
            let least = low.map_or(lower[j], |range| range.0);
            let most = high.map_or(upper[j], |range| range.1);
            let kind = match integrality {
                0 => VariableKind::Continuous,
                _ if least >= 0.0 && most <= 1.0 => VariableKind::Binary,
                _ => VariableKind::Integer,
            };
            let name = arrays.names.as_ref().and_then(|names| names.get(j).cloned());
            let name = name.unwrap_or_else(|| format!("x{j}"));
            let x = self.model.variable(name, kind, least, most)?;
            self.layout.variables.push(x);
        }
        for j in 0..self.layout.variables.len() {
            let x = self.layout.variables[j];
            if let Some(range) = range(ranges.lb.as_ref(), j) {
                let bound = self.parameter(Side::Lower, j, lower[j], range)?;
                let row = self.model.add(format!("lb{j}"), (x - bound).ge(0.0))?;
                self.layout.bounds.push((j, row));
            }
            if let Some(range) = range(ranges.ub.as_ref(), j) {
                let bound = self.parameter(Side::Upper, j, upper[j], range)?;
                let row = self.model.add(format!("ub{j}"), (x - bound).le(0.0))?;
                self.layout.bounds.push((j, row));
            }
        }
        Ok(())
    }

    fn add_row(
        &mut self,
        row: usize,
        sum: &Affine,
        arrays: &Arrays,
        ranges: &Ranges,
    ) -> Result<(), Error> {
        let (lower, upper) = (arrays.l.0[row], arrays.u.0[row]);
        let low = range(ranges.l.as_ref(), row);
        let high = range(ranges.u.as_ref(), row);
        let name = format!("row{row}");
        let rows = match (low, high) {
            (None, None) => [self.add_plain_row(&name, sum, lower, upper)?, None],
            (Some(low), Some(high)) if low == high && lower == upper => {
                let side = self.parameter(Side::RowBoth, row, upper, low)?;
                [Some(self.model.add(name, sum.equals(side))?), None]
            }
            (low, high) => {
                let from = match low {
                    Some(range) => {
                        let side = self.parameter(Side::RowLower, row, lower, range)?;
                        Some(self.model.add(format!("{name}_lower"), sum.ge(side))?)
                    }
                    None => {
                        self.add_plain_row(&format!("{name}_lower"), sum, lower, f64::INFINITY)?
                    }
                };
                let to = match high {
                    Some(range) => {
                        let side = self.parameter(Side::RowUpper, row, upper, range)?;
                        Some(self.model.add(format!("{name}_upper"), sum.le(side))?)
                    }
                    None => {
                        self.add_plain_row(&format!("{name}_upper"), sum, f64::NEG_INFINITY, upper)?
                    }
                };
                [from, to]
            }
        };
        self.layout.rows.push(rows);
        Ok(())
    }

    /// Adds a row, unless it holds for all points. One that holds for none gets a variable that is
    /// 0, because models have no rows without variables.
    fn add_plain_row(
        &mut self,
        name: &str,
        sum: &Affine,
        lower: f64,
        upper: f64,
    ) -> Result<Option<Constraint>, Error> {
        let is_empty = sum.terms().is_empty();
        let holds = lower <= sum.offset() && sum.offset() <= upper;
        if (lower, upper) == (f64::NEG_INFINITY, f64::INFINITY) || (is_empty && holds) {
            return Ok(None);
        }
        let row = match is_empty {
            true => {
                let zero = self.model.continuous(format!("{name}_zero"), 0.0, 0.0)?;
                (sum + zero).within(lower, upper)
            }
            false => sum.within(lower, upper),
        };
        self.model.add(name, row).map(Some)
    }

    fn add_cones(&mut self, arrays: &Arrays) -> Result<(), Error> {
        let Some(matrix) = &arrays.cones else { return Ok(()) };
        let variables = &self.layout.variables;
        let rows = matrix.rows().zip(&arrays.h.0);
        let entries: Vec<Affine> =
            rows.map(|(terms, &constant)| affine(terms, constant, variables)).collect();
        let mut entries = entries.into_iter();
        for (cone, &size) in arrays.sizes.0.iter().enumerate() {
            let name = format!("cone{cone}");
            let Some(bound) = entries.next() else { break };
            let others: Vec<Affine> = entries.by_ref().take(size.saturating_sub(1)).collect();
            let is_constant = |entry: &Affine| entry.terms().is_empty();
            if others.iter().all(is_constant) {
                let length = others.iter().fold(0.0, |length: f64, e| length.hypot(e.offset()));
                self.add_plain_row(&name, &(bound - length), 0.0, f64::INFINITY)?;
            } else {
                self.model.add(name, norm(others).le(bound))?;
            }
        }
        Ok(())
    }
}
