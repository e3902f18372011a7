//! The program of a scene over a horizon.

use super::axes::AXES;
use super::contact::{ContactFace, ContactPair, Mode};
use super::geometry::dot;
use super::rule::DamageRule;
use super::statement::{INSIDE, Scene};
use super::system::Stated;
use super::units::SceneUnits;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::program::{HybridProgram, owns_program};
use crate::model::{Affine, Family, Literal, Model, Quadratic, either};

/// The program of a scene over a horizon: the [`HybridProgram`] of the scene's
/// [system](Scene::hybrid_system), with the rules of the scene.
///
/// All that a hybrid program offers can be asked of it too. Its objective is the price of the
/// rules, until [`minimize`](HybridProgram::minimize) sets another one.
#[derive(Debug, Clone)]
pub struct SceneProgram {
    pub(super) program: HybridProgram,
    /// In units of its own.
    pub(super) scene: Scene,
    pub(super) units: SceneUnits,
    pub(super) contacts: Vec<ContactPair>,
    /// Damage of each contact by step, if a rule needs it.
    pub(super) damage: Vec<Option<Family>>,
    /// The value of each rule's measure by contact and step.
    pub(super) measured: Vec<Vec<Vec<Affine>>>,
    /// The cases, by name; the model is that of this program.
    pub(super) cases: Vec<(String, SceneProgram)>,
}

owns_program!(SceneProgram);

impl Scene {
    /// The program of the scene over a horizon, from starts to goals. Bodies without a start or a
    /// goal may begin or end anywhere.
    ///
    /// [Sets](Scene::reach_sets) of each axis fix transitions that no plan takes and narrow bounds.
    /// No plan is lost. If they prove that there is none, the row `no_plan_by_reach_sets`
    /// contradicts the bounds, and [`ReachSets::explain`](crate::hybrid::reach::ReachSets::explain)
    /// says why. Where hits couple axes, by friction, slanted faces or pairs of bodies, there are
    /// such sets only if a step has few combinations of modes.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Solid, Scene, Surface};
    /// use carom::prelude::*;
    ///
    /// let room = [0.0..=4.0, 0.0..=2.0];
    /// let pillar = [1.5..=2.0, -0.1..=1.2];
    /// let scene = Scene::new(0.25)
    ///     .with_body(
    ///         Body::new("drone", room, 2.0, 2.0)
    ///             .with_start([0.5, 0.5, 0.0, 0.0])
    ///             .with_goal([3.5, 0.5, 0.0, 0.0]),
    ///     )
    ///     .with_obstacle(Solid::cuboid("pillar", &pillar, Surface::avoid()));
    /// let mut program = scene.program(16)?;
    /// let effort = program.effort()?;
    /// program.minimize(effort)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// // Touching the pillar is allowed.
    /// let inside = |p: &Vec<f64>| p[0] > 1.50001 && p[0] < 1.99999 && p[1] < 1.19999;
    /// assert!(!plan.bodies[0].position.iter().any(inside));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `steps`: the horizon τ.
    ///
    /// # Errors
    ///
    /// [`SceneError`](super::SceneError) and others for a scene that contradicts itself, or whose
    /// courses are shorter than the horizon; those of
    /// [`HybridSystem::program`](crate::hybrid::HybridSystem::program).
    pub fn program(&self, steps: usize) -> Result<SceneProgram, Error> {
        let stated = self.stated()?;
        let mut program = stated.program(steps)?;
        if !program.tighten_by_sets(&stated)? {
            program.contradict()?;
        }
        Ok(program)
    }

    /// The [program](Scene::program) as it is stated, without what sets say about it: for other
    /// solvers that shall confirm both.
    ///
    /// # Errors
    ///
    /// As for [`program`](Scene::program).
    pub fn plain_program(&self, steps: usize) -> Result<SceneProgram, Error> {
        self.stated()?.program(steps)
    }
}

impl Stated {
    /// The program from the starts to the goals.
    pub(super) fn program(&self, steps: usize) -> Result<SceneProgram, Error> {
        self.check_courses(steps)?;
        let mut model = Model::new("scene");
        let horizon = Horizon::new(steps, self.system.time_step)?;
        let user = self.user_system()?;
        let hybrid = user.write_restated(&self.restated(), &mut model, "", &horizon, None)?;
        let mut program = HybridProgram::from_parts(model, hybrid);
        program.systems_mut().modes_follow_states = true;
        let mut program = self.completed(program)?;
        let price = program.price();
        program.minimize(price)?;
        Ok(program)
    }

    /// Refuses obstacles whose courses end before some steps.
    pub(super) fn check_courses(&self, steps: usize) -> Result<(), Error> {
        match self.scene.longest().filter(|(_, last)| *last < steps) {
            None => Ok(()),
            Some((obstacle, last)) => {
                let obstacle = obstacle.name.clone();
                Err(super::SceneError::Course { obstacle, last, needed: steps }.into())
            }
        }
    }

