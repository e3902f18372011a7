//! Damage and rules about it in the program of a scene.

use super::contact::ContactPair;
use super::geometry::{dot, minus};
use super::law::sound_margin;
use super::program::SceneProgram;
use super::rule::{CHORDS, DamageMeasure, DamageRule};
use crate::error::Error;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::damage::ImpactEstimate;
use crate::model::Affine;

impl SceneProgram {
    /// Adds damage to the contacts for which a rule needs it.
    pub(super) fn add_damage(&mut self) -> Result<(), Error> {
        for c in 0..self.contacts.len() {
            let contact = &self.contacts[c];
            let needs = |rule: &DamageRule| {
                let faces = 0..contact.faces.len();
                rule.needs_damage() && faces.into_iter().any(|k| rule.applies(contact, k))
            };
            if self.scene.rules.iter().any(needs) {
                self.add_damage_of(c)?;
            }
        }
        Ok(())
    }

    /// Adds `damage_c[t]`, in m/s: at least the impact speed of each hit. The statements are
    /// [background](crate::model::Model::set_background), because they define damage.
    pub(super) fn add_damage_of(&mut self, c: usize) -> Result<(), Error> {
        let contact = self.contacts[c].clone();
        let hit_modes = || contact.modes.iter().filter(|mode| mode.is_hit);
        if hit_modes().next().is_none() {
            return Ok(());
        }
        let speeds = self
            .program()
            .variables()
            .output_of(&contact.name, IMPACT_SPEED)?
            .map(<[Affine]>::to_vec);
        let is_sound = self.scene.estimate == ImpactEstimate::Sound;
        let dt = self.scene.time_step;
        let family = format!("damage_{c}");
        let mut members = Vec::with_capacity(self.steps());
        for t in 0..self.steps() {
            let hits = self.hits_of(c, t);
            // Without the output, only the approach at the start counts.
            let speed = speeds.as_ref().map_or_else(Affine::zero, |speeds| speeds[t].clone());
            let mut most = self.program.model.range(&speed)?.upper.max(0.0);
            let mut approaches = Vec::new();
            for mode in hit_modes().filter(|_| is_sound) {
                let face = &contact.faces[mode.face];
                let surface = dot(&face.normal, &contact.velocity_in(t, self.scene.axes()));
                let back = minus(&face.normal);
                let margin = sound_margin(face, dt);
                let start = self.along(&contact, &back, t, true) + (surface + margin);
                most = most.max(self.program.model.range(&start)?.upper);
                approaches.push((self.taken(c, mode, t)?, start));
            }
            let margin = contact.faces.iter().map(|f| sound_margin(f, dt)).fold(0.0_f64, f64::max);
            let margin = if is_sound { margin } else { 0.0 };
            let damage = self.program.model.continuous((family.as_str(), t), 0.0, most + margin)?;
            let at_end = speed + margin * hits;
            self.program.add((format!("{family}_end").as_str(), t), damage.ge(at_end))?;
            for (k, (taken, start)) in approaches.into_iter().enumerate() {
                let row = damage.ge(start);
                let name = format!("{family}_start_{k}");
                let stated = match taken {
                    Some(taken) => {
                        self.program.add((name.as_str(), t), taken.implies(row)).map(drop)
                    }
                    None => self.program.add((name.as_str(), t), row).map(drop),
                };
                stated?;
            }
            members.push(damage);
        }
        self.program.model.set_law(&format!("{family}_end"))?;
        for (k, _) in hit_modes().enumerate().filter(|_| is_sound) {
            self.program.model.set_law(&format!("{family}_start_{k}"))?;
        }
        self.damage[c] = Some(members.into_iter().collect());
        Ok(())
    }

