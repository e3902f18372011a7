//! A lowered program with its terms.

use std::collections::BTreeMap;

use super::flaw::SearchFlaw;
use super::logarithms::exponentials;
use super::term::{Shape, SmoothTerm, bounds};
use crate::error::Error;
use crate::model::{Affine, Function, Model, Name, StoredRow, VariableKind};
use crate::presolve::{Domain, Reduced, ReducedCone};
use crate::program::Program;
use crate::reformulate::Tie;
use crate::solver::ProgramSize;

/// A lowered program with its terms. Columns are the variables of the model, those of the lowering,
/// and those of arguments.
#[derive(Debug)]
pub(crate) struct SpatialProgram {
    pub(crate) program: Program,
    /// By the order in which they depend on each other, those that others imply last.
    pub(crate) terms: Vec<SmoothTerm>,
    /// Columns that equal affine expressions of columns.
    arguments: Vec<ArgumentColumn>,
    /// All rows and columns, without terms and cones.
    pub(crate) base: Reduced,
    /// The cones, which relaxations cut off.
    pub(crate) cones: Vec<ReducedCone>,
    /// Columns whose ranges enclosures depend on.
    pub(crate) spatial: Vec<usize>,
    /// By column, whether stated rows, cones or functions have it.
    is_used: Vec<bool>,
    /// The names of columns and rows, if they were asked for.
    names: [Vec<String>; 2],
}

/// A column that equals an affine expression.
#[derive(Debug)]
struct ArgumentColumn {
    column: usize,
    of: Affine,
}

impl SpatialProgram {
    /// The program of a model.
    ///
    /// # Arguments
    ///
    /// * `model`: for its smooth functions.
    /// * `rows`: the lowered model, to which the columns of arguments are added.
    /// * `ties`: by function of the model.
    /// * `has_log`: whether it is for a log, which has the names of columns and rows and states no
    ///   implied terms.
    pub(crate) fn new(
        model: &Model,
        mut rows: Model,
        ties: &[Tie],
        has_log: bool,
    ) -> Result<Self, Error> {
        let mut builder = Builder { arguments: Vec::new(), known: BTreeMap::new() };
        let mut terms = Vec::new();
        for (function, &tie) in model.functions().zip(ties) {
            let result = function.result().index();
            let name = function.name();
            let mut column = |of: &Affine| builder.column(&mut rows, name, of);
            let shape = match function.function() {
                Function::Elementary { function, of } => {
                    Shape::Elementary { function: function.clone(), of: column(of)? }
                }
                Function::Bilinear([a, b]) => Shape::Bilinear([column(a)?, column(b)?]),
                Function::Quotient([a, b]) => Shape::Quotient([column(a)?, column(b)?]),
                _ => continue,
            };
            terms.push(SmoothTerm { result, shape, tie, is_implied: false });
        }
        let stated_rows = rows.constraint_count();
        // A log states the program, and what is implied is no part of that.
        if !has_log {
            terms.extend(exponentials(&mut rows, &mut builder, &terms)?);
        }
        let program = Program::assemble(&rows)?;
        let mut base = Reduced::whole(&program);
        let cones = std::mem::take(&mut base.cones);
        let mut spatial: Vec<usize> =
            terms.iter().flat_map(SmoothTerm::arguments).copied().collect();
        spatial.sort_unstable();
        spatial.dedup();
        let mut is_used = vec![false; program.column_count()];
        let of_cones = program.cones.iter().flat_map(|cone| &cone.columns);
        let of_rows = (0..stated_rows).flat_map(|row| base.rows.vector(row).0);
        let used = of_rows.chain(&base.quadratic.index).chain(&spatial);
        used.chain(of_cones).for_each(|&column| is_used[column] = true);
        let arguments = builder.arguments;
        let mut names = [Vec::new(), Vec::new()];
        if has_log {
            names[0] = rows.variables().map(|variable| variable.name().to_string()).collect();
            names[1] = rows.constraints().map(|row| row.name().to_string()).collect();
        }
        Ok(SpatialProgram { program, terms, arguments, base, cones, spatial, is_used, names })
    }

    /// The names of its columns and rows, for people.
    pub(crate) fn names(&self) -> [&[String]; 2] {
        [&self.names[0], &self.names[1]]
    }

    /// Its size, without the rows of terms.
    pub(crate) fn size(&self) -> ProgramSize {
        self.program.size()
    }

    /// A point with these values of columns, and with one between its bounds for each other column
    /// that no function determines.
    pub(crate) fn around(&self, values: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut x = middle(&Domain::new(&self.program));
        for (column, value) in values.filter(|(_, value)| value.is_finite()) {
            x[column] = value;
        }
        self.settle(&mut x);
        x
    }

    /// The terms that are not implied by others.
    pub(super) fn stated_terms(&self) -> &[SmoothTerm] {
        let count = self.terms.iter().take_while(|term| !term.is_implied).count();
        &self.terms[..count]
    }

    /// Whether nothing but the linear cost has the column of a term.
    pub(super) fn is_cost(&self, term: &SmoothTerm) -> bool {
        !self.is_used[term.result]
    }

    /// Whether a column has a lower bound before anything is propagated.
    pub(crate) fn has_lower(&self, column: usize) -> bool {
        self.program.lower[column].is_finite()
    }

