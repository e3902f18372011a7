//! Hybrid systems from and to `serde`: a system that is read is checked.

use std::collections::BTreeMap;

use faer::Mat;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::HybridSystem;
use super::choice::Choice;
use super::halfspace::Halfspace;
use super::input_values::InputValues;
use super::norm_limit::NormLimit;
use super::schedule::Schedule;
use super::state_row::StateRow;
use super::step_functions::StepFunctions;
use super::transition::Reset;
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;

/// The serialised form of a system.
#[derive(Serialize, Deserialize)]
pub(super) struct StoredSystem {
    time_step: f64,
    states: Vec<(String, Interval)>,
    inputs: Vec<(String, Schedule<Interval>)>,
    #[serde(default)]
    input_values: BTreeMap<String, InputValues>,
    #[serde(default)]
    limits: Vec<Halfspace>,
    #[serde(default)]
    norms: Vec<NormLimit>,
    #[serde(default)]
    flow: Option<LinearSystem>,
    choices: Vec<Choice>,
    #[serde(default)]
    functions: StepFunctions,
    #[serde(default)]
    state_rows: Vec<StateRow>,
    #[serde(default)]
    most_events: Option<usize>,
    #[serde(default)]
    disturbance: Vec<Interval>,
}

impl From<HybridSystem> for StoredSystem {
    fn from(system: HybridSystem) -> Self {
        StoredSystem {
            time_step: system.time_step,
            states: system.states,
            inputs: system.inputs,
            input_values: system.input_values,
            limits: system.limits,
            norms: system.norms,
            flow: system.flow,
            choices: system.choices,
            functions: system.functions,
            state_rows: system.state_rows,
            most_events: system.most_events,
            disturbance: system.disturbance,
        }
    }
}

impl TryFrom<StoredSystem> for HybridSystem {
    type Error = Error;

    fn try_from(stored: StoredSystem) -> Result<Self, Error> {
        let mut system = HybridSystem::new(stored.time_step);
        for (name, domain) in stored.states {
            system = system.with_state(name, domain);
        }
        for (name, range) in stored.inputs {
            system = system.with_input(name, range);
        }
        system = stored.choices.into_iter().fold(system, HybridSystem::with_choice);
        (system.limits, system.norms) = (stored.limits, stored.norms);
        system.flow = stored.flow;
        (system.functions, system.state_rows) = (stored.functions, stored.state_rows);
        system.input_values = stored.input_values;
        (system.most_events, system.disturbance) = (stored.most_events, stored.disturbance);
        system.check()?;
        Ok(system)
    }
}

/// The serialised form of a reset: rows of numbers.
#[derive(Serialize, Deserialize)]
pub(super) struct StoredReset {
    matrix: Vec<Vec<f64>>,
    offset: Schedule<Vec<f64>>,
}

impl From<Reset> for StoredReset {
    fn from(Reset { matrix, offset }: Reset) -> Self {
        let row = |i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect();
        StoredReset { matrix: (0..matrix.nrows()).map(row).collect(), offset }
    }
}

impl TryFrom<StoredReset> for Reset {
    type Error = Error;

    fn try_from(StoredReset { matrix, offset }: StoredReset) -> Result<Self, Error> {
        let columns = matrix.first().map_or(0, Vec::len);
        if let Some(row) = matrix.iter().find(|row| row.len() != columns) {
            return Err(ErrorKind::Shape {
                what: "the matrix of a reset",
                rows: 1,
                columns: row.len(),
                expected: format!("{columns} columns in every row"),
            }
            .into());
        }
        let matrix = Mat::from_fn(matrix.len(), columns, |i, j| matrix[i][j]);
        Ok(Reset { matrix, offset })
    }
}

/// A number that may be infinite.
#[derive(Serialize, Deserialize)]
#[serde(transparent)]
struct Limit(#[serde(with = "crate::serde_numbers")] f64);

/// Writes limits by step, of which some may be infinite.
pub(super) fn write_limits<S: Serializer>(
    limits: &Schedule<f64>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let limits: Vec<Limit> = limits.values().map(|&limit| Limit(limit)).collect();
    Schedule::<Limit>::from(limits).serialize(serializer)
}

/// Reads limits by step, of which some may be infinite.
pub(super) fn read_limits<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Schedule<f64>, D::Error> {
    let limits = Schedule::<Limit>::deserialize(deserializer)?;
    Ok(limits.values().map(|limit| limit.0).collect::<Vec<f64>>().into())
}
