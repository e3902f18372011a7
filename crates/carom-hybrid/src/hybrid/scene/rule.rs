//! Rules about damage: what is measured, at which hits, and how much of it is allowed or costs.

use super::contact::ContactPair;
use super::handles::{BodyHandle, ObstacleHandle};
use super::place::Where;
use super::statement::Scene;
use crate::error::{Error, ErrorKind, SceneError};
use crate::model::is_name;
use crate::setters::setters;

/// Number of chords of the energy between 0 and its largest value.
pub(super) const CHORDS: usize = 16;

/// The quantity that measures the damage of a hit.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DamageMeasure {
    /// The impact speed, in m/s.
    #[default]
    ImpactSpeed,
    /// The normal impulse `(1+e) m f`, in N s.
    NormalImpulse,
    /// The kinetic energy `(1-e²) m f²/2` that the hit takes, in J. Needs a surface without
    /// friction.
    DissipatedEnergy,
    /// The largest of `slope f + constant`, in any unit; slopes are not negative.
    Convex(Vec<(f64, f64)>),
}

/// A rule about damage: limits on single hits, on sums over a window of steps, on incidence and on
/// numbers of hits, and prices.
///
/// The impact speed is that of the scene's [`ImpactEstimate`](crate::hybrid::ImpactEstimate).
///
/// ```
/// use carom::hybrid::scene::{DamageMeasure, DamageRule};
///
/// // At most 2 N s in a hit, and 3 N s within any 10 steps.
/// let rule = DamageRule::new("bumper", DamageMeasure::NormalImpulse)
///     .with_per_hit(2.0)
///     .with_total(3.0)
///     .with_window(10);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DamageRule {
    /// Its name.
    pub name: String,
    /// The measured quantity.
    pub measure: DamageMeasure,
    /// Where hits count; everywhere by default.
    #[cfg_attr(feature = "serde", serde(default, skip_deserializing))]
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Where::is_everywhere"))]
    #[cfg_attr(feature = "serde", serde(serialize_with = "Where::refused"))]
    pub(super) place: Where,
    /// The most in one hit, in the measure's unit.
    pub per_hit: Option<f64>,
    /// The most in all hits of a window, in the measure's unit.
    pub total: Option<f64>,
    /// The most hits of a window.
    pub count: Option<usize>,
    /// The length of the window in steps; the whole plan by default.
    pub window: Option<usize>,
    /// The largest angle between the approach and the normal, in rad, below π/2.
    pub incidence: Option<f64>,
    /// The price of a unit of damage, in the objective's unit.
    pub price: f64,
    /// The price of a hit, in the objective's unit.
    pub price_per_hit: f64,
}

impl Default for DamageRule {
    /// A rule `damage` about impact speeds, without limits and prices.
    fn default() -> Self {
        DamageRule::new("damage", DamageMeasure::ImpactSpeed)
    }
}

impl DamageRule {
    /// A rule that measures and limits nothing yet.
    pub fn new(name: impl Into<String>, measure: DamageMeasure) -> Self {
        DamageRule {
            name: name.into(),
            measure,
            place: Where::default(),
            per_hit: None,
            total: None,
            count: None,
            window: None,
            incidence: None,
            price: 0.0,
            price_per_hit: 0.0,
        }
    }

    setters! {
        /// Limits each hit, in the measure's unit.
        with_per_hit(most: f64) => per_hit = Some(most);
        /// Limits the sum over the window, in the measure's unit.
        with_total(most: f64) => total = Some(most);
        /// Limits the number of hits in the window.
        with_count(most: usize) => count = Some(most);
        /// Applies total and count to every window of this many steps: what heals.
        with_window(steps: usize) => window = Some(steps);
        /// Limits the angle between the approach and the normal, in rad.
        with_incidence(most: f64) => incidence = Some(most);
        /// Sets the price of a unit of damage.
        with_price(price: f64) => price = price;
        /// Sets the price of a hit.
        with_price_per_hit(price: f64) => price_per_hit = price;
    }

    /// Counts the hits of one body alone.
    #[must_use]
    pub fn with_body(mut self, body: BodyHandle) -> Self {
        self.place.bodies = [Some(body), None];
        self
    }

    /// Counts the hits of two bodies with each other alone.
    #[must_use]
    pub fn with_pair(mut self, first: BodyHandle, second: BodyHandle) -> Self {
        self.place.bodies = [Some(first), Some(second)];
        self
    }

    /// Counts the hits at one obstacle alone.
    #[must_use]
    pub fn with_obstacle(mut self, obstacle: ObstacleHandle) -> Self {
        (self.place.obstacle, self.place.face) = (Some(obstacle), None);
        self
    }

    /// Counts the hits at one face of an obstacle alone.
    #[must_use]
    pub fn with_face(mut self, obstacle: ObstacleHandle, face: usize) -> Self {
        (self.place.obstacle, self.place.face) = (Some(obstacle), Some(face));
        self
    }

    /// Whether hits of a contact's face count.
    pub(super) fn applies(&self, contact: &ContactPair, face: usize) -> bool {
        self.place.contains([Some(contact.body), contact.other], contact.obstacle, face)
            && contact.faces[face].surface.restitution.is_some()
    }

