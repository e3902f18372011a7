//! The elastic form of a model: statements that may give, at a price.

use crate::activity;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{
    Affine, AnyStatement, BigM, IndicatorRef, Literal, Logic, Model, Name, SpecialOrderedSetRef,
    StoredRow, StoredTerm, Variable, VariableKind, at_most, exactly, statements, subset,
};
use crate::reformulate::with_slack;

/// A model whose statements may give, and the variables that say by how much.
pub(super) struct ElasticModel<'a> {
    original: &'a Model,
    pub(super) model: Model,
    pub(super) slacks: Vec<ElasticSlack>,
}

/// The variables that say how much a statement gives: below its lower limit, above its upper one,
/// or, for logic, at all.
pub(super) struct ElasticSlack {
    /// Position of the statement in the original model.
    pub(super) statement: usize,
    pub(super) below: Option<Variable>,
    pub(super) above: Option<Variable>,
}

impl<'a> ElasticModel<'a> {
    /// Makes all statements with a finite weight elastic. The objective is the weighted sum of
    /// their slacks.
    pub(super) fn of(model: &'a Model, weights: &[f64]) -> Result<Self, Error> {
        let mut elastic = ElasticModel {
            original: model,
            model: subset(model, |position| weights[position].is_infinite()),
            slacks: Vec::new(),
        };
        let mut cost = Affine::zero();
        let statements = statements(model).zip(weights).enumerate();
        for (position, (statement, &weight)) in statements.filter(|(_, (_, w))| w.is_finite()) {
            let (below, above) = elastic.add(statement)?;
            for slack in [below, above].into_iter().flatten() {
                cost += weight * slack;
            }
            elastic.slacks.push(ElasticSlack { statement: position, below, above });
        }
        elastic.model.minimize(cost)?;
        Ok(elastic)
    }

