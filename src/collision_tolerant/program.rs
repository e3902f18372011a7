//! The programs of the paper, for one horizon, row by row with their equation numbers.

use std::borrow::{Borrow, BorrowMut};

use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::rows::SystemVariables;
use crate::hybrid::{ContactLaw, Damage, Horizon, ImpactSpeed, When};
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
///
/// The model may be extended by rows and costs of your own. A solution of it becomes a plan by
/// [`Plan::certify`](super::Plan::certify).
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
    /// The system's variables by name: (3)-(7), and (8)-(13) or the reflecting law instead.
    #[doc(hidden)]
    pub hybrid: SystemVariables,
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

        let hybrid = scenario.system(&horizon, None)?.write(&mut model, "", steps)?;
        // a(τ) does not enter the dynamics.
        let limits = scenario.acceleration;
        let last = model.continuous(("a", steps), limits.lower, limits.upper)?;
        let mut program = PlanningProgram {
            horizon,
            position: hybrid.state("x")?.clone(),
            velocity: hybrid.state("v")?.clone(),
            acceleration: hybrid.input("a")?.iter().chain([last]).collect(),
            contact: contacts(&hybrid),
            impact_speed: Vec::new(),
            damage: None,
            model,
            hybrid,
        };
        if scenario.collisions == Collisions::Tolerated {
            let wall = scenario.contact.wall;
            program.impact_speed = match scenario.contact.law {
                ContactLaw::Literal => {
                    let speeds = program.velocity.iter().take(steps);
                    speeds.map(|v| -wall.rate_of(&v.into())).collect()
                }
                _ => program.hybrid.output(IMPACT_SPEED)?.to_vec(),
            };
        }
        if ends == Ends::Fixed {
            program.fix_ends(scenario)?;
        }
        program.add_damage(scenario, objective)?;
        program.set_objective(objective)?;
        Ok(program)
    }

    /// (14)-(20).
    fn add_damage(&mut self, scenario: &Scenario, objective: Objective) -> Result<(), Error> {
        let Some(zeta) = &self.contact else { return Ok(()) };
        if !scenario.damage.is_active() && objective != Objective::LargestDamage {
            return Ok(());
        }
        // Under the literal law the wall pushes from the start of the step on.
        let zero_in_flight = scenario.contact.law == ContactLaw::Reflecting;
        let speeds = self.impact_speed.iter();
        let wall = scenario.contact.wall;
        let impacts = speeds.zip(&self.velocity).map(|(speed, v)| {
            let impact = ImpactSpeed::new(speed.clone(), zero_in_flight);
            match scenario.is_sound() {
                true => impact.with_start(-wall.rate_of(&v.into())),
                false => impact,
            }
        });
        let contacts: Vec<(Variable, ImpactSpeed)> = zeta.iter().zip(impacts).collect();
        self.damage = Some(Damage::add(&mut self.model, &contacts, &scenario.damage)?);
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

    fn fix_ends(&mut self, scenario: &Scenario) -> Result<(), Error> {
        let (start, goal, last) = (&scenario.start, &scenario.goal, self.horizon.steps());
        let (model, x, v) = (&mut self.model, &self.position, &self.velocity);
        model.fix(x[0], start.position)?; // (1), (21c)
        model.fix(v[0], start.velocity)?; // (21e)
        if scenario.goal_region.is_some() {
            self.hybrid.require(model, "goal", &scenario.goal_states(), When::At(last))?;
        } else {
            model.fix(x[last], goal.position)?; // (2), (21d)
            model.fix(v[last], goal.velocity)?; // (21f)
        }
        if let Some(value) = start.acceleration {
            model.fix(self.acceleration[0], value)?; // (21g)
        }
        if let Some(value) = goal.acceleration {
            model.fix(self.acceleration[last], value)?; // (21h)
        }
        Ok(())
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

/// ζ(0), ..., ζ(τ-1), the choice of the second transition, if there is a choice.
fn contacts(hybrid: &SystemVariables) -> Option<Family> {
    let variables = hybrid.horizon_variables();
    variables.transitions.into_iter().find(|(number, _)| *number == 1).map(|(_, zeta)| zeta)
}
