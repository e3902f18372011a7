//! The program with its limits as statements, for explanations of why there is no plan.

use super::law::ContactLaw;
use super::literal;
use super::program::{Objective, PlanningProgram};
use super::scenario::Scenario;
use crate::error::Error;
use crate::hybrid::When;
use crate::hybrid::scene::{DamageMeasure, DamageRule};
use crate::interval::Interval;
use crate::model::{Affine, Row};

/// The rule that measures the impact speed of every hit, under the reflecting law.
const SPEED: &str = "impact speed";

impl Scenario {
    /// The program of the scenario over a horizon for explanations: start, goal and limits are
    /// named statements over wider domains, so that `explain` can name them. Everything else is
    /// background. The plans are the same as those of [`program`](Scenario::program), which is much
    /// faster to solve. Only a limit on a sum of energies may be stricter, because the chords that
    /// bound an energy are longer over wider domains. There is no objective.
    ///
    /// | statement | meaning | paper |
    /// | --- | --- | --- |
    /// | `start_position`, `start_velocity`, `start_acceleration` | x(0), v(0), a(0) | (1) |
    /// | `goal_position`, `goal_velocity` | x(τ), v(τ) | (2) |
    /// | `goal_limit...` | the rows of the goal's region | |
    /// | `acceleration[t]` | a(t) within its limits, in flight | (5), (6) |
    /// | `speed[t]` | v(t) within its limits | |
    /// | `wall[t]` | x(t) on the free side, if collisions are forbidden | (7) |
    /// | `damage_limit[t]` | D(t) <= D_max, as a limit on the speed | (19) |
    /// | `damage_budget[t]` | the sum of D over the rule's window from t on <= D_total,max | (20) |
    ///
    /// Domains are at least twice the limits, and wide enough to go from the start to the goal in
    /// the given time. The goal's acceleration is never applied, so it contradicts nothing.
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    /// use carom::explain::{ExplainOptions, infeasibility};
    /// use carom::prelude::*;
    ///
    /// // 2 s are too short: 47 steps of 0.05 s are needed.
    /// let program = Scenario::paper().with_time_step(0.05).explainable_program(40)?;
    /// let mut solver = BranchAndBound::default();
    /// let why = infeasibility(program.model(), &ExplainOptions::default(), &mut solver)?;
    /// assert!(why.is_irreducible() && why.solves() <= 20);
    /// assert!(why.groups().iter().any(|group| group.name() == "goal_position"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`program`](Scenario::program).
    pub fn explainable_program(&self, steps: usize) -> Result<PlanningProgram, Error> {
        self.check()?;
        let wide = widened(self, steps);
        let (mut program, speeds) = match self.law {
            ContactLaw::Literal => wide.literal_without_ends(steps)?,
            _ => wide.scene_without_ends(steps)?,
        };
        program.scenario = self.clone();
        program.state_ends(self)?;
        program.state_limits(self)?;
        program.state_damage(self, &speeds)?;
        Ok(program)
    }

    /// The program of the scene from anywhere to anywhere, and the impact speeds that count. A wall
    /// that must not be hit is left out: the domain extends as far behind it as in front of it.
    fn scene_without_ends(&self, steps: usize) -> Result<(PlanningProgram, Vec<Affine>), Error> {
        let (mut positions, free) = (self.positions(steps), self.law == ContactLaw::Forbidden);
        if free {
            let gap = self.wall.gap(positions.lower).max(self.wall.gap(positions.upper));
            positions = self.wall.between(-gap, gap);
        }
        let speed = DamageRule::new(SPEED, DamageMeasure::ImpactSpeed).with_price(1.0);
        let mut scene = self.scene(positions, [self.damage.clone(), speed]);
        if free {
            scene.obstacles.clear();
        }
        for body in &mut scene.bodies {
            (body.start, body.goal) = (None, None);
        }
        let program = scene.plain_program(steps)?;
        let speeds = if free { Vec::new() } else { program.damage_by_step(SPEED)? };
        Ok((self.program_of(program, Objective::Feasibility)?, speeds))
    }

