//! A nonlinear expression as an affine one over variables that are functions of others.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{FunctionPart, MAX_FUNCTION_DEPTH, Nonlinear};
use crate::elementary::Elementary;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::model::affine::Affine;
use crate::model::function::Function;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::store::Model;
use crate::model::variable::VariableKind;

impl Model {
    /// Adds what a nonlinear expression needs, and returns an affine expression that equals it, for
    /// conditions, disjunctions and whatever else takes rows. Its variables are `name_part1`,
    /// `name_part2`, ...
    ///
    /// The expression must have a value: a model with the square root of `x` has no point at which
    /// `x` is negative.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous("x", 0.0, 4.0)?;
    /// let hot = model.binary("hot")?;
    /// let heat = model.nonlinear("heat", x.exp())?;
    /// model.add("hot", hot.on().implies(heat.ge(20.0)))?;
    /// model.minimize(x - 5.0 * hot)?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(x)? - 20.0_f64.ln()).abs() < 1e-5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`], [`ErrorKind::ForeignHandle`], [`ErrorKind::NotFinite`].
    pub fn nonlinear(
        &mut self,
        name: impl Into<Name>,
        expression: impl Into<Nonlinear>,
    ) -> Result<Affine, Error> {
        let (name, expression) = (name.into(), expression.into());
        self.all_or_nothing(|model| expression.define(model, &name))
    }
}

impl Nonlinear {
    /// The expression over variables of a model, which are added under a name.
    pub(in crate::model) fn define(self, model: &mut Model, name: &Name) -> Result<Affine, Error> {
        self.check_depth(name)?;
        Definer::new(model, name).affine(&self)
    }

    /// The same, with products of variables.
    pub(in crate::model) fn define_parts(
        self,
        model: &mut Model,
        name: &Name,
    ) -> Result<Quadratic, Error> {
        self.check_depth(name)?;
        Definer::new(model, name).quadratic(&self)
    }
}

impl Nonlinear {
    /// Refuses functions that are too deep inside each other.
    fn check_depth(&self, name: &Name) -> Result<(), Error> {
        if self.depth <= MAX_FUNCTION_DEPTH {
            return Ok(());
        }
        Err(Error::out_of_range_with(
            format!("the number of functions inside each other in `{name}`"),
            f64::from(self.depth),
            ..=f64::from(MAX_FUNCTION_DEPTH),
            "; give inner ones variables of their own by `Model::nonlinear`",
        ))
    }
}

/// The variables that a statement needs.
struct Definer<'a> {
    model: &'a mut Model,
    name: Name,
    named: usize,
    /// By the place of a part, the expression that it became.
    known: BTreeMap<*const FunctionPart, Affine>,
}

impl<'a> Definer<'a> {
    fn new(model: &'a mut Model, name: &Name) -> Self {
        Definer { model, name: name.clone(), named: 0, known: BTreeMap::new() }
    }

    fn affine(&mut self, expression: &Nonlinear) -> Result<Affine, Error> {
        let quadratic = self.quadratic(expression)?;
        let mut affine = quadratic.affine().clone();
        for (first, second, factor) in quadratic.products() {
            affine.append(&self.product(first.into(), second.into())?, factor);
        }
        Ok(affine)
    }

    fn quadratic(&mut self, expression: &Nonlinear) -> Result<Quadratic, Error> {
        let mut sum = expression.rest.clone();
        for (factor, part) in &expression.parts {
            sum.append(&self.part(part)?.into(), *factor);
        }
        Ok(sum)
    }

