//! Scenarios: start, goal, limits, wall, contact and damage.

use super::error::ScenarioError;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::{Contact, ContactLaw, DamageLimits, Horizon, Restitution, Waiting, Wall};
use crate::interval::Interval;
use crate::setters::setters;

/// Whether a plan may hit the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Collisions {
    /// Collisions are allowed, under the scenario's contact law and damage limits.
    #[default]
    Tolerated,
    /// Collisions are forbidden, but the vehicle may touch the wall at a sample.
    Forbidden,
}

/// One end of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Endpoint {
    /// Position, in m.
    pub position: f64,
    /// Velocity, in m/s.
    pub velocity: f64,
    /// Acceleration, in m/s²; free if `None`. At the start, it is applied in step 0. At the goal,
    /// it is a(τ), which is never applied: the last one applied is a(τ-1).
    pub acceleration: Option<f64>,
}

impl Endpoint {
    /// At rest at a position (m), acceleration free.
    pub fn at_rest(position: f64) -> Self {
        Endpoint { position, velocity: 0.0, acceleration: None }
    }

    setters! {
        /// Sets the velocity, in m/s.
        with_velocity(velocity: f64) => velocity = velocity;
        /// Sets the acceleration, in m/s².
        with_acceleration(acceleration: f64) => acceleration = Some(acceleration);
    }
}

/// A vehicle on a line with a wall: the data of the paper's sections 3 and 4. All positions are in
/// one frame, in m.
///
/// ```
/// use carom::collision_tolerant::{Endpoint, Scenario};
///
/// let elastic = Scenario::paper().with_restitution(0.5)?.with_time_step(0.02);
/// elastic.check()?;
/// let behind = Scenario::paper().with_goal(Endpoint::at_rest(-1.0));
/// assert!(behind.check().is_err());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scenario {
    /// Where the plan starts; equation (1).
    pub start: Endpoint,
    /// Where it ends; equation (2).
    pub goal: Endpoint,
    /// Smallest and largest acceleration of free flight, in m/s²; equations (5), (6).
    pub acceleration: Interval,
    /// Largest speed at a sample, in m/s.
    pub max_speed: f64,
    /// Δt, in s.
    pub time_step: f64,
    /// The wall and what happens there; equation (7).
    pub contact: Contact,
    /// Whether the plan may hit the wall.
    pub collisions: Collisions,
    /// Limits and weight of damage; equations (14)-(20). Ignored if collisions are forbidden.
    pub damage: DamageLimits,
    /// Allowed positions, in m. If `None`, they extend as far as the vehicle can go and still reach
    /// the goal within the horizon, which excludes no plan.
    pub domain: Option<Interval>,
}

impl Scenario {
    /// A scenario with a perfectly plastic wall, the reflecting law and no damage limits.
    ///
    /// # Arguments
    ///
    /// * `acceleration`: smallest and largest, in m/s².
    /// * `max_speed`: largest speed at a sample, in m/s.
    /// * `time_step`: Δt, in s.
    ///
    /// The data are checked by [`check`](Scenario::check), which every planning function calls.
    pub fn new(
        start: Endpoint,
        goal: Endpoint,
        wall: Wall,
        acceleration: Interval,
        max_speed: f64,
        time_step: f64,
    ) -> Self {
        Scenario {
            start,
            goal,
            acceleration,
            max_speed,
            time_step,
            contact: Contact::new(wall, Restitution::PLASTIC),
            collisions: Collisions::Tolerated,
            damage: DamageLimits::default(),
            domain: None,
        }
    }

    /// The paper's scenario: Tables 1 and 2, a plastic wall at 0 m, and a time step of 0.005 s, of
    /// which its printed times are multiples.
    pub fn paper() -> Self {
        let start = Endpoint::at_rest(10.0).with_acceleration(0.0);
        let goal = Endpoint::at_rest(0.3).with_acceleration(0.0);
        let wall = Wall::default();
        Scenario::new(start, goal, wall, Interval::new(-6.0, 6.0), 15.0, 0.005)
    }

    setters! {
        /// Sets the start.
        with_start(start: Endpoint) => start = start;
        /// Sets the goal.
        with_goal(goal: Endpoint) => goal = goal;
        /// Moves the goal to another position (m) without changing its velocity and acceleration.
        with_goal_position(position: f64) => goal.position = position;
        /// Sets the wall.
        with_wall(wall: Wall) => contact.wall = wall;
    }

    /// Sets the coefficient of restitution e (no unit).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] outside `[0, 1]`.
    pub fn with_restitution(mut self, restitution: f64) -> Result<Self, Error> {
        self.contact.restitution = Restitution::new(restitution)?;
        Ok(self)
    }

    setters! {
        /// Sets the contact law.
        with_law(law: ContactLaw) => contact.law = law;
        /// The same scenario with collisions forbidden.
        collision_free() => collisions = Collisions::Forbidden;
        /// Sets the limits of the acceleration, in m/s².
        with_acceleration(lower: f64, upper: f64) => acceleration = Interval::new(lower, upper);
        /// Sets the largest speed, in m/s.
        with_max_speed(speed: f64) => max_speed = speed;
        /// Sets the time step, in s.
        with_time_step(time_step: f64) => time_step = time_step;
        /// Sets limits and weight of damage.
        with_damage(limits: DamageLimits) => damage = limits;
        /// Sets the allowed positions, in m.
        with_domain(lower: f64, upper: f64) => domain = Some(Interval::new(lower, upper));
    }

