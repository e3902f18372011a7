//! A wall on a line as a scene: the transitions of a [`Contact`], and programs with the damage and
//! the rules of a scene.

use super::body::Body;
use super::contact::{Mode, contacts};
use super::law::Writer;
use super::program::SceneProgram;
use super::rule::DamageRule;
use super::solid::Solid;
use super::statement::Scene;
use super::surface::Surface;
use super::units::SceneUnits;
use crate::error::{Error, ErrorKind};
use crate::hybrid::contact::{Contact, ContactLaw, literal_transitions};
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::system::Transition;
use crate::hybrid::wall::Wall;
use crate::interval::Interval;
use crate::model::Affine;

impl Contact {
    /// The law as transitions of a vehicle with state `[x, v]` (m, m/s) and input `[a]` (m/s²), for
    /// a [`HybridSystem`](crate::hybrid::HybridSystem): first the flight, then the contact, which
    /// is an event.
    ///
    /// Under the reflecting law, the impact has the output `impact speed` (m/s). Under the literal
    /// law, the contact forces the input to `-(1+e) v/Δt`, so give the contact an
    /// [input range](Transition::with_input_range) that contains it.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt, in s, finite and positive.
    /// * `max_speed`: limit on the impact speed, in m/s, if there is one.
    ///
    /// ```
    /// use carom::hybrid::{Contact, Restitution, Wall};
    ///
    /// let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.5)?);
    /// let [flight, impact] = floor.transitions(0.01, Some(3.0))?;
    /// assert!(impact.is_event && !flight.is_event);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    #[doc(hidden)]
    pub fn transitions(
        &self,
        time_step: f64,
        max_speed: Option<f64>,
    ) -> Result<[Transition; 2], Error> {
        match self.law {
            ContactLaw::Reflecting => {
                self.reflecting(time_step, ImpactEstimate::EndOfStep, speed_rule(max_speed))
            }
            ContactLaw::Literal => {
                literal_transitions(self.wall, self.restitution, time_step, max_speed)
            }
        }
    }

    /// The reflecting law, under which `estimate` says which steps and speeds a plan may have, with
    /// the rule's limit on a hit.
    pub(crate) fn reflecting(
        &self,
        time_step: f64,
        estimate: ImpactEstimate,
        rule: Option<DamageRule>,
    ) -> Result<[Transition; 2], Error> {
        let surface = Surface::bounce(self.restitution).with_spread(self.spread);
        self.written(surface, time_step, estimate, rule, ["flight", "impact"])
    }

    /// The largest impact speed that a rule's limit on a hit allows, in m/s.
    pub(crate) fn most_speed(&self, rule: &DamageRule) -> Option<f64> {
        let scene = self.scene(Surface::bounce(self.restitution), 1.0);
        contacts(&scene).first().and_then(|contact| rule.most_speed(contact, 0))
    }

    /// A contact that may come to rest, as transitions of the same vehicle: flight, impact,
    /// settling and rest. It is a law of its own, whatever [`law`](Contact::law) says.
    ///
    /// A step in contact ends at the wall. An impact rebounds with e times the approach at the
    /// *start* of its step, so that bounces die out. A vehicle that does not approach at the start,
    /// and would end behind the wall, settles there. One at rest at the wall stays as long as its
    /// acceleration does not point away, which is no event.
    ///
    /// Under the reflecting law bounces may go on for ever: what the acceleration adds between the
    /// impact and the end of its step is reflected too.
    ///
    /// # Arguments
    ///
    /// As for [`transitions`](Contact::transitions).
    ///
    /// ```
    /// use carom::hybrid::{Contact, Region, Restitution, Wall};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.8)?);
    /// let mut ball = HybridSystem::new(0.05)
    ///     .with_state("x", Interval::new(0.0, 2.0))
    ///     .with_state("v", Interval::new(-10.0, 10.0))
    ///     .with_input("a", Interval::point(-9.81));
    /// for transition in floor.transitions_with_rest(0.05, None)? {
    ///     ball = ball.with_transition(transition);
    /// }
    /// let (start, rest) = (Region::point([1.0, 0.0]), Region::point([0.0, 0.0]));
    /// let found = ball.shortest(start, rest, &mut BranchAndBound::default())?;
    /// assert!(found.plan.is_some());
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    #[doc(hidden)]
    pub fn transitions_with_rest(
        &self,
        time_step: f64,
        max_speed: Option<f64>,
    ) -> Result<[Transition; 4], Error> {
        let surface = Surface::bounce(self.restitution).with_rest();
        let (estimate, names) = (ImpactEstimate::EndOfStep, ["flight", "impact", "settle", "rest"]);
        self.written(surface, time_step, estimate, speed_rule(max_speed), names)
    }

