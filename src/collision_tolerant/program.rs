//! The programs of the paper, for one horizon, row by row with their equation numbers.

use std::borrow::{Borrow, BorrowMut};

use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::hybrid::{ContactLaw, ContactStep, Damage, Horizon, ImpactSpeed, LinearSystem};
use crate::model::{Affine, Family, Model, Quadratic, Variable};

/// The objective of a plan over a fixed horizon.
///
/// A damage weight of the scenario is added, except with [`Feasibility`](Objective::Feasibility).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Objective {
    /// No objective: any plan will do. The paper's choice in its search for the shortest horizon.
    Feasibility,
    /// The effort `Σ Δt a(t)²` over t = 0, ..., τ-1, in m²/s³.
    #[default]
    Effort,
    /// The number of contacts, `Σ ζ(t)`.
    Impacts,
    /// The largest damage of one contact, `max D(t)`, in the damage function's unit.
    LargestDamage,
}

/// Whether start and goal are bounds of the first and the last sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    Fixed,
    Open,
}

/// The program of one horizon: its model and the handles of its variables.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PlanningProgram {
    /// The model.
    pub model: Model,
    /// Its horizon.
    pub horizon: Horizon,
    /// x(0), ..., x(τ), in m.
    pub position: Family,
    /// v(0), ..., v(τ), in m/s.
    pub velocity: Family,
    /// a(0), ..., a(τ), in m/s²; a(τ) does not enter the dynamics.
    pub acceleration: Family,
    /// ζ(0), ..., ζ(τ-1), if collisions are tolerated.
    pub contact: Option<Family>,
    /// Impact speed of each step, in m/s, valid if ζ(t) = 1; empty if collisions are forbidden.
    pub impact_speed: Vec<Affine>,
    /// The damage states, if the scenario or the objective needs them.
    pub damage: Option<Damage>,
}

impl Borrow<Model> for PlanningProgram {
    fn borrow(&self) -> &Model {
        &self.model
    }
}

impl BorrowMut<Model> for PlanningProgram {
    fn borrow_mut(&mut self) -> &mut Model {
        &mut self.model
    }
}

impl PlanningProgram {
    /// Writes the program of a scenario over a horizon.
    ///
    /// ```
    /// use carom::collision_tolerant::{Objective, PlanningProgram, Scenario};
    ///
    /// let program = PlanningProgram::build(&Scenario::paper(), 457, Objective::Feasibility)?;
    /// let zeta = program.contact.expect("collisions are tolerated");
    /// assert_eq!(zeta.len(), 457);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `steps`: τ.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::check`] and of [`Horizon::new`].
    pub fn build(scenario: &Scenario, steps: usize, objective: Objective) -> Result<Self, Error> {
        scenario.check()?;
        PlanningProgram::write(scenario, steps, objective, Ends::Fixed)
    }

    /// Writes the program of a scenario that has been checked.
    pub(super) fn write(
        scenario: &Scenario,
        steps: usize,
        objective: Objective,
        ends: Ends,
    ) -> Result<Self, Error> {
        let horizon = Horizon::new(steps, scenario.time_step)?;
        let mut model = Model::new(match scenario.collisions {
            Collisions::Tolerated => "collision_tolerant",
            Collisions::Forbidden => "collision_free",
        });

        let [position, velocity, acceleration] = add_states(&mut model, scenario, &horizon, ends)?;
        let mut program = PlanningProgram {
            model,
            horizon,
            position,
            velocity,
            acceleration,
            contact: None,
            impact_speed: Vec::new(),
            damage: None,
        };
        match scenario.collisions {
            Collisions::Forbidden => program.add_flight(scenario)?,
            Collisions::Tolerated => program.add_contacts(scenario, objective)?,
        }
        program.set_objective(objective)?;
        Ok(program)
    }

    /// (3), (4) at every step; (7) is in the bounds of the positions.
    fn add_flight(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let vehicle = LinearSystem::double_integrator(scenario.time_step)?;
        let (x, v, a) = (&self.position, &self.velocity, &self.acceleration);
        for t in 0..self.horizon.steps() {
            let (now, next) = ([x[t], v[t]], [x[t + 1], v[t + 1]]);
            vehicle.add_dynamics(&mut self.model, &["x", "v"], t, &now, &[a[t]], &next)?;
        }
        Ok(())
    }

