//! The programs of the paper, for one horizon, and the paper's variables in them.

use super::law::ContactLaw;
use super::literal;
use super::scenario::Scenario;
use crate::error::{Error, ErrorKind};
use crate::hybrid::HybridProgram;
use crate::hybrid::scene::SceneProgram;
use crate::model::{Affine, Literal, Model, Name, Quadratic, Statement, Variable};

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

/// The program of one horizon: that of the scenario's scene, or of the paper's own system under the
/// literal law, and the paper's variables in it by step.
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
    pub(super) written: Written,
    /// The scenario, against which plans are certified.
    pub scenario: Scenario,
    /// x(0), ..., x(τ), in m.
    pub position: Vec<Affine>,
    /// v(0), ..., v(τ), in m/s.
    pub velocity: Vec<Affine>,
    /// a(0), ..., a(τ), in m/s²; a(τ) does not enter the dynamics.
    pub acceleration: Vec<Affine>,
    /// ζ(0), ..., ζ(τ-1); empty if collisions are forbidden.
    pub contact: Vec<Literal>,
    /// Impact speed of each step, in m/s, valid if ζ(t) = 1; empty if collisions are forbidden.
    pub impact_speed: Vec<Affine>,
    /// D(0), ..., D(τ-1), in the unit of the scenario's rule, at least the damage of the step;
    /// empty if the rule has neither a total nor a price.
    pub damage: Vec<Affine>,
    /// The cases, by name, with their scenarios and their a(τ).
    pub(super) cases: Vec<(String, Scenario, Affine)>,
}

/// (3)-(20): by the scenes, or by hand.
#[derive(Debug, Clone)]
pub(super) enum Written {
    Scene(Box<SceneProgram>),
    Literal(Box<HybridProgram>),
}

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
        match self.law {
            ContactLaw::Literal => {
                let mut program = self.system(steps)?.program(steps)?;
                program.start(self.start_state())?;
                program.goal(self.goal_states())?;
                self.literal_program(program, objective)
            }
            _ => self.program_of(self.scene_over(steps).plain_program(steps)?, objective),
        }
    }

    /// The program of the paper's own system with the paper's variables, and with the rule.
    pub(super) fn literal_program(
        &self,
        mut program: HybridProgram,
        objective: Objective,
    ) -> Result<PlanningProgram, Error> {
        let (own, cost) = Variables::of_literal(self, &mut program, objective)?;
        program.minimize(cost)?;
        Ok(own.program(self, Written::Literal(Box::new(program))))
    }

    /// The program of a scene with the paper's variables.
    pub(super) fn program_of(
        &self,
        mut program: SceneProgram,
        objective: Objective,
    ) -> Result<PlanningProgram, Error> {
        let (own, cost) = Variables::of_scene(self, &mut program, objective)?;
        program.minimize(cost)?;
        Ok(own.program(self, Written::Scene(Box::new(program))))
    }
}

impl PlanningProgram {
    /// The hybrid program: the scenario's system over the horizon, and what has been added.
    pub fn program(&self) -> &HybridProgram {
        match &self.written {
            Written::Scene(program) => program.program(),
            Written::Literal(program) => program,
        }
    }

    /// The hybrid program, for statements with the handles of its system.
    pub fn program_mut(&mut self) -> &mut HybridProgram {
        match &mut self.written {
            Written::Scene(program) => program.program_mut(),
            Written::Literal(program) => program,
        }
    }

    /// The number of steps, τ.
    pub fn steps(&self) -> usize {
        self.program().steps()
    }

    /// The model.
    pub fn model(&self) -> &Model {
        self.program().model()
    }

    /// The model, for statements of your own.
    pub fn model_mut(&mut self) -> &mut Model {
        self.program_mut().model_mut()
    }

    /// Adds a statement to the model, as [`Model::add`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Model::add`].
    pub fn add<S: Statement>(
        &mut self,
        name: impl Into<Name>,
        statement: S,
    ) -> Result<S::Handle, Error> {
        self.model_mut().add(name, statement)
    }

