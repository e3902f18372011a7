//! The lowered model under construction: its rows, their names, the auxiliary columns.

use std::collections::BTreeMap;

use super::implied_bounds::ImpliedBounds;
use super::linear_program::Maximizer;
use super::logic::AuxiliaryBinary;
use super::report::BigMReport;
use crate::error::{Error, ErrorKind};
use crate::model::{
    BigM, Formula, Literal, Model, Name, StoredConic, StoredRow, Variable, VariableKind,
};
use crate::solver::StopToken;
use crate::tolerance;

/// State shared by the reformulations.
pub(super) struct Lowering<'a> {
    /// The model so far.
    pub(super) model: Model,
    /// The big-Ms so far.
    pub(super) report: BigMReport,
    /// Bounds expressions by linear programs, if requested.
    pub(super) maximizer: Option<Maximizer<'a>>,
    /// The bounds that rows imply, sought once a bound was missing.
    pub(super) implied: Option<ImpliedBounds<'a>>,
    /// Ends the linear programs.
    pub(super) token: &'a StopToken,
    /// Number of variables of the original model.
    pub(super) original: usize,
    /// Auxiliary binaries of formulas; shared by all statements.
    pub(super) parts: BTreeMap<Formula, AuxiliaryBinary>,
    /// For variables of ordered sets and semi-continuous ones: the condition of being other than 0.
    pub(super) nonzero: BTreeMap<Variable, Literal>,
    /// The statement that is being lowered, and how many names were derived from its name.
    statement: Name,
    named: usize,
}

impl<'a> Lowering<'a> {
    pub(super) fn new(
        model: &Model,
        maximizer: Option<Maximizer<'a>>,
        implied: Option<ImpliedBounds<'a>>,
        token: &'a StopToken,
    ) -> Self {
        Lowering {
            model: model.with_rows_only(),
            report: BigMReport::default(),
            maximizer,
            implied,
            token,
            original: model.variable_count(),
            parts: BTreeMap::new(),
            nonzero: BTreeMap::new(),
            statement: Name::from("model"),
            named: 0,
        }
    }

    /// From now on, rows and columns are named after this statement.
    pub(super) fn begin(&mut self, statement: &Name) {
        self.statement = statement.clone();
        self.named = 0;
    }

    /// The name of the row added last.
    pub(super) fn newest_row(&self) -> Option<String> {
        self.model.constraints().next_back().map(|row| row.name().to_string())
    }

    pub(super) fn statement(&self) -> &Name {
        &self.statement
    }

    /// Adds a row under the statement's name, `name`, `name_2`, ...
    pub(super) fn row(
        &mut self,
        terms: Vec<(Variable, f64)>,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        self.check_coefficients(&terms)?;
        loop {
            self.named += 1;
            let name = match self.named {
                1 => self.statement.clone(),
                k => self.statement.suffixed(&format!("_{k}")),
            };
            let row = StoredRow { terms: terms.clone(), lower, upper };
            match self.model.push_constraint(name, row) {
                Ok(_) => return Ok(()),
                Err(error) if matches!(error.kind(), ErrorKind::DuplicateName { .. }) => {}
                Err(other) => return Err(other),
            }
        }
    }

    /// Adds a conic row under the statement's name, `name`, `name_2`, ...
    pub(super) fn conic(&mut self, conic: StoredConic) -> Result<(), Error> {
        loop {
            self.named += 1;
            let name = match self.named {
                1 => self.statement.clone(),
                k => self.statement.suffixed(&format!("_{k}")),
            };
            if !self.model.has_statement(&name) {
                return self.model.push_conic(name, None, conic, BigM::Automatic).map(|_| ());
            }
        }
    }

    /// The name of the conic row added last.
    pub(super) fn newest_conic(&self) -> Option<String> {
        self.model.conic_constraints().next_back().map(|row| row.name().to_string())
    }

    /// Adds a row under the statement's name with a suffix, and underscores if that is taken.
    pub(super) fn row_named(
        &mut self,
        suffix: &str,
        terms: Vec<(Variable, f64)>,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        self.check_coefficients(&terms)?;
        let name = self.statement.suffixed(suffix).free(|name| self.model.has_statement(name));
        self.model.push_constraint(name, StoredRow { terms, lower, upper }).map(|_| ())
    }

    /// The big-M of a binary that is in the row itself adds up with its coefficient.
    fn check_coefficients(&self, terms: &[(Variable, f64)]) -> Result<(), Error> {
        match terms.iter().find(|(_, a)| a.is_nan() || a.abs() >= tolerance::INFINITE) {
            None => Ok(()),
            Some(&(_, value)) => {
                let (name, what) = (self.statement.to_string(), "a coefficient with its big-M");
                Err(ErrorKind::NotFinite { name, what, value }.into())
            }
        }
    }

    /// Adds an auxiliary column named after the statement, `name_part1`, `name_part2`, ...
    pub(super) fn column(
        &mut self,
        what: &str,
        kind: VariableKind,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        for k in 1.. {
            let name = self.statement.suffixed(&format!("_{what}{k}"));
            if self.model.variable_by_name(name.clone()).is_err() {
                return self.model.variable(name, kind, lower, upper);
            }
        }
        unreachable!("a model has finitely many names")
    }
}