    /// Gives the original's variables wide bounds where they have none.
    pub(super) fn within(&mut self, wide: &[Interval]) -> Result<(), Error> {
        for (variable, wide) in self.original.variables().zip(wide) {
            if variable.parameter_range().is_none() {
                self.model.set_bounds(variable.id(), wide.lower, wide.upper)?;
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        statement: AnyStatement<'_>,
    ) -> Result<(Option<Variable>, Option<Variable>), Error> {
        let name = statement.name();
        match statement {
            AnyStatement::Row(row) => {
                let (below, above) = self.slacks(name, row.terms(), row.limits())?;
                let mut terms = row.terms().to_vec();
                terms.extend(below.map(|slack| (slack, 1.0)));
                terms.extend(above.map(|slack| (slack, -1.0)));
                let Interval { lower, upper } = row.limits();
                self.model.push_constraint(name.clone(), StoredRow { terms, lower, upper })?;
                Ok((below, above))
            }
            AnyStatement::Indicator(indicator) => self.add_indicator(indicator),
            AnyStatement::Conic(conic) => {
                let slack = self.slack(name, "_above", VariableKind::Continuous, f64::INFINITY)?;
                let row = with_slack(conic.conic(), name, slack, &self.model)?;
                let condition = conic.condition().cloned();
                self.model.push_conic(name.clone(), condition, row, conic.big_m())?;
                Ok((None, Some(slack)))
            }
            AnyStatement::Disjunction(disjunction) => {
                let fails = self.slack(name, "_fails", VariableKind::Binary, 1.0)?;
                let mut terms = self.released(name, disjunction.stored_terms(), fails, None)?;
                terms.push(StoredTerm::always(fails.on()));
                self.model.push_disjunction(name.clone(), disjunction.method(), terms)?;
                Ok((None, Some(fails)))
            }
            AnyStatement::Set(set) => self.add_set(&set).map(|fails| (None, Some(fails))),
            AnyStatement::Logic(logical) => {
                let fails = self.slack(name, "_fails", VariableKind::Binary, 1.0)?;
                let logic = logical.logic().clone() | fails;
                self.model.push_logical(name.clone(), logic)?;
                Ok((None, Some(fails)))
            }
        }
    }

    /// A set as one chosen place, and indicators that keep the members elsewhere at 0 unless the
    /// set fails.
    fn add_set(&mut self, set: &SpecialOrderedSetRef<'_>) -> Result<Variable, Error> {
        let (name, members) = (set.name(), set.members());
        let fails = self.slack(name, "_fails", VariableKind::Binary, 1.0)?;
        let mut places = Vec::with_capacity(members.len());
        for _ in set.most().min(members.len())..=members.len() {
            places.push(self.slack(name, "_at", VariableKind::Binary, 1.0)?);
        }
        self.model.push_logical(name.clone(), at_most(1, &places))?;
        for (k, &(member, _)) in members.iter().enumerate() {
            let near = (k + 1).saturating_sub(set.most())..places.len().min(k + 1);
            let near = places[near].iter().copied().chain([fails]);
            let row = StoredRow { terms: vec![(member, 1.0)], lower: 0.0, upper: 0.0 };
            let name = self.free(name, &format!("_{}", k + 1));
            self.model.push_indicator(name, !Logic::any(near), row, BigM::Automatic)?;
        }
        Ok(fails)
    }

    /// The terms of a disjunction with selectors of their own, which equal the original ones unless
    /// the disjunction fails; then the original ones are free. `outer` is the original selector of
    /// the enclosing term.
    fn released(
        &mut self,
        name: &Name,
        terms: &[StoredTerm],
        fails: Variable,
        outer: Option<Literal>,
    ) -> Result<Vec<StoredTerm>, Error> {
        let selectors = || terms.iter().map(|term| term.selector);
        let one = exactly(1, selectors());
        let selects = match outer {
            None => one,
            Some(outer) => outer.implies(one) & (!outer).implies(at_most(0, selectors())),
        };
        self.model.push_logical(self.free(name, "_selects"), selects | fails)?;
        let mut released = Vec::with_capacity(terms.len());
        for term in terms {
            let own = self.slack(name, "_takes", VariableKind::Binary, 1.0)?.on();
            self.model.push_logical(self.free(name, "_taken"), own.implies(term.selector))?;
            let nested = term.nested.iter();
            let nested = nested.map(|inner| self.released(name, inner, fails, Some(term.selector)));
            let nested = nested.collect::<Result<_, _>>()?;
            let (rows, conic) = (term.rows.clone(), term.conic.clone());
            released.push(StoredTerm { selector: own, rows, conic, nested });
        }
        Ok(released)
    }

    /// A name that no statement of either model has.
    fn free(&self, name: &Name, suffix: &str) -> Name {
        let mut name = name.suffixed(suffix);
        while self.model.has_statement(&name) || self.original.has_statement(&name) {
            name = name.suffixed("_");
        }
        name
    }

    /// Makes the implied row elastic. Each side becomes an indicator of its own, because a slack of
    /// one side would enlarge the big-M of the other.
    fn add_indicator(
        &mut self,
        indicator: IndicatorRef<'_>,
    ) -> Result<(Option<Variable>, Option<Variable>), Error> {
        let name = indicator.name();
        let (below, above) = self.slacks(name, indicator.terms(), indicator.limits())?;
        let Interval { lower, upper } = indicator.limits();
        let sides = [(below, 1.0, lower, f64::INFINITY), (above, -1.0, f64::NEG_INFINITY, upper)];
        let mut name = name.clone();
        for (slack, sign, lower, upper) in sides {
            let Some(slack) = slack else { continue };
            let mut terms = indicator.terms().to_vec();
            terms.push((slack, sign));
            let (condition, big_m) = (indicator.condition().clone(), indicator.big_m());
            let row = StoredRow { terms, lower, upper };
            self.model.push_indicator(name.clone(), condition, row, big_m)?;
            name = self.free(&name, "_");
        }
        Ok((below, above))
    }

    /// A slack for each finite limit of a row, bounded by how far the row can miss that limit
    /// within the bounds of its variables.
    fn slacks(
        &mut self,
        name: &Name,
        terms: &[(Variable, f64)],
        limits: Interval,
    ) -> Result<(Option<Variable>, Option<Variable>), Error> {
        let term = |&(variable, a): &(Variable, f64)| {
            Ok::<_, Error>((a, self.model.variable_ref(variable)?.bounds()))
        };
        let range = activity::try_range(0.0, terms.iter().map(term))?;
        let mut side = |suffix: &str, limit: f64, miss: f64| match limit.is_finite() {
            true => self.slack(name, suffix, VariableKind::Continuous, miss.max(0.0)).map(Some),
            false => Ok(None),
        };
        let below = side("_below", limits.lower, (limits.lower - range.lower).next_up())?;
        let above = side("_above", limits.upper, (range.upper - limits.upper).next_up())?;
        Ok((below, above))
    }

    fn slack(
        &mut self,
        name: &Name,
        suffix: &str,
        kind: VariableKind,
        most: f64,
    ) -> Result<Variable, Error> {
        let mut name = name.suffixed(suffix);
        while self.model.variable_by_name(name.clone()).is_ok() {
            name = name.suffixed("_");
        }
        self.model.variable(name, kind, 0.0, most)
    }
}