    /// Adds the rules on sums and numbers of hits.
    pub(super) fn add_rules(&mut self) -> Result<(), Error> {
        let steps = self.steps();
        for (r, rule) in self.scene.rules.clone().iter().enumerate() {
            let mut measured = Vec::new();
            for c in 0..self.contacts.len() {
                measured.push(self.measure(rule, r, c)?);
            }
            let window = rule.window.unwrap_or(steps).min(steps);
            for first in 0..=steps - window {
                let span = first..first + window;
                if let Some(most) = rule.total {
                    let values = measured.iter().flat_map(|values| values.get(span.clone()));
                    let sum: Affine = values.flatten().cloned().sum();
                    if !sum.terms().is_empty() {
                        let name = format!("{}_total", rule.name);
                        self.program.add((name.as_str(), first), sum.le(most))?;
                    }
                }
                if let Some(most) = rule.count {
                    let contacts = 0..self.contacts.len();
                    let hits = contacts.flat_map(|c| span.clone().map(move |t| (c, t)));
                    let hits: Affine = hits.map(|(c, t)| self.counted(rule, c, t)).sum();
                    if !hits.terms().is_empty() {
                        let name = format!("{}_count", rule.name);
                        self.program.add((name.as_str(), first), hits.le(most as f64))?;
                    }
                }
            }
            self.measured.push(measured);
        }
        Ok(())
    }

    /// A rule's measure of a contact by step; empty if it does not count there, or needs no
    /// variables.
    fn measure(&mut self, rule: &DamageRule, r: usize, c: usize) -> Result<Vec<Affine>, Error> {
        let contact = self.contacts[c].clone();
        let faces: Vec<usize> =
            (0..contact.faces.len()).filter(|&face| rule.applies(&contact, face)).collect();
        let (true, Some(damage), Some(&first)) =
            (rule.needs_damage(), self.damage[c].clone(), faces.first())
        else {
            return Ok(Vec::new());
        };
        let is_all =
            faces.len() == contact.faces.iter().filter(|f| f.surface.restitution.is_some()).count();
        let factor = rule.factor(&contact, first);
        let is_even = faces.iter().all(|&face| rule.factor(&contact, face) == factor);
        let linear =
            matches!(rule.measure, DamageMeasure::ImpactSpeed | DamageMeasure::NormalImpulse);
        let mut values = Vec::with_capacity(damage.len());
        for (t, own) in damage.iter().enumerate() {
            if linear && is_all && is_even {
                values.push(factor * own);
                continue;
            }
            let most = self.program.model.variable_ref(own)?.bounds().upper;
            let largest = faces.iter().map(|&k| rule.damage(&contact, k, most)).fold(0.0, f64::max);
            let family = format!("{}_{r}_{c}", rule.name);
            let value = self.program.model.continuous((family.as_str(), t), 0.0, largest)?;
            for &face in &faces {
                let hit = self.sum_of(c, t, |mode| mode.is_hit && mode.face == face);
                for (k, (slope, constant)) in pieces(rule, &contact, face, most).iter().enumerate()
                {
                    let row = format!("{family}_{face}_{k}");
                    // Where the face is not hit, the right side is at most 0.
                    let off = if is_all && is_even { 0.0 } else { (slope * most).max(0.0) };
                    let right = *slope * own + (constant + off) * hit.clone() - off;
                    self.program.add((row.as_str(), t), value.ge(right))?;
                    if t + 1 == damage.len() {
                        self.program.model.set_law(&row)?;
                    }
                }
            }
            values.push(value.into());
        }
        Ok(values)
    }
}

/// Lines `slope f + constant` whose largest value is at least the damage of f, from 0 to `most`.
fn pieces(rule: &DamageRule, contact: &ContactPair, face: usize, most: f64) -> Vec<(f64, f64)> {
    let factor = rule.factor(contact, face);
    match &rule.measure {
        DamageMeasure::Convex(pieces) => pieces.clone(),
        DamageMeasure::DissipatedEnergy => (0..CHORDS)
            .map(|k| {
                let ends = [k, k + 1].map(|k| most * k as f64 / CHORDS as f64);
                // The chord of a square: (a + b) f - a b.
                (factor * (ends[0] + ends[1]), -factor * ends[0] * ends[1])
            })
            .collect(),
        _ => vec![(factor, 0.0)],
    }
}