    fn part(&mut self, part: &Arc<FunctionPart>) -> Result<Affine, Error> {
        let key = Arc::as_ptr(part);
        if let Some(known) = self.known.get(&key) {
            return Ok(known.clone());
        }
        let made = match &**part {
            FunctionPart::Elementary(function, of) => {
                let of = self.affine(of)?;
                self.elementary(function.clone(), of)?
            }
            FunctionPart::Product(left, right) => {
                let (left, right) = (self.affine(left)?, self.affine(right)?);
                self.product(left, right)?
            }
            FunctionPart::Quotient(left, right) => {
                let (left, right) = (self.affine(left)?, self.affine(right)?);
                self.quotient(left, right)?
            }
            FunctionPart::Absolute(of) => {
                let of = self.affine(of)?;
                match of.terms().is_empty() {
                    true => Affine::constant(of.offset().abs()),
                    false => self.variable(Function::Absolute(of))?,
                }
            }
            FunctionPart::Piecewise(graph, of) => {
                let of = self.affine(of)?;
                match of.terms().is_empty() {
                    true => Affine::constant(graph.value_near(of.offset())),
                    false => self.variable(Function::Piecewise { of, graph: graph.clone() })?,
                }
            }
            // Refused before.
            FunctionPart::Dropped => Affine::zero(),
            FunctionPart::Maximum(left, right) => {
                let both = vec![self.affine(left)?, self.affine(right)?];
                self.variable(Function::Maximum(both))?
            }
        };
        self.known.insert(key, made.clone());
        Ok(made)
    }

    fn elementary(&mut self, function: Elementary, of: Affine) -> Result<Affine, Error> {
        match (&function, of.terms().is_empty()) {
            (_, true) => Ok(Affine::constant(function.value(of.offset()))),
            (Elementary::Power(1.0), _) => Ok(of),
            (Elementary::Power(0.0), _) => Ok(Affine::constant(1.0)),
            _ => self.variable(Function::Elementary { function, of }),
        }
    }

    fn product(&mut self, left: Affine, right: Affine) -> Result<Affine, Error> {
        if left.terms().is_empty() {
            return Ok(right * left.offset());
        }
        if right.terms().is_empty() {
            return Ok(left * right.offset());
        }
        if left == right {
            return match self.binary(&left) {
                Some(_) => Ok(left),
                None => self.elementary(Elementary::Power(2.0), left),
            };
        }
        match (self.binary(&left), self.binary(&right)) {
            (Some(factor), _) => self.variable(Function::Product { factor, of: right }),
            (None, Some(factor)) => self.variable(Function::Product { factor, of: left }),
            (None, None) => self.variable(Function::Bilinear([left, right])),
        }
    }

    fn quotient(&mut self, left: Affine, right: Affine) -> Result<Affine, Error> {
        if right.terms().is_empty() {
            return Ok(left * (1.0 / right.offset()));
        }
        if left.terms().is_empty() {
            let factor = left.offset();
            return Ok(self.elementary(Elementary::Power(-1.0), right)? * factor);
        }
        self.variable(Function::Quotient([left, right]))
    }

    /// The binary that an expression is.
    fn binary(&self, expression: &Affine) -> Option<Variable> {
        match (expression.terms().as_slice(), expression.offset()) {
            (&[(variable, 1.0)], 0.0) => {
                let found = self.model.variable_ref(variable).ok()?;
                (found.kind() == VariableKind::Binary && found.parameter_range().is_none())
                    .then_some(variable)
            }
            _ => None,
        }
    }

    /// A variable that equals a function, an older one if there is one.
    fn variable(&mut self, function: Function) -> Result<Affine, Error> {
        let key = function.text(&|v| format!("#{}", v.index()));
        let is_own = matches!(function, Function::Elementary { function: Elementary::Own(_), .. });
        if let Some(&known) = self.model.parts.get(&key).filter(|_| !is_own) {
            return Ok(known.into());
        }
        let name = loop {
            self.named += 1;
            let name = self.name.suffixed(&format!("_part{}", self.named));
            if self.model.variable_by_name(name.clone()).is_err() {
                break name;
            }
        };
        let variable = self.model.define(name, function)?;
        if !is_own {
            self.model.parts.insert(key, variable);
        }
        Ok(variable.into())
    }
}