    /// Sets the cost, as [`Model::minimize`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Model::minimize`].
    pub fn minimize(&mut self, cost: impl Into<Quadratic>) -> Result<(), Error> {
        self.model_mut().minimize(cost.into())
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
    /// horizon and another time step; [`ErrorKind::DuplicateName`]; [`ErrorKind::Unsupported`]
    /// under the literal law. The program then stays as it was.
    pub fn add_case(
        &mut self,
        name: &str,
        scenario: &Scenario,
        until: usize,
        objective: Objective,
    ) -> Result<Quadratic, Error> {
        scenario.check()?;
        let steps = self.steps();
        let Written::Scene(program) = &mut self.written else { return Err(no_cases()) };
        if scenario.law == ContactLaw::Literal {
            return Err(no_cases());
        }
        let before = program.clone();
        let added = program.add_case(name, &scenario.scene_over(steps), until).and_then(|()| {
            program.in_case(name, |case| Variables::of_scene(scenario, case, objective))
        });
        match added {
            Ok((own, cost)) => {
                let last = own.acceleration[steps].clone();
                self.cases.push((name.to_owned(), scenario.clone(), last));
                Ok(cost)
            }
            Err(error) => {
                *program = before;
                Err(error)
            }
        }
    }
}

fn no_cases() -> Error {
    ErrorKind::Unsupported {
        solver: "the literal law".into(),
        what: "cases".into(),
        help: "choose the reflecting law".into(),
    }
    .into()
}

/// The paper's variables.
struct Variables {
    position: Vec<Affine>,
    velocity: Vec<Affine>,
    acceleration: Vec<Affine>,
    contact: Vec<Literal>,
    impact_speed: Vec<Affine>,
    damage: Vec<Affine>,
}

impl Variables {
    /// The variables of the program of a scene, and a cost.
    fn of_scene(
        scenario: &Scenario,
        program: &mut SceneProgram,
        objective: Objective,
    ) -> Result<(Self, Quadratic), Error> {
        let mut own = Variables::of(scenario, program.program_mut(), ["vehicle at wall", "hit"])?;
        if own.has_damage(scenario) {
            own.damage = program.damage_by_step(&scenario.damage.name)?;
        }
        let cost = match objective {
            Objective::Feasibility => Quadratic::zero(),
            Objective::LargestDamage => (program.largest_impact()? + program.price()).into(),
            other => own.cost(other, scenario.time_step) + program.price(),
        };
        Ok((own, cost))
    }

    /// The variables of the program of the paper's own system, to which the rule is added, and a
    /// cost.
    fn of_literal(
        scenario: &Scenario,
        program: &mut HybridProgram,
        objective: Objective,
    ) -> Result<(Self, Quadratic), Error> {
        let mut own = Variables::of(scenario, program, ["mode", "contact"])?;
        let (rule, e) = (&scenario.damage, scenario.restitution.value());
        if own.has_damage(scenario) {
            own.damage = literal::add_damage(program, &own.contact, &own.impact_speed, rule, e)?;
        }
        let hits = own.hits();
        literal::limit_sums(program, &hits, &own.damage, rule)?;
        let price = rule.price * own.damage.iter().sum::<Affine>()
            + rule.price_per_hit * hits.iter().sum::<Affine>();
        let cost = match objective {
            Objective::Feasibility => Quadratic::zero(),
            Objective::LargestDamage => {
                let speeds = literal::add_speeds(program, &own.contact, &own.impact_speed)?;
                let most = scenario.max_speed;
                let largest = program.model_mut().continuous("largest_damage", 0.0, most)?;
                for (t, speed) in speeds.iter().enumerate() {
                    program.add(("damage_at_most", t), largest.ge(speed))?;
                }
                (largest + price).into()
            }
            other => own.cost(other, scenario.time_step) + price,
        };
        Ok((own, cost))
    }