    /// A program whose first system is that of the scene, with starts, goals and rules.
    pub(super) fn completed(&self, mut program: HybridProgram) -> Result<SceneProgram, Error> {
        let Stated { scene, contacts, system, .. } = self;
        program.require_own("start", &scene.ends(system, true), 0)?;
        program.require_own("goal", &scene.ends(system, false), program.steps())?;
        let mut program = SceneProgram {
            program,
            scene: scene.clone(),
            units: self.units.clone(),
            contacts: contacts.clone(),
            damage: vec![None; contacts.len()],
            measured: Vec::new(),
            cases: Vec::new(),
        };
        program.fix_first()?;
        program.start_outside()?;
        program.one_hit()?;
        program.next_outside()?;
        program.add_damage()?;
        program.add_rules()?;
        Ok(program)
    }
}

impl SceneProgram {
    /// The effort `Σ Δt |u(t)|²` of all bodies, in m²/s³, without that of torques.
    ///
    /// # Errors
    ///
    /// None for programs of scenes.
    pub fn effort(&self) -> Result<Quadratic, Error> {
        let mut effort = Quadratic::zero();
        let factor = self.units.effort() * self.scene.time_step;
        for family in self.accelerations() {
            for variable in family {
                effort.add_product(factor, variable, variable);
            }
        }
        Ok(effort)
    }

    /// The fuel of all bodies, in m/s², without that of torques; adds variables to the model. Of a
    /// body with an [acceleration ball](super::Body::with_acceleration_ball), whose thrust can be
    /// turned, it is the sum of the lengths of the inputs, and of others the sum of their
    /// magnitudes along each axis.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`] at the second call.
    pub fn fuel(&mut self) -> Result<Affine, Error> {
        let mut fuel = Affine::zero();
        let axes = self.scene.axes();
        for (k, family) in self.accelerations().to_vec().iter().enumerate() {
            if self.scene.bodies[k / axes].acceleration_ball.is_some() {
                if k % axes == 0 {
                    fuel += self.lengths(k)?;
                }
                continue;
            }
            for (t, variable) in family.iter().enumerate() {
                let most = self.program.model.variable_ref(variable)?.bounds().magnitude();
                let name = format!("fuel_{k}");
                let size = self.program.model.continuous((name.as_str(), t), 0.0, most)?;
                let above = format!("fuel_above_{k}");
                let below = format!("fuel_below_{k}");
                self.program.add((above.as_str(), t), size.ge(variable))?;
                self.program.add((below.as_str(), t), size.ge(-variable))?;
                fuel += size;
            }
        }
        Ok(if self.units.is_plain() { fuel } else { self.units.acceleration() * fuel })
    }

    /// The inputs along the axes, by body.
    fn accelerations(&self) -> &[Family] {
        &self.program().variables().inputs()[..self.scene.axes() * self.scene.bodies.len()]
    }

    /// The sum of the lengths of a body's inputs, of which the first is given.
    fn lengths(&mut self, first: usize) -> Result<Affine, Error> {
        let own = self.accelerations()[first..first + self.scene.axes()].to_vec();
        let (steps, model) = (self.program.steps(), &mut self.program.model);
        let length = |t: usize| {
            let entries = own.iter().filter_map(|family| family.get(t));
            Ok(Affine::from(model.norm((format!("fuel_{first}"), t), entries)?))
        };
        (0..steps).map(length).sum()
    }

    /// The number of hits of all bodies.
    pub fn hits(&self) -> Affine {
        let steps = 0..self.steps();
        steps.map(|t| (0..self.contacts.len()).map(|c| self.hits_of(c, t)).sum::<Affine>()).sum()
    }

    /// The largest damage of a hit, in m/s: that of a new variable `largest_damage`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`] at the second call.
    pub fn largest_impact(&mut self) -> Result<Affine, Error> {
        for c in 0..self.contacts.len() {
            if self.damage[c].is_none() && self.contacts[c].bounces() {
                self.add_damage_of(c)?;
            }
        }
        let families: Vec<Family> = self.damage.iter().flatten().cloned().collect();
        let mut most = 0.0_f64;
        for variable in families.iter().flatten() {
            most = most.max(self.program.model.variable_ref(variable)?.bounds().upper);
        }
        let largest = self.program.model.continuous("largest_damage", 0.0, most)?;
        for (k, family) in families.iter().enumerate() {
            for (t, variable) in family.iter().enumerate() {
                let name = format!("damage_at_most_{k}");
                self.program.add((name.as_str(), t), largest.ge(variable))?;
            }
        }
        Ok(self.units.speed() * largest)
    }

