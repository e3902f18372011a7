//! Scenarios: start, goal, limits, wall, contact and damage.

#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::SystemRow;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::scene::{DamageRule, SceneUnits, region_where};
use crate::hybrid::system::{Coordinates, Restated, check_digits};
use crate::hybrid::{
    Contact, ContactLaw, FreeSide, HybridSystem, ImpactEstimate, Monotonicity, Region, Restitution,
    State, Wall,
};
use crate::interval::Interval;
use crate::setters::setters;
use crate::tolerance;

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
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scenario {
    /// Where the plan starts; equation (1).
    pub start: Endpoint,
    /// Where it ends; equation (2).
    pub goal: Endpoint,
    /// Where it may end, if that is not only the position and the velocity of `goal`: a region of
    /// position (m) and velocity (m/s), without modes. Only its part on the wall's free side
    /// counts.
    pub goal_region: Option<Region>,
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
    /// Limits and prices of damage; equations (14)-(20). Ignored if collisions are forbidden.
    pub damage: DamageRule,
    /// Which speed counts as the impact speed under the reflecting law; default
    /// [`ImpactEstimate::EndOfStep`], as in the paper.
    pub estimate: ImpactEstimate,
    /// By how much pushes may change the velocity in each step, in m/s; default 0. Robust programs
    /// plan for all of them, and others for none.
    #[cfg_attr(feature = "serde", serde(default = "still"))]
    pub pushes: Interval,
    /// Allowed positions, in m. If `None`, they extend as far as the vehicle can go and still reach
    /// the goal within the horizon, which excludes no plan.
    pub domain: Option<Interval>,
}

/// No pushes.
fn still() -> Interval {
    Interval::point(0.0)
}

