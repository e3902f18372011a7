//! The programs of the paper, for one horizon, row by row with their equation numbers.

use std::borrow::{Borrow, BorrowMut};

use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::rows::SystemVariables;
use crate::hybrid::scene::SceneProgram;
use crate::hybrid::{ContactLaw, Horizon, When};
use crate::model::{Affine, Family, Model, Quadratic};

/// The objective of a plan over a fixed horizon.
///
/// The prices of the scenario's damage are added, except with [`Feasibility`](Objective::Feasibility).
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
    /// The largest impact speed of a contact that counts as damage, in m/s.
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
    pub(crate) horizon: Horizon,
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
    /// D(0), ..., D(τ-1), in the unit of the scenario's rule, at least the damage of the step; empty
    /// if the rule has neither a total nor a price.
    pub damage: Vec<Affine>,
    /// The impact speeds that count as damage, in m/s, if the model has them.
    pub(super) counted_speed: Option<Family>,
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
    /// Those of [`Scenario::check`]; [`ErrorKind::OutOfRange`](crate::ErrorKind::OutOfRange) for the
    /// number of steps.
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

        let hybrid = scenario.system(&horizon, &scenario.damage)?.write(&mut model, "", steps)?;
        // a(τ) does not enter the dynamics.
        let limits = scenario.acceleration;
        let last = model.continuous(("a", steps), limits.lower, limits.upper)?;
        let (position, velocity) = (hybrid.state("x")?.clone(), hybrid.state("v")?.clone());
        let acceleration: Family = hybrid.input("a")?.iter().chain([last]).collect();
        let contact = contacts(&hybrid);
        let impact_speed = match (scenario.collisions, scenario.contact.law) {
            (Collisions::Forbidden, _) => Vec::new(),
            (_, ContactLaw::Literal) => {
                let speeds = velocity.iter().take(steps);
                speeds.map(|v| -scenario.contact.wall.rate_of(&v.into())).collect()
            }
            _ => hybrid.output(IMPACT_SPEED)?.to_vec(),
        };
        if ends == Ends::Fixed {
            let families = [&position, &velocity, &acceleration];
            fix_ends(scenario, &mut model, &hybrid, families)?;
        }
        // (14)-(20).
        let hit = match scenario.contact.law {
            _ if contact.is_none() => None,
            ContactLaw::Literal => Some("contact"),
            _ => Some("impact"),
        };
        let mut program = SceneProgram::on_line(scenario.scene(&horizon), model, hybrid, hit)?;
        set_objective(&mut program, objective)?;
        let (damage, counted_speed) = (program.damage_by_step(), program.counted_speed());
        let SceneProgram { model, hybrid, .. } = program;
        Ok(PlanningProgram {
            model,
            horizon,
            position,
            velocity,
            acceleration,
            contact,
            impact_speed,
            hybrid,
            damage,
            counted_speed,
        })
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

fn set_objective(program: &mut SceneProgram, objective: Objective) -> Result<(), Error> {
    let cost: Quadratic = match objective {
        Objective::Feasibility => return Ok(()),
        Objective::Effort => program.effort()?,
        Objective::Impacts => program.hits().into(),
        Objective::LargestDamage => program.largest_impact()?.into(),
    };
    let price = program.price();
    program.model.minimize(cost + price)
}

/// (1), (2), (21c)-(21h), on the positions, velocities and accelerations.
fn fix_ends(
    scenario: &Scenario,
    model: &mut Model,
    hybrid: &SystemVariables,
    [x, v, a]: [&Family; 3],
) -> Result<(), Error> {
    let (start, goal, last) = (&scenario.start, &scenario.goal, hybrid.horizon().steps());
    model.fix(x[0], start.position)?; // (1), (21c)
    model.fix(v[0], start.velocity)?; // (21e)
    if scenario.goal_region.is_some() {
        hybrid.require(model, "goal", &scenario.goal_states(), When::At(last))?;
    } else {
        model.fix(x[last], goal.position)?; // (2), (21d)
        model.fix(v[last], goal.velocity)?; // (21f)
    }
    if let Some(value) = start.acceleration {
        model.fix(a[0], value)?; // (21g)
    }
    if let Some(value) = goal.acceleration {
        model.fix(a[last], value)?; // (21h)
    }
    Ok(())
}

/// ζ(0), ..., ζ(τ-1), the choice of the second transition, if there is a choice.
fn contacts(hybrid: &SystemVariables) -> Option<Family> {
    let variables = hybrid.horizon_variables();
    variables.transitions.into_iter().find(|(number, _)| *number == 1).map(|(_, zeta)| zeta)
}
