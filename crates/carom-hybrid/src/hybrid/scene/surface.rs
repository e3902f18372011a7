//! Surfaces: to avoid, or to bounce off with or without friction.

use crate::error::SceneError;
use crate::hybrid::contact::Restitution;
use crate::setters::setters;

/// The law for the velocity along a surface in a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Tangential {
    /// No change.
    Frictionless,
    /// `u⁺ = keep u + from_normal f`, with the impact speed f.
    Linear { keep: f64, from_normal: f64 },
    /// Coulomb's law: an impulse of at most `coefficient` times the normal one, in space along one
    /// of `directions` directions.
    Coulomb { coefficient: f64, directions: usize },
}

/// The rules of a surface: whether bodies may bounce off it or rest at it, and how.
///
/// ```
/// use carom::hybrid::Restitution;
/// use carom::hybrid::scene::Surface;
///
/// let cushion = Surface::bounce(Restitution::new(0.8)?).with_friction(0.2);
/// assert!(cushion.restitution().is_some() && Surface::avoid().restitution().is_none());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Surface {
    pub(super) restitution: Option<Restitution>,
    /// By how much the restitution may be more or less (no unit).
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) spread: f64,
    pub(super) tangential: Tangential,
    /// Whether bodies come to rest at it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) rests: bool,
}

impl Surface {
    /// A surface that no body may reach; touching it at a sample is allowed.
    pub fn avoid() -> Self {
        Surface {
            restitution: None,
            spread: 0.0,
            tangential: Tangential::Frictionless,
            rests: false,
        }
    }

    /// A surface off which bodies may bounce, without friction.
    pub fn bounce(restitution: Restitution) -> Self {
        Surface { restitution: Some(restitution), ..Surface::avoid() }
    }

    setters! {
        /// Coulomb's friction with a coefficient (no unit, from 0 to 10): the tangential impulse is
        /// at most this many times the normal one, and stops the sliding if it can. Exact in the
        /// plane; in space it acts along one of 8 directions, within a pyramid inside the cone.
        with_friction(coefficient: f64) =>
            tangential = Tangential::Coulomb { coefficient, directions: 8 };
        /// The same with another number of directions in space, from 3 to 32.
        with_friction_along(coefficient: f64, directions: usize) =>
            tangential = Tangential::Coulomb { coefficient, directions };
        /// Says that the restitution e is not known: it may be up to `spread` more or less (no
        /// unit), in every hit anew. [Robust programs](crate::hybrid::HybridProgram::robust) plan
        /// for all of it, and others for e.
        with_spread(spread: f64) => spread = spread;
        /// A linear law, as identified from experiments: the velocity u with which the touching
        /// points slide along the surface becomes `keep u + from_normal f`, where f is the impact
        /// speed (both no unit). With a [spin](super::Body::with_spin), `-keep` is the tangential
        /// restitution: 1 of Garwin's ideal superball, 0 where it sticks. In the plane, u is
        /// counted along the normal turned left; on a line and in space `from_normal` is 0.
        with_linear_map(keep: f64, from_normal: f64) =>
            tangential = Tangential::Linear { keep, from_normal };
    }

    /// Lets bodies come to rest at it. A hit then ends its step at the surface, and rebounds with e
    /// times the approach at the *start* of the step; a body that does not approach at the start
    /// and would end behind the surface settles there; and one that is at rest there stays as long
    /// as the net acceleration points into it, which is no hit. Bounces die out, as those of a real
    /// ball do, instead of settling at a height that the step makes; the law errs on the side of
    /// slower rebounds. See the [module](super).
    #[must_use]
    pub fn with_rest(mut self) -> Self {
        self.rests = true;
        self
    }

    /// The coefficient of restitution; `None` if the surface is to be avoided.
    pub fn restitution(&self) -> Option<Restitution> {
        self.restitution
    }

    /// Whether hits depend on the restitution by what they do alone, and not by when they do it.
    fn follows_restitution(&self) -> bool {
        self.is_frictionless() || matches!(self.tangential, Tangential::Linear { .. })
    }

    /// Whether nothing happens along the surface.
    pub(super) fn is_frictionless(&self) -> bool {
        match self.tangential {
            Tangential::Frictionless => true,
            Tangential::Linear { keep, from_normal } => keep == 1.0 && from_normal == 0.0,
            Tangential::Coulomb { coefficient, .. } => coefficient == 0.0,
        }
    }

    pub(super) fn check(&self, obstacle: &str, axes: usize) -> Result<(), SceneError> {
        let wrong = |reason| {
            let obstacle = obstacle.to_owned();
            Err(SceneError::Surface { obstacle, reason })
        };
        if self.restitution.is_none() && self.tangential != Tangential::Frictionless {
            return wrong("it is avoided, so nothing rubs there; let bodies bounce, or drop it");
        }
        let e = self.restitution.map_or(0.0, |e| e.value());
        if !(self.spread >= 0.0 && e - self.spread >= 0.0 && e + self.spread <= 1.0) {
            return wrong("its restitution with the spread must lie within [0, 1]");
        }
        if self.spread > 0.0 && (self.rests || !self.follows_restitution()) {
            return wrong(
                "where friction or rest decide by the restitution, it cannot be uncertain; drop \
                 them, or drop `with_spread`",
            );
        }
        if self.rests && self.restitution.is_none() {
            return wrong("it is avoided, so nothing rests there; let bodies bounce, or drop it");
        }
        if let (true, Tangential::Linear { .. }, false) =
            (self.rests, self.tangential, self.is_frictionless())
        {
            return wrong(
                "its linear map says what one hit does, not what rest does in every step; use \
                 friction, or drop `with_rest`",
            );
        }
        match self.tangential {
            Tangential::Frictionless => Ok(()),
            Tangential::Coulomb { coefficient, directions } => {
                if !(0.0..=10.0).contains(&coefficient) {
                    return wrong("the coefficient of friction must lie within [0, 10]");
                }
                if !(3..=32).contains(&directions) {
                    return wrong("friction in space needs 3 to 32 directions");
                }
                Ok(())
            }
            Tangential::Linear { from_normal, .. } => {
                if axes != 2 && from_normal != 0.0 {
                    return wrong("`from_normal` has a meaning in the plane alone; set it to 0");
                }
                Ok(())
            }
        }
    }

    /// Refuses a linear map that adds energy in a contact of a
    /// [mobility](super::contact::ContactPair::mobility).
    pub(super) fn check_energy(&self, obstacle: &str, mobility: f64) -> Result<(), SceneError> {
        let Tangential::Linear { keep, from_normal } = self.tangential else { return Ok(()) };
        let e = self.restitution.map_or(0.0, |e| e.value());
        // Spin and sliding share u: the angular momentum about the touching points stays, and the
        // rest of the energy is m (f² + u²/k)/2. The largest singular value of [[e, 0],
        // [from_normal/√k, keep]] is at most 1.
        let square = from_normal * from_normal / mobility;
        let (trace, det) = (e * e + square + keep * keep, e * keep);
        if trace - det * det <= 1.0 + 1e-12 && det.abs() <= 1.0 && trace.is_finite() {
            return Ok(());
        }
        let reason = "its linear map adds energy; make its entries smaller";
        Err(SceneError::Surface { obstacle: obstacle.to_owned(), reason })
    }
}
