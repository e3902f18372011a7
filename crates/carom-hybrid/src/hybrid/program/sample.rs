//! Expressions of systems, taken at a sample of a program.

use std::collections::BTreeMap;

use crate::error::{Error, ErrorKind};
use crate::hybrid::memory::Memory;
use crate::hybrid::mission::RequiredMission;
use crate::hybrid::rows::SystemVariables;
use crate::hybrid::system::{HybridSystem, Input, Meaning, State, SystemRow, power_of_two};
use crate::interval::Interval;
use crate::model::{
    Affine, ConicRow, Literal, Model, ModelTag, Nonlinear, NonlinearRow, Norm, NormSum, Quadratic,
    Row, StoredConic, Variable,
};
use crate::solution::Solution;
use crate::solver::Solver;

use super::HybridPlan;

/// The systems of a program and their variables.
#[derive(Debug, Clone)]
pub(crate) struct ProgramSystems {
    /// Of the program's model.
    tag: ModelTag,
    pub(crate) steps: usize,
    /// By name; the first one has none.
    pub(super) all: Vec<(String, SystemVariables)>,
    /// The systems that are cases, by name, with the number of first steps in which they share
    /// their inputs.
    pub(crate) cases: BTreeMap<String, usize>,
    /// Missions that plans are checked for.
    pub(crate) missions: Vec<RequiredMission>,
    /// Bounds before and after what sets have proved about them, which says nothing that the
    /// program does not.
    pub(super) implied: BTreeMap<Variable, (Interval, Interval)>,
    /// The memory with which plans begin, if the program says it.
    pub(crate) memory: Option<Memory>,
    /// Whether the state says in which modes a step begins, as with bodies at rest, so that no mode
    /// is carried.
    pub(crate) modes_follow_states: bool,
    /// How many first steps have whole integers, if later ones are relaxed.
    pub(crate) integer_steps: Option<usize>,
}

impl ProgramSystems {
    pub(super) fn new(tag: ModelTag, variables: SystemVariables) -> Self {
        let steps = variables.horizon().steps();
        let (cases, implied, missions) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        let all = vec![(String::new(), variables)];
        let (memory, modes_follow_states, integer_steps) = (None, false, None);
        ProgramSystems {
            tag,
            steps,
            all,
            cases,
            missions,
            implied,
            memory,
            modes_follow_states,
            integer_steps,
        }
    }

    /// The first system's variables.
    pub(crate) fn first(&self) -> &SystemVariables {
        &self.all[0].1
    }

    /// The system's variables if there is only one.
    pub(crate) fn only(&self) -> Option<&SystemVariables> {
        (self.all.len() == 1).then(|| self.first())
    }

    /// The variables of the system that a controller steers: of the first one, if all others are
    /// cases.
    pub(crate) fn steered(&self) -> Option<&SystemVariables> {
        (self.all.len() == self.cases.len() + 1).then(|| self.first())
    }

    /// Puts the system with a name in the place of the first one.
    pub(crate) fn put_first(&mut self, name: &str) {
        if let Some(k) = self.all.iter().position(|(own, _)| own == name) {
            self.all.swap(0, k);
        }
    }

    /// All systems' variables with their names.
    pub(crate) fn named(&self) -> impl Iterator<Item = (&str, &SystemVariables)> {
        self.all.iter().map(|(name, variables)| (name.as_str(), variables))
    }

