//! The program with its limits as statements, for explanations of why there is no plan.

use super::program::{Ends, Objective, PlanningProgram};
use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::{ContactLaw, Region};
use crate::interval::Interval;
use crate::model::{Affine, Row};

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
    /// | `goal_limit_k[0]` | half-space k of the goal's region | |
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
        let wide = widened(self, &Horizon::new(steps, self.time_step)?);
        let mut program = PlanningProgram::write(&wide, steps, Objective::Feasibility, Ends::Open)?;
        program.scenario = self.clone();
        program.state_ends(self)?;
        program.state_limits(self)?;
        Ok(program)
    }
}

impl PlanningProgram {
    fn state_ends(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let (start, last) = (&scenario.start, self.steps());
        let (x, v) = (&self.position, &self.velocity);
        self.program.add("start_position", x[0].equals(start.position))?;
        self.program.add("start_velocity", v[0].equals(start.velocity))?;
        if let Some(value) = start.acceleration {
            self.program.add("start_acceleration", self.acceleration[0].equals(value))?;
        }
        let Region { ranges, halfspaces, norms, .. } = scenario.goal_states();
        let last_states = [&x[last], &v[last]];
        for ((name, value), range) in
            ["goal_position", "goal_velocity"].into_iter().zip(last_states).zip(&ranges)
        {
            if range.lower == range.upper {
                self.program.add(name, value.equals(range.lower))?;
            } else if *range != Interval::REALS {
                self.program.add(name, value.within(range.lower, range.upper))?;
            }
        }
        let coordinates = self.program().variables().coordinates().clone();
        let families = self.program().variables().states();
        let last_states = [families[0][last], families[1][last]];
        for (k, halfspace) in halfspaces.into_iter().enumerate() {
            let alone = Region::from([Interval::REALS; 2]).with_halfspace(halfspace);
            let alone = coordinates.region(&alone);
            alone.add(self.program.model_mut(), &format!("goal_limit_{k}"), &last_states)?;
        }
        let discs = Region { norms, ..Region::from([Interval::REALS; 2]) };
        let discs = coordinates.region(&discs);
        discs.add(self.program.model_mut(), "goal_limit", &last_states)?;
        Ok(())
    }

    fn state_limits(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let Interval { lower, upper } = scenario.acceleration;
        let literal = scenario.contact.law == ContactLaw::Literal;
        for (t, a) in self.acceleration.iter().enumerate().take(self.steps()) {
            let limited: Row = a.within(lower, upper);
            // The forced acceleration of the literal law is not limited.
            if let Some(zeta) = self.contact.as_ref().filter(|_| literal) {
                self.program.add(("acceleration", t), zeta[t].off().implies(limited))?;
            } else {
                self.program.add(("acceleration", t), limited)?;
            }
        }
        if self.contact.is_some() && literal {
            // Stated above, with the limits that are questioned.
            ["flight_least_a", "flight_most_a"]
                .iter()
                .try_for_each(|f| self.program.model_mut().set_law(f))?;
        }
        for (t, v) in self.velocity.iter().enumerate() {
            let limit = scenario.max_speed;
            self.program.add(("speed", t), v.within(-limit, limit))?;
        }
        if scenario.collisions == Collisions::Forbidden {
            self.state_wall(scenario)?;
        }
        self.state_damage(scenario)
    }

    /// The limits of the rule: on the impact speed of a contact, and on sums over its window.
    fn state_damage(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let (rule, steps) = (&scenario.damage, self.steps());
        if let Some(most) = scenario.contact.most_speed(rule).filter(|most| most.is_finite()) {
            for (t, speed) in self.counted_speed.iter().flatten().enumerate() {
                let limited = match &self.contact {
                    // No impact is slow enough.
                    Some(zeta) if most < 0.0 => zeta[t].le(0.0),
                    _ => speed.le(most),
                };
                self.program.add(("damage_limit", t), limited)?;
            }
        }
        let Some(total) = rule.total.filter(|_| !self.damage.is_empty()) else { return Ok(()) };
        for (t, window) in self.damage.windows(rule.window.unwrap_or(steps).min(steps)).enumerate()
        {
            let sum: Affine = window.iter().cloned().sum();
            self.program.add(("damage_budget", t), sum.le(total))?;
        }
        Ok(())
    }

    /// The wall as a statement; the domain extends as far behind it as in front of it.
    fn state_wall(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let (wall, place) = (scenario.contact.wall, self.units.place(0));
        let own = self.program().variables().state("x")?.clone();
        for (t, (x, variable)) in self.position.iter().zip(&own).enumerate() {
            let own = self.program.model_mut().variable_ref(variable)?.bounds();
            let domain = place.outward_range(Interval::new(own.lower, own.upper));
            let gap = wall.gap(domain.lower).max(wall.gap(domain.upper));
            let (one, other) = (wall.at_gap(-gap), wall.at_gap(gap));
            let wide = place.inward_range(Interval::new(one.min(other), one.max(other)));
            self.program.model_mut().set_bounds(variable, wide.lower, wide.upper)?;
            self.program.add(("wall", t), wall.gap_of(x).ge(0.0))?;
        }
        Ok(())
    }
}

/// The scenario with limits so wide that a plan from start to goal need not reach them.
fn widened(scenario: &Scenario, horizon: &Horizon) -> Scenario {
    let time = horizon.steps() as f64 * horizon.time_step();
    let distance = scenario.distance();
    let speeds = scenario.start.velocity.abs() + scenario.slowest_end();
    // From rest to rest, at full acceleration both ways.
    let hardest = 4.0 * (distance + speeds * time) / (time * time);
    let fastest = 2.0 * distance / time + speeds;
    let most = 2.0 * scenario.max_acceleration().max(hardest);
    let mut wide = scenario.clone();
    wide.acceleration = Interval::new(-most, most);
    wide.max_speed = 2.0 * scenario.max_speed.max(fastest);
    let limits = [wide.damage.per_hit.take(), wide.damage.total.take()];
    if limits.iter().any(Option::is_some) {
        // Damage without limits.
        wide.damage.price = 1.0;
    }
    wide
}
