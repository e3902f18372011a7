//! The statements of a choice at a step.

use std::collections::BTreeSet;

use super::change::{Part, RATIO, quantity};
use super::constant_rows::nontrivial;
use super::names::{Names, Scope};
use super::program::{ChoiceProgram, SystemVariables};
use super::switch::{Label, SupportRow, Switch, SwitchRow};
use super::write::expression;
use crate::error::Error;
use crate::hybrid::step::{self, ConditionSet, Dynamics, Moment, StepCondition};
use crate::hybrid::system::{Choice, SystemRow};
use crate::interval::Interval;
use crate::model::{Affine, Either, Literal, Method, Model, Row, Term};

/// A choice at a step.
pub(super) struct ChoiceStep<'a> {
    pub(super) program: &'a SystemVariables,
    /// The number of the choice.
    pub(super) number: usize,
    pub(super) own: &'a [Dynamics],
    pub(super) rows: &'a Switch,
    pub(super) step: usize,
    pub(super) method: Option<Method>,
    /// Which next states are what is predicted.
    pub(super) as_predicted: &'a [bool],
}

/// A statement's family, the row, and whether it describes the system.
type Named = (String, SystemRow, bool);

/// The inequalities of a change that a row states: at least, at most, or both.
#[derive(Clone, Copy, PartialEq)]
enum Halves {
    Lower,
    Upper,
    Both,
}

