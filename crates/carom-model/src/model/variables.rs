//! Adding, finding and changing variables.

use super::Model;
use super::affine::Affine;
use super::checks::bounds;
use super::family_shape::FamilyShape;
use super::ids::Variable;
use super::name::Name;
use super::refs::VariableRef;
use super::store::VariableData;
use super::variable::VariableKind;
use crate::activity;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;

impl Model {
    /// Range of an affine expression over the current bounds, rounded outward.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn range(&self, expression: &Affine) -> Result<Interval, Error> {
        let term = |(variable, a)| Ok((a, self.variable_ref(variable)?.bounds()));
        activity::try_range(expression.offset(), expression.terms().into_iter().map(term))
    }

    /// Adds a continuous variable with bounds, either of which may be infinite.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::CrossedBounds`], and
    /// [`ErrorKind::NotFinite`] for NaN.
    pub fn continuous(
        &mut self,
        name: impl Into<Name>,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        self.variable(name, VariableKind::Continuous, lower, upper)
    }

    /// Adds a binary variable.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`] and [`ErrorKind::InvalidName`].
    pub fn binary(&mut self, name: impl Into<Name>) -> Result<Variable, Error> {
        self.variable(name, VariableKind::Binary, 0.0, 1.0)
    }

    /// Adds an integer variable with bounds, either of which may be infinite.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`].
    pub fn integer(
        &mut self,
        name: impl Into<Name>,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        self.variable(name, VariableKind::Integer, lower, upper)
    }

    /// Adds a variable of any kind; a binary's bounds must lie within `[0, 1]`.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`]; [`ErrorKind::OutOfRange`] for a binary outside `[0, 1]`.
    pub fn variable(
        &mut self,
        name: impl Into<Name>,
        kind: VariableKind,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        let name = self.scoped(name.into());
        name.check()?;
        let (lower, upper) = variable_bounds(&name, kind, lower, upper)?;
        let index = self.stored.variables.len();
        let variable = Variable::new(index, self.stored.tag);
        if !self.variable_names.claim(&name, variable.index) {
            return Err(
                ErrorKind::DuplicateName { name: name.to_string(), kind: "variable" }.into()
            );
        }
        self.stored.variables.push(VariableData {
            name,
            kind,
            lower,
            upper,
            range: None,
            semicontinuous: None,
            relaxed: false,
        });
        self.touch();
        Ok(variable)
    }

    /// Adds continuous variables `name[0] .. name[count - 1]` with the same bounds. For two
    /// indices, give a pair of numbers: `name[i][j]` are then members of a family for each `i`.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("transport");
    /// let sent = model.continuous_family("sent", (2, 3), 0.0, 9.0)?; // t, from 2 works to 3 shops
    /// for (shop, need) in [4.0, 5.0, 6.0].into_iter().enumerate() {
    ///     model.add(("need", shop), (sent[0][shop] + sent[1][shop]).ge(need))?;
    /// }
    /// assert!(model.to_string().contains("need[2]: sent[0][2] + sent[1][2] >= 6\n"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`].
    pub fn continuous_family<S: FamilyShape>(
        &mut self,
        name: &str,
        shape: S,
        lower: f64,
        upper: f64,
    ) -> Result<S::Families, Error> {
        shape.add_to(self, name, (VariableKind::Continuous, lower, upper))
    }

    /// Adds binary variables `name[0] .. name[count - 1]`, or `name[i][j]` for a pair of numbers.
    ///
    /// # Errors
    ///
    /// As for [`Model::binary`].
    pub fn binary_family<S: FamilyShape>(
        &mut self,
        name: &str,
        shape: S,
    ) -> Result<S::Families, Error> {
        shape.add_to(self, name, (VariableKind::Binary, 0.0, 1.0))
    }

    /// Adds integer variables `name[0] .. name[count - 1]` with the same bounds, or `name[i][j]`
    /// for a pair of numbers.
    ///
    /// # Errors
    ///
    /// As for [`Model::continuous`].
    pub fn integer_family<S: FamilyShape>(
        &mut self,
        name: &str,
        shape: S,
        lower: f64,
        upper: f64,
    ) -> Result<S::Families, Error> {
        shape.add_to(self, name, (VariableKind::Integer, lower, upper))
    }

    /// Number of variables.
    pub fn variable_count(&self) -> usize {
        self.stored.variables.len()
    }

    /// The variables in the order of creation.
    pub fn variables(&self) -> impl ExactSizeIterator<Item = VariableRef<'_>> {
        let data = self.stored.variables.iter().enumerate();
        data.map(|(i, data)| VariableRef { id: Variable::new(i, self.stored.tag), data })
    }

    /// Name, kind and bounds of a variable.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn variable_ref(&self, variable: Variable) -> Result<VariableRef<'_>, Error> {
        self.check_variable(variable, "a look-up")?;
        Ok(VariableRef { id: variable, data: &self.stored.variables[variable.index()] })
    }

    /// The variable with a name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn variable_by_name(&self, name: impl Into<Name>) -> Result<Variable, Error> {
        let name = name.into();
        match self.variable_names.get(&name) {
            Some(index) => Ok(Variable { index, tag: self.stored.tag }),
            None => Err(ErrorKind::UnknownName { name: name.to_string(), kind: "variable" }.into()),
        }
    }

    /// Changes the bounds of a variable. Automatic big-Ms follow at the next solve. The values of a
    /// semi-continuous variable stay, and both must hold.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`], [`ErrorKind::CrossedBounds`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::OutOfRange`] for a binary outside `[0, 1]`, [`ErrorKind::IsParameter`].
    pub fn set_bounds(&mut self, variable: Variable, lower: f64, upper: f64) -> Result<(), Error> {
        self.check_variable(variable, "set_bounds")?;
        let data = &mut self.stored.variables[variable.index()];
        if data.range.is_some() {
            return Err(ErrorKind::IsParameter { name: data.name.to_string() }.into());
        }
        (data.lower, data.upper) = variable_bounds(&data.name, data.kind, lower, upper)?;
        self.touch();
        Ok(())
    }

    /// Lets an integer variable take values between whole numbers, in a model that is solved with
    /// some of its integers only: those of a long horizon's first steps, for example.
    ///
    /// Statements about it stay as they are, and become rows as if it were whole. So every point of
    /// the model is still one, and the bound of a solve is a bound on the model with all integers.
    /// [`Solution::relaxed`](crate::solution::Solution::relaxed) tells these variables, and the
    /// point is [verified](crate::solution::Solution::verification) by the rows. Continuous
    /// variables stay as they are. Files tell the kind of the variable alone.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("bag");
    /// let (rope, tent) = (model.binary("rope")?, model.binary("tent")?);
    /// model.add("weight", (3.0 * rope + 7.0 * tent).le(8.0))?;
    /// model.maximize(6.0 * rope + 7.0 * tent)?;
    /// model.relax_integer(tent)?;
    ///
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!(solution.is_on(rope)?);
    /// assert!((solution.value(tent)? - 5.0 / 7.0).abs() < 1e-6);
    /// assert_eq!(solution.relaxed(), [tent]);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`].
    pub fn relax_integer(&mut self, variable: Variable) -> Result<(), Error> {
        self.check_variable(variable, "relax_integer")?;
        let data = &mut self.stored.variables[variable.index()];
        data.relaxed = data.kind.is_integral();
        self.touch();
        Ok(())
    }

    /// The integer variables that need not be whole.
    pub fn relaxed_integers(&self) -> impl Iterator<Item = Variable> {
        self.variables().filter(|variable| variable.data.relaxed).map(|variable| variable.id())
    }

    /// Puts continuous variables in the place of relaxed integers. Only rows may speak of them.
    #[doc(hidden)]
    pub fn make_relaxed_continuous(&mut self) {
        let relaxed = self.stored.variables.iter_mut().filter(|data| data.relaxed);
        relaxed.for_each(|data| data.kind = VariableKind::Continuous);
        self.touch();
    }

    /// The model with every variable continuous. If it has only rows, this is its relaxation.
    #[doc(hidden)]
    pub fn with_continuous_variables(mut self) -> Model {
        self.stored.variables.iter_mut().for_each(|data| data.kind = VariableKind::Continuous);
        self.touch();
        self
    }

    /// Fixes a variable to one value; [`set_bounds`](Model::set_bounds) frees it again.
    ///
    /// # Errors
    ///
    /// As for [`Model::set_bounds`].
    pub fn fix(&mut self, variable: Variable, value: f64) -> Result<(), Error> {
        self.set_bounds(variable, value, value)
    }
}

fn variable_bounds(
    name: &Name,
    kind: VariableKind,
    lower: f64,
    upper: f64,
) -> Result<(f64, f64), Error> {
    let (lower, upper) = bounds(lower, upper, name)?;
    if kind == VariableKind::Binary && (lower < 0.0 || upper > 1.0) {
        return Err(Error::out_of_range(
            format!("a bound of the binary `{name}`"),
            if lower < 0.0 { lower } else { upper },
            0.0..=1.0,
        ));
    }
    Ok((lower, upper))
}