    /// All systems' variables.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &SystemVariables> {
        self.all.iter().map(|(_, variables)| variables)
    }

    pub(crate) fn push(&mut self, name: &str, variables: SystemVariables) {
        self.all.push((name.to_owned(), variables));
    }

    /// Refuses a system that cannot be added.
    pub(crate) fn check_new(&self, name: &str, system: &HybridSystem) -> Result<(), Error> {
        let time_step = self.first().system().time_step;
        if system.time_step != time_step {
            let (what, own) = ("the time step (s)", time_step..=time_step);
            let more = ", that of the program";
            return Err(Error::out_of_range_with(what, system.time_step, own, more));
        }
        let is_in = |own: &SystemVariables| own.system().handles.tag == system.handles.tag;
        if self.iter().any(is_in) {
            let (name, place) = (format!("the system of `{name}`"), "this program".to_owned());
            let help = "it is in it already; state a second system, with handles of its own";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        if name.is_empty() || self.all.iter().any(|(own, _)| own == name) {
            return Err(Error::duplicate_name(name, "system of the program"));
        }
        Ok(())
    }

    /// The system of a handle with its variables, and what the handle stands for; `None` if it is
    /// of no system of the program.
    pub(super) fn meaning(&self, handle: Variable) -> Option<(&SystemVariables, &Meaning)> {
        self.iter().find_map(|own| Some((own, own.system().handles.meaning(handle)?)))
    }

    /// A handle at a sample.
    pub(crate) fn value(&self, handle: Variable, sample: usize) -> Result<Affine, Error> {
        if handle.tag() == self.tag {
            return Ok(handle.into());
        }
        let Some((own, meaning)) = self.meaning(handle) else { return Err(foreign(handle)) };
        let ends = match meaning {
            Meaning::State(_) | Meaning::InMode(..) | Meaning::Series(..) => self.steps + 1,
            _ => self.steps,
        };
        if sample >= ends {
            let what = format!("the sample of `{}`", own.system().handle_name(handle));
            let (sample, steps) = (sample as f64, self.steps as f64);
            return Err(match ends == self.steps {
                true => Error::out_of_range_with(what, sample, ..steps, ", the number of steps"),
                false => Error::out_of_range_with(what, sample, ..=steps, ", the last sample"),
            });
        }
        match meaning {
            Meaning::State(i) => {
                Ok(own.in_units(own.coordinates().state(*i), own.states()[*i][sample]))
            }
            Meaning::Input(u) => {
                Ok(own.in_units(own.coordinates().input(*u), own.inputs()[*u][sample]))
            }
            Meaning::Series(_, values) => {
                Ok(Affine::constant(values.get(sample).copied().unwrap_or(f64::NAN)))
            }
            Meaning::InMode(choice, mode) => own.mode_value(*choice, mode, sample),
            Meaning::Acting(choice, mode) => own.mode_value(*choice, mode, sample + 1),
            Meaning::Taken(choice, number) => Ok(own.taken_value(*choice, *number, sample)),
            Meaning::Output(name) => {
                let (value, unit) = (&own.output(name)?[sample], own.coordinates().output(name));
                Ok(if unit == 1.0 { value.clone() } else { unit * value })
            }
            Meaning::Prediction(_) => {
                let name = format!("`{}`", own.system().handle_name(handle));
                let place = "an expression of a program".to_owned();
                let help = "use the state at the next sample, or state the prediction as an output";
                Err(ErrorKind::Misplaced { name, place, help }.into())
            }
        }
    }

    /// The power of two that brings a condition on some expressions into the unit in which its
    /// states, inputs and outputs are computed, so that tolerances mean there what they mean for
    /// these; 1 for the user's own numbers.
    pub(crate) fn weight<'a>(&self, parts: impl IntoIterator<Item = &'a Affine>) -> f64 {
        let (mut largest, mut is_plain) = (0.0_f64, true);
        for (handle, factor) in parts.into_iter().flat_map(Affine::terms) {
            let Some((own, meaning)) = self.meaning(handle) else { continue };
            let scale = match meaning {
                Meaning::State(i) => own.coordinates().state(*i).scale,
                Meaning::Input(u) => own.coordinates().input(*u).scale,
                Meaning::Output(name) => own.coordinates().output(name),
                _ => continue,
            };
            largest = largest.max((factor * scale).abs());
            is_plain &= scale == 1.0;
        }
        if is_plain || largest == 0.0 { 1.0 } else { 1.0 / power_of_two(largest) }
    }

    /// The same for a norm; squares are left in their unit.
    pub(crate) fn weight_of(&self, conic: &StoredConic) -> f64 {
        match conic {
            StoredConic::Norm { entries, bound } => self.weight(entries.iter().chain([bound])),
            StoredConic::Quadratic { .. } => 1.0,
        }
    }

    /// The variable of a state or an input at a sample.
    pub(super) fn variable(&self, handle: Variable, sample: usize) -> Result<Variable, Error> {
        let value = self.value(handle, sample)?;
        let is_series =
            matches!(self.meaning(handle), Some((_, Meaning::State(_) | Meaning::Input(_))) | None);
        match value.terms()[..] {
            [(variable, _)] if is_series => Ok(variable),
            _ => {
                let own = self.meaning(handle).map(|(own, _)| own.system().handle_name(handle));
                let name = format!("`{}`", own.unwrap_or_default());
                let place = "a question for a variable".to_owned();
                let help = "name a state or an input; everything else is an expression, by `at`";
                Err(ErrorKind::Misplaced { name, place, help }.into())
            }
        }
    }

    /// The number of samples at which an expression has a value: that of steps, or one more.
    pub(crate) fn samples(&self, expression: &Affine) -> usize {
        let is_at_samples = |handle: Variable| {
            let own = self.meaning(handle).map(|(_, meaning)| meaning);
            matches!(
                own,
                Some(Meaning::State(_) | Meaning::InMode(..) | Meaning::Series(..)) | None
            )
        };
        match expression.terms().iter().all(|(handle, _)| is_at_samples(*handle)) {
            true => self.steps + 1,
            false => self.steps,
        }
    }

    /// The values of a handle in a plan's point, at all its samples.
    pub(super) fn values(&self, handle: Variable, solution: &Solution) -> Result<Vec<f64>, Error> {
        let samples = 0..self.samples(&handle.into());
        samples.map(|sample| solution.value(self.value(handle, sample)?)).collect()
    }

    /// A solution whose inputs are as far outward as they can be.
    pub(super) fn extreme(
        &self,
        model: &Model,
        plan: &HybridPlan,
        solver: &mut dyn Solver,
    ) -> Result<Option<Solution>, Error> {
        let mut model = model.clone();
        let mut inputs = Vec::new();
        for (own, run) in self.iter().zip(plan.runs()) {
            own.fix_transitions(&mut model, run)?;
            inputs.extend(own.input_values(run)?);
        }
        crate::hybrid::rows::push_outward(model, &inputs, solver)
    }
}