impl ChoiceStep<'_> {
    fn choice(&self) -> &Choice {
        &self.program.system.choices[self.number]
    }

    fn variables(&self) -> &ChoiceProgram {
        &self.program.choices[self.number]
    }

    /// Whether the choice decides on the next state alone.
    fn is_alone(&self) -> bool {
        self.program.system.choices.len() == 1
    }

    /// Adds the statements; notes the families of those that describe the system.
    pub(super) fn add(
        &self,
        model: &mut Model,
        names: &mut Names,
        background: &mut BTreeSet<String>,
    ) -> Result<(), Error> {
        let count = self.own.len();
        for (from, row) in &self.rows.common {
            let family = self.family(names, *from, row.label, Scope::Common);
            let left = self.by_next(*from, row).unwrap_or_else(|| self.expression(row));
            model.add((family.as_str(), self.step), left.le(row.limit))?;
            note(background, family, describes(row.label));
        }
        if count == 1 {
            for (family, row, describes) in self.norms(0, names) {
                row.add_to(model, (family.as_str(), self.step), None)?;
                note(background, family, describes);
            }
        }
        let selectors = (0..count).map(|j| self.variables().taken.literal(j, self.step));
        let Some(selectors) = selectors.collect::<Option<Vec<Literal>>>() else { return Ok(()) };
        let implications = count == 2 && matches!(self.method, None | Some(Method::BigM));
        if self.has_spans() {
            self.add_spans(model, names, background)?;
        }
        self.add_supports(model, names, background)?;
        let mut terms = Vec::with_capacity(count);
        for (j, literal) in selectors.iter().enumerate() {
            let mut term = Term::default();
            for (family, row, describes) in self.statements(j, model, names)? {
                if implications || !describes {
                    row.add_to(model, (family.as_str(), self.step), Some(*literal))?;
                    note(background, family, describes);
                } else {
                    term = match row {
                        SystemRow::Row(row) => term.and(row),
                        SystemRow::Conic(row) => term.and(row),
                        SystemRow::Nonlinear(row) => term.and(row),
                    };
                }
            }
            terms.push(term);
        }
        if !implications {
            let mut either = Either::of(terms).selected_by(selectors);
            if let Some(method) = self.method {
                either = either.by(method);
            }
            let key = (self.number, usize::MAX, None, Scope::Own);
            let family = names.keyed(key, &[&self.choice().name]);
            model.add((family.as_str(), self.step), either)?;
            background.insert(family);
        }
        Ok(())
    }

    /// Whether the ranges of the changes are stated for all transitions at once. Two transitions
    /// need it not, because the implications of the reference say the same; the hull implies it.
    fn has_spans(&self) -> bool {
        self.own.len() > 2 && self.method != Some(Method::Hull)
    }

    /// Adds `Σ l_j λ_j <= w <= Σ u_j λ_j` for each group's variable w, which lies within
    /// `[l_j, u_j]` in the transition j with the binary λ_j. This is all that a transition with a
    /// constant change needs.
    fn add_spans(
        &self,
        model: &mut Model,
        names: &mut Names,
        background: &mut BTreeSet<String>,
    ) -> Result<(), Error> {
        let of = if self.is_alone() { "" } else { &self.choice().name };
        for (group, spans) in self.rows.spans.iter().enumerate() {
            let Some(variable) = self.variables().groups[group].get(self.step) else { continue };
            for (word, upper) in [("least", false), ("most", true)] {
                let end = |range: &Interval| if upper { range.upper } else { range.lower };
                if spans.iter().all(|range| end(range) == end(&self.rows.bounds[group])) {
                    continue;
                }
                let ends = spans.iter().map(end).enumerate().filter(|(_, end)| *end != 0.0);
                let sum: Affine =
                    ends.map(|(j, end)| end * self.variables().taken.value(j, self.step)).sum();
                let row = if upper { variable.le(sum) } else { variable.ge(sum) };
                let key =
                    (self.number, usize::MAX, Some(Label::Change { group, upper }), Scope::Common);
                let family = names.keyed(key, &[of, word, self.quantity_name(group)]);
                model.add((family.as_str(), self.step), row)?;
                background.insert(family);
            }
        }
        Ok(())
    }

    /// Adds the rows with the largest value of their left side in each transition.
    fn add_supports(
        &self,
        model: &mut Model,
        names: &mut Names,
        background: &mut BTreeSet<String>,
    ) -> Result<(), Error> {
        for SupportRow { from, row, most } in &self.rows.supports {
            let family = self.family(names, *from, row.label, Scope::Support);
            let left = self.by_next(*from, row).unwrap_or_else(|| self.expression(row));
            let ends = most.iter().enumerate().filter(|(_, most)| **most != 0.0);
            let sum: Affine =
                ends.map(|(i, most)| *most * self.variables().taken.value(i, self.step)).sum();
            model.add((family.as_str(), self.step), (left - sum).le(0.0))?;
            note(background, family, describes(row.label));
        }
        Ok(())
    }

    /// The name of the next state or the output whose change is a group's variable.
    fn quantity_name(&self, group: usize) -> &str {
        let states = &self.program.system.states;
        let quantity = self.variables().changes.groups[group];
        match states.get(quantity) {
            Some((state, _)) => state,
            None => step::output_names(&self.choice().transitions)
                .get(quantity - states.len())
                .copied()
                .unwrap_or_default(),
        }
    }

    /// The family of a transition's statements.
    fn family(&self, names: &mut Names, from: usize, label: Label, scope: Scope) -> String {
        let system = &self.program.system;
        let choice = self.choice();
        let of = if self.is_alone() { "" } else { &choice.name };
        let transition = &choice.transitions[from];
        // A range of several transitions has the name of none.
        let (from, mut parts) = match (scope, label) {
            (Scope::Support, Label::Range { .. }) => (usize::MAX, vec![of]),
            _ => (from, vec![of, &transition.name]),
        };
        match label {
            Label::Change { group, upper } => {
                parts.push(self.quantity_name(group));
                parts.extend(match scope {
                    Scope::Own => None,
                    Scope::Common => Some("always"),
                    Scope::Support => Some(if upper { "most" } else { "least" }),
                });
            }
            Label::Guard { number, .. } => {
                parts.extend(transition.conditions().nth(number).map(StepCondition::name));
            }
            Label::Range { input, upper } => {
                parts.extend([if upper { "most" } else { "least" }, &system.inputs[input].0]);
            }
        }
        // Both halves of a change may be one statement.
        let label = match label {
            Label::Change { group, .. } if scope == Scope::Own => {
                Label::Change { group, upper: false }
            }
            label => label,
        };
        names.keyed((self.number, from, Some(label), scope), &parts)
    }

    /// The rows of a transition that do not hold in every transition, and then its norms.
    fn statements(
        &self,
        transition: usize,
        model: &Model,
        names: &mut Names,
    ) -> Result<Vec<Named>, Error> {
        let mut rows = self.rows.own[transition].iter().peekable();
        let mut named = Vec::new();
        while let Some(row) = rows.next() {
            if let Label::Change { group, .. } = row.label
                && self.has_spans()
                && self.rows.spans[group][transition].width() == 0.0
            {
                continue;
            }
            let family = self.family(names, transition, row.label, Scope::Own);
            let Label::Change { group, upper } = row.label else {
                let left = self.by_next(transition, row).unwrap_or_else(|| self.expression(row));
                named.push((family, left.le(row.limit).into(), describes(row.label)));
                continue;
            };
            let both = Label::Change { group, upper: true };
            let halves = if upper {
                Halves::Upper
            } else if rows.next_if(|next| next.label == both).is_some() {
                Halves::Both
            } else {
                Halves::Lower
            };
            named.push((family, self.tightest(transition, group, halves, model)?.into(), true));
        }
        named.extend(self.norms(transition, names));
        Ok(named)
    }

    /// The norm limits of a transition, on the start of the step and then on the prediction.
    fn norms(&self, transition: usize, names: &mut Names) -> Vec<Named> {
        let system = &self.program.system;
        let own = &self.choice().transitions[transition];
        let of = if self.is_alone() { "" } else { &self.choice().name };
        let width = system.states.len() + system.inputs.len();
        let flow = step::flow(&own.flow);
        let stated = |moment: Moment, factors: &[f64], constant: f64| {
            let used = || factors.iter().enumerate().filter(|(_, factor)| **factor != 0.0);
            if moment == Moment::Prediction && used().all(|(i, _)| self.as_predicted[i]) {
                let mut sum = Affine::constant(constant);
                for (i, factor) in used() {
                    if let Some(next) = self.program.states[i].get(self.step + 1) {
                        sum.add_term(*factor, next);
                    }
                }
                return sum;
            }
            expression(self.program, &moment.map(factors, constant, &flow, width), self.step)
        };
        let mut rows = Vec::new();
        for condition in own.conditions() {
            let ConditionSet::Norm(norm) = condition.set else { continue };
            let row = norm
                .row(self.step, |factors, constant| stated(condition.moment, factors, constant));
            let Some(row) = nontrivial(self.program, row.into(), self.step) else { continue };
            let label = Label::Guard { number: condition.number, is_limit: norm.is_limit };
            let key = (self.number, transition, Some(label), Scope::Own);
            let family = names.keyed(key, &[of, &own.name, &norm.name]);
            rows.push((family, row, !norm.is_limit));
        }
        rows
    }

    /// "The change is the transition's", by the group's variable or by one of the next states,
    /// whichever is violated least over the bounds.
    fn tightest(
        &self,
        transition: usize,
        group: usize,
        halves: Halves,
        model: &Model,
    ) -> Result<Row, Error> {
        let program = self.variables();
        let (changes, t) = (&program.changes, self.step);
        let value = changes.of(self.own, transition, changes.groups[group]);
        let mut forms: Vec<(Affine, f64)> = Vec::new();
        if let Some(variable) = program.groups[group].get(t) {
            forms.push((variable - expression(self.program, &value, t), 1.0));
        }
        for (i, family) in self.program.states.iter().enumerate().filter(|_| self.is_alone()) {
            match (changes.parts[i], family.get(t + 1)) {
                (Part::Shared { group: own, ratio }, Some(next))
                    if own == group && ratio.abs() >= RATIO =>
                {
                    let value = quantity(&self.own[transition], i);
                    forms.push((next - expression(self.program, value, t), ratio));
                }
                _ => {}
            }
        }
        // In the hull, the copies of the next state keep its domain in every transition.
        if self.method == Some(Method::Hull) && forms.len() > 1 {
            forms.remove(0);
        }
        let mut best: Option<(f64, Row)> = None;
        for (form, ratio) in forms {
            let range = model.range(&form)?;
            let (above, below) = (range.upper.max(0.0), (-range.lower).max(0.0));
            let (above, below) = if ratio > 0.0 { (above, below) } else { (below, above) };
            let miss = match halves {
                Halves::Lower => below,
                Halves::Upper => above,
                Halves::Both => above + below,
            };
            let miss = miss / ratio.abs();
            if best.as_ref().is_none_or(|(least, _)| miss < least * (1.0 - 1e-9)) {
                let row = match (halves, ratio > 0.0) {
                    (Halves::Both, _) => form.equals(0.0),
                    (Halves::Upper, true) | (Halves::Lower, false) => form.le(0.0),
                    (Halves::Lower, true) | (Halves::Upper, false) => form.ge(0.0),
                };
                best = Some((miss, row));
            }
        }
        Ok(best.map_or(Affine::zero().le(0.0), |(_, row)| row))
    }

    /// The left side of a guard on the prediction, by the next states, if these are what is
    /// predicted. One variable says more to presolve than the terms of a flow.
    fn by_next(&self, from: usize, row: &SwitchRow) -> Option<Affine> {
        let Label::Guard { number, .. } = row.label else { return None };
        let transition = &self.choice().transitions[from];
        let condition = transition.conditions().nth(number)?;
        let (Moment::Prediction, ConditionSet::HalfSpace(own)) = (condition.moment, condition.set)
        else {
            return None;
        };
        let normal = &own.normal;
        let used = || normal.iter().enumerate().filter(|(_, n)| **n != 0.0);
        if row.w.iter().any(|&w| w != 0.0) || !used().all(|(i, _)| self.as_predicted[i]) {
            return None;
        }
        let flow = step::flow(&transition.flow);
        let factors = normal.iter().copied();
        let predicted = step::combine(factors, &flow, row.z.len(), 0.0);
        // The row may be another one where the prediction is constant.
        if predicted.is_constant() || predicted.factors != row.z {
            return None;
        }
        let mut sum = Affine::zero();
        for (i, n) in used() {
            sum.add_term(*n, self.program.states.get(i)?.get(self.step + 1)?);
            sum += -n * flow[i].constant;
        }
        Some(sum)
    }

    /// The left side of a row.
    fn expression(&self, row: &SwitchRow) -> Affine {
        let z = step::AffineForm { factors: row.z.clone(), constant: 0.0 };
        let mut sum = expression(self.program, &z, self.step);
        for (factor, family) in row.w.iter().zip(&self.variables().groups) {
            if let Some(variable) = family.get(self.step).filter(|_| *factor != 0.0) {
                sum.add_term(*factor, variable);
            }
        }
        sum
    }
}

/// Notes the family of a statement that describes the system.
fn note(background: &mut BTreeSet<String>, family: String, describes: bool) {
    if describes {
        background.insert(family);
    }
}

/// Whether a row describes the system, so that explanations never question it.
fn describes(label: Label) -> bool {
    match label {
        Label::Change { .. } => true,
        Label::Guard { is_limit, .. } => !is_limit,
        Label::Range { .. } => false,
    }
}
