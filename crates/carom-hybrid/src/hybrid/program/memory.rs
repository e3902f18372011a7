//! Programs that begin with a memory: with modes, how long they have lasted, and events.

use super::{HybridProgram, ProgramSystems};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::memory::Memory;
use crate::hybrid::rows::{MemoryRow, SystemVariables};
use crate::hybrid::system::Choice;
use crate::interval::Interval;
use crate::model::{Model, Variable};
use crate::tolerance::FEASIBILITY;

impl HybridProgram {
    /// Requires the plan to begin with a [memory](Memory): in its modes, which have lasted for some
    /// samples, after some events. So what is left of dwell times holds for the first steps. The
    /// choices of a [joined](HybridProgram::join) system are named after its name and a blank.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`] for a mode that does not exist; [`ErrorKind::DuplicateName`] at
    /// the second call. The model then stays as it was.
    pub fn start_from(&mut self, memory: &Memory) -> Result<(), Error> {
        let systems = self.systems.clone();
        memory.check_choices(&systems.choices())?;
        self.model.all_or_nothing(|model| {
            for (own, prefix, row) in systems.memory_rows() {
                let limit = row.limit(memory);
                if limit >= row.range.upper {
                    continue;
                }
                let name = row.name(&["memory", prefix], "");
                let Some(stated) = own.of_memory(row.expression.le(limit)) else { continue };
                model.describe(name.family(), "the memory of the start".to_owned());
                model.add(name, stated)?;
            }
            Ok(())
        })?;
        self.systems_mut().memory = Some(memory.clone());
        Ok(())
    }
}

impl ProgramSystems {
    /// The name of a choice in memories and moves: its own in the first system and in its cases,
    /// after the system's name in others.
    fn known_as(&self, number: usize, choice: &str) -> String {
        let name = &self.all[number].0;
        match number == 0 || name.is_empty() || self.cases.contains_key(name) {
            true => choice.to_owned(),
            false => format!("{name} {choice}"),
        }
    }

    /// The choices of all systems with their names in memories and moves.
    pub(crate) fn choices(&self) -> Vec<(String, &Choice)> {
        let all = self.all.iter().enumerate();
        let choices = all.flat_map(|(k, (_, own))| {
            own.system().choices.iter().map(move |choice| (self.known_as(k, &choice.name), choice))
        });
        choices.collect()
    }

    /// The rows by which a memory limits the runs, with the prefixes of their names.
    pub(crate) fn memory_rows(&self) -> Vec<(&SystemVariables, &str, MemoryRow)> {
        let all = self.all.iter().enumerate();
        let rows = all.flat_map(|(k, (name, own))| {
            // The name of a choice begins with that of its system unless it is a case.
            let prefix = if self.cases.contains_key(name) { name.as_str() } else { "" };
            let rows = own.memory_rows(|choice| self.known_as(k, choice));
            rows.into_iter().map(move |row| (own, prefix, row))
        });
        rows.collect()
    }

    /// The systems that are no cases with the names of their choices in memories and moves.
    pub(crate) fn steered_choices(&self) -> impl Iterator<Item = (&SystemVariables, Vec<String>)> {
        let all = self.all.iter().enumerate();
        let own = all.filter(|(_, (name, _))| !self.cases.contains_key(name));
        own.map(|(k, (_, own))| {
            let choices = own.system().choices.iter();
            (own, choices.map(|choice| self.known_as(k, &choice.name)).collect())
        })
    }

    /// The choices of which a model says at the first sample that they are in another mode than a
    /// memory.
    pub(crate) fn told_modes(&self, model: &Model, memory: &Memory) -> Vec<String> {
        let all = self.all.iter().enumerate();
        let choices = all.flat_map(|(k, (_, own))| {
            own.system().choices.iter().enumerate().map(move |(c, choice)| (k, own, c, choice))
        });
        let told = choices.filter_map(|(k, own, c, choice)| {
            let name = self.known_as(k, &choice.name);
            let values = own.first_mode(c, memory.mode(&name)?);
            contradicts(model, &values).then_some(name)
        });
        told.collect()
    }

    /// A choice of which a model says at the first sample that it is not in one of its modes.
    pub(crate) fn fixed_mode(&self, model: &Model) -> Option<String> {
        self.choices().into_iter().find_map(|(name, choice)| {
            let modes = choice.modes();
            let in_mode = |mode: &&str| Memory::default().with_mode(&name, *mode, None);
            let mut told = modes.iter().map(|mode| self.told_modes(model, &in_mode(mode)));
            told.any(|told| !told.is_empty()).then(|| choice.name.clone())
        })
    }
}

/// Whether bounds or rows of some variables alone exclude values of them.
fn contradicts(model: &Model, values: &[(Variable, f64)]) -> bool {
    let value = |of: Variable| values.iter().find(|(own, _)| *own == of).map(|(_, value)| *value);
    let excludes = |range: Interval, value: f64| {
        value < range.lower - FEASIBILITY || value > range.upper + FEASIBILITY
    };
    let bounds = values.iter().filter_map(|(own, value)| {
        model.variable_ref(*own).ok().map(|own| excludes(own.bounds(), *value))
    });
    let mut rows = model.constraints().filter_map(|row| {
        let parts = row.terms().iter().map(|(own, factor)| Some(factor * value(*own)?));
        let sum: Option<f64> = parts.sum();
        Some(!row.terms().is_empty() && excludes(row.limits(), sum?))
    });
    bounds.into_iter().any(|excluded| excluded) || rows.any(|excluded| excluded)
}
