//! The programs of the paper, for one horizon, row by row with their equation numbers.

use super::scenario::{Collisions, Scenario};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::program::owns_program;
use crate::hybrid::rows::SystemVariables;
use crate::hybrid::scene::line::in_unit;
use crate::hybrid::scene::{SceneProgram, SceneUnits};
use crate::hybrid::system::Measure;
use crate::hybrid::{ContactLaw, HybridProgram};
use crate::model::{Affine, Family, Model, Quadratic};

/// The objective of a plan over a fixed horizon.
///
/// The prices of the scenario's damage are added, except with
/// [`Feasibility`](Objective::Feasibility).
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

/// The program of one horizon: a [`HybridProgram`], and the paper's variables in it by step.
///
/// It may be extended by rows and costs of your own. What the scenario says is then checked against
/// the scenario itself.
///
/// ```
/// use carom::collision_tolerant::{Objective, Scenario};
/// use carom::prelude::*;
///
/// let scenario = Scenario::paper().with_time_step(0.1);
/// let mut program = scenario.program(30, Objective::Effort)?;
/// // Speeds up to 6 m/s in the first second, and nothing in the second one.
/// for t in 1..=10 {
///     program.add(("slow", t), program.velocity[t].within(-6.0, 6.0))?;
///     program.add(("coast", t), program.acceleration[10 + t].equals(0.0))?;
/// }
/// let plan = program.solve(&mut BranchAndBound::default())?;
/// assert!(plan.trajectory.velocity[10] >= -6.0 - 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PlanningProgram {
    /// (3)-(7), and (8)-(13) or the reflecting law instead.
    pub(super) program: HybridProgram,
    /// The scenario, against which plans are certified.
    pub scenario: Scenario,
    /// x(0), ..., x(τ), in m.
    pub position: Vec<Affine>,
    /// v(0), ..., v(τ), in m/s.
    pub velocity: Vec<Affine>,
    /// a(0), ..., a(τ), in m/s²; a(τ) does not enter the dynamics.
    pub acceleration: Vec<Affine>,
    /// ζ(0), ..., ζ(τ-1), if collisions are tolerated.
    pub contact: Option<Family>,
    /// Impact speed of each step, in m/s, valid if ζ(t) = 1; empty if collisions are forbidden.
    pub impact_speed: Vec<Affine>,
    /// D(0), ..., D(τ-1), in the unit of the scenario's rule, at least the damage of the step;
    /// empty if the rule has neither a total nor a price.
    pub damage: Vec<Affine>,
    /// The impact speeds that count as damage, in m/s, if the model has them.
    pub(super) counted_speed: Option<Vec<Affine>>,
    /// Those of the variables.
    pub(super) units: SceneUnits,
    /// The cases, by name; the model is that of this program.
    pub(super) cases: Vec<(String, PlanningProgram)>,
}

owns_program!(PlanningProgram);

impl Scenario {
    /// The program of the scenario over a horizon, row by row. [`plan`](Scenario::plan) tightens it
    /// by reach sets before it is solved.
    ///
    /// # Arguments
    ///
    /// * `steps`: τ.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::check`]; [`ErrorKind::OutOfRange`] for a number of steps that is not
    /// from 1 to [`MAX_STEPS`](crate::tolerance::MAX_STEPS).
    pub fn program(&self, steps: usize, objective: Objective) -> Result<PlanningProgram, Error> {
        self.check()?;
        PlanningProgram::write(self, steps, objective, Ends::Fixed)
    }
}

