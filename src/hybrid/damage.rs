//! Damage of contacts, and limits on it; the paper's equations (14)-(20).

use super::contact::ImpactSpeed;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::model::{Affine, Family, Model, Variable};
use crate::setters::setters;

/// How the damage of one contact is measured: the paper's `F_d`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DamageFunction {
    /// The speed towards the wall at impact, in m/s.
    #[default]
    ImpactSpeed,
}

/// Which speed counts as the impact speed of a step that hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ImpactEstimate {
    /// At least the approach at both ends of the step. The impact lies between them, so this is
    /// never less than its speed. Steps without a hit stay outside all along.
    #[default]
    Sound,
    /// The approach at the end of the step, had there been no hit, as in the paper. The impact may
    /// be faster, by up to the largest acceleration times Δt, and a step without a hit may dip into
    /// a surface between its ends.
    EndOfStep,
}

/// Limits and cost of damage, in the damage function's unit (m/s for
/// [`DamageFunction::ImpactSpeed`]).
///
/// ```
/// use carom::hybrid::DamageLimits;
///
/// let limits = DamageLimits::default().with_per_impact(2.0).with_cumulative(5.0);
/// assert!(limits.is_active());
/// assert!(!DamageLimits::default().is_active());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DamageLimits {
    /// The measure of damage.
    pub function: DamageFunction,
    /// `D_max` of (19), in the damage function's unit, finite and not negative; no limit if `None`.
    pub per_impact: Option<f64>,
    /// `D_total,max` of (20), in the damage function's unit, finite and not negative; no limit if
    /// `None`.
    pub cumulative: Option<f64>,
    /// Weight of `D_total` in the objective, in the objective's unit per unit of damage, finite
    /// and not negative; default 0.
    pub weight: f64,
}

impl DamageLimits {
    setters! {
        /// Limits the damage of each contact, in the damage function's unit.
        with_per_impact(limit: f64) => per_impact = Some(limit);
        /// Limits the total damage over the horizon, in the damage function's unit.
        with_cumulative(limit: f64) => cumulative = Some(limit);

        /// Adds the total damage to the objective, with a weight in the objective's unit per unit of
        /// damage.
        with_weight(weight: f64) => weight = weight;
    }

    /// Whether there is a limit or a weight, so that damage states are needed.
    pub fn is_active(&self) -> bool {
        self.per_impact.is_some() || self.cumulative.is_some() || self.weight != 0.0
    }

    /// Refuses numbers that are not finite or are negative.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`], naming the limit.
    pub fn check(&self) -> Result<(), Error> {
        let numbers = [
            ("the damage limit per impact", self.per_impact),
            ("the cumulative damage limit", self.cumulative),
            ("the damage weight", Some(self.weight)),
        ];
        for (what, value) in numbers {
            if let Some(value) = value
                && !(value.is_finite() && value >= 0.0)
            {
                return Err(Error::out_of_range(what, value, "finite and not negative"));
            }
        }
        Ok(())
    }
}

/// The damage states of a horizon, as handles of its model.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Damage {
    /// D(t), in the damage function's unit.
    pub values: Family,
    /// `D_total`, the same unit.
    pub total: Variable,
    /// Its share of the objective: weight times `D_total`.
    pub cost: Affine,
}

impl Damage {
    /// Adds the damage states `D[t]` and `D_total` of a horizon to a model.
    ///
    /// | statement | meaning | paper |
    /// | --- | --- | --- |
    /// | `damage_off[t]` | ζ(t) = 0 implies D(t) = 0 | (14), (15) |
    /// | `damage_on[t]` | ζ(t) = 1 implies D(t) = F_d(t) | (16), (17) |
    /// | `damage_total` | D_total - Σ D(t) = 0 | (18) |
    /// | upper bound of `D[t]` | D(t) <= D_max | (19), closed |
    /// | upper bound of `D_total` | D_total <= D_total,max | (20) |
    ///
    /// The statements are [background](Model::set_background), because they define damage. The
    /// limits are bounds, which no [explanation](crate::explain) questions. If it should, omit them
    /// here and add `D[t].le(limit)` as statements.
    ///
    /// If the law's impact speed is 0 in flight, (16) and (17) hold in both modes and are plain
    /// rows.
    ///
    /// The strict `>` of (17) and its -ε become an equality here: the damage *is* F_d. If an impact
    /// speed [has a start](ImpactSpeed::with_start), the damage is at least both, and
    /// `damage_start[t]` says so.
    ///
    /// # Arguments
    ///
    /// * `contacts`: for each step t = 0, 1, ... its contact binary ζ(t) and impact speed, which are
    ///   [`taken`](super::HybridProgram::taken) and the [`output`](super::HybridProgram::output)
    ///   `impact speed` of a program under the reflecting law.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for bad limits, [`ErrorKind::NotFinite`] if an impact speed has no
    /// finite range over the model's bounds, and the errors of [`Model::add`].
    pub fn add(
        model: &mut Model,
        contacts: &[(Variable, ImpactSpeed)],
        limits: &DamageLimits,
    ) -> Result<Self, Error> {
        limits.check()?;
        let DamageFunction::ImpactSpeed = limits.function;
        let values = model.continuous_family("D", contacts.len(), 0.0, 0.0)?;
        let (mut lowest_total, mut highest_total) = (0.0, 0.0);
        for (t, (_, impact)) in contacts.iter().enumerate() {
            let range = model.range(&impact.speed)?;
            let lowest = if impact.zero_in_flight { 0.0 } else { range.lower.min(0.0) };
            let start = impact.start.as_ref().map(|start| model.range(start)).transpose()?;
            let upper = start.map_or(range.upper, |start| range.upper.max(start.upper));
            let highest = upper.max(0.0).min(limits.per_impact.unwrap_or(f64::INFINITY));
            check_finite(format_args!("D[{t}]"), "a bound", [lowest, highest])?;
            model.set_bounds(values[t], lowest, highest)?;
            lowest_total += lowest;
            highest_total += highest;
        }
        let highest_total = limits.cumulative.unwrap_or(highest_total);
        let total = model.continuous("D_total", lowest_total, highest_total)?;
        for (t, ((hit, impact), damage)) in contacts.iter().zip(&values).enumerate() {
            model.add(("damage_off", t), hit.off().implies(damage.equals(0.0)))?;
            let on = match &impact.start {
                None => damage.equals(&impact.speed),
                Some(start) => {
                    let row = hit.on().implies(damage.ge(start));
                    model.add(("damage_start", t), row)?;
                    damage.ge(&impact.speed)
                }
            };
            match impact.zero_in_flight {
                true => drop(model.add(("damage_on", t), on)?),
                false => drop(model.add(("damage_on", t), hit.on().implies(on))?),
            }
        }
        let sum: Affine = values.iter().sum();
        model.add("damage_total", total.equals(sum))?;
        let families = ["damage_off", "damage_on", "damage_total"];
        let added = if contacts.is_empty() { &families[2..] } else { &families[..] };
        added.iter().try_for_each(|family| model.set_background(family))?;
        if contacts.iter().any(|(_, impact)| impact.start.is_some()) {
            model.set_background("damage_start")?;
        }
        let cost = limits.weight * total;
        Ok(Damage { values, total, cost })
    }
}
