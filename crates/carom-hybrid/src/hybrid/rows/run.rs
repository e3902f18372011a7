//! Runs of a hybrid system, read back from solutions by name.

use std::fmt::Write;

use super::program::{OneOf, SystemVariables, find};
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::system::{Coordinates, Measure};
use crate::model::Variable;
use crate::number::{DIGITS, TableColumn, rounded};
use crate::solution::{Point, Solution, Termination};

/// Names over the steps or samples, for each choice with its name.
pub(crate) type Named = Vec<(String, Vec<String>)>;

/// A run of a hybrid system over a horizon, in numbers and names.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HybridRun {
    /// Length of a step, in s.
    pub time_step: f64,
    /// Name and values of each state, at the samples 0, ..., τ.
    pub states: Vec<(String, Vec<f64>)>,
    /// Name and values of each input, in the steps 0, ..., τ-1.
    pub inputs: Vec<(String, Vec<f64>)>,
    /// For each choice, its name and the transitions that the steps take.
    pub transitions: Vec<(String, Vec<String>)>,
    /// For each choice with memory, its name and the modes at the samples.
    pub modes: Vec<(String, Vec<String>)>,
    /// Name and values of each output, in the steps 0, ..., τ-1.
    pub outputs: Vec<(String, Vec<f64>)>,
}

impl HybridRun {
    /// The values of a state at the samples.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn state(&self, name: &str) -> Result<&[f64], Error> {
        series(&self.states, name, "state of the run")
    }

    /// The values of an input in the steps.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn input(&self, name: &str) -> Result<&[f64], Error> {
        series(&self.inputs, name, "input of the run")
    }

    /// The transitions of a choice that the steps take.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn transitions(&self, choice: &str) -> Result<&[String], Error> {
        series(&self.transitions, choice, "choice of the run")
    }

    /// The modes of a choice at the samples.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`] also for a choice without memory.
    pub fn modes(&self, choice: &str) -> Result<&[String], Error> {
        series(&self.modes, choice, "choice with modes of the run")
    }

    /// The values of an output in the steps.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn output(&self, name: &str) -> Result<&[f64], Error> {
        series(&self.outputs, name, "output of the run")
    }

    /// The run as a table of comma-separated values, one line per sample: the time in s, states,
    /// inputs, outputs, transitions, modes. The last sample has no inputs, outputs and transitions.
    pub fn to_csv(&self) -> String {
        let quoted = |text: &str| match text.contains([',', '"', '\n', '\r']) {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text.to_owned(),
        };
        let numbers = self.states.iter().chain(&self.inputs).chain(&self.outputs);
        let words = self.transitions.iter().chain(&self.modes);
        let transitions = self.transitions.iter().map(|(name, _)| name.clone());
        let modes = self.modes.iter().map(|(name, _)| format!("{name} mode"));
        let names = numbers.clone().map(|(name, _)| name.clone()).chain(transitions).chain(modes);
        let mut table = "time".to_owned();
        for name in names {
            let _ = write!(table, ",{}", quoted(&name));
        }
        table.push('\n');
        let numbers: Vec<(TableColumn, &[f64])> =
            numbers.map(|(_, values)| (TableColumn::new(values), &values[..])).collect();
        let samples = self.states.first().map_or(0, |(_, values)| values.len());
        for t in 0..samples {
            // Writing into a string cannot fail.
            let _ = write!(table, "{}", rounded(t as f64 * self.time_step, DIGITS));
            for (column, values) in &numbers {
                let _ = match values.get(t) {
                    Some(&value) => write!(table, ",{}", column.text(value)),
                    None => write!(table, ","),
                };
            }
            for (_, values) in words.clone() {
                let _ = write!(table, ",{}", values.get(t).map_or(String::new(), |w| quoted(w)));
            }
            table.push('\n');
        }
        table
    }
}

fn series<'a, T>(
    of: &'a [(String, Vec<T>)],
    name: &str,
    kind: &'static str,
) -> Result<&'a [T], Error> {
    find(of.iter().map(|(name, _)| name.as_str()), name, kind).map(|k| &of[k].1[..])
}

/// The error for a search that ended without a plan.
pub(crate) fn no_plan(termination: Termination) -> Error {
    let help = match termination {
        Termination::Infeasible => {
            "`explain::infeasibility` says which statements of its model contradict each other; a limit that \
             is softened may be exceeded"
        }
        _ => "give it more time, or a larger gap",
    };
    ErrorKind::NoPlan { termination: termination.to_string(), help }.into()
}

impl SystemVariables {
    /// The run of a solution.
    pub fn read(&self, solution: &Solution) -> Result<HybridRun, Error> {
        match solution.point() {
            Some(point) => self.read_point(point),
            None => Err(no_plan(solution.termination())),
        }
    }

    /// The run of a point.
    pub fn read_point(&self, point: &Point) -> Result<HybridRun, Error> {
        self.read_in(point, &self.coordinates)
    }

    /// The run of a point in the coordinates of the variables.
    pub(crate) fn read_own(&self, point: &Point) -> Result<HybridRun, Error> {
        self.read_in(point, &Coordinates::default())
    }

