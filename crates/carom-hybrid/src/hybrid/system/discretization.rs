//! How a flow by nonlinear rates becomes a step.

use super::HybridSystem;
use super::step_functions::FlowFunctions;
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::model::{Affine, Nonlinear};

/// A method that makes steps of nonlinear rates. Plans, refutations and certificates are about
/// these steps; [`HybridSystem::motion`] says how far the motion between them is.
///
/// Inputs are held over the step. Linear rates need no method: their step is exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Discretization {
    /// `x⁺ = x + Δt f(x)`, of first order.
    Euler,
    /// `x⁺ = x + Δt f(x⁺)`, of first order, for stiff rates.
    ImplicitEuler,
    /// `x⁺ = x + Δt f((x + x⁺) / 2)`, of second order, with one value of each function in a step.
    #[default]
    Midpoint,
    /// The classical method of Runge and Kutta, explicit and of fourth order, with four values of
    /// each function in a step.
    RungeKutta4,
    /// Collocation by a cubic polynomial (C. R. Hargraves, S. W. Paris, "Direct trajectory
    /// optimization using nonlinear programming and collocation", Journal of Guidance, Control, and
    /// Dynamics 10(4), 1987), of fourth order, with three values of each function in a step.
    HermiteSimpson,
}

impl Discretization {
    /// Whether the step is an equation in the next state.
    pub fn is_implicit(self) -> bool {
        !matches!(self, Discretization::Euler | Discretization::RungeKutta4)
    }

    /// The next states by rates.
    fn step(self, rates: &mut FlowFunctions<'_>, h: f64) -> Result<Vec<Affine>, Error> {
        let (x, y) = (rates.start.clone(), rates.end.clone());
        let moved = |by: &[(f64, &[Affine])]| -> Vec<Affine> {
            let at = |(i, x): (usize, &Affine)| {
                by.iter().fold(x.clone(), |sum, (factor, rates)| sum + h * *factor * &rates[i])
            };
            x.iter().enumerate().map(at).collect()
        };
        let middle: Vec<Affine> = x.iter().zip(&y).map(|(x, y)| 0.5 * x + 0.5 * y).collect();
        Ok(match self {
            Discretization::Euler => moved(&[(1.0, &rates.at(&x)?)]),
            Discretization::ImplicitEuler => moved(&[(1.0, &rates.at(&y)?)]),
            Discretization::Midpoint => moved(&[(1.0, &rates.at(&middle)?)]),
            Discretization::RungeKutta4 => {
                let first = rates.at(&x)?;
                let second = rates.at(&moved(&[(0.5, &first)]))?;
                let third = rates.at(&moved(&[(0.5, &second)]))?;
                let fourth = rates.at(&moved(&[(1.0, &third)]))?;
                let (outer, inner) = (1.0 / 6.0, 1.0 / 3.0);
                moved(&[(outer, &first), (inner, &second), (inner, &third), (outer, &fourth)])
            }
            Discretization::HermiteSimpson => {
                let (first, last) = (rates.at(&x)?, rates.at(&y)?);
                let bent = (0..x.len()).map(|i| &middle[i] + 0.125 * h * (&first[i] - &last[i]));
                let inner = rates.at(&bent.collect::<Vec<Affine>>())?;
                moved(&[(1.0 / 6.0, &first), (2.0 / 3.0, &inner), (1.0 / 6.0, &last)])
            }
        })
    }
}

impl std::fmt::Display for Discretization {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Discretization::Euler => "Euler's method",
            Discretization::ImplicitEuler => "Euler's implicit method",
            Discretization::Midpoint => "the midpoint rule",
            Discretization::RungeKutta4 => "the method of Runge and Kutta",
            Discretization::HermiteSimpson => "collocation by Hermite and Simpson",
        })
    }
}

impl HybridSystem {
    /// Sets the method that makes steps of nonlinear rates; without it, the
    /// [midpoint rule](Discretization::Midpoint). An implicit method is for flows that lead to the
    /// next state: without a reset, and, beside other choices, the common flow.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] after the first nonlinear flow.
    pub fn discretization(&mut self, method: Discretization) -> Result<(), Error> {
        if self.is_nonlinear() {
            let name = "the discretization".to_owned();
            let place = "a statement after a nonlinear flow".to_owned();
            let help = "state it before the first flow";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        self.functions.method = method;
        Ok(())
    }

    /// The method that makes steps of the nonlinear rates; `None` if no flow has nonlinear rates.
    pub fn discretized_by(&self) -> Option<Discretization> {
        self.functions.has_rates().then_some(self.functions.method)
    }

    /// The step of nonlinear rates.
    pub(super) fn discretized(&mut self, rates: &[Nonlinear]) -> Result<LinearSystem, Error> {
        let (method, h) = (self.functions.method, self.time_step);
        self.flow_of_functions(rates, true, |own| method.step(own, h))
    }
}
