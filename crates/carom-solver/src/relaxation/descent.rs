//! Directions in which the objective of a program falls without limit.

use super::attempts::Purpose;
use super::method_cascade::MethodCascade;
use super::polish::polish;
use super::recession::{growth_program, is_descent_ray, recession_program, relaxed_along};
use crate::presolve::Reduced;
use crate::solver::StopToken;

impl MethodCascade {
    /// Looks for a direction of descent without end, or for a curve, when no method named one.
    pub(super) fn falls_forever(&mut self, program: &Reduced, token: &StopToken) -> bool {
        let is_ray = |ray: &[f64]| is_descent_ray(program, ray);
        if recession_program(program).is_some_and(|all| self.has_direction(&all, token, is_ray)) {
            return true;
        }
        let Some(growth) = growth_program(program) else { return false };
        let mut relaxed = None;
        self.has_direction(&growth, token, |ray| {
            relaxed = relaxed_along(program, ray);
            relaxed.is_some()
        });
        let Some(relaxed) = relaxed else { return false };
        let is_ray = |ray: &[f64]| is_descent_ray(&relaxed, ray);
        recession_program(&relaxed).is_some_and(|all| self.has_direction(&all, token, is_ray))
    }

    /// Whether the steepest of some directions is accepted.
    fn has_direction(
        &mut self,
        directions: &Reduced,
        token: &StopToken,
        mut accept: impl FnMut(&[f64]) -> bool,
    ) -> bool {
        if directions.is_conic() {
            return self.steepest_conic(directions, token, accept);
        }
        let mut result = self.solve_once(directions, Purpose::Direction, token);
        polish(directions, &mut result.x, token);
        accept(&result.x)
    }
}