    /// The sum of the prices of the rules: what their damage and their hits cost.
    pub fn price(&self) -> Affine {
        let mut price = Affine::zero();
        for (rule, measured) in self.scene.rules.iter().zip(&self.measured) {
            for (c, values) in measured.iter().enumerate() {
                price += rule.price * values.iter().cloned().sum::<Affine>();
                if rule.price_per_hit != 0.0 {
                    let hits = (0..self.steps()).map(|t| self.counted(rule, c, t));
                    price += rule.price_per_hit * hits.sum::<Affine>();
                }
            }
        }
        price
    }

    /// The damage that a rule measures over the whole plan, in its unit, by the rule's name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`] for a rule that the scene does not have, or that has neither a
    /// total nor a price, so that its damage is no variable.
    pub fn damage(&self, rule: &str) -> Result<Affine, Error> {
        Ok(self.damage_by_step(rule)?.into_iter().sum())
    }

    /// The damage that a rule measures in each step, in its unit; empty if it counts no contact.
    /// Rows and costs of part of a plan are stated with it, such as a limit on what a critical
    /// phase may take.
    ///
    /// # Errors
    ///
    /// As for [`damage`](SceneProgram::damage).
    pub fn damage_by_step(&self, rule: &str) -> Result<Vec<Affine>, Error> {
        let known = self.scene.rules.iter().position(|own| own.name == rule && own.needs_damage());
        let k = known.ok_or_else(|| Error::unknown_name(rule, "rule with a total or a price"))?;
        let unit = self.units.damage(&self.scene.rules[k].measure);
        let counted: Vec<_> = self.measured[k].iter().filter(|own| !own.is_empty()).collect();
        let steps = if counted.is_empty() { 0 } else { self.steps() };
        let sum = |t: usize| -> Affine { counted.iter().map(|own| own[t].clone()).sum() };
        Ok((0..steps).map(|t| if unit == 1.0 { sum(t) } else { unit * sum(t) }).collect())
    }

    /// The binary of a contact's mode in a step.
    pub(super) fn taken(
        &self,
        contact: usize,
        mode: &Mode,
        step: usize,
    ) -> Result<Option<Literal>, Error> {
        self.program().variables().taken(&self.contacts[contact].name, &mode.name, step)
    }

    pub(super) fn sum_of(
        &self,
        contact: usize,
        step: usize,
        wanted: impl Fn(&Mode) -> bool,
    ) -> Affine {
        let modes = self.contacts[contact].modes.iter().filter(|mode| wanted(mode));
        let values = modes.map(|mode| match self.taken(contact, mode, step) {
            Ok(Some(literal)) if literal.is_on() => Affine::from(literal.variable()),
            Ok(Some(literal)) => 1.0 - literal.variable(),
            // The only mode of a contact is no hit.
            _ => Affine::constant(1.0),
        });
        values.sum()
    }

    /// 1 if a contact is hit in a step, and 0 otherwise.
    pub(super) fn hits_of(&self, contact: usize, step: usize) -> Affine {
        self.sum_of(contact, step, |mode| mode.is_hit)
    }

    /// 1 if a contact is hit in a step at a face that a rule counts.
    pub(super) fn counted(&self, rule: &DamageRule, contact: usize, step: usize) -> Affine {
        let own = &self.contacts[contact];
        let counts = |mode: &Mode| mode.is_hit && rule.applies(own, mode.face);
        self.sum_of(contact, step, counts)
    }

    /// States that there is no plan.
    pub(super) fn contradict(&mut self) -> Result<(), Error> {
        let first = self.program().variables().states()[0][0];
        let beyond = self.program.model.variable_ref(first)?.bounds().upper + 1.0;
        self.program.add("no_plan_by_reach_sets", first.ge(beyond))?;
        Ok(())
    }

    /// Fixes the inputs of the first step, where bodies say so.
    fn fix_first(&mut self) -> Result<(), Error> {
        for body in &self.scene.bodies {
            let Some(first) = &body.first else { continue };
            for (axis, value) in AXES.iter().zip(first) {
                let input = self.program().variables().input(&format!("{} a{axis}", body.name))?;
                self.program.model.fix(input[0], *value)?;
            }
        }
        Ok(())
    }

    /// Bodies start outside convex obstacles, where the first step does not say so: if only the
    /// ends of steps count, and the start is not a point.
    fn start_outside(&mut self) -> Result<(), Error> {
        if self.scene.estimate == ImpactEstimate::Sound {
            return Ok(());
        }
        for c in 0..self.contacts.len() {
            let contact = self.contacts[c].clone();
            let is_clear = |face: &ContactFace| {
                self.scene.nearest_start(&contact, face) >= face.limit_at(0) - INSIDE
            };
            if contact.faces.len() < 2 || contact.faces.iter().any(is_clear) {
                continue;
            }
            let row = |face: &ContactFace| {
                self.along(&contact, &face.normal, 0, false).ge(face.limit_at(0))
            };
            let mut rows = contact.faces.iter().map(row);
            let (Some(first), Some(second)) = (rows.next(), rows.next()) else { continue };
            let outside = rows.fold(either(first).or(second), |all, row| all.or(row));
            let name = format!("starts_outside_{c}");
            self.program.add(name.as_str(), outside)?;
            self.program.model.set_law(&name)?;
        }
        Ok(())
    }