    /// (8)-(13) or the reflecting law instead, and (14)-(20).
    fn add_contacts(&mut self, scenario: &Scenario, objective: Objective) -> Result<(), Error> {
        let vehicle = LinearSystem::double_integrator(scenario.time_step)?;
        let (x, v, a) = (&self.position, &self.velocity, &self.acceleration);
        let zeta = self.model.binary_family("zeta", self.horizon.steps())?;
        let mut contacts: Vec<(Variable, ImpactSpeed)> = Vec::with_capacity(zeta.len());
        for t in 0..self.horizon.steps() {
            let predicted = vehicle.predict(&[x[t], v[t]], &[a[t]])?;
            let step = ContactStep {
                step: t,
                time_step: scenario.time_step,
                position: x[t].into(),
                velocity: v[t].into(),
                acceleration: a[t].into(),
                acceleration_limits: scenario.acceleration,
                predicted_position: predicted[0].clone(),
                predicted_velocity: predicted[1].clone(),
                next_position: x[t + 1].into(),
                next_velocity: v[t + 1].into(),
                contact: zeta[t],
            };
            let impact = scenario.contact.add_step(&mut self.model, &step)?;
            self.impact_speed.push(impact.speed.clone());
            contacts.push((zeta[t], impact));
        }
        if scenario.damage.is_active() || objective == Objective::LargestDamage {
            self.damage = Some(Damage::add(&mut self.model, &contacts, &scenario.damage)?);
        }
        self.contact = Some(zeta);
        Ok(())
    }

    fn set_objective(&mut self, objective: Objective) -> Result<(), Error> {
        let cost = match objective {
            Objective::Feasibility => return Ok(()),
            Objective::Effort => {
                let mut effort = Quadratic::zero();
                for a in self.acceleration.iter().take(self.horizon.steps()) {
                    effort.add_product(self.horizon.time_step(), a, a);
                }
                effort
            }
            Objective::Impacts => {
                let contacts = self.contact.iter().flatten();
                contacts.sum::<Affine>().into()
            }
            Objective::LargestDamage => match &self.damage {
                None => Quadratic::zero(),
                Some(damage) => {
                    let bounds = damage.values.iter().map(|d| self.model.variable_ref(d));
                    let mut highest = 0.0_f64;
                    for variable in bounds {
                        highest = highest.max(variable?.bounds().upper);
                    }
                    let largest = self.model.continuous("D_largest", 0.0, highest)?;
                    for (t, d) in damage.values.iter().enumerate() {
                        self.model.add(("largest_damage", t), d.le(largest))?;
                    }
                    largest.into()
                }
            },
        };
        match &self.damage {
            Some(damage) => self.model.minimize(cost + &damage.cost),
            None => self.model.minimize(cost),
        }
    }

    /// Adds the row `contact_needed`, `Σ ζ(t) >= 1`, for a horizon whose collision-free program is
    /// known to be infeasible. This bounds the number of contacts from below.
    pub(super) fn require_contact(&mut self) -> Result<(), Error> {
        let contacts = self.contact.iter().flatten();
        let total: Affine = contacts.sum();
        self.model.add("contact_needed", total.ge(1.0))?;
        Ok(())
    }
}

/// Positions, velocities and accelerations with their bounds and end conditions.
fn add_states(
    model: &mut Model,
    scenario: &Scenario,
    horizon: &Horizon,
    ends: Ends,
) -> Result<[Family; 3], Error> {
    let samples = horizon.steps() + 1;
    let last = horizon.steps();
    // (7), (21k): the wall is one end of the domain of the positions.
    let positions = scenario.positions(horizon);
    let x = model.continuous_family("x", samples, positions.lower, positions.upper)?;
    let v = model.continuous_family("v", samples, -scenario.max_speed, scenario.max_speed)?;
    // (5), (6), (21i), (21j). The forced acceleration of the literal law exceeds these limits.
    let limits = scenario.acceleration;
    let (lowest, highest) = match (scenario.contact.law, scenario.collisions) {
        (ContactLaw::Literal, Collisions::Tolerated) => {
            let e = scenario.contact.restitution.value();
            let forced = (1.0 + e) * scenario.max_speed / scenario.time_step;
            (limits.lower.min(-forced), limits.upper.max(forced))
        }
        _ => (limits.lower, limits.upper),
    };
    let a = model.continuous_family("a", samples, lowest, highest)?;
    model.set_bounds(a[last], limits.lower, limits.upper)?;
    if ends == Ends::Open {
        return Ok([x, v, a]);
    }

    model.fix(x[0], scenario.start.position)?; // (1), (21c)
    model.fix(x[last], scenario.goal.position)?; // (2), (21d)
    model.fix(v[0], scenario.start.velocity)?; // (21e)
    model.fix(v[last], scenario.goal.velocity)?; // (21f)
    if let Some(value) = scenario.start.acceleration {
        model.fix(a[0], value)?; // (21g)
    }
    if let Some(value) = scenario.goal.acceleration {
        model.fix(a[last], value)?; // (21h)
    }
    Ok([x, v, a])
}
