//! Semi-continuous variables: 0, or between two limits.
//!
//! The bounds of such a variable include 0, so whatever reads bounds stays valid. That the values
//! between 0 and the nearer limit are excluded is stored beside them, checked by
//! [`Verification`](crate::solution::Verification), and lowered in
//! `reformulate/semicontinuous.rs`.

use super::Model;
use super::checks::bounds;
use super::ids::Variable;
use super::name::Name;
use super::store::SemicontinuousRange;
use super::variable::VariableKind;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::interval::Interval;

impl Model {
    /// Adds a variable that is 0 or lies within `[lower, upper]`, such as a pump that is off or
    /// runs at least at half its power.
    ///
    /// Its [`bounds`](super::VariableRef::bounds) are `[lower, upper]` extended to 0. Setting other
    /// bounds narrows both parts. A limit may be infinite (also where 0 does not lie within the
    /// limits) if rows imply the bound that is missing, or if the cost of any point does: a solve
    /// looks for one.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let pump = model.semicontinuous("pump", 2.0, 5.0)?;
    /// let level = model.continuous("level", 0.0, 9.0)?;
    /// model.add("inflow", (level - pump).within(0.0, 1.5))?;
    /// model.minimize((level - 2.5).square() + 0.1 * pump)?;
    /// assert!(model.to_string().contains("pump = 0 or 2 <= pump <= 5"));
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(pump)? - 2.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`], [`ErrorKind::InvalidName`], [`ErrorKind::CrossedBounds`], and
    /// [`ErrorKind::NotFinite`] for NaN.
    pub fn semicontinuous(
        &mut self,
        name: impl Into<Name>,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        self.with_zero(name.into(), VariableKind::Continuous, lower, upper)
    }

    /// Adds a semi-integer variable: 0, or a whole number within `[lower, upper]`; otherwise as
    /// [`Model::semicontinuous`].
    ///
    /// # Errors
    ///
    /// As for [`Model::semicontinuous`].
    pub fn semiinteger(
        &mut self,
        name: impl Into<Name>,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        self.with_zero(name.into(), VariableKind::Integer, lower, upper)
    }

    fn with_zero(
        &mut self,
        name: Name,
        kind: VariableKind,
        lower: f64,
        upper: f64,
    ) -> Result<Variable, Error> {
        let (lower, upper) = bounds(lower, upper, &name)?;
        let hull = with_zero(Interval::new(lower, upper));
        let variable = self.variable(name, kind, hull.lower, hull.upper)?;
        self.stored.variables[variable.index()].semicontinuous =
            Some(SemicontinuousRange { lower, upper });
        Ok(variable)
    }

    /// Makes a variable that was just added semi-continuous.
    #[cfg(feature = "serde")]
    pub(super) fn make_semicontinuous(
        &mut self,
        variable: Variable,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        let data = &mut self.stored.variables[variable.index()];
        let (lower, upper) = bounds(lower, upper, &data.name)?;
        data.semicontinuous = Some(SemicontinuousRange { lower, upper });
        Ok(())
    }
}

/// An interval extended to 0.
pub(super) fn with_zero(values: Interval) -> Interval {
    // A lower end of -0 stays.
    let lower = if values.lower > 0.0 { 0.0 } else { values.lower };
    let upper = if values.upper < 0.0 { 0.0 } else { values.upper };
    Interval::new(lower, upper)
}
