//! The paper's own contact law, equations (8)-(13), and its damage, (14)-(20), with the errata
//! corrected.
//!
//! In gap g (m) and rate s (m/s):
//!
//! * (8) ζ(t) = 0 implies `g(t) >= 0`;
//! * (9) ζ(t) = 1 implies `g(t) <= 0`. As printed, `-x(t) - M(1-ζ(t)) >= x_w`, the row is
//!   infeasible whenever ζ(t) = 0, and its right side has the wrong sign if `x_w != 0`. It should
//!   be `x(t) <= x_w + M(1-ζ(t))` (erratum 1);
//! * (10), (11) ζ(t) = 0 implies `a_min <= a(t) <= a_max`;
//! * (12), (13) ζ(t) = 1 implies `a(t) = F_col = -(1+e) v(t)/Δt`;
//! * (3), (4) the double integrator's dynamics, always.
//!
//! The strict inequalities of the paper's other rows are closed here, without an ε, because a
//! solver cannot tell them apart (erratum 2).

use super::scenario::Scenario;
use crate::error::Error;
use crate::hybrid::scene::{DamageMeasure, DamageRule};
use crate::hybrid::{HybridProgram, HybridSystem};
use crate::interval::Interval;
use crate::model::{Affine, Literal};

/// Number of chords of the energy between 0 and its largest value.
const ENERGY_CHORDS: usize = 16;

impl Scenario {
    /// The literal law as a system, with the domain of the positions, in m. It must extend into the
    /// wall, or the law never applies.
    pub(super) fn literal_system(&self, positions: Interval) -> Result<HybridSystem, Error> {
        let (n, at) = (self.wall.normal(), self.wall.position());
        let (e, dt) = (self.restitution.value(), self.time_step);
        let Interval { lower, upper } = self.acceleration;
        // The forced acceleration exceeds the vehicle's own limits.
        let forced = (1.0 + e) * self.max_speed / dt;
        let mut system = HybridSystem::new(dt);
        let x = system.state("vehicle x", positions.lower, positions.upper)?;
        let v = system.state("vehicle vx", -self.max_speed, self.max_speed)?;
        let a = system.input("vehicle ax", lower.min(-forced), upper.max(forced))?;
        if self.pushes != Interval::point(0.0) {
            system.disturbance(v, self.pushes.lower, self.pushes.upper)?;
        }
        system.rates([x.is(v), v.is(a)])?;
        let flight = system.mode("flight")?.guard((n * x).ge(n * at))?;
        flight.guard(a.within(lower, upper))?;
        // Δt a = -(1+e) v, without a division by Δt.
        let contact = system.event("contact")?.guard((n * x).le(n * at))?;
        let contact = contact.guard(((1.0 + e) * v + dt * a).equals(0.0))?;
        if let Some(most) = most_speed(&self.damage, e) {
            contact.limit("the limit on the impact speed", (-n * v).le(most))?;
        }
        Ok(system)
    }
}

/// Adds variables that are at least the impact speed of each step with a contact, in m/s.
///
/// # Arguments
///
/// * `approach`: speed towards the wall at the start of each step, in m/s.
pub(super) fn add_speeds(
    program: &mut HybridProgram,
    contact: &[Literal],
    approach: &[Affine],
) -> Result<Vec<Affine>, Error> {
    add_measure(program, "impact_speed", &|_| vec![(1.0, 0.0)], contact, approach)
}

/// Adds D(t), in the unit of a rule, which is at least the damage of each contact.
pub(super) fn add_damage(
    program: &mut HybridProgram,
    contact: &[Literal],
    approach: &[Affine],
    rule: &DamageRule,
    e: f64,
) -> Result<Vec<Affine>, Error> {
    add_measure(program, "damage", &|most| pieces(rule, e, most), contact, approach)
}

/// Adds variables that are at least the largest of some lines at the approach of a contact.
fn add_measure(
    program: &mut HybridProgram,
    name: &str,
    lines: &dyn Fn(f64) -> Vec<(f64, f64)>,
    contact: &[Literal],
    approach: &[Affine],
) -> Result<Vec<Affine>, Error> {
    let mut values = Vec::with_capacity(contact.len());
    for (t, (hit, approach)) in contact.iter().zip(approach).enumerate() {
        let most = program.model().range(approach)?.upper.max(0.0);
        let lines = lines(most);
        let largest = lines.iter().map(|(slope, constant)| slope * most + constant);
        let largest = largest.fold(0.0, f64::max);
        let value = program.model_mut().continuous((name, t), 0.0, largest)?;
        for (k, (slope, constant)) in lines.into_iter().enumerate() {
            let (family, least) = (format!("{name}_at_{k}"), slope * approach + constant);
            program.add((family.as_str(), t), hit.implies(value.ge(least)))?;
            program.model_mut().set_background(&family)?;
        }
        values.push(value.into());
    }
    Ok(values)
}

/// Adds the limits of a rule on sums of damage and on numbers of contacts, (20).
pub(super) fn limit_sums(
    program: &mut HybridProgram,
    contact: &[Affine],
    damage: &[Affine],
    rule: &DamageRule,
) -> Result<(), Error> {
    let window = rule.window.unwrap_or(contact.len()).min(contact.len());
    let count = rule.count.map(|count| count as f64);
    for (name, most, values) in [("total", rule.total, damage), ("count", count, contact)] {
        let Some(most) = most else { continue };
        for (t, values) in values.windows(window).enumerate() {
            let sum: Affine = values.iter().cloned().sum();
            program.add((format!("{}_{name}", rule.name).as_str(), t), sum.le(most))?;
        }
    }
    Ok(())
}

/// The largest impact speed that the limit of a rule on a hit allows, in m/s; negative if it allows
/// none.
pub(super) fn most_speed(rule: &DamageRule, e: f64) -> Option<f64> {
    let most = rule.per_hit?;
    let least = match &rule.measure {
        DamageMeasure::DissipatedEnergy => (most / (0.5 * (1.0 - e * e))).sqrt(),
        _ => {
            let bound = |(slope, constant): (f64, f64)| match slope > 0.0 {
                true => (most - constant) / slope,
                false if constant <= most => f64::INFINITY,
                false => -1.0,
            };
            pieces(rule, e, 0.0).into_iter().map(bound).fold(f64::INFINITY, f64::min)
        }
    };
    least.is_finite().then_some(least)
}

/// Lines `slope f + constant` whose largest value is at least the damage of an impact speed f from
/// 0 to `most`, per kg.
fn pieces(rule: &DamageRule, e: f64, most: f64) -> Vec<(f64, f64)> {
    match &rule.measure {
        DamageMeasure::Convex(pieces) => pieces.clone(),
        DamageMeasure::NormalImpulse => vec![(1.0 + e, 0.0)],
        DamageMeasure::DissipatedEnergy => {
            let chord = |k: usize| {
                let [one, other] = [k, k + 1].map(|k| most * k as f64 / ENERGY_CHORDS as f64);
                let factor = 0.5 * (1.0 - e * e);
                (factor * (one + other), -factor * one * other)
            };
            (0..ENERGY_CHORDS).map(chord).collect()
        }
        _ => vec![(1.0, 0.0)],
    }
}
