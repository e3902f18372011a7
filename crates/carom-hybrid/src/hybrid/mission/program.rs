//! Missions of programs: required, or with their margin as a variable, and checked in plans.

use super::formula::{Mission, MissionNode};
use super::required::RequiredMission;
use super::robustness::ValueSource;
use super::rows::{Margin, write};
use super::unrolled::{FALSE, RowAt, Unrolled};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::program::{AtSample, HybridPlan, HybridProgram, ProgramSystems};
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{HybridSystem, SystemRow};
use crate::interval::Interval;
use crate::model::{Affine, Model, Name, SealedStatement, Statement, Variable, VariableKind};
use crate::solution::Solution;
use crate::tolerance::REACH;

/// Where a mission is read.
struct RunShape<'a> {
    row_at: &'a RowAt<'a>,
    is_binary: &'a dyn Fn(Variable) -> bool,
    samples: usize,
    time_step: f64,
}

/// How to treat a mission that cannot be true because the run ends before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Late {
    Refused,
    /// The program has no plan.
    NoPlan,
}

/// How much robustness a mission has to have.
#[derive(Clone, Copy, PartialEq)]
enum Wanted {
    /// None, beside that it holds.
    Truth,
    /// A variable that is at most the robustness, and at least a number.
    Margin { at_least: Option<f64> },
}

/// Adds the statements of a mission, and returns its margin.
fn state(
    model: &mut Model,
    name: &str,
    mission: &Mission,
    place: &RunShape<'_>,
    wanted: Wanted,
    late: Late,
) -> Result<Affine, Error> {
    Name::from(name).check()?;
    if let Wanted::Margin { at_least: Some(least) } = wanted {
        check_finite(name, "the least margin", [least])?;
    }
    let separated = wanted == Wanted::Truth;
    let (samples, time_step) = (place.samples, place.time_step);
    mission.check_windows(time_step)?;
    let mut unrolled =
        Unrolled::new(model, place.row_at, place.is_binary, samples, time_step, separated);
    let root = unrolled.at(mission, true, 0)?;
    if root == FALSE && late == Late::Refused {
        let last = samples.saturating_sub(1);
        let what = format!("the last sample of the run of `{name}`");
        let range = "late enough for its windows: what is beyond the end counts as not true; give it more \
                     steps, or let windows last to the end, as in `always(0..)`";
        return Err(Error::out_of_range_in_words(what, last as f64, .., range));
    }
    let bound = unrolled.finite_range(root);
    let ranges = unrolled.ranges.clone();
    let parts = unrolled.into_parts();
    let margin = model.all_or_nothing(|model| {
        let margin = match wanted {
            Wanted::Truth => Margin { value: Affine::zero(), range: Interval::point(0.0) },
            Wanted::Margin { at_least } => {
                let least = at_least.unwrap_or(f64::NEG_INFINITY);
                let lower = match least.max(bound.lower.min(bound.upper)) {
                    // A mission that no plan fulfils.
                    lower if lower == f64::NEG_INFINITY && bound.upper == lower => 0.0,
                    lower => lower,
                };
                let range = Interval::new(lower, bound.upper.max(lower));
                let variable = model.continuous(name, range.lower, range.upper)?;
                Margin { value: variable.into(), range }
            }
        };
        write(model, name, &parts, root, &margin)?;
        Ok(margin.value)
    })?;
    narrow(model, &ranges)?;
    Ok(margin)
}

/// Gives variables the ranges that the model's rows imply, from which big-Ms are computed.
fn narrow(model: &mut Model, ranges: &[Interval]) -> Result<(), Error> {
    let variables: Vec<(Variable, Interval)> = model
        .variables()
        .filter(|own| own.kind() == VariableKind::Continuous && own.semicontinuous().is_none())
        .filter(|own| own.parameter_range().is_none())
        .filter_map(|own| {
            let range = own.bounds().intersection(*ranges.get(own.id().index())?);
            (range != own.bounds() && range.lower <= range.upper).then_some((own.id(), range))
        })
        .collect();
    variables
        .into_iter()
        .try_for_each(|(own, range)| model.set_bounds(own, range.lower, range.upper))
}