    fn read_in(&self, point: &Point, coordinates: &Coordinates) -> Result<HybridRun, Error> {
        let system = &self.system;
        let family = |variables: &crate::model::Family| -> Result<Vec<f64>, Error> {
            variables.iter().map(|variable| point.value(variable)).collect()
        };
        let mut run = HybridRun { time_step: self.horizon.time_step(), ..HybridRun::default() };
        let outward = |measure: Measure, values: Vec<f64>| -> Vec<f64> {
            values.into_iter().map(|value| measure.outward(value)).collect()
        };
        for (i, ((name, _), variables)) in system.states.iter().zip(&self.states).enumerate() {
            let values = outward(coordinates.state(i), family(variables)?);
            run.states.push((name.clone(), values));
        }
        for (u, ((name, _), variables)) in system.inputs.iter().zip(&self.inputs).enumerate() {
            let values = family(variables)?.into_iter().map(|value| self.of_level(u, value));
            let mut values = outward(coordinates.input(u), values.collect());
            if let Some(stated) =
                self.system().values_of_input(u).filter(|_| !coordinates.is_plain())
            {
                values.iter_mut().for_each(|value| *value = stated.nearest(*value));
            }
            run.inputs.push((name.clone(), values));
        }
        [run.transitions, run.modes] = self.chosen(point)?;
        for (name, values) in &self.outputs {
            let unit = coordinates.output(name);
            let values = values.iter().map(|value| Ok::<f64, Error>(unit * point.value(value)?));
            run.outputs.push((name.clone(), values.collect::<Result<_, _>>()?));
        }
        Ok(run)
    }

    /// The transitions of each choice in the steps of a point, and the modes at its samples.
    pub(crate) fn chosen(&self, point: &Point) -> Result<[Named; 2], Error> {
        let steps = self.horizon.steps();
        let which = |of: &OneOf, names: &[&str], count: usize| -> Result<Vec<String>, Error> {
            let one = |t: usize| -> Result<String, Error> {
                let mut best = (f64::NEG_INFINITY, 0);
                for k in 0..names.len() {
                    let value = point.value(of.value(k, t))?;
                    if value > best.0 {
                        best = (value, k);
                    }
                }
                Ok(names.get(best.1).map_or(String::new(), |name| (*name).to_owned()))
            };
            (0..count).map(one).collect()
        };
        let (mut transitions, mut held) = (Named::new(), Named::new());
        for (choice, program) in self.system.choices.iter().zip(&self.choices) {
            let names: Vec<&str> = choice.transitions.iter().map(|t| t.name.as_str()).collect();
            transitions.push((choice.name.clone(), which(&program.taken, &names, steps)?));
            let modes = choice.modes();
            if !modes.is_empty() {
                held.push((choice.name.clone(), which(&program.modes, &modes, steps + 1)?));
            }
        }
        Ok([transitions, held])
    }

    /// The values of all variables of the program in a run: a MIP start, or a point to check. Only
    /// states, inputs, transitions and modes of the run are used; modes need not be given if the
    /// transitions say what they are.
    pub fn values(&self, run: &HybridRun) -> Result<Vec<(Variable, f64)>, Error> {
        let steps = self.horizon.steps();
        let mut values = Vec::new();
        let mut assign = |family: &crate::model::Family, own: &[f64]| -> Result<(), Error> {
            check_length("the values of a state or input", own.len(), family.len())?;
            values.extend(family.iter().zip(own.iter().copied()));
            Ok(())
        };
        let inward = |measure: Measure, values: &[f64]| -> Vec<f64> {
            values.iter().map(|value| measure.inward(*value)).collect()
        };
        let mut series: Vec<Vec<f64>> = Vec::new();
        for (i, ((name, _), family)) in self.system.states.iter().zip(&self.states).enumerate() {
            let own = inward(self.coordinates.state(i), run.state(name)?);
            assign(family, &own)?;
            series.push(own);
        }
        for (u, ((name, _), family)) in self.system.inputs.iter().zip(&self.inputs).enumerate() {
            let own = inward(self.coordinates.input(u), run.input(name)?);
            assign(family, &own)?;
            series.push(own);
        }
        let of_inputs = &series[self.states.len()..];
        for (own, levels) in of_inputs.iter().zip(&self.levels) {
            let Some(levels) = levels else { continue };
            own.iter().enumerate().for_each(|(t, value)| levels.assign(*value, t, &mut values));
        }
        let z = |t: usize| -> Vec<f64> {
            series.iter().map(|values| values.get(t).copied().unwrap_or(0.0)).collect()
        };
        for (c, (choice, program)) in self.system.choices.iter().zip(&self.choices).enumerate() {
            let taken = run.transitions(&choice.name)?;
            check_length("the transitions of a choice", taken.len(), steps)?;
            let mut modes: Vec<String> = Vec::new();
            for (t, name) in taken.iter().enumerate() {
                let names = choice.transitions.iter().map(|t| t.name.as_str());
                let j = find(names, name, "transition of the choice")?;
                choose(&program.taken, j, t, &mut values);
                if let Some((from, to)) = &choice.transitions[j].modes {
                    if t == 0 {
                        modes.push(from.clone());
                    }
                    modes.push(to.clone());
                }
                let step = self.dynamics(c, t);
                for (g, family) in program.groups.iter().enumerate() {
                    let change = program.changes.of(&step, j, program.changes.groups[g]);
                    values.extend(family.get(t).map(|variable| (variable, change.at(&z(t)))));
                }
            }
            for (t, mode) in modes.iter().enumerate() {
                let k = find(choice.modes().into_iter(), mode, "mode of the choice")?;
                choose(&program.modes, k, t, &mut values);
            }
        }
        Ok(values)
    }
}

/// The values of the binaries with which one of several things holds.
fn choose(of: &OneOf, number: usize, step: usize, values: &mut Vec<(Variable, f64)>) {
    values.extend(of.families().filter_map(|(k, family)| {
        let value = if k == number { 1.0 } else { 0.0 };
        Some((family.get(step)?, value))
    }));
}
