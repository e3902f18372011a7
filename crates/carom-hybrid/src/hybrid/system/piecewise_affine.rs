//! Piecewise-affine systems.

use super::{Halfspace, HybridSystem, Transition};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_length};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::{Matrix, faer};
use crate::interval::Interval;

impl HybridSystem {
    /// A piecewise-affine system: `x⁺ = A x + B u + c` in the mode whose polyhedron
    /// `H (x, u) <= k` contains the state and the input. The modes have no memory.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt, in s.
    /// * `states`, `inputs`: names with domains and ranges, finite.
    /// * `modes`: for each mode its name, its flow, H and k. H has a column per state, or one per
    ///   state and input.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, LinearSystem};
    ///
    /// // The rotation of Bemporad and Morari (Automatica 35, 1999), whose sense depends on x1.
    /// let turn = |angle: f64| {
    ///     let (s, c) = angle.sin_cos();
    ///     LinearSystem::new([[0.8 * c, -0.8 * s], [0.8 * s, 0.8 * c]], [[0.0], [1.0]], [0.0; 2])
    /// };
    /// let third = std::f64::consts::FRAC_PI_3;
    /// let rotation = HybridSystem::piecewise_affine(
    ///     1.0,
    ///     [("x1", -10.0..=10.0), ("x2", -10.0..=10.0)],
    ///     [("u", -1.0..=1.0)],
    ///     [
    ///         ("right", turn(third)?, [[-1.0, 0.0]], [0.0]),
    ///         ("left", turn(-third)?, [[1.0, 0.0]], [0.0]),
    ///     ],
    /// )?;
    /// let run = rotation.simulate(&[1.0, 1.0], &[[0.0], [0.0]])?;
    /// assert_eq!(run.taken(), [["right"], ["left"]]);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`] if H has not as many rows as k has entries; the errors of
    /// [`HybridSystem::check`].
    #[doc(alias = "PWA")]
    pub fn piecewise_affine<S, U, R, M, H, K>(
        time_step: f64,
        states: impl IntoIterator<Item = (S, R)>,
        inputs: impl IntoIterator<Item = (U, R)>,
        modes: impl IntoIterator<Item = (M, LinearSystem, H, K)>,
    ) -> Result<Self, Error>
    where
        S: Into<String>,
        U: Into<String>,
        R: Into<Interval>,
        M: Into<String>,
        H: Into<Matrix>,
        K: Into<Vec<f64>>,
    {
        let mut system = HybridSystem::new(time_step);
        for (name, domain) in states {
            system = system.with_state(name, domain.into());
        }
        for (name, range) in inputs {
            system = system.with_input(name, range.into());
        }
        for (name, flow, normals, limits) in modes {
            let (normals, limits) = (faer(normals), limits.into());
            check_length("the limits of a polyhedron", limits.len(), normals.nrows())?;
            let mut transition = Transition::new(name, flow);
            for (k, limit) in limits.into_iter().enumerate() {
                let normal: Vec<f64> = (0..normals.ncols()).map(|j| normals[(k, j)]).collect();
                let name = format!("row {} of {}", k + 1, transition.name);
                transition = transition.with_guard(Halfspace::new(name, normal, limit));
            }
            system = system.with_transition(transition);
        }
        system.check()?;
        Ok(system)
    }
}