impl Scenario {
    /// A scenario with a perfectly plastic wall, the reflecting law, no damage limits and impact
    /// speeds at the ends of steps.
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
        acceleration: impl Into<Interval>,
        max_speed: f64,
        time_step: f64,
    ) -> Self {
        let acceleration = acceleration.into();
        Scenario {
            start,
            goal,
            goal_region: None,
            acceleration,
            max_speed,
            time_step,
            contact: Contact::new(wall, Restitution::PLASTIC),
            collisions: Collisions::Tolerated,
            damage: DamageRule::default(),
            estimate: ImpactEstimate::EndOfStep,
            pushes: still(),
            domain: None,
        }
    }

    /// The paper's scenario: Tables 1 and 2, a plastic wall at 0 m, and a time step of 0.005 s, of
    /// which its printed times are multiples.
    pub fn paper() -> Self {
        let start = Endpoint::at_rest(10.0).with_acceleration(0.0);
        let goal = Endpoint::at_rest(0.3).with_acceleration(0.0);
        let wall = Wall::default();
        Scenario::new(start, goal, wall, -6.0..=6.0, 15.0, 0.005)
    }

    setters! {
        /// Sets the start.
        with_start(start: Endpoint) => start = start;
        /// Sets the wall.
        with_wall(wall: Wall) => contact.wall = wall;
    }

    /// Sets the goal, in place of any other goal and region.
    #[must_use]
    pub fn with_goal(self, goal: Endpoint) -> Self {
        Scenario { goal, goal_region: None, ..self }
    }

    /// Moves the goal to another position (m) without changing its velocity and acceleration.
    #[must_use]
    pub fn with_goal_position(self, position: f64) -> Self {
        let goal = Endpoint { position, ..self.goal };
        self.with_goal(goal)
    }

    /// Lets the plan end anywhere in a region of position (m) and velocity (m/s): a point or a
    /// range for each. The acceleration of the goal stays as it is.
    #[must_use]
    pub fn with_goal_region(mut self, region: impl Into<Region>) -> Self {
        self.goal_region = Some(region.into());
        self
    }

    /// Lets the plan end wherever rows of the position (m) and the velocity (m/s) hold.
    ///
    /// ```
    /// use carom::collision_tolerant::{PlanningOptions, Scenario};
    /// use carom::prelude::*;
    ///
    /// // At most 0.5 m from the wall, and slow enough: |v| <= 2 x.
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let parked = scenario.with_goal_where(|x, v| [x.le(0.5), v.le(2.0 * x), v.ge(-2.0 * x)])?;
    /// let (options, mut solver) = (PlanningOptions::default(), BranchAndBound::default());
    /// let found = parked.shortest_with(&options, &mut solver)?;
    /// let trajectory = found.plan.expect("there is one").trajectory;
    /// let last = trajectory.steps();
    /// let (x, v) = (trajectory.position[last], trajectory.velocity[last]);
    /// assert!(x < 0.5 + 1e-6 && v.abs() < 2.0 * x + 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::region`](crate::hybrid::HybridSystem::region).
    pub fn with_goal_where<R: IntoIterator<Item: Into<SystemRow>>>(
        self,
        rows: impl FnOnce(State, State) -> R,
    ) -> Result<Self, Error> {
        let region = region_where(1, |x, v| rows(x[0], v[0]))?;
        Ok(self.with_goal_region(region))
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
        /// Says by how much the restitution may be more or less in a hit (no unit), for
        /// [robust programs](crate::hybrid::HybridProgram::robust).
        with_spread(spread: f64) => contact.spread = spread;
        /// The same scenario with collisions forbidden.
        collision_free() => collisions = Collisions::Forbidden;
        /// Sets the largest speed, in m/s.
        with_max_speed(speed: f64) => max_speed = speed;
        /// Sets the time step, in s.
        with_time_step(time_step: f64) => time_step = time_step;
        /// Sets limits and prices of damage.
        with_damage(rule: DamageRule) => damage = rule;
        /// Sets which speed counts as the impact speed.
        with_estimate(wanted: ImpactEstimate) => estimate = wanted;
    }

    /// Sets the limits of the acceleration, in m/s².
    #[must_use]
    pub fn with_acceleration(self, limits: impl Into<Interval>) -> Self {
        Scenario { acceleration: limits.into(), ..self }
    }

    /// Says by how much pushes may change the velocity in each step, in m/s, for
    /// [robust programs](crate::hybrid::HybridProgram::robust).
    ///
    /// ```
    /// use carom::collision_tolerant::{Objective, Scenario};
    /// use carom::hybrid::Feedback;
    /// use carom::prelude::*;
    ///
    /// // The paper's vehicle with a coarser step; the wall has a restitution from 0.2 to 0.4.
    /// let scenario = Scenario::paper().with_time_step(0.1);
    /// let scenario = scenario.with_restitution(0.3)?.with_spread(0.1);
    /// let goal = Region::from([0.2..=0.6, -0.4..=0.4]);
    /// let scenario = scenario.with_goal_region(goal).with_pushes(-0.02..=0.02);
    /// let program = scenario.program(30, Objective::Effort)?;
    /// // The goal is narrow beside the way to it, so that errors have to end soon.
    /// let feedback = Feedback::new(program.system(), [[-6.0, -5.0]])?;
    /// let plan = program.program().robust(&feedback)?.solve(&mut BranchAndBound::default())?;
    /// assert!(plan.simulate(&mut |range| range.upper)?.kept);
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_pushes(self, pushes: impl Into<Interval>) -> Self {
        Scenario { pushes: pushes.into(), ..self }
    }

    /// Sets the allowed positions, in m.
    #[must_use]
    pub fn with_domain(self, positions: impl Into<Interval>) -> Self {
        Scenario { domain: Some(positions.into()), ..self }
    }

    /// Refuses scenarios that contradict themselves.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotFinite`], [`ErrorKind::CrossedBounds`], [`ErrorKind::OutOfRange`] and
    /// [`SceneError`](crate::hybrid::scene::SceneError), each with what to change.
    pub fn check(&self) -> Result<(), Error> {
        let horizon = Horizon::new(tolerance::MAX_STEPS, self.time_step)?;
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
        self.pushes.check("the pushes")?;
        if self.contact.law == ContactLaw::Literal && self.contact.spread != 0.0 {
            let what = "the spread of the restitution";
            let help = " under the literal law; use the reflecting one";
            return Err(Error::out_of_range_with(what, self.contact.spread, 0.0..=0.0, help));
        }
        if let Some(domain) = self.domain {
            domain.check("domain")?;
        }
        if let Some(region) = &self.goal_region {
            region.check(&self.system(&horizon, &DamageRule::default())?, "the goal")?;
        }
        if let Some(acceleration) = self.goal.acceleration
            && !self.acceleration.contains(acceleration)
        {
            let Interval { lower, upper } = self.acceleration;
            let range = format!("within {lower} and {upper}");
            let what = "the goal's acceleration";
            return Err(Error::out_of_range_in_words(what, acceleration, lower..=upper, range));
        }
        let (near, units) = (self.near(), self.units());
        check_digits("x", near)?;
        let mut scene = self.scene(&horizon);
        if self.domain.is_none() {
            // So that a start behind the wall is found to be there.
            scene.bodies.iter_mut().for_each(|body| body.domain[0] = body.domain[0].hull(near));
        }
        match units.scene(&scene).checked_as_stated() {
            Ok(_) => Ok(()),
            // Said in the user's units where it is wrong there too.
            Err(error) => scene.checked_as_stated().and(Err(error)),
        }
    }

    /// The positions at the wall, at the start and at the goal, and those within a step of them, in
    /// m: they have the size of the task, which domains over many steps have not.
    fn near(&self) -> Interval {
        let (wall, start) = (self.contact.wall.position(), self.start.position);
        let step = self.max_speed * self.time_step;
        let ends = Interval::point(start).hull(Interval::point(wall));
        let goal = self.goal_positions();
        let goal = if goal.is_bounded() { goal } else { Interval::point(goal.nearest(start)) };
        let Interval { lower, upper } = ends.hull(goal);
        Interval::new(lower - step, upper + step)
    }

    /// The units in which the scenario is computed: those of its scene.
    pub(super) fn units(&self) -> SceneUnits {
        SceneUnits::of(&self.scene_within(self.near()))
    }

    /// The coordinates of the scenario's system in units.
    pub(super) fn coordinates(&self, units: &SceneUnits) -> Coordinates {
        units.coordinates(&self.scene_within(self.near()))
    }

    /// A system of the scenario, in units.
    pub(super) fn restated(
        &self,
        system: &HybridSystem,
        units: &SceneUnits,
    ) -> Result<Restated, Error> {
        let coordinates = self.coordinates(units);
        Ok(Restated { system: coordinates.system(system)?, coordinates })
    }

    /// The positions at which a plan may end, in m: on the wall's free side, if there are any
    /// there.
    fn goal_positions(&self) -> Interval {
        let Some(region) = &self.goal_region else { return Interval::point(self.goal.position) };
        let (all, at) = (range(region, 0), self.contact.wall.position());
        let free = match self.contact.wall.free() {
            FreeSide::Above => Interval::new(at, f64::INFINITY),
            FreeSide::Below => Interval::new(f64::NEG_INFINITY, at),
        };
        let both = all.intersection(free);
        if both.is_empty() { all } else { both }
    }

    /// The velocities at which a plan may end, in m/s.
    fn goal_velocities(&self) -> Interval {
        let region = self.goal_region.as_ref();
        region.map_or(Interval::point(self.goal.velocity), |region| range(region, 1))
    }

    /// The state in which a plan starts.
    pub(super) fn start_state(&self) -> Region {
        Region::point([self.start.position, self.start.velocity])
    }

    /// The states in which a plan may end.
    pub(super) fn goal_states(&self) -> Region {
        let halfspaces = self.goal_region.iter().flat_map(|region| &region.halfspaces);
        let ranges = Region::from([self.goal_positions(), self.goal_velocities()]);
        let region =
            halfspaces.fold(ranges, |region, halfspace| region.with_halfspace(halfspace.clone()));
        let norms = self.goal_region.iter().flat_map(|region| region.norms.clone()).collect();
        Region { norms, ..region }
    }

    /// Whether waiting is free, so that the shortest horizon may be found by bisection.
    ///
    /// The vehicle can wait at the start if it is at rest there, zero acceleration is admissible
    /// and the first acceleration is free or 0. It can wait at the goal if it is always at rest
    /// there and zero acceleration is admissible (a(τ) is never applied, so its value does not
    /// matter). Limits, wall and damage do not depend on the step, and the search has no running
    /// cost.
    pub fn monotonicity(&self) -> Monotonicity {
        let coasting = self.acceleration.contains(0.0);
        if !coasting {
            return Monotonicity::NotMonotone("zero acceleration is not admissible".into());
        }
        if self.start.velocity == 0.0 && self.start.acceleration.unwrap_or(0.0) == 0.0 {
            return Monotonicity::Monotone("the vehicle can rest at its start".into());
        }
        if self.goal_velocities() == Interval::point(0.0) {
            return Monotonicity::Monotone("the vehicle can rest at its goal".into());
        }
        Monotonicity::NotMonotone(
            "the vehicle can rest neither at its start nor at its goal".into(),
        )
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
    /// `(g₀ + g₁ + τ l)/2`, nor than `g₀ + τ l`.
    ///
    /// Under the literal law it may also be inside the wall: by the step that takes it there, plus
    /// the `Δt v_max (1-e)/2` of the first contact. Later contacts alternate in direction and undo
    /// more than they add.
    pub(super) fn positions(&self, horizon: &Horizon) -> Interval {
        let (wall, dt) = (self.contact.wall, self.time_step);
        let longest_step = dt * (self.max_speed + 0.5 * dt * self.max_acceleration());
        let goal = self.goal_positions();
        let (start, end) =
            (wall.gap(self.start.position), wall.gap(goal.lower).max(wall.gap(goal.upper)));
        let travel = horizon.steps() as f64 * longest_step;
        let mut farthest = (0.5 * (start + end + travel)).min(start.max(0.0) + travel);
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

    /// The distance from the start to the nearest position at which a plan may end, in m.
    pub(super) fn distance(&self) -> f64 {
        (self.goal_positions().nearest(self.start.position) - self.start.position).abs()
    }

    /// The smallest speed at which a plan may end, in m/s.
    pub(super) fn slowest_end(&self) -> f64 {
        self.goal_velocities().nearest(0.0).abs()
    }

    /// A number of steps (at least 1) at which to begin the search for the shortest horizon: full
    /// acceleration from the start without stopping. A guess, not a bound.
    pub(super) fn lower_hint(&self) -> usize {
        let distance = self.distance();
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

/// The range of a state, of a region that may not have been checked.
fn range(region: &Region, state: usize) -> Interval {
    region.ranges.get(state).copied().unwrap_or(Interval::REALS)
}