fn foreign(handle: Variable) -> Error {
    let (index, place) = (handle.index(), "an expression of a program".to_owned());
    ErrorKind::ForeignHandle { kind: "variable", index, place, name: None }.into()
}

/// An argument of [`HybridProgram::at`](super::HybridProgram::at): an expression, a row, a
/// comparison of a norm or of squares, or a condition.
pub trait AtSample {
    /// The same, of the variables of the program's model.
    type Output;

    #[doc(hidden)]
    #[expect(private_interfaces, reason = "only the types of this module implement it")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Self::Output, Error>;
}

macro_rules! at_sample_as {
    ($via:ty: $($type:ty),+) => {$(
        impl AtSample for $type {
            type Output = <$via as AtSample>::Output;

            #[expect(private_interfaces, reason = "as the trait")]
            fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Self::Output, Error> {
                <$via>::from(self.clone()).at_sample(systems, sample)
            }
        }
    )+};
}

impl AtSample for Affine {
    type Output = Affine;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Affine, Error> {
        let mut sum = Affine::constant(self.offset());
        for (handle, factor) in self.terms() {
            sum += factor * systems.value(handle, sample)?;
        }
        Ok(sum)
    }
}

impl AtSample for Quadratic {
    type Output = Quadratic;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Quadratic, Error> {
        let mut sum = Quadratic::from(self.affine().at_sample(systems, sample)?);
        for (first, second, factor) in self.products() {
            let [first, second] = [systems.value(first, sample)?, systems.value(second, sample)?];
            sum += factor * (first * second);
        }
        Ok(sum)
    }
}