    /// Whether there are contacts and a rule with a total or a price.
    fn has_damage(&self, scenario: &Scenario) -> bool {
        let rule = &scenario.damage;
        !self.contact.is_empty() && (rule.total.is_some() || rule.price != 0.0)
    }

    /// Reads the variables of a program, adds a(τ), which does not enter the dynamics, and fixes
    /// both ends of the acceleration, (21g) and (21h).
    ///
    /// # Arguments
    ///
    /// * `contact`: the choice and the transition of the contact.
    fn of(
        scenario: &Scenario,
        program: &mut HybridProgram,
        contact: [&str; 2],
    ) -> Result<Self, Error> {
        let (steps, system) = (program.steps(), program.system());
        let [x, v] = [system.state_named("vehicle x")?, system.state_named("vehicle vx")?];
        let a = system.input_named("vehicle ax")?;
        let hit = match scenario.law {
            ContactLaw::Forbidden => None,
            _ => Some(system.transition_named(contact[0], contact[1])?.on()),
        };
        let at = |of: Variable, last: usize| -> Result<Vec<Affine>, Error> {
            (0..=last).map(|t| program.at(of, t)).collect()
        };
        let (position, velocity) = (at(x.into(), steps)?, at(v.into(), steps)?);
        let mut acceleration = at(a.into(), steps - 1)?;
        let contact = (0..steps).filter_map(|t| Some(program.at(hit?, t)));
        let contact = contact.collect::<Result<Vec<Literal>, _>>()?;
        if let (Some(value), ContactLaw::Literal) = (scenario.start.acceleration, scenario.law) {
            program.add("start_acceleration", program.at(a.equals(value), 0)?)?;
        }
        let limits = scenario.acceleration;
        let model = program.model_mut();
        let last = model.continuous(("vehicle_ax", steps), limits.lower, limits.upper)?;
        if let Some(value) = scenario.goal.acceleration {
            model.fix(last, value)?;
        }
        acceleration.push(last.into());
        // The approach at the end of the flight, or at its start.
        let speed = |t: usize| match scenario.law {
            ContactLaw::Literal => -scenario.wall.rate_of(&velocity[t]),
            _ => {
                let end = &velocity[t] + scenario.time_step * &acceleration[t];
                -scenario.wall.rate_of(&end)
            }
        };
        let impact_speed = (0..contact.len()).map(speed).collect();
        Ok(Variables {
            position,
            velocity,
            acceleration,
            contact,
            impact_speed,
            damage: Vec::new(),
        })
    }

    /// ζ(t) as numbers.
    fn hits(&self) -> Vec<Affine> {
        self.contact.iter().map(|&hit| hit.into()).collect()
    }

    /// The effort or the number of contacts.
    fn cost(&self, objective: Objective, time_step: f64) -> Quadratic {
        match objective {
            Objective::Effort => {
                let applied = &self.acceleration[..self.acceleration.len() - 1];
                applied.iter().map(|a| time_step * (a * a)).sum()
            }
            _ => self.hits().into_iter().sum::<Affine>().into(),
        }
    }

    fn program(self, scenario: &Scenario, written: Written) -> PlanningProgram {
        let Variables { position, velocity, acceleration, contact, impact_speed, damage } = self;
        PlanningProgram {
            written,
            scenario: scenario.clone(),
            position,
            velocity,
            acceleration,
            contact,
            impact_speed,
            damage,
            cases: Vec::new(),
        }
    }
}

impl From<PlanningProgram> for HybridProgram {
    /// The program with its rules and cases, for controllers.
    fn from(program: PlanningProgram) -> Self {
        match program.written {
            Written::Scene(program) => (*program).into(),
            Written::Literal(program) => *program,
        }
    }
}

impl AsRef<Model> for PlanningProgram {
    fn as_ref(&self) -> &Model {
        self.model()
    }
}

impl AsMut<Model> for PlanningProgram {
    fn as_mut(&mut self) -> &mut Model {
        self.model_mut()
    }
}