    /// A point at the wall.
    fn scene(&self, surface: Surface, time_step: f64) -> Scene {
        let point = Body::new("vehicle", [Interval::REALS], f64::INFINITY, f64::INFINITY);
        Scene::new(time_step).with_body(point).with_obstacle(half_line(&self.wall, surface))
    }

    /// The transitions of a point at the wall, with names of their own.
    fn written<const N: usize>(
        &self,
        surface: Surface,
        time_step: f64,
        estimate: ImpactEstimate,
        rule: Option<DamageRule>,
        names: [&str; N],
    ) -> Result<[Transition; N], Error> {
        let flow = LinearSystem::double_integrator(time_step)?;
        let mut scene = self.scene(surface, time_step).with_estimate(estimate);
        scene.rules = rule.into_iter().collect();
        scene.rules.iter_mut().for_each(|rule| rule.name = "the limit on the impact speed".into());
        let mut all = Vec::new();
        for contact in &contacts(&scene) {
            all = Writer { scene: &scene, contact, flow: &flow }.transitions()?.0;
        }
        all.iter_mut().zip(names).for_each(|(own, name)| own.name = name.to_owned());
        all.try_into().map_err(|all: Vec<Transition>| {
            let what = "the transitions of the contact";
            ErrorKind::Length { what, found: all.len(), expected: N }.into()
        })
    }
}

fn speed_rule(max_speed: Option<f64>) -> Option<DamageRule> {
    max_speed.map(|most| DamageRule::default().with_per_hit(most))
}

impl SceneProgram {
    /// The program of a scene of one body on a line, whose system another one has written: adds
    /// damage and rules.
    ///
    /// # Arguments
    ///
    /// * `scene`: as it is stated.
    /// * `units`: those of the program.
    /// * `hit`: the transition that hits, of the choice `mode`.
    pub(crate) fn on_line(
        scene: &Scene,
        units: &SceneUnits,
        program: HybridProgram,
        hit: Option<&str>,
    ) -> Result<Self, Error> {
        let (scene, units) = (units.scene(scene), units.clone());
        let mut contacts = contacts(&scene);
        for contact in &mut contacts {
            contact.name = "mode".into();
            let mode = |name: &str| Mode { name: name.to_owned(), face: 0, is_hit: true };
            contact.modes = hit.into_iter().map(mode).collect();
        }
        let damage = vec![None; contacts.len()];
        let (measured, cases) = Default::default();
        let mut program = SceneProgram { program, scene, units, contacts, damage, measured, cases };
        program.add_damage()?;
        program.add_rules()?;
        Ok(program)
    }

    /// The impact speeds at the first contact that count as damage, in m/s, if the model has them.
    pub(crate) fn counted_speed(&self) -> Option<Vec<Affine>> {
        let own = self.damage.first()?.as_ref()?;
        Some(own.iter().map(|speed| in_unit(self.units.speed(), speed.into())).collect())
    }

    /// The damage of the first rule by step, in its unit; empty if it needs no variables.
    pub(crate) fn damage_by_step(&self) -> Vec<Affine> {
        let Some((rule, own)) = self.scene.rules.iter().zip(&self.measured).next() else {
            return Vec::new();
        };
        let unit = self.units.damage(&rule.measure);
        own.iter().flatten().map(|damage| in_unit(unit, damage.clone())).collect()
    }
}

/// An expression in the user's unit, of which a unit is a multiple.
pub(crate) fn in_unit(unit: f64, own: Affine) -> Affine {
    if unit == 1.0 { own } else { unit * own }
}

/// A wall as the obstacle `wall`.
pub(crate) fn half_line(wall: &Wall, surface: Surface) -> Solid {
    let n = wall.normal();
    Solid::halfspace("wall", [n], n * wall.position(), surface)
}