impl PlanningProgram {
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
        let units = scenario.units();
        let system = scenario.system(&horizon, &scenario.damage)?;
        system.check()?;
        let own = scenario.restated(&system, &units)?;
        let hybrid = system.write_restated(&own, &mut model, "", &horizon, None)?;
        let program = HybridProgram::from_parts(model, hybrid);
        let (mut program, cost) =
            PlanningProgram::completed(scenario, units, program, objective, ends)?;
        if objective != Objective::Feasibility {
            program.minimize(cost)?;
        }
        Ok(program)
    }

    /// A program whose first system is that of the scenario in some units, with its ends and rules,
    /// and its cost.
    fn completed(
        scenario: &Scenario,
        units: SceneUnits,
        mut program: HybridProgram,
        objective: Objective,
        ends: Ends,
    ) -> Result<(Self, Quadratic), Error> {
        let steps = program.steps();
        let horizon = Horizon::new(steps, scenario.time_step)?;
        let hybrid = program.variables().clone();
        let measures = units.measures();
        // a(τ) does not enter the dynamics.
        let limits = measures[2].inward_range(scenario.acceleration);
        let last = program.model.continuous(("a", steps), limits.lower, limits.upper)?;
        let own: [Family; 3] = [
            hybrid.state("x")?.clone(),
            hybrid.state("v")?.clone(),
            hybrid.input("a")?.iter().chain([last]).collect(),
        ];
        if ends == Ends::Fixed {
            fix_ends(scenario, &mut program, &own, &measures)?;
        }
        let stated = |k: usize| own[k].iter().map(|x| hybrid.in_units(measures[k], x)).collect();
        let [position, velocity, acceleration]: [Vec<Affine>; 3] = [0, 1, 2].map(stated);
        let contact = contacts(&hybrid);
        let impact_speed = match (scenario.collisions, scenario.contact.law) {
            (Collisions::Forbidden, _) => Vec::new(),
            (_, ContactLaw::Literal) => {
                let speeds = velocity.iter().take(steps);
                speeds.map(|v| -scenario.contact.wall.rate_of(v)).collect()
            }
            _ => {
                let own = hybrid.output(IMPACT_SPEED)?.iter();
                own.map(|speed| in_unit(units.speed(), speed.clone())).collect()
            }
        };
        // (14)-(20).
        let hit = match scenario.contact.law {
            _ if contact.is_none() => None,
            ContactLaw::Literal => Some("contact"),
            _ => Some("impact"),
        };
        let scene = scenario.scene(&horizon);
        let mut program = SceneProgram::on_line(&scene, &units, program, hit)?;
        let cost = cost(&mut program, objective)?;
        let program = PlanningProgram {
            damage: program.damage_by_step(),
            counted_speed: program.counted_speed(),
            program: program.into(),
            scenario: scenario.clone(),
            position,
            velocity,
            acceleration,
            contact,
            impact_speed,
            units,
            cases: Vec::new(),
        };
        Ok((program, cost))
    }

    /// Adds a case: another scenario, such as one with another restitution or another goal. In the
    /// steps before `until` it has the accelerations of the program's scenario; from then on the
    /// cases can be told apart. [Plans](super::Plan::cases) have those of the cases.
    ///
    /// The objective stays as it is: add the returned cost with weights, or limit both by
    /// [`worst`](HybridProgram::worst).
    ///
    /// ```
    /// use carom::collision_tolerant::{Objective, Scenario};
    /// use carom::prelude::*;
    ///
    /// // The wall rebounds by 0.2 or by 0.5, which is known after 20 steps.
    /// let goal = Region::from([0.1..=0.6, -0.4..=0.4]);
    /// let scenario = Scenario::paper().with_time_step(0.1).with_goal_region(goal);
    /// let soft = scenario.clone().with_restitution(0.2)?;
    /// let hard = scenario.with_restitution(0.5)?;
    /// let mut program = soft.program(28, Objective::Effort)?;
    /// let soft_cost = program.model().objective().clone();
    /// let hard_cost = program.add_case("hard", &hard, 20, Objective::Effort)?;
    /// program.minimize(0.5 * soft_cost + 0.5 * hard_cost)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// let [soft, hard] = [&plan, &plan.cases["hard"]].map(|plan| &plan.trajectory.acceleration);
    /// assert!((0..20).all(|t| (soft[t] - hard[t]).abs() < 1e-6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Returns
    ///
    /// The cost of the case, in the unit of the objective; 0 for [`Objective::Feasibility`].
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::program`] for the case; [`ErrorKind::OutOfRange`] for steps beyond the
    /// horizon and another time step; [`ErrorKind::DuplicateName`]. The program then stays as it
    /// was.
    pub fn add_case(
        &mut self,
        name: &str,
        scenario: &Scenario,
        until: usize,
        objective: Objective,
    ) -> Result<Quadratic, Error> {
        scenario.check()?;
        let horizon = Horizon::new(self.steps(), scenario.time_step)?;
        let system = scenario.system(&horizon, &scenario.damage)?;
        let mut cost = Quadratic::zero();
        system.check()?;
        let own = scenario.restated(&system, &self.units)?;
        let units = self.units.clone();
        let case = self.program.write_case(
            name,
            &system,
            &own,
            until,
            |program| {
                let (case, own) =
                    PlanningProgram::completed(scenario, units, program, objective, Ends::Fixed)?;
                cost = own;
                Ok(case)
            },
            PlanningProgram::program_mut,
        )?;
        self.cases.push((name.to_owned(), case));
        Ok(cost)
    }

    /// Adds the row `contact_needed`, `Σ ζ(t) >= 1`, for a horizon whose collision-free program is
    /// known to be infeasible. This bounds the number of contacts from below.
    pub(super) fn require_contact(&mut self) -> Result<(), Error> {
        let total: Affine = self.contact.iter().flatten().sum();
        self.add("contact_needed", total.ge(1.0))?;
        Ok(())
    }
}

/// An objective and the prices of damage.
fn cost(program: &mut SceneProgram, objective: Objective) -> Result<Quadratic, Error> {
    let cost: Quadratic = match objective {
        Objective::Feasibility => return Ok(Quadratic::zero()),
        Objective::Effort => program.effort()?,
        Objective::Impacts => program.hits().into(),
        Objective::LargestDamage => program.largest_impact()?.into(),
    };
    Ok(cost + program.price())
}

/// (1), (2), (21c)-(21h), on the positions, velocities and accelerations, which are in measures.
fn fix_ends(
    scenario: &Scenario,
    program: &mut HybridProgram,
    [x, v, a]: &[Family; 3],
    [place, speed, push]: &[Measure; 3],
) -> Result<(), Error> {
    let (start, goal, last) = (&scenario.start, &scenario.goal, program.steps());
    if scenario.goal_region.is_some() {
        program.goal(scenario.goal_states())?;
    }
    let model = program.model_mut();
    model.fix(x[0], place.inward(start.position))?; // (1), (21c)
    model.fix(v[0], speed.inward(start.velocity))?; // (21e)
    if scenario.goal_region.is_none() {
        model.fix(x[last], place.inward(goal.position))?; // (2), (21d)
        model.fix(v[last], speed.inward(goal.velocity))?; // (21f)
    }
    if let Some(value) = start.acceleration {
        model.fix(a[0], push.inward(value))?; // (21g)
    }
    if let Some(value) = goal.acceleration {
        model.fix(a[last], push.inward(value))?; // (21h)
    }
    Ok(())
}

/// ζ(0), ..., ζ(τ-1), the choice of the second transition, if there is a choice.
fn contacts(hybrid: &SystemVariables) -> Option<Family> {
    let variables = hybrid.horizon_variables();
    variables.transitions.into_iter().find(|(number, _)| *number == 1).map(|(_, zeta)| zeta)
}