impl HybridProgram {
    /// Requires every plan to do what a mission says, from sample 0 on. A negated row is missed by
    /// at least [`MISSION_SEPARATION`](crate::tolerance::MISSION_SEPARATION), so that a mission and
    /// its negation never both hold.
    ///
    /// Bounds and rows that the program has already, such as its start, decide parts of the mission
    /// beforehand: state the start and the goal first, and [`tighten`](HybridProgram::tighten)
    /// before this. Do not make these rows wider later, except by the value of a
    /// [parameter](crate::model::Model::parameter) in its range.
    ///
    /// Plans are checked by the mission's [robustness](Mission::robustness), which knows nothing of
    /// the rows. The statements are `name_1`, `name_2`, ...
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at); [`ErrorKind::NotConicRow`] for a norm that is negated;
    /// [`ErrorKind::OutOfRange`] for a window without samples, and for a mission that cannot be
    /// true because the run ends before.
    #[doc(alias("STL", "signal temporal logic"))]
    pub fn require_mission(&mut self, name: &str, mission: &Mission) -> Result<(), Error> {
        self.state_mission(name, mission, Wanted::Truth, Late::Refused).map(drop)
    }

    /// The same, but a run that ends too early for the mission is no error: there is no plan.
    pub(in crate::hybrid) fn require_mission_if_in_time(
        &mut self,
        name: &str,
        mission: &Mission,
    ) -> Result<(), Error> {
        self.state_mission(name, mission, Wanted::Truth, Late::NoPlan).map(drop)
    }

    /// Requires the same by a margin, and returns the margin, a variable of the model in the unit
    /// of the mission's rows that is at most the [robustness](Mission::robustness): maximise it, or
    /// have it in a cost.
    ///
    /// ```
    /// use carom::hybrid::Mission;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", -9.0, 9.0)?; // m
    /// let u = cart.input("u", -1.0, 1.0)?; // m/s
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// let near = Mission::holds("near", [x.within(2.0, 3.0)]);
    /// let mut program = cart.program(4)?;
    /// program.start([x.equals(0.0)])?;
    /// let margin = program.mission_margin("mission", &near.eventually(0..=4), 0.0)?;
    /// program.maximize(margin)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.value(margin, 0)? - 0.5).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `at_least`: the least margin; with `None`, plans may fail the mission, but for its modes.
    ///
    /// # Errors
    ///
    /// Those of [`require_mission`](HybridProgram::require_mission); [`ErrorKind::NotFinite`].
    #[doc(alias = "robustness")]
    pub fn mission_margin(
        &mut self,
        name: &str,
        mission: &Mission,
        at_least: impl Into<Option<f64>>,
    ) -> Result<Variable, Error> {
        let wanted = Wanted::Margin { at_least: at_least.into() };
        let margin = self.state_mission(name, mission, wanted, Late::Refused)?;
        Ok(margin
            .terms()
            .first()
            .map_or(Variable::new(usize::MAX, self.model.tag()), |term| term.0))
    }

    fn state_mission(
        &mut self,
        name: &str,
        mission: &Mission,
        wanted: Wanted,
        late: Late,
    ) -> Result<Affine, Error> {
        let systems = self.systems.clone();
        // A margin is in the unit of the rows.
        let as_stated = wanted != Wanted::Truth;
        let row_at = |row: &SystemRow, sample: usize| match systems.row_has_values(row, sample)? {
            true if as_stated => row.as_stated_at(&systems, sample).map(Some),
            true => row.at_sample(&systems, sample).map(Some),
            false => Ok(None),
        };
        let (samples, time_step) = (self.steps() + 1, self.system().time_step());
        let is_binary = |handle: Variable| systems.is_binary(handle);
        let place = RunShape { row_at: &row_at, is_binary: &is_binary, samples, time_step };
        let margin = state(&mut self.model, name, mission, &place, wanted, late)?;
        let (name, mission) = (name.to_owned(), mission.clone());
        let unit = unit(&mission, &self.systems);
        let required = RequiredMission { name, mission, margin: margin.clone(), unit };
        self.systems_mut().missions.push(required);
        Ok(margin)
    }
}

impl Mission {
    /// The mission as a statement of a [`Model`] without a system: that it holds from sample 0 on.
    /// Rows are of the model's variables, by [`holds_by_sample`](Mission::holds_by_sample).
    ///
    /// ```
    /// use carom::hybrid::Mission;
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("storage");
    /// let level = model.continuous_family("level", 4, 0.0, 10.0)?; // m
    /// let full = Mission::holds_by_sample("full", (0..4).map(|k| [level[k].ge(4.0)]));
    /// model.add("mission", full.eventually(1..=3).over(4, 60.0))?;
    /// model.minimize(level[1] + level[2] + 0.5 * level[3])?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(level[3])? - 4.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `samples`: how many there are, the first one included.
    /// * `time_step`: Δt between them, in s, for windows in seconds.
    ///
    /// # Errors
    ///
    /// Adding it has the errors of [`HybridProgram::require_mission`].
    pub fn over(&self, samples: usize, time_step: f64) -> impl Statement<Handle = ()> + use<> {
        MissionOfModel { mission: self.clone(), samples, time_step }
    }
}