impl AtSample for NormSum {
    type Output = NormSum;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<NormSum, Error> {
        self.try_map(
            |entry| entry.at_sample(systems, sample),
            |rest| rest.at_sample(systems, sample),
        )
    }
}

impl AtSample for Row {
    type Output = Row;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Row, Error> {
        let expression = self.expression().at_sample(systems, sample)?;
        Ok(match systems.weight([self.expression()]) {
            1.0 => expression.within(self.lower(), self.upper()),
            weight => (weight * expression).within(weight * self.lower(), weight * self.upper()),
        })
    }
}

impl AtSample for ConicRow {
    type Output = ConicRow;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<ConicRow, Error> {
        let row = self.try_map(&mut |expression| expression.at_sample(systems, sample))?;
        match systems.weight_of(self.stored()) {
            1.0 => Ok(row),
            weight => row.try_map(&mut |expression| Ok(weight * expression)),
        }
    }
}

impl AtSample for Nonlinear {
    type Output = Nonlinear;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Nonlinear, Error> {
        self.try_map(&mut |own: &Affine| own.at_sample(systems, sample))
    }
}

impl AtSample for NonlinearRow {
    type Output = NonlinearRow;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<NonlinearRow, Error> {
        self.try_map(&mut |own: &Affine| own.at_sample(systems, sample))
    }
}

impl AtSample for SystemRow {
    type Output = SystemRow;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<SystemRow, Error> {
        Ok(match self {
            SystemRow::Row(row) => row.at_sample(systems, sample)?.into(),
            SystemRow::Conic(row) => row.at_sample(systems, sample)?.into(),
            SystemRow::Nonlinear(row) => row.at_sample(systems, sample)?.into(),
        })
    }
}

impl SystemRow {
    /// The row at a sample in the units in which it is stated.
    pub(crate) fn as_stated_at(
        &self,
        systems: &ProgramSystems,
        sample: usize,
    ) -> Result<SystemRow, Error> {
        Ok(match self {
            SystemRow::Row(row) => {
                let expression = row.expression().at_sample(systems, sample)?;
                expression.within(row.lower(), row.upper()).into()
            }
            SystemRow::Conic(row) => {
                row.try_map(&mut |expression| expression.at_sample(systems, sample))?.into()
            }
            SystemRow::Nonlinear(row) => row.at_sample(systems, sample)?.into(),
        })
    }
}

impl AtSample for Literal {
    type Output = Literal;

    #[expect(private_interfaces, reason = "as the trait")]
    fn at_sample(&self, systems: &ProgramSystems, sample: usize) -> Result<Literal, Error> {
        let value = systems.value(self.variable(), sample)?;
        match (&value.terms()[..], value.offset()) {
            ([(binary, 1.0)], 0.0) if self.is_on() => Ok(binary.on()),
            ([(binary, 1.0)], 0.0) => Ok(binary.off()),
            ([(binary, -1.0)], 1.0) if self.is_on() => Ok(binary.off()),
            ([(binary, -1.0)], 1.0) => Ok(binary.on()),
            _ => {
                let name = "a condition that always holds or that is no binary".to_owned();
                let place = "a program".to_owned();
                let help = "conditions are on modes and transitions that have an alternative";
                Err(ErrorKind::Misplaced { name, place, help }.into())
            }
        }
    }
}

at_sample_as!(Affine: State, Input, Variable, &State, &Input, &Variable, &Affine);
at_sample_as!(Quadratic: &Quadratic);
at_sample_as!(Nonlinear: &Nonlinear);
at_sample_as!(NormSum: Norm);
