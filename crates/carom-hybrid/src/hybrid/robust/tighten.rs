//! Statements of a program, tightened by the width that a tube has in them.
//!
//! A variable of the model differs between runs if it is a state or an input at a sample, what a
//! choice changes, or defined by such variables. Others, such as binaries and slacks, are parts of
//! the plan: the same for every run.

use std::collections::{BTreeMap, BTreeSet};

use super::tube::ErrorTube;
use super::words::{GROWTH, for_every};
use crate::error::{Error, RobustError};
use crate::hybrid::program::HybridProgram;
use crate::hybrid::step::AffineForm;
use crate::interval::Interval;
use crate::model::{
    Affine, AnyStatement, Consequent, Logic, Model, Name, Row, Statement, StoredConic, StoredRow,
    StoredTerm, Variable, norm, statements,
};

/// The suffix of rows that state the bounds of a variable.
pub(super) const BOUNDS: &str = "_bounds";

/// Widths of one value that are not more than this are rounding.
const ONE_VALUE: f64 = 1e-9;

/// By how much a variable differs between runs.
pub(super) enum Carried {
    /// Factors of the error at a sample.
    Error { sample: usize, factors: Vec<f64> },
    /// Half its width.
    Width(Affine),
}

/// A row of the program and half its width, which a certificate checks.
#[derive(Debug, Clone)]
pub(super) struct TightStatement {
    pub(super) statement: String,
    /// Under which it holds.
    pub(super) condition: Option<Logic>,
    pub(super) row: TightRow,
    pub(super) width: Affine,
}

#[derive(Debug, Clone)]
pub(super) enum TightRow {
    Linear(StoredRow),
    Norm { entries: Vec<Affine>, bound: Affine },
}

/// Tightens the statements of a model that its system did not write.
pub(super) struct StatementTightening<'a> {
    pub(super) tube: &'a ErrorTube<'a>,
    pub(super) carried: BTreeMap<Variable, Carried>,
    all: Vec<TightStatement>,
}

impl<'a> StatementTightening<'a> {
    /// Adds the tightened statements to a model that has the tube, and returns them.
    pub(super) fn write(
        model: &mut Model,
        program: &HybridProgram,
        tube: &'a ErrorTube<'a>,
    ) -> Result<Vec<TightStatement>, Error> {
        let original = program.model();
        let mut own = StatementTightening { tube, carried: BTreeMap::new(), all: Vec::new() };
        own.system();
        own.changes(model)?;
        own.bounds(model, program)?;
        let defined = own.defined(model, original)?;
        own.statements(model, original, &defined)?;
        Ok(own.all)
    }

    /// States and inputs.
    fn system(&mut self) {
        let own = self.tube.own;
        let families = own.states().iter().chain(own.inputs());
        let width = own.states().len() + own.inputs().len();
        for (k, family) in families.enumerate() {
            let mut map = AffineForm::constant(width, 0.0);
            map.factors[k] = 1.0;
            let factors = self.tube.feedback.closed(&map);
            for (sample, variable) in family.iter().enumerate() {
                let factors = factors.clone();
                self.carried.insert(variable, Carried::Error { sample, factors });
            }
        }
    }

    /// Bounds of states and inputs that are narrower than what the system says, such as those of a
    /// goal.
    fn bounds(&mut self, model: &mut Model, program: &HybridProgram) -> Result<(), Error> {
        let own = self.tube.own;
        let system = own.computed();
        for (k, family) in own.states().iter().chain(own.inputs()).enumerate() {
            for (sample, variable) in family.iter().enumerate().skip(self.tube.first) {
                let of_system = match system.states.get(k) {
                    Some((_, domain)) => *domain,
                    None => system
                        .input_ranges(k - system.states.len(), sample)
                        .fold(Interval::REALS, |all, range| all.intersection(range)),
                };
                let Interval { lower, upper } = program.stated_bounds(variable)?;
                if lower <= of_system.lower && upper >= of_system.upper {
                    continue;
                }
                // A single value says where the plan starts.
                if sample == 0 && k < system.states.len() && lower == upper {
                    continue;
                }
                let row = StoredRow { terms: vec![(variable, 1.0)], lower, upper };
                let name = program.model().variable_ref(variable)?.name();
                self.linear(model, name, BOUNDS, None, &row)?;
            }
        }
        Ok(())
    }

