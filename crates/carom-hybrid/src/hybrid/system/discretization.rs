//! How a flow by nonlinear rates becomes a step.

use crate::error::Error;
use crate::model::Affine;

/// The rates at some states.
pub(super) type RatesAt<'a> = dyn FnMut(&[Affine]) -> Result<Vec<Affine>, Error> + 'a;

/// Where a step begins and ends, and the rates between.
pub(super) struct StepRates<'a> {
    /// The states at the start of the step.
    pub(super) start: Vec<Affine>,
    /// The next states.
    pub(super) end: Vec<Affine>,
    /// The rates at some states.
    pub(super) at: &'a mut RatesAt<'a>,
}

/// A method that makes steps of nonlinear rates. Plans, refutations and certificates are about
/// these steps; [`motion`](crate::hybrid::HybridSystem::motion) says how far the motion between
/// them is.
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
    pub(super) fn step(self, rates: StepRates<'_>, h: f64) -> Result<Vec<Affine>, Error> {
        let StepRates { start: x, end: y, at } = rates;
        let moved = |by: &[(f64, &[Affine])]| -> Vec<Affine> {
            let one = |(i, x): (usize, &Affine)| {
                by.iter().fold(x.clone(), |sum, (factor, rates)| sum + h * *factor * &rates[i])
            };
            x.iter().enumerate().map(one).collect()
        };
        let middle: Vec<Affine> = x.iter().zip(&y).map(|(x, y)| 0.5 * x + 0.5 * y).collect();
        Ok(match self {
            Discretization::Euler => moved(&[(1.0, &at(&x)?)]),
            Discretization::ImplicitEuler => moved(&[(1.0, &at(&y)?)]),
            Discretization::Midpoint => moved(&[(1.0, &at(&middle)?)]),
            Discretization::RungeKutta4 => {
                let first = at(&x)?;
                let second = at(&moved(&[(0.5, &first)]))?;
                let third = at(&moved(&[(0.5, &second)]))?;
                let fourth = at(&moved(&[(1.0, &third)]))?;
                let (outer, inner) = (1.0 / 6.0, 1.0 / 3.0);
                moved(&[(outer, &first), (inner, &second), (inner, &third), (outer, &fourth)])
            }
            Discretization::HermiteSimpson => {
                let (first, last) = (at(&x)?, at(&y)?);
                let bent = (0..x.len()).map(|i| &middle[i] + 0.125 * h * (&first[i] - &last[i]));
                let inner = at(&bent.collect::<Vec<Affine>>())?;
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
