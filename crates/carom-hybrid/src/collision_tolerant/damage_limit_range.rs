//! The limits on the damage of one impact, equation (19), for which a horizon is the shortest.

use super::scenario::Scenario;
use crate::error::{Error, SceneError};
use crate::hybrid::ContactLaw;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::scene::{DamageLimitOptions, DamageLimitRange};
use crate::solver::Solver;

impl Scenario {
    /// Finds the limits `D_max` for which a horizon is the shortest one, as
    /// [`Scene::damage_limit_range`](crate::hybrid::scene::Scene::damage_limit_range) does.
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    /// use carom::hybrid::scene::DamageLimitOptions;
    /// use carom::prelude::*;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let (options, mut solver) = (DamageLimitOptions::default(), BranchAndBound::default());
    /// let interval = scenario.damage_limit_range(49, &options, &mut solver)?;
    /// assert!((interval.lower.attained - 5.895).abs() < 2e-3);
    /// assert!((interval.upper.attained - 6.947).abs() < 2e-3);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`Scene::damage_limit_range`](crate::hybrid::scene::Scene::damage_limit_range), and
    /// [`SceneError::NoDamageLimitRange`] under the literal law.
    pub fn damage_limit_range(
        &self,
        steps: usize,
        options: &DamageLimitOptions,
        solver: &mut dyn Solver,
    ) -> Result<DamageLimitRange, Error> {
        self.check()?;
        if self.contact.law == ContactLaw::Literal {
            let reason = "scenes do not have the literal law; choose the reflecting one".into();
            return Err(SceneError::NoDamageLimitRange { reason }.into());
        }
        let horizon = Horizon::new(steps, self.time_step)?;
        self.scene(&horizon).damage_limit_range(steps, options, solver)
    }
}