    /// Refuses scenarios that contradict themselves.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotFinite`], [`ErrorKind::CrossedBounds`], [`ErrorKind::OutOfRange`] and
    /// [`ScenarioError`], each with what to change.
    pub fn check(&self) -> Result<(), Error> {
        Horizon::new(1, self.time_step)?;
        self.damage.check()?;
        for (name, end) in [("start", &self.start), ("goal", &self.goal)] {
            let numbers = [
                ("the position", Some(end.position)),
                ("the velocity", Some(end.velocity)),
                ("the acceleration", end.acceleration),
            ];
            for (what, value) in numbers {
                check_finite(name, what, value)?;
            }
        }
        check_finite("wall", "the position", [self.contact.wall.position()])?;
        self.acceleration.check("acceleration")?;
        if !(self.max_speed.is_finite() && self.max_speed > 0.0) {
            let (what, range) = ("the largest speed (m/s)", "finite and positive");
            return Err(Error::out_of_range(what, self.max_speed, range));
        }
        if let Some(domain) = self.domain {
            domain.check("domain")?;
        }
        self.check_end("start", &self.start)?;
        Ok(self.check_end("goal", &self.goal)?)
    }

    fn check_end(&self, end: &'static str, at: &Endpoint) -> Result<(), ScenarioError> {
        let (position, speed, wall) = (at.position, at.velocity.abs(), self.contact.wall);
        if wall.gap(position) < 0.0 {
            return Err(ScenarioError::InsideWall { end, position, wall });
        }
        if speed > self.max_speed {
            return Err(ScenarioError::TooFast { end, speed, limit: self.max_speed });
        }
        if let Some(acceleration) = at.acceleration
            && !self.acceleration.contains(acceleration)
        {
            let limits = self.acceleration;
            return Err(ScenarioError::Acceleration { end, acceleration, limits });
        }
        if let Some(domain) = self.domain
            && !domain.contains(position)
        {
            return Err(ScenarioError::OutsideDomain { end, position, domain });
        }
        Ok(())
    }

    /// Whether waiting is free, so that the shortest horizon may be found by bisection.
    ///
    /// The vehicle can wait at the start if it is at rest there, zero acceleration is admissible
    /// and the first acceleration is free or 0. It can wait at the goal if it is at rest there and
    /// zero acceleration is admissible (a(τ) is never applied, so its value does not matter).
    /// Limits, wall and damage do not depend on the step, and the search has no running cost.
    pub fn waiting(&self) -> Waiting {
        let coasting = self.acceleration.contains(0.0);
        if !coasting {
            return Waiting::NotFree("zero acceleration is not admissible".into());
        }
        if self.start.velocity == 0.0 && self.start.acceleration.unwrap_or(0.0) == 0.0 {
            return Waiting::Free("the vehicle can rest at its start".into());
        }
        if self.goal.velocity == 0.0 {
            return Waiting::Free("the vehicle can rest at its goal".into());
        }
        Waiting::NotFree("the vehicle can rest neither at its start nor at its goal".into())
    }

    /// Largest magnitude of an acceleration in free flight, in m/s².
    pub fn max_acceleration(&self) -> f64 {
        self.acceleration.magnitude()
    }

    /// The domain of the positions (m) over a horizon, restricted to where the vehicle can be.
    ///
    /// No step is longer than `l = Δt (v_max + a_max Δt/2)`: a flight is Δt times the mean of two
    /// admissible velocities, and a contact ends no farther from the wall than that flight would.
    /// So between gap g₀ and gap g₁ in τ steps, the vehicle is never farther from the wall than
    /// `(g₀ + g₁ + τ l)/2`.
    ///
    /// Under the literal law it may also be inside the wall: by the step that takes it there, plus
    /// the `Δt v_max (1-e)/2` of the first contact. Later contacts alternate in direction and undo
    /// more than they add.
    pub(super) fn positions(&self, horizon: &Horizon) -> Interval {
        let (wall, dt) = (self.contact.wall, self.time_step);
        let longest_step = dt * (self.max_speed + 0.5 * dt * self.max_acceleration());
        let ends = wall.gap(self.start.position) + wall.gap(self.goal.position);
        let mut farthest = 0.5 * (ends + horizon.steps() as f64 * longest_step);
        let e = self.contact.restitution.value();
        let mut nearest = match (self.contact.law, self.collisions) {
            (ContactLaw::Literal, Collisions::Tolerated) => {
                -(longest_step + 0.5 * dt * self.max_speed * (1.0 - e))
            }
            _ => 0.0,
        };
        if let Some(domain) = self.domain {
            let (one, other) = (wall.gap(domain.lower), wall.gap(domain.upper));
            farthest = farthest.min(one.max(other));
            // If the domain reaches the wall, the contact law decides what happens there.
            if one.min(other) > 0.0 {
                nearest = one.min(other);
            }
        }
        let (one, other) = (wall.at_gap(nearest), wall.at_gap(farthest));
        Interval::new(one.min(other), one.max(other))
    }

    /// A number of steps (at least 1) at which to begin the search for the shortest horizon: full
    /// acceleration from the start without stopping. A guess, not a bound.
    pub(super) fn lower_hint(&self) -> usize {
        let distance = (self.goal.position - self.start.position).abs();
        let (speed, acceleration) = (self.start.velocity.abs(), self.max_acceleration());
        let sprint = if acceleration > 0.0 {
            ((speed * speed + 2.0 * acceleration * distance).sqrt() - speed) / acceleration
        } else {
            0.0
        };
        let time = sprint.max(distance / self.max_speed);
        ((time / self.time_step) as usize).max(1)
    }
}
