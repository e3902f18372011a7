//! Programs and their answers.

use carom_model::error::Error;
use carom_model::model::{Affine, Family, Model, Quadratic, Variable, VariableKind};

use super::capability::Capability;

/// A missing bound.
pub(super) const INF: f64 = f64::INFINITY;

/// The answer of a program.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Truth {
    /// The optimum, in the model's own sense, and the values of variables that are unique there.
    Optimal(f64, Vec<(Variable, f64)>),
    /// No point satisfies the program.
    Infeasible,
    /// The objective improves without limit.
    Unbounded,
}

/// A program and its answer.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Case {
    /// The name of the case, which says what it tests; the model has the same name.
    pub name: String,
    /// The program.
    pub model: Model,
    /// Its answer.
    pub answer: Truth,
    /// The capabilities that a backend needs for it.
    pub needs: Vec<Capability>,
}

impl Case {
    /// A case whose needs follow from the model and the answer.
    pub(super) fn new(model: Model, answer: Truth) -> Self {
        let mut needs = Vec::new();
        let mut need = |needed: bool, capability| needed.then(|| needs.push(capability));
        let kind = |wanted: VariableKind| model.variables().any(|v| v.kind() == wanted);
        need(kind(VariableKind::Continuous), Capability::Continuous);
        need(kind(VariableKind::Integer), Capability::Integers);
        let quadratic = !model.objective().products().is_empty();
        need(quadratic, Capability::Quadratic);
        // Lowering may add binaries.
        let sets = model.special_ordered_set_count() > 0;
        let semicontinuous = model.variables().any(|v| v.semicontinuous().is_some());
        let whole = kind(VariableKind::Integer) || kind(VariableKind::Binary);
        let integral = whole || model.function_count() > 0 || sets || semicontinuous;
        need(quadratic && integral, Capability::MixedIntegerQuadratic);
        need(has_cones(&model), Capability::Cones);
        need(model.indicator_count() > 0, Capability::Indicators);
        need(model.logical_constraint_count() > 0, Capability::Logic);
        need(model.disjunction_count() > 0, Capability::Disjunctions);
        need(sets, Capability::OrderedSets);
        need(semicontinuous, Capability::SemiContinuous);
        need(model.function_count() > 0, Capability::Functions);
        need(answer == Truth::Unbounded, Capability::Unbounded);
        Case { name: model.name().to_owned(), model, answer, needs }
    }
}

/// Whether there are norms or quadratic rows, also inside disjunctions.
pub(super) fn has_cones(model: &Model) -> bool {
    let mut found = model.conic_constraint_count() > 0;
    for disjunction in model.disjunctions() {
        let terms = disjunction.stored_terms().iter();
        terms.for_each(|term| term.for_each_conic(&mut |_| found = true));
    }
    found
}

/// Collects cases of one file.
#[derive(Default)]
pub(super) struct Cases(pub(super) Vec<Case>);

impl Cases {
    pub(super) fn optimal(&mut self, model: &Model, optimum: f64, values: &[(Variable, f64)]) {
        self.0.push(Case::new(model.clone(), Truth::Optimal(optimum, values.to_vec())));
    }

    pub(super) fn infeasible(&mut self, model: &Model) {
        self.0.push(Case::new(model.clone(), Truth::Infeasible));
    }

    pub(super) fn unbounded(&mut self, model: &Model) {
        self.0.push(Case::new(model.clone(), Truth::Unbounded));
    }
}

/// `coefficients'x`.
pub(super) fn sum(coefficients: &[f64], x: &Family) -> Affine {
    let mut sum = Affine::zero();
    coefficients.iter().zip(x).for_each(|(&a, x)| sum.add_term(a, x));
    sum
}

/// A model with an objective to minimise.
pub(super) fn minimizing(
    mut model: Model,
    objective: impl Into<Quadratic>,
) -> Result<Model, Error> {
    model.minimize(objective)?;
    Ok(model)
}
