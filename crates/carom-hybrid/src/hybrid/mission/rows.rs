//! The rows of a mission: what holds without a choice as it is, choices between convex sets as
//! disjunctions, and a binary for a part only where it is one alternative of several.

use std::collections::HashMap;

use super::unrolled::{Demand, FALSE, Id, MissionPart, TRUE, Unrolled};
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{
    Affine, ConicRow, Either, Literal, Logic, Model, Name, NonlinearRow, Quadratic, Row,
    StoredConic, Term,
};
use crate::tolerance::FEASIBILITY;

/// The parts and conditions of a mission, without the model that they were read with.
pub(super) struct MissionParts {
    parts: Vec<MissionPart>,
    bounds: Vec<Interval>,
    conditions: Vec<Demand>,
}

impl Unrolled<'_> {
    pub(super) fn into_parts(self) -> MissionParts {
        MissionParts { parts: self.parts, bounds: self.bounds, conditions: self.conditions }
    }
}

/// The margin by which a mission is to hold.
pub(super) struct Margin {
    /// A number, or a variable of the model.
    pub(super) value: Affine,
    pub(super) range: Interval,
}

/// A row of a condition.
enum DemandRow {
    Row(Row),
    Conic(ConicRow),
    Nonlinear(NonlinearRow),
}

pub(super) struct MissionWriter<'a> {
    model: &'a mut Model,
    name: &'a str,
    parts: &'a MissionParts,
    margin: &'a Margin,
    /// How many parts each part stands in.
    uses: Vec<usize>,
    literals: HashMap<Id, Literal>,
    statements: usize,
}

/// Adds the rows of a part, which must hold by the margin.
pub(super) fn write(
    model: &mut Model,
    name: &str,
    parts: &MissionParts,
    root: Id,
    margin: &Margin,
) -> Result<(), Error> {
    let mut uses = vec![0; parts.parts.len()];
    let mut open = vec![root];
    let mut seen = vec![false; parts.parts.len()];
    while let Some(id) = open.pop() {
        uses[id] += 1;
        if !std::mem::replace(&mut seen[id], true)
            && let MissionPart::All(of) | MissionPart::Any(of) = &parts.parts[id]
        {
            open.extend(of);
        }
    }
    let literals = HashMap::new();
    MissionWriter { model, name, parts, margin, uses, literals, statements: 0 }.require(root)
}