    /// The largest impact speed that the limit on a hit allows, in m/s.
    pub(super) fn most_speed(&self, contact: &ContactPair, face: usize) -> Option<f64> {
        let most = self.per_hit?;
        Some(match &self.measure {
            DamageMeasure::ImpactSpeed => most,
            DamageMeasure::NormalImpulse => {
                let factor = self.factor(contact, face);
                if factor > 0.0 { most / factor } else { f64::INFINITY }
            }
            DamageMeasure::DissipatedEnergy => {
                let factor = self.factor(contact, face);
                if factor > 0.0 { (most / factor).sqrt() } else { return None }
            }
            DamageMeasure::Convex(pieces) => {
                let bound = |(slope, constant): &(f64, f64)| match *slope > 0.0 {
                    true => (most - constant) / slope,
                    false if *constant <= most => f64::INFINITY,
                    // No hit is allowed.
                    false => -1.0,
                };
                let least = pieces.iter().map(bound).fold(f64::INFINITY, f64::min);
                return least.is_finite().then_some(least);
            }
        })
    }

    /// The factor of the impact speed, or of its square, in the measure.
    pub(super) fn factor(&self, contact: &ContactPair, face: usize) -> f64 {
        let e = contact.faces[face].surface.restitution.map_or(0.0, |e| e.value());
        match self.measure {
            DamageMeasure::NormalImpulse => contact.mass * (1.0 + e),
            DamageMeasure::DissipatedEnergy => 0.5 * contact.mass * (1.0 - e * e),
            _ => 1.0,
        }
    }

    /// The damage of an impact speed (m/s), in the measure's unit.
    pub(super) fn damage(&self, contact: &ContactPair, face: usize, speed: f64) -> f64 {
        let factor = self.factor(contact, face);
        match &self.measure {
            DamageMeasure::ImpactSpeed | DamageMeasure::NormalImpulse => factor * speed,
            DamageMeasure::DissipatedEnergy => factor * speed * speed,
            DamageMeasure::Convex(pieces) => {
                pieces.iter().map(|(a, c)| a * speed + c).fold(0.0, f64::max)
            }
        }
    }

    /// Whether it needs variables for damage.
    pub(super) fn needs_damage(&self) -> bool {
        self.total.is_some() || self.price != 0.0
    }

    /// The tangent of the largest incidence, where there is one.
    pub(super) fn incidence_slope(&self, axes: usize) -> Option<f64> {
        self.incidence.filter(|_| axes > 1).map(f64::tan)
    }

    /// Refuses handles of other scenes and faces that the obstacle does not have.
    fn check_place(&self, scene: &Scene) -> Result<(), Error> {
        let place = format!("the rule `{}`", self.name);
        for body in self.place.bodies.iter().flatten() {
            scene.body_number(*body, &place)?;
        }
        let Some(obstacle) = self.place.obstacle else { return Ok(()) };
        let faces = scene.obstacles[scene.obstacle_number(obstacle, &place)?].faces.len();
        match self.place.face {
            Some(face) if face >= faces => {
                let what = format!("the face of {place}");
                Err(Error::out_of_range(what, face as f64, ..faces as f64))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn check(&self, scene: &Scene) -> Result<(), Error> {
        if !is_name(&self.name) {
            return Err(ErrorKind::InvalidName { name: self.name.clone() }.into());
        }
        self.check_place(scene)?;
        let numbers = [
            ("limit of a hit", self.per_hit.unwrap_or(0.0)),
            ("total", self.total.unwrap_or(0.0)),
            ("price", self.price),
            ("price of a hit", self.price_per_hit),
        ];
        for (what, value) in numbers {
            if !(value.is_finite() && value >= 0.0) {
                let what = format!("the {what} of the rule `{}`", self.name);
                let (range, words) = (0.0..f64::INFINITY, "finite and not negative");
                return Err(Error::out_of_range_in_words(what, value, range, words));
            }
        }
        if self.window == Some(0) {
            let what = format!("the window of the rule `{}`", self.name);
            return Err(Error::out_of_range_with(what, 0.0, 1.0.., " step"));
        }
        if let Some(angle) = self.incidence
            && !(angle > 0.0 && angle < std::f64::consts::FRAC_PI_2)
        {
            let what = format!("the incidence of the rule `{}` (rad)", self.name);
            let (range, words) = (0.0..std::f64::consts::FRAC_PI_2, "above 0 and below π/2");
            return Err(Error::out_of_range_in_words(what, angle, range, words));
        }
        if let DamageMeasure::Convex(pieces) = &self.measure {
            let fits = |(a, c): &(f64, f64)| a.is_finite() && *a >= 0.0 && c.is_finite();
            if pieces.is_empty() || !pieces.iter().all(fits) {
                let reason = "its pieces need finite slopes of at least 0; give at least one";
                return Err(SceneError::Rule { rule: self.name.clone(), reason }.into());
            }
        }
        if self.measure == DamageMeasure::DissipatedEnergy {
            for contact in super::contact::contacts(scene) {
                let rubs = |k: usize| {
                    self.applies(&contact, k) && !contact.faces[k].surface.is_frictionless()
                };
                if (0..contact.faces.len()).any(rubs) {
                    let reason = "the energy that friction takes is not a function of the impact \
                                  speed; measure the normal impulse instead";
                    return Err(SceneError::Rule { rule: self.name.clone(), reason }.into());
                }
            }
        }
        Ok(())
    }
}