    /// The ranges by which choices change next states and outputs: as wide as under the transition
    /// that is taken.
    fn changes(&mut self, model: &mut Model) -> Result<(), Error> {
        let own = self.tube.own;
        for step in self.tube.first..own.horizon().steps() {
            for choice in 0..own.computed().choices.len() {
                for (g, (variable, maps)) in own.change_maps(choice, step).into_iter().enumerate() {
                    let widths = maps.iter().map(|map| {
                        let factors = self.tube.feedback.closed(map);
                        self.tube.width(&factors, step)
                    });
                    let widths: Vec<Affine> = widths.collect();
                    let mut most = 0.0_f64;
                    for width in &widths {
                        most = most.max(model.range(width)?.upper);
                    }
                    if most == 0.0 {
                        continue;
                    }
                    let name = format!("tube_change_{choice}_{g}");
                    let half = model.continuous((name.as_str(), step), 0.0, most)?;
                    for (j, width) in widths.into_iter().enumerate() {
                        if width.terms().is_empty() {
                            continue;
                        }
                        let (name, row) = (format!("{name}_{j}"), half.ge(width));
                        model.describe(&name, GROWTH.to_owned());
                        match own.literal(choice, j, step) {
                            None => model.add((name.as_str(), step), row).map(drop)?,
                            Some(when) => {
                                model.add((name.as_str(), step), when.implies(row)).map(drop)?;
                            }
                        }
                    }
                    self.carried.insert(variable, Carried::Width(half.into()));
                }
            }
        }
        Ok(())
    }

    /// The tightened statements.
    fn statements(
        &mut self,
        model: &mut Model,
        original: &Model,
        defined: &BTreeSet<usize>,
    ) -> Result<(), Error> {
        let mut positions = [0_usize; 4];
        for statement in statements(original) {
            let kind = match statement {
                AnyStatement::Row(_) => 0,
                AnyStatement::Indicator(_) => 1,
                AnyStatement::Conic(_) => 2,
                AnyStatement::Disjunction(_) => 3,
                AnyStatement::Set(set) => {
                    self.refuse_set(statement.name(), set.members())?;
                    continue;
                }
                // It is about the plan.
                AnyStatement::Logic(_) => continue,
            };
            let position = positions[kind];
            positions[kind] += 1;
            if self.tube.own.wrote(kind, position) {
                continue;
            }
            let name = statement.name();
            match statement {
                AnyStatement::Row(row) => {
                    if defined.contains(&position) || self.is_start(original, row.terms())? {
                        continue;
                    }
                    let (lower, upper) = (row.limits().lower, row.limits().upper);
                    let row = StoredRow { terms: row.terms().to_vec(), lower, upper };
                    self.linear(model, name, "", None, &row)?;
                }
                AnyStatement::Indicator(own) => {
                    let (lower, upper) = (own.limits().lower, own.limits().upper);
                    let row = StoredRow { terms: own.terms().to_vec(), lower, upper };
                    self.linear(model, name, "", Some(own.condition()), &row)?;
                }
                AnyStatement::Conic(own) => {
                    self.conic(model, name, "", own.condition(), own.conic())?;
                }
                AnyStatement::Disjunction(own) => {
                    self.terms(model, name, "", own.stored_terms())?;
                }
                AnyStatement::Logic(_) | AnyStatement::Set(_) => {}
            }
        }
        Ok(())
    }

    fn terms(
        &mut self,
        model: &mut Model,
        name: &Name,
        at: &str,
        terms: &[StoredTerm],
    ) -> Result<(), Error> {
        for (j, term) in terms.iter().enumerate() {
            let condition = Logic::from(term.selector);
            for (k, row) in term.rows.iter().enumerate() {
                self.linear(model, name, &format!("{at}_{j}_{k}"), Some(&condition), row)?;
            }
            for (k, row) in term.conic.iter().enumerate() {
                self.conic(model, name, &format!("{at}_{j}_c{k}"), Some(&condition), row)?;
            }
            for (k, nested) in term.nested.iter().enumerate() {
                self.terms(model, name, &format!("{at}_{j}_n{k}"), nested)?;
            }
        }
        Ok(())
    }