impl MissionWriter<'_> {
    /// Whether a part is true or false whatever the plan is; `None` if that is open.
    fn decided(&self, id: Id) -> Option<bool> {
        let (own, margin) = (self.parts.bounds[id], self.margin.range);
        if id == TRUE || own.lower >= margin.upper {
            return Some(true);
        }
        // A plan may miss a row by the tolerance.
        let is_far = own.upper < margin.lower - 2.0 * FEASIBILITY * (1.0 + margin.lower.abs());
        (id == FALSE || is_far).then_some(false)
    }

    /// The parts of a part that matter, each once; those of conjunctions inside conjunctions and of
    /// alternatives inside alternatives as its own, if nothing else uses them.
    fn open(&self, id: Id) -> Vec<Id> {
        let of = match &self.parts.parts[id] {
            MissionPart::Conditions(_) => return vec![id],
            MissionPart::All(of) | MissionPart::Any(of) => of,
        };
        let all = matches!(self.parts.parts[id], MissionPart::All(_));
        let mut open = Vec::new();
        for &part in of {
            if self.decided(part) == Some(all) || self.decided(part) == Some(!all) {
                continue;
            }
            let same = matches!(
                (&self.parts.parts[part], all),
                (MissionPart::All(_), true) | (MissionPart::Any(_), false)
            );
            match same && self.uses[part] <= 1 {
                true => open.extend(self.open(part)),
                false => open.push(part),
            }
        }
        open
    }

    fn statement_name(&mut self) -> Name {
        self.statements += 1;
        let name = Name::from(format!("{}_{}", self.name, self.statements));
        name.free(|name| self.model.has_statement(name))
    }

    /// The row of a condition by the margin; nothing if it always holds.
    fn row(&self, condition: usize) -> Result<Option<DemandRow>, Error> {
        Ok(match &self.parts.conditions[condition] {
            Demand::Slack(slack) => {
                Some(DemandRow::Row(Row::new(slack - &self.margin.value, 0.0, f64::INFINITY)))
            }
            Demand::Nonlinear(slack) => {
                Some(DemandRow::Nonlinear((slack - self.margin.value.clone()).ge(0.0)))
            }
            Demand::Logical(slack) => Some(DemandRow::Row(slack.ge(0.0))),
            Demand::Conic(row) => Some(DemandRow::Conic(match row.stored() {
                StoredConic::Norm { entries, bound } => {
                    crate::model::norm(entries.iter().cloned()).le(bound - &self.margin.value)
                }
                StoredConic::Quadratic { expression } => {
                    (expression + Quadratic::from(self.margin.value.clone())).le(0.0)
                }
            })),
        }
        .filter(|stated| match stated {
            DemandRow::Row(row) => !row.is_constant_and_holds(),
            DemandRow::Conic(_) | DemandRow::Nonlinear(_) => true,
        }))
    }

    /// The rows of a part that is made of conditions alone.
    fn rows(&self, id: Id) -> Result<Option<Vec<DemandRow>>, Error> {
        let mut rows = Vec::new();
        let parts = match &self.parts.parts[id] {
            MissionPart::Any(_) => return Ok(None),
            _ => self.open(id),
        };
        for part in parts {
            let MissionPart::Conditions(conditions) = &self.parts.parts[part] else {
                return Ok(None);
            };
            for &condition in conditions {
                rows.extend(self.row(condition)?);
            }
        }
        Ok(Some(rows))
    }

    /// States a part that must hold.
    fn require(&mut self, id: Id) -> Result<(), Error> {
        match self.decided(id) {
            Some(true) => return Ok(()),
            Some(false) => return self.add_infeasible(),
            None => {}
        }
        if let MissionPart::Conditions(conditions) = &self.parts.parts[id] {
            for &condition in conditions {
                let name = self.statement_name();
                match self.row(condition)? {
                    Some(DemandRow::Row(row)) if row.expression().terms().is_empty() => {
                        self.add_infeasible()?
                    }
                    Some(DemandRow::Row(row)) => drop(self.model.add(name, row)?),
                    Some(DemandRow::Conic(row)) => drop(self.model.add(name, row)?),
                    Some(DemandRow::Nonlinear(row)) => drop(self.model.add(name, row)?),
                    None => {}
                }
            }
            return Ok(());
        }
        let open = self.open(id);
        if matches!(self.parts.parts[id], MissionPart::All(_)) {
            return open.into_iter().try_for_each(|part| self.require(part));
        }
        if let [only] = open[..] {
            return self.require(only);
        }
        let shared =
            open.iter().any(|part| self.uses[*part] > 1 || self.literals.contains_key(part));
        let rows = open.iter().map(|part| self.rows(*part)).collect::<Result<Vec<_>, _>>()?;
        let convex: Option<Vec<Vec<DemandRow>>> = rows.into_iter().collect();
        match convex {
            // Several single rows, such as the faces of an obstacle, of which more than one may
            // hold: to select exactly one would only make equal plans different.
            Some(terms) if !shared && (terms.len() == 2 || terms.iter().any(|t| t.len() > 1)) => {
                self.either(terms)
            }
            _ => {
                let literals = self.alternatives(&open)?;
                let name = self.statement_name();
                self.model.add(name, Logic::any(literals)).map(drop)
            }
        }
    }

    /// A choice between convex sets.
    fn either(&mut self, terms: Vec<Vec<DemandRow>>) -> Result<(), Error> {
        let term = |rows: Vec<DemandRow>| {
            rows.into_iter().fold(Term::default(), |term, row| match row {
                DemandRow::Row(row) => term.and(row),
                DemandRow::Conic(row) => term.and(row),
                DemandRow::Nonlinear(row) => term.and(row),
            })
        };
        let either = Either::of(terms.into_iter().map(term));
        let name = self.statement_name();
        self.model.add(name, either).map(drop)
    }

    /// The conditions that select alternatives.
    fn alternatives(&mut self, of: &[Id]) -> Result<Vec<Literal>, Error> {
        of.iter().map(|part| self.literal(*part)).collect()
    }

    /// A binary that implies a part.
    fn literal(&mut self, id: Id) -> Result<Literal, Error> {
        if let Some(literal) = self.literals.get(&id) {
            return Ok(*literal);
        }
        let name = Name::from(format!("{}_part{}", self.name, self.literals.len() + 1));
        let name = name.free(|name| self.model.variable_by_name(name.clone()).is_ok());
        let literal = self.model.binary(name)?.on();
        self.literals.insert(id, literal);
        self.imply(literal, id)?;
        Ok(literal)
    }

    /// States that a part holds if a literal does.
    fn imply(&mut self, literal: Literal, id: Id) -> Result<(), Error> {
        match &self.parts.parts[id] {
            MissionPart::Conditions(conditions) => {
                for &condition in conditions {
                    let name = self.statement_name();
                    match self.row(condition)? {
                        Some(DemandRow::Row(row)) if row.expression().terms().is_empty() => {
                            self.model.add(name, !literal).map(drop)?;
                        }
                        Some(DemandRow::Row(row)) => {
                            self.model.add(name, literal.implies(row)).map(drop)?;
                        }
                        Some(DemandRow::Conic(row)) => {
                            self.model.add(name, literal.implies(row)).map(drop)?;
                        }
                        Some(DemandRow::Nonlinear(row)) => {
                            self.model.add(name, literal.implies(row)).map(drop)?;
                        }
                        None => {}
                    }
                }
                Ok(())
            }
            MissionPart::All(_) => {
                for part in self.open(id) {
                    let is_own = self.uses[part] <= 1 && !self.literals.contains_key(&part);
                    match is_own {
                        true => self.imply(literal, part)?,
                        false => {
                            let then = self.literal(part)?;
                            let name = self.statement_name();
                            self.model.add(name, literal.implies(then))?;
                        }
                    }
                }
                Ok(())
            }
            MissionPart::Any(_) => {
                let open = self.open(id);
                let literals = self.alternatives(&open)?;
                let name = self.statement_name();
                self.model.add(name, literal.implies(Logic::any(literals))).map(drop)
            }
        }
    }

    /// States that the mission cannot hold.
    fn add_infeasible(&mut self) -> Result<(), Error> {
        let name = self.statement_name();
        let never = Name::from(format!("{} is impossible", self.name));
        let never = never.free(|name| self.model.variable_by_name(name.clone()).is_ok());
        let never = self.model.continuous(never, 0.0, 0.0)?;
        self.model.add(name, never.ge(1.0)).map(drop)
    }
}