    /// As [`scene_without_ends`](Self::scene_without_ends), under the literal law.
    fn literal_without_ends(&self, steps: usize) -> Result<(PlanningProgram, Vec<Affine>), Error> {
        let system = self.system(steps)?;
        let mut program = self.literal_program(system.program(steps)?, Objective::Feasibility)?;
        let (contact, approach) = (program.contact.clone(), program.impact_speed.clone());
        let speeds = literal::add_speeds(program.program_mut(), &contact, &approach)?;
        // Stated with the limits that are questioned.
        for family in ["flight_least_vehicle_ax", "flight_most_vehicle_ax"] {
            program.model_mut().set_background(family)?;
        }
        Ok((program, speeds))
    }
}

impl PlanningProgram {
    fn state_ends(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let (start, last) = (&scenario.start, self.steps());
        let (x, v, a) = (self.position.clone(), self.velocity.clone(), self.acceleration.clone());
        self.add("start_position", x[0].equals(start.position))?;
        self.add("start_velocity", v[0].equals(start.velocity))?;
        if let Some(value) = start.acceleration {
            self.add("start_acceleration", a[0].equals(value))?;
        }
        let mut region = scenario.goal_states();
        let ends = ["goal_position", "goal_velocity"].into_iter().zip([&x[last], &v[last]]);
        for ((name, value), range) in ends.zip(&mut region.ranges) {
            if range.lower == range.upper {
                self.add(name, value.equals(range.lower))?;
            } else if *range != Interval::REALS {
                self.add(name, value.within(range.lower, range.upper))?;
            }
            *range = Interval::REALS;
        }
        self.program_mut().require("goal_limit", region, When::At(last))
    }

    fn state_limits(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let Interval { lower, upper } = scenario.acceleration;
        for t in 0..self.steps() {
            let limited: Row = self.acceleration[t].within(lower, upper);
            // The forced acceleration of the literal law is not limited.
            match scenario.law {
                ContactLaw::Literal => {
                    let flight = !self.contact[t];
                    self.add(("acceleration", t), flight.implies(limited)).map(drop)?;
                }
                _ => self.add(("acceleration", t), limited).map(drop)?,
            }
        }
        for (t, v) in self.velocity.clone().iter().enumerate() {
            let limit = scenario.max_speed;
            self.add(("speed", t), v.within(-limit, limit))?;
        }
        if scenario.law == ContactLaw::Forbidden {
            for (t, x) in self.position.clone().iter().enumerate() {
                self.add(("wall", t), scenario.wall.gap_of(x).ge(0.0))?;
            }
        }
        Ok(())
    }

    /// The limits of the rule: on the impact speed of a contact, and on sums over its window.
    fn state_damage(&mut self, scenario: &Scenario, speeds: &[Affine]) -> Result<(), Error> {
        let (rule, steps) = (&scenario.damage, self.steps());
        if let Some(most) = literal::most_speed(rule, scenario.restitution.value()) {
            for (t, speed) in speeds.iter().enumerate() {
                let limited = match most < 0.0 {
                    // No impact is slow enough.
                    true => Affine::from(self.contact[t]).le(0.0),
                    false => speed.le(most),
                };
                self.add(("damage_limit", t), limited)?;
            }
        }
        let Some(total) = rule.total.filter(|_| !self.damage.is_empty()) else { return Ok(()) };
        let window = rule.window.unwrap_or(steps).min(steps);
        for (t, damage) in self.damage.clone().windows(window).enumerate() {
            let sum: Affine = damage.iter().sum();
            self.add(("damage_budget", t), sum.le(total))?;
        }
        Ok(())
    }
}

/// The scenario with limits so wide that a plan from start to goal need not reach them, and without
/// a first acceleration.
fn widened(scenario: &Scenario, steps: usize) -> Scenario {
    let time = steps as f64 * scenario.time_step;
    let distance = scenario.distance();
    let speeds = scenario.start.velocity.abs() + scenario.slowest_end();
    // From rest to rest, at full acceleration both ways.
    let hardest = 4.0 * (distance + speeds * time) / (time * time);
    let fastest = 2.0 * distance / time + speeds;
    let most = 2.0 * scenario.max_acceleration().max(hardest);
    let mut wide = scenario.clone();
    wide.start.acceleration = None;
    wide.acceleration = Interval::new(-most, most);
    wide.max_speed = 2.0 * scenario.max_speed.max(fastest);
    let limits = [wide.damage.per_hit.take(), wide.damage.total.take()];
    if limits.iter().any(Option::is_some) {
        // Damage without limits.
        wide.damage.price = 1.0;
    }
    wide
}
