//! Soft limits: half-spaces that a run may leave at a price.

use crate::error::{Error, check_finite};
use crate::hybrid::rows::HybridProgram;
use crate::hybrid::system::{Halfspace, check_halfspace};
use crate::model::{Affine, Model, Quadratic};

impl HybridProgram {
    /// Adds a limit that the run may exceed, and returns what that costs: over all samples (or
    /// steps, if the limit depends on the inputs), the sum of
    /// `linear * excess + quadratic * excess²`.
    ///
    /// The excess of a sample is the variable `name_excess[t]`. A linear price above the limit's
    /// shadow price keeps the limit wherever it can be kept; a quadratic price alone does not.
    ///
    /// ```
    /// use carom::hybrid::{Halfspace, Horizon, HybridSystem, LinearSystem, Region, Transition, When};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let system = HybridSystem::new()
    ///     .with_state("x", Interval::new(0.0, 9.0))
    ///     .with_input("u", Interval::new(-2.0, 2.0))
    ///     .with_transition(Transition::new("go", LinearSystem::new([[1.0]], [[1.0]], [0.0])?));
    /// let mut model = Model::new("m");
    /// let program = system.write(&mut model, "", &Horizon::new(2, 1.0)?)?;
    /// program.require(&mut model, "start", &Region::point([4.0]), When::At(0))?;
    /// // At most 1: exceeded by 3 at the start, and by 1 after a step.
    /// let low = Halfspace::new("low", [1.0], 1.0);
    /// let price = program.soften(&mut model, "low", &low, 10.0, 0.0)?;
    /// model.minimize(price)?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.objective().unwrap_or(0.0) - 40.0).abs() < 1e-5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `limit`: by sample, or by step if it depends on the inputs; not a limit of the system, which
    ///   holds without exception.
    /// * `linear`, `quadratic`: cost per unit of the excess, and per unit squared; at least 0.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotFinite`](crate::ErrorKind::NotFinite);
    /// [`ErrorKind::OutOfRange`](crate::ErrorKind::OutOfRange) for a normal of another length, for a
    /// negative price, and if both are 0; [`ErrorKind::DuplicateName`](crate::ErrorKind::DuplicateName). The model then stays
    /// as it was.
    pub fn soften(
        &self,
        model: &mut Model,
        name: &str,
        limit: &Halfspace,
        linear: f64,
        quadratic: f64,
    ) -> Result<Quadratic, Error> {
        let (n, m) = (self.states().len(), self.inputs().len());
        check_halfspace(limit, n, m)?;
        check_finite(name, "a price", [linear, quadratic])?;
        let lower = linear.min(quadratic);
        if lower < 0.0 || linear.max(quadratic) == 0.0 {
            let range = "at least 0, and one of the two prices above 0";
            return Err(Error::out_of_range(format!("a price of `{name}`"), lower, range));
        }
        let (states, inputs) = limit.parts(n);
        let steps = self.horizon().steps();
        let samples = if limit.is_joint(n) { steps } else { steps + 1 };
        model.all_or_nothing(|model| {
            let mut sum = Quadratic::zero();
            for t in (0..samples).filter(|&t| limit.limit_at(t).is_finite()) {
                let state = states.iter().zip(self.states());
                let terms = state.chain(inputs.iter().zip(self.inputs()));
                let terms = terms.filter(|(factor, _)| **factor != 0.0);
                let terms = terms.filter_map(|(factor, family)| Some((*factor, family.get(t)?)));
                let value: Affine = terms.map(|(factor, variable)| factor * variable).sum();
                let most = model.range(&value)?.upper - limit.limit_at(t);
                if most <= 0.0 {
                    continue;
                }
                let excess = model.continuous((format!("{name}_excess"), t), 0.0, most)?;
                model.add((name, t), (value - excess).le(limit.limit_at(t)))?;
                sum += linear * excess + quadratic * excess.square();
            }
            if limit.limit.varies() {
                model.note_by_step(format!("the soft limit `{name}`"));
            }
            Ok(sum)
        })
    }
}
