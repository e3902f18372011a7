//! Products, absolute values, extrema and piecewise-affine functions as variables of a model.
//!
//! Each method adds a continuous variable that equals the function, whichever way the objective
//! pushes it. Its rows are made at each solve, from the current bounds. No binary is needed if
//! bounds decide the case or if the model pushes the variable only towards its convex side; see
//! `reformulate`.

use super::Model;
use super::affine::Affine;
use super::checks::finite;
use super::function::Function;
use super::ids::Variable;
use super::name::Name;
use super::piecewise::PiecewiseAffine;
use super::refs::FunctionRef;
use super::store::FunctionData;
use super::variable::VariableKind;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;

impl Model {
    /// Adds a variable that equals `factor * of` for a binary or integer `factor`.
    ///
    /// A binary factor needs four rows. An integer factor is split into bits, so its range must be
    /// bounded and at most 1000. All variables of `of` need bounds.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let burning = model.binary("burning")?;
    /// let thrust = model.continuous("thrust", 1.0, 3.0)?;
    /// let force = model.product("force", burning, 2.0 * thrust)?;
    /// model.add("enough", force.ge(5.0))?;
    /// model.minimize(force + burning)?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(thrust)? - 2.5).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotIntegral`] for a continuous factor; [`ErrorKind::DuplicateName`],
    /// [`ErrorKind::InvalidName`], [`ErrorKind::ForeignHandle`], [`ErrorKind::NotFinite`]. Missing
    /// bounds are found when the model is lowered.
    pub fn product(
        &mut self,
        name: impl Into<Name>,
        factor: Variable,
        of: impl Into<Affine>,
    ) -> Result<Variable, Error> {
        self.define(name.into(), Function::Product { factor, of: of.into() })
    }

    /// Adds a variable that equals `|of|`.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous("x", -3.0, 5.0)?;
    /// let effort = model.absolute("effort", x - 1.0)?;
    /// model.minimize(effort + 0.5 * x)?;
    /// let mut solver = BranchAndBound::default();
    /// assert!((solver.solve(&model)?.value(x)? - 1.0).abs() < 1e-6);
    /// // The same variable, pushed to the other side: |x - 1| - x is largest at x = -3.
    /// model.maximize(effort - x)?;
    /// assert!((solver.solve(&model)?.value(effort)? - 4.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`Model::maximum`].
    pub fn absolute(
        &mut self,
        name: impl Into<Name>,
        of: impl Into<Affine>,
    ) -> Result<Variable, Error> {
        self.define(name.into(), Function::Absolute(of.into()))
    }

    /// Adds a variable that equals `max(of, 0)`.
    ///
    /// # Errors
    ///
    /// As for [`Model::maximum`].
    pub fn positive_part(
        &mut self,
        name: impl Into<Name>,
        of: impl Into<Affine>,
    ) -> Result<Variable, Error> {
        self.define(name.into(), Function::Maximum(vec![of.into(), Affine::zero()]))
    }