    /// At most one hit of contacts that exclude each other.
    fn one_hit(&mut self) -> Result<(), Error> {
        for (k, own) in exclusive(&self.scene, &self.contacts).iter().enumerate() {
            let family = format!("one_hit_{k}");
            for t in 0..self.steps() {
                let hits: Affine = own.iter().map(|&c| self.hits_of(c, t)).sum();
                self.program.add((family.as_str(), t), hits.le(1.0))?;
            }
            self.program.model.set_law(&family)?;
        }
        Ok(())
    }

    /// A body that hits something else in a step still ends it in front of the same face of each
    /// convex obstacle. In corners, that is also said of the faces that it hits.
    fn next_outside(&mut self) -> Result<(), Error> {
        for c in 0..self.contacts.len() {
            let contact = self.contacts[c].clone();
            let involved = |other: &ContactPair| {
                let own = [Some(contact.body), contact.other];
                other.bounces()
                    && (own.contains(&Some(other.body))
                        || other.other.is_some() && own.contains(&other.other))
            };
            let others = (0..self.contacts.len()).filter(|&k| k != c);
            if contact.faces.len() < 2 || !others.into_iter().any(|k| involved(&self.contacts[k])) {
                continue;
            }
            let family = format!("outside_{c}");
            for t in 0..self.steps() {
                let corners = self.scene.corners;
                for (m, mode) in contact.modes.iter().enumerate() {
                    if mode.is_hit && !corners {
                        continue;
                    }
                    let face = &contact.faces[mode.face];
                    let gap = self.along(&contact, &face.normal, t + 1, false);
                    let Some(taken) = self.taken(c, mode, t)? else { continue };
                    let row = gap.ge(face.limit_at(t + 1));
                    let name = format!("{family}_{m}");
                    self.program.add((name.as_str(), t), taken.implies(row))?;
                    self.program.model.set_law(&name)?;
                }
            }
        }
        Ok(())
    }

    /// `direction . x` or `direction . v` of a contact at a sample.
    pub(super) fn along(
        &self,
        contact: &ContactPair,
        direction: &[f64],
        sample: usize,
        speed: bool,
    ) -> Affine {
        let axes = self.scene.axes();
        let from = if speed { axes } else { 0 };
        let mut sum = Affine::zero();
        for (body, sign) in [(Some(contact.body), 1.0), (contact.other, -1.0)] {
            let Some(body) = body else { continue };
            let families = &self.program().variables().states()[2 * axes * body + from..];
            for (family, n) in families.iter().zip(direction) {
                if let Some(variable) = family.get(sample).filter(|_| *n != 0.0) {
                    sum.add_term(sign * n, variable);
                }
            }
        }
        sum
    }
}

/// Contacts of which at most one is hit in a step, by their numbers: all of a body, unless corners
/// are allowed, and opposite walls in any case.
pub(super) fn exclusive(scene: &Scene, contacts: &[ContactPair]) -> Vec<Vec<usize>> {
    let count = contacts.len();
    let mut groups: Vec<Vec<usize>> = match scene.corners {
        false => (0..scene.bodies.len())
            .map(|b| {
                let of_body = |c: &usize| {
                    let contact = &contacts[*c];
                    contact.bounces() && (contact.body == b || contact.other == Some(b))
                };
                (0..count).filter(of_body).collect()
            })
            .collect(),
        true => (0..count)
            .flat_map(|a| (a + 1..count).map(move |b| vec![a, b]))
            .filter(|pair| are_opposite(&contacts[pair[0]], &contacts[pair[1]]))
            .collect(),
    };
    groups.retain(|group| group.len() > 1);
    groups
}

/// Whether two contacts are still walls on opposite sides of a body.
fn are_opposite(first: &ContactPair, second: &ContactPair) -> bool {
    let same = (first.body, first.other) == (second.body, second.other);
    let ([one], [two]) = (&first.faces[..], &second.faces[..]) else { return false };
    let opposite = dot(&one.normal, &two.normal) < -1.0 + 1e-12;
    let room = one.limit.len() == 1 && two.limit.len() == 1;
    let apart = one.limit_at(0) + two.limit_at(0) < 0.0;
    same && opposite && room && apart && first.bounces() && second.bounces()
}
