//! Scenarios: start, goal, limits, wall, contact and damage.

use super::checks::{check_finite, check_order, check_range, out_of_range};
use super::law::ContactLaw;
use super::wall::Wall;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::scene::{Body, DamageRule};
use crate::hybrid::{ImpactEstimate, Monotonicity, Region, Restitution, State, SystemRow};
use crate::interval::Interval;

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

    /// Sets the velocity, in m/s.
    #[must_use]
    pub fn with_velocity(self, velocity: f64) -> Self {
        Endpoint { velocity, ..self }
    }

    /// Sets the acceleration, in m/s².
    #[must_use]
    pub fn with_acceleration(self, acceleration: f64) -> Self {
        Endpoint { acceleration: Some(acceleration), ..self }
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
    /// The wall; equation (7).
    pub wall: Wall,
    /// The contact law at the wall.
    pub law: ContactLaw,
    /// The coefficient of restitution e (no unit).
    pub restitution: Restitution,
    /// By how much the restitution may be more or less in a hit (no unit); default 0. Robust
    /// programs plan for all of it, and others for none.
    #[cfg_attr(feature = "serde", serde(default))]
    pub spread: f64,
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
            wall,
            law: ContactLaw::Reflecting,
            restitution: Restitution::PLASTIC,
            spread: 0.0,
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

    /// Sets the start.
    #[must_use]
    pub fn with_start(self, start: Endpoint) -> Self {
        Scenario { start, ..self }
    }

    /// Sets the wall.
    #[must_use]
    pub fn with_wall(self, wall: Wall) -> Self {
        Scenario { wall, ..self }
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
    /// use carom::collision_tolerant::Scenario;
    /// use carom::prelude::*;
    ///
    /// // At most 0.5 m from the wall, and slow enough: |v| <= 2 x.
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let parked = scenario.with_goal_where(|x, v| [x.le(0.5), v.le(2.0 * x), v.ge(-2.0 * x)])?;
    /// let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
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
        let vehicle = Body::new("vehicle", [Interval::REALS], f64::INFINITY, f64::INFINITY);
        let vehicle = vehicle.with_goal_where(|x, v| rows(x[0], v[0]))?;
        Ok(Scenario { goal_region: vehicle.goal, ..self })
    }

    /// Sets the coefficient of restitution e (no unit).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] outside `[0, 1]`.
    pub fn with_restitution(mut self, restitution: f64) -> Result<Self, Error> {
        self.restitution = Restitution::new(restitution)?;
        Ok(self)
    }

    /// Sets what happens at the wall.
    #[must_use]
    pub fn with_law(self, law: ContactLaw) -> Self {
        Scenario { law, ..self }
    }

    /// Says by how much the restitution may be more or less in a hit (no unit), for
    /// [robust programs](crate::hybrid::HybridProgram::robust).
    #[must_use]
    pub fn with_spread(self, spread: f64) -> Self {
        Scenario { spread, ..self }
    }

    /// The same scenario with collisions forbidden.
    #[must_use]
    pub fn collision_free(self) -> Self {
        self.with_law(ContactLaw::Forbidden)
    }

    /// Sets the largest speed, in m/s.
    #[must_use]
    pub fn with_max_speed(self, max_speed: f64) -> Self {
        Scenario { max_speed, ..self }
    }

    /// Sets the time step, in s.
    #[must_use]
    pub fn with_time_step(self, time_step: f64) -> Self {
        Scenario { time_step, ..self }
    }

    /// Sets limits and prices of damage.
    #[must_use]
    pub fn with_damage(self, damage: DamageRule) -> Self {
        Scenario { damage, ..self }
    }

    /// Sets which speed counts as the impact speed.
    #[must_use]
    pub fn with_estimate(self, estimate: ImpactEstimate) -> Self {
        Scenario { estimate, ..self }
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
    /// let feedback = Feedback::new(program.program().system(), [[-6.0, -5.0]])?;
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
        for (name, end) in [("start", &self.start), ("goal", &self.goal)] {
            check_finite(name, "the position", end.position)?;
            check_finite(name, "the velocity", end.velocity)?;
            check_finite(name, "the acceleration", end.acceleration.unwrap_or(0.0))?;
        }
        check_finite("wall", "the position", self.wall.position())?;
        check_range("acceleration", self.acceleration)?;
        check_range("the pushes", self.pushes)?;
        check_range("domain", self.domain.unwrap_or(still()))?;
        for (name, range) in ["x", "v"].iter().zip(self.goal_region.iter().flat_map(|r| &r.ranges))
        {
            check_order(name, *range)?;
        }
        if self.law == ContactLaw::Literal && self.spread != 0.0 {
            let what = "the spread of the restitution";
            return Err(out_of_range(
                what,
                self.spread,
                0.0..=0.0,
                "0 under the literal law; use the reflecting one",
            ));
        }
        if let Some(acceleration) = self.goal.acceleration
            && !self.acceleration.contains(acceleration)
        {
            let Interval { lower, upper } = self.acceleration;
            let range = format!("within {lower} and {upper}");
            return Err(out_of_range(
                "the goal's acceleration",
                acceleration,
                lower..=upper,
                &range,
            ));
        }
        // Domains over many steps say nothing about the size of the task, and a start behind the
        // wall is outside of them.
        let system = self.scene(self.domain.unwrap_or(self.near()), [self.damage.clone()]);
        let system = system.hybrid_system()?;
        match &self.goal_region {
            Some(region) => system.program(1)?.goal(region),
            None => Ok(()),
        }
    }

    /// The positions at the wall, at the start and at the goal, and those within a step of them, in
    /// m: they have the size of the task.
    pub(super) fn near(&self) -> Interval {
        let (start, step) = (self.start.position, self.max_speed * self.time_step);
        let ends = Interval::point(start).hull(Interval::point(self.wall.position()));
        let Interval { lower, upper } = self.goal_positions();
        let goal = Interval::new(lower, upper);
        let nearest = Interval::point(start.max(lower).min(upper));
        let Interval { lower, upper } = ends.hull(if goal.is_bounded() { goal } else { nearest });
        Interval::new(lower - step, upper + step)
    }

    /// The positions at which a plan may end, in m: on the wall's free side, if there are any
    /// there.
    fn goal_positions(&self) -> Interval {
        let Some(region) = &self.goal_region else { return Interval::point(self.goal.position) };
        let all = range(region, 0);
        let free = all.intersection(self.wall.free_positions());
        if free.lower <= free.upper { free } else { all }
    }

    /// The velocities at which a plan may end, in m/s.
    fn goal_velocities(&self) -> Interval {
        let region = self.goal_region.as_ref();
        region.map_or(Interval::point(self.goal.velocity), |region| range(region, 1))
    }

    /// The states in which a plan may end.
    pub(super) fn goal_states(&self) -> Region {
        let ranges = [self.goal_positions(), self.goal_velocities()];
        match self.goal_region.clone() {
            Some(mut region) if region.ranges.len() == 2 => {
                region.ranges = ranges.to_vec();
                region
            }
            Some(region) => region,
            None => ranges.into(),
        }
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
    pub(super) fn positions(&self, steps: usize) -> Interval {
        let (wall, dt) = (self.wall, self.time_step);
        let longest_step = dt * (self.max_speed + 0.5 * dt * self.max_acceleration());
        let goal = self.goal_positions();
        let start = wall.gap(self.start.position);
        let [one, other] = [goal.lower, goal.upper].map(|end| wall.gap(end));
        let travel = steps as f64 * longest_step;
        let farthest = (0.5 * (start + one.max(other) + travel)).min(start.max(0.0) + travel);
        // Where the time is too short to go from one to the other, both ends are still places.
        let mut farthest = farthest.max(start).max(one.min(other));
        let e = self.restitution.value();
        let mut nearest = match self.law {
            ContactLaw::Literal => -(longest_step + 0.5 * dt * self.max_speed * (1.0 - e)),
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
        wall.between(nearest, farthest)
    }

    /// The distance from the start to the nearest position at which a plan may end, in m.
    pub(super) fn distance(&self) -> f64 {
        let (start, Interval { lower, upper }) = (self.start.position, self.goal_positions());
        (lower - start).max(start - upper).max(0.0)
    }

    /// The smallest speed at which a plan may end, in m/s.
    pub(super) fn slowest_end(&self) -> f64 {
        let Interval { lower, upper } = self.goal_velocities();
        lower.max(-upper).max(0.0)
    }
}

/// The range of a state, of a region that may not have been checked.
fn range(region: &Region, state: usize) -> Interval {
    region.ranges.get(state).copied().unwrap_or(Interval::REALS)
}