    /// The variables of the expression that a column equals, or the column itself.
    pub(crate) fn variables_of(&self, column: usize) -> Vec<usize> {
        let argument = self.arguments.iter().find(|argument| argument.column == column);
        let terms = argument.map(|argument| argument.of.terms());
        terms.map_or(vec![column], |terms| terms.iter().map(|(v, _)| v.index()).collect())
    }

    /// A term that is infinite inside the range of its argument.
    pub(super) fn pole(&self, domain: &Domain) -> Option<SearchFlaw> {
        let pole = |term: &SmoothTerm| {
            let (range, has_pole) = match &term.shape {
                Shape::Elementary { function, of } => {
                    let range = bounds(domain, *of);
                    (range, function.has_pole_in(range))
                }
                Shape::Quotient([_, by]) => {
                    let range = bounds(domain, *by);
                    (range, range.lower < 0.0 && range.upper > 0.0)
                }
                Shape::Bilinear(_) => return None,
            };
            has_pole.then_some(SearchFlaw::Pole { result: term.result, range })
        };
        self.terms.iter().find_map(pole)
    }

    /// Whether all columns of terms have bounds.
    pub(super) fn has_bounded_terms(&self, domain: &Domain) -> bool {
        let is_bounded = |j: &usize| bounds(domain, *j).is_bounded();
        self.spatial.iter().all(is_bounded)
            && self.terms.iter().all(|term| is_bounded(&term.result))
    }

    /// By column, how much the terms are off of which it is an argument, relative to their values.
    pub(crate) fn misses(&self, x: &[f64]) -> Vec<f64> {
        let mut misses = vec![0.0; self.program.column_count()];
        for term in &self.terms {
            let miss = term.violation(x) / x[term.result].abs().max(1.0);
            let miss = if miss.is_nan() { 1.0 } else { miss };
            term.arguments().iter().for_each(|&column| misses[column] += miss);
        }
        misses
    }

    /// A column of an argument without a bound, or a term without one.
    pub(super) fn openness(&self, domain: &Domain) -> Option<SearchFlaw> {
        let is_open = |j: usize| !bounds(domain, j).is_bounded();
        let column = self.spatial.iter().copied().find(|&j| is_open(j));
        column.map(SearchFlaw::OpenColumn).or_else(|| {
            let term = self.terms.iter().find(|term| is_open(term.result))?;
            // The divisor of a quotient.
            let range = bounds(domain, *term.arguments().last()?);
            Some(SearchFlaw::Pole { result: term.result, range })
        })
    }

    /// Puts the columns of terms and arguments of a point on their functions, in the order in which
    /// they depend on each other.
    pub(crate) fn settle(&self, x: &mut [f64]) {
        // Arguments follow from variables, and terms from arguments. Terms are in order; an
        // argument may depend on terms before it.
        let mut next = 0;
        for term in &self.terms {
            while let Some(argument) = self.arguments.get(next) {
                if !term.arguments().contains(&argument.column) {
                    break;
                }
                x[argument.column] = argument.of.evaluate(|v| x[v.index()]);
                next += 1;
            }
            x[term.result] = term.value(x);
        }
    }
}

pub(super) struct Builder {
    arguments: Vec<ArgumentColumn>,
    known: BTreeMap<String, usize>,
}

impl Builder {
    /// The column of which another one is a multiple, with the factor.
    pub(super) fn multiple(&self, column: usize) -> Option<(usize, f64)> {
        let argument = self.arguments.iter().find(|argument| argument.column == column)?;
        match argument.of.terms().as_slice() {
            &[(variable, factor)] if argument.of.offset() == 0.0 => {
                Some((variable.index(), factor))
            }
            _ => None,
        }
    }

    /// The column of an expression.
    pub(super) fn column(
        &mut self,
        rows: &mut Model,
        name: &Name,
        of: &Affine,
    ) -> Result<usize, Error> {
        let terms = of.terms();
        if let (&[(variable, 1.0)], 0.0) = (terms.as_slice(), of.offset()) {
            return Ok(variable.index());
        }
        let key = of.to_string();
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let range = rows.range(of)?;
        let name = name.suffixed("_argument");
        let mut name = name.free(|name| rows.variable_by_name(name.clone()).is_ok());
        name = name.free(|name| rows.has_statement(name));
        let (lower, upper) = (range.lower, range.upper);
        let variable = rows.variable(name.clone(), VariableKind::Continuous, lower, upper)?;
        let (mut terms, constant) = of.clone().into_parts();
        terms.push((variable, -1.0));
        let row = StoredRow { terms, lower: -constant, upper: -constant };
        rows.push_constraint(name, row)?;
        self.known.insert(key, variable.index());
        self.arguments.push(ArgumentColumn { column: variable.index(), of: of.clone() });
        Ok(variable.index())
    }
}

/// A point of a box without a relaxed one.
pub(crate) fn middle(domain: &Domain) -> Vec<f64> {
    let middle = |j: usize| {
        let [lower, upper] = domain.bounds(j);
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) => 0.5 * lower + 0.5 * upper,
            (true, false) => lower,
            (false, true) => upper,
            (false, false) => 0.0,
        }
    };
    (0..domain.column_count()).map(middle).collect()
}