    pub(super) fn linear(
        &mut self,
        model: &mut Model,
        name: &Name,
        at: &str,
        condition: Option<&Logic>,
        row: &StoredRow,
    ) -> Result<(), Error> {
        let width = self.width(&row.terms);
        if width.terms().is_empty() {
            return Ok(());
        }
        let mut value = Affine::zero();
        row.terms.iter().for_each(|(variable, factor)| value.add_term(*factor, *variable));
        let mut tight: Vec<Row> = Vec::new();
        if row.lower == row.upper {
            let least = model.range(&width)?.lower;
            if least > ONE_VALUE && condition.is_none() {
                let (statement, width) = (name.to_string(), 2.0 * least);
                return Err(RobustError::OneValue { statement, width }.into());
            }
            tight.push(width.clone().le(0.0));
        } else {
            if row.upper.is_finite() {
                tight.push((&value + &width).le(row.upper));
            }
            if row.lower.is_finite() {
                tight.push((&value - &width).ge(row.lower));
            }
        }
        let words = for_every(&match at {
            BOUNDS => format!("the bounds of `{}`", name.family()),
            _ => model.words(name.family()).to_owned(),
        });
        for (k, tight) in tight.into_iter().enumerate() {
            let name = name.suffixed(&format!("{at}_tube_{k}"));
            model.describe(name.family(), words.clone());
            state(model, name, condition, tight)?;
        }
        self.all.push(TightStatement {
            statement: name.to_string(),
            condition: condition.cloned(),
            row: TightRow::Linear(row.clone()),
            width,
        });
        Ok(())
    }

    /// Refuses a set whose members differ between runs: which of them is 0 may differ too.
    fn refuse_set(&self, name: &Name, members: &[(Variable, f64)]) -> Result<(), Error> {
        if members.iter().all(|(member, _)| self.width(&[(*member, 1.0)]).terms().is_empty()) {
            return Ok(());
        }
        let help = "let binaries say which of them may differ from 0, and limit the others by rows";
        let (statement, kind) = (name.to_string(), "an ordered set of states or inputs");
        Err(RobustError::Statement { statement, kind, help }.into())
    }

    fn conic(
        &mut self,
        model: &mut Model,
        name: &Name,
        at: &str,
        condition: Option<&Logic>,
        row: &StoredConic,
    ) -> Result<(), Error> {
        let StoredConic::Norm { entries, bound } = row else {
            let mut differs = false;
            row.for_each_variable(&mut |variable| {
                differs |= !self.width(&[(variable, 1.0)]).terms().is_empty();
            });
            if !differs {
                return Ok(());
            }
            let help = "state it as the norm of its entries, `norm([x, y]).le(r)`";
            let (statement, kind) = (name.to_string(), "a quadratic row of states or inputs");
            return Err(RobustError::Statement { statement, kind, help }.into());
        };
        let parts = entries.iter().chain([bound]);
        let width: Affine = parts.map(|part| self.width(&part.terms())).sum();
        if width.terms().is_empty() {
            return Ok(());
        }
        let tight = norm(entries.iter().cloned()).le(bound - &width);
        let words = for_every(model.words(name.family()));
        let tube = name.suffixed(&format!("{at}_tube"));
        model.describe(tube.family(), words);
        state(model, tube, condition, tight)?;
        let row = TightRow::Norm { entries: entries.clone(), bound: bound.clone() };
        let (statement, condition) = (name.to_string(), condition.cloned());
        self.all.push(TightStatement { statement, condition, row, width });
        Ok(())
    }

    /// Half the width of a sum over all runs. Errors at one sample are added before their
    /// magnitudes are.
    pub(super) fn width(&self, terms: &[(Variable, f64)]) -> Affine {
        let mut errors: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        let mut sum = Affine::zero();
        for &(variable, factor) in terms {
            match self.carried.get(&variable) {
                None => {}
                Some(Carried::Width(width)) => sum += factor.abs() * width,
                Some(Carried::Error { sample, factors }) => {
                    let all = errors.entry(*sample).or_insert_with(|| vec![0.0; factors.len()]);
                    all.iter_mut().zip(factors).for_each(|(all, own)| *all += factor * own);
                }
            }
        }
        errors.iter().for_each(|(sample, factors)| sum += self.tube.width(factors, *sample));
        sum
    }
}

/// Adds a row, under a condition if there is one.
fn state<R>(model: &mut Model, name: Name, condition: Option<&Logic>, row: R) -> Result<(), Error>
where
    R: Consequent + Statement,
    R::Output: Statement,
{
    match condition {
        None => model.add(name, row).map(drop),
        Some(condition) => model.add(name, condition.clone().implies(row)).map(drop),
    }
}