/// A mission over the samples of a model.
struct MissionOfModel {
    mission: Mission,
    samples: usize,
    time_step: f64,
}

impl SealedStatement for MissionOfModel {}
impl Statement for MissionOfModel {
    type Handle = ();

    fn add_to(self, model: &mut Model, name: Name) -> Result<(), Error> {
        let MissionOfModel { mission, samples, time_step } = self;
        let row_at = |row: &SystemRow, _: usize| Ok(Some(row.clone()));
        let place = RunShape { row_at: &row_at, is_binary: &|_| false, samples, time_step };
        let name = name.to_string();
        state(model, &name, &mission, &place, Wanted::Truth, Late::Refused).map(drop)
    }
}

/// The largest unit in which the rows of a mission are computed.
fn unit(mission: &Mission, systems: &ProgramSystems) -> f64 {
    if systems.iter().all(|own| own.coordinates().is_plain()) {
        return 1.0;
    }
    let mut least = f64::INFINITY;
    mission.visit(&mut |part| {
        let MissionNode::Holds(predicate) = &part.node else { return };
        for row in (0..=systems.steps).filter_map(|sample| predicate.rows(sample)).flatten() {
            let weight = match row {
                SystemRow::Row(row) => systems.weight([row.expression()]),
                SystemRow::Conic(row) => systems.weight_of(row.stored()),
                SystemRow::Nonlinear(_) => 1.0,
            };
            least = least.min(weight);
        }
    });
    if least.is_finite() { 1.0 / least } else { 1.0 }
}

/// A plan's point, by the handles of its systems.
struct PlanValues<'a> {
    systems: &'a ProgramSystems,
    solution: &'a Solution,
}

impl ValueSource for PlanValues<'_> {
    fn value(&self, handle: Variable, sample: usize) -> Result<Option<f64>, Error> {
        match self.systems.has_value(handle, sample)? {
            false => Ok(None),
            true => self.solution.value(self.systems.value(handle, sample)?).map(Some),
        }
    }

    fn is_binary(&self, handle: Variable) -> bool {
        self.systems.is_binary(handle)
    }
}

impl ProgramSystems {
    /// The robustness of a mission in a solution.
    fn robustness(&self, mission: &Mission, solution: &Solution) -> Result<f64, Error> {
        let time_step = self.first().system().time_step();
        mission.robustness_of(&PlanValues { systems: self, solution }, self.steps + 1, time_step)
    }

    /// Refuses a solution that does not do what the program's missions say.
    pub(crate) fn check_missions(&self, solution: &Solution) -> Result<(), Error> {
        for RequiredMission { name, mission, margin, unit } in &self.missions {
            let (found, wanted) =
                (self.robustness(mission, solution)?, solution.value(margin.clone())?);
            let holds = found >= wanted - REACH * (unit + wanted.abs());
            if !holds {
                let what = format!("the robustness of `{name}` in the plan");
                let more = ", the margin of the rows";
                return Err(Error::out_of_range_with(what, found, wanted.., more));
            }
        }
        Ok(())
    }
}

impl HybridPlan {
    /// By how much the plan does what a mission says, also one that the program does not require:
    /// its [robustness](Mission::robustness), in the unit of its rows.
    ///
    /// # Errors
    ///
    /// Those of [`Mission::robustness`]; [`ErrorKind::ForeignHandle`].
    pub fn robustness(&self, mission: &Mission) -> Result<f64, Error> {
        self.systems().robustness(mission, &self.solution)
    }
}

/// A run, by the names of its system.
struct RunValues<'a> {
    system: &'a HybridSystem,
    run: &'a HybridRun,
}

impl ValueSource for RunValues<'_> {
    fn value(&self, handle: Variable, sample: usize) -> Result<Option<f64>, Error> {
        self.system.value_in(self.run, handle, sample)
    }

    fn is_binary(&self, handle: Variable) -> bool {
        self.system.is_binary(handle)
    }
}

impl HybridSystem {
    /// By how much a run, such as a simulation's or one of a scene's plan, does what a mission
    /// says: its [robustness](Mission::robustness), in the unit of its rows.
    ///
    /// # Errors
    ///
    /// Those of [`Mission::robustness`]; [`ErrorKind::ForeignHandle`]; [`ErrorKind::UnknownName`]
    /// for the run of another system.
    pub fn robustness(&self, mission: &Mission, run: &HybridRun) -> Result<f64, Error> {
        let samples = run.states.first().map_or(0, |(_, values)| values.len());
        mission.robustness_of(&RunValues { system: self, run }, samples, run.time_step)
    }
}