    /// Adds a variable that equals the largest of several expressions, some of which may be
    /// constant.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous("x", 0.0, 4.0)?;
    /// let worst = model.maximum("worst", [2.0 * x - 3.0, 1.0 - x, Affine::constant(0.5)])?;
    /// model.minimize(worst)?;
    /// assert!(model.to_string().contains("worst = max(2 x - 3, -x + 1, 0.5)"));
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(worst)? - 0.5).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::ForeignHandle`],
    /// [`ErrorKind::NotFinite`]; [`ErrorKind::OutOfRange`] if there is no expression. Missing
    /// bounds are found when the model is lowered.
    pub fn maximum<T: Into<Affine>>(
        &mut self,
        name: impl Into<Name>,
        of: impl IntoIterator<Item = T>,
    ) -> Result<Variable, Error> {
        self.define(name.into(), Function::Maximum(of.into_iter().map(T::into).collect()))
    }

    /// Adds a variable that equals the smallest of several expressions.
    ///
    /// # Errors
    ///
    /// As for [`Model::maximum`].
    pub fn minimum<T: Into<Affine>>(
        &mut self,
        name: impl Into<Name>,
        of: impl IntoIterator<Item = T>,
    ) -> Result<Variable, Error> {
        self.define(name.into(), Function::Minimum(of.into_iter().map(T::into).collect()))
    }

    /// Adds a variable that equals a piecewise-affine function of an expression. The expression
    /// must then lie in the function's domain; [`PiecewiseAffine::extended`] widens it.
    ///
    /// ```
    /// use carom::model::PiecewiseAffine;
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let slip = model.continuous("slip", -2.0, 2.0)?;
    /// let law = PiecewiseAffine::new([(-2.0, 1.0), (-0.5, 1.0), (0.5, -1.0), (2.0, -1.0)])?;
    /// let friction = model.piecewise("friction", slip, &law)?;
    /// model.minimize(friction + 0.1 * slip)?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(slip)? - 0.5).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::ForeignHandle`],
    /// [`ErrorKind::NotFinite`].
    #[doc(alias("piecewise linear", "PWL"))]
    pub fn piecewise(
        &mut self,
        name: impl Into<Name>,
        of: impl Into<Affine>,
        graph: &PiecewiseAffine,
    ) -> Result<Variable, Error> {
        self.define(name.into(), Function::Piecewise { of: of.into(), graph: graph.clone() })
    }

    /// Number of variables that are functions of others.
    pub fn function_count(&self) -> usize {
        self.stored.functions.len()
    }

    /// The variables that are functions of others, in the order of creation. Their arguments are
    /// older than they are.
    pub fn functions(&self) -> impl ExactSizeIterator<Item = FunctionRef<'_>> {
        let data = self.stored.functions.iter();
        data.map(|data| FunctionRef { variable: &self.stored.variables[data.result.index()], data })
    }

    /// A new variable that equals a function.
    #[doc(hidden)]
    pub fn define(&mut self, name: Name, function: Function) -> Result<Variable, Error> {
        self.check_function(&name, &function)?;
        let range = match &function {
            Function::Absolute(_) => Interval::new(0.0, f64::INFINITY),
            Function::Elementary { function, .. } => function.range(Interval::REALS),
            _ => Interval::REALS,
        };
        let result = self.variable(name, VariableKind::Continuous, range.lower, range.upper)?;
        self.stored.functions.push(FunctionData { result, function });
        self.touch();
        Ok(result)
    }

    /// Adds a function from a file: its variable exists, is continuous, younger than the
    /// arguments, and no other function's.
    #[cfg(feature = "serde")]
    pub(super) fn push_stored_function(
        &mut self,
        result: Variable,
        function: Function,
    ) -> Result<(), Error> {
        self.check_variable(result, "a function")?;
        let name = self.variable_ref(result)?.name().clone();
        self.check_function(&name, &function)?;
        let continuous = self.variable_ref(result)?.kind() == VariableKind::Continuous;
        let terms = function.expressions().iter().flat_map(Affine::terms);
        let mut arguments = terms.map(|(v, _)| v).chain(function.factor());
        let newer = self.stored.functions.last().is_none_or(|data| data.result < result);
        if !continuous || !newer || arguments.any(|v| v >= result) {
            return Err(super::store::foreign("variable", result.index(), name));
        }
        self.stored.functions.push(FunctionData { result, function });
        self.touch();
        Ok(())
    }

    fn check_function(&self, name: &Name, function: &Function) -> Result<(), Error> {
        if let Some(factor) = function.factor() {
            self.check_variable(factor, name)?;
            let factor = self.variable_ref(factor)?;
            if !factor.kind().is_integral() {
                return Err(ErrorKind::NotIntegral {
                    name: factor.name().to_string(),
                    place: name.to_string(),
                }
                .into());
            }
        }
        if function.expressions().is_empty() {
            let what = format!("the number of expressions in `{name}`");
            return Err(Error::out_of_range(what, 0.0, 1.0..));
        }
        for expression in function.expressions() {
            for (variable, coefficient) in expression.terms() {
                self.check_variable(variable, name)?;
                finite(coefficient, "a coefficient", name)?;
            }
            finite(expression.offset(), "the constant", name)?;
        }
        Ok(())
    }
}
