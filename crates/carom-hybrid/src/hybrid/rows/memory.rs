//! The memory with which a run begins, as rows: its modes, what is left of dwell times, the events
//! so far.

use super::constant_rows::constant;
use super::program::SystemVariables;
use crate::hybrid::memory::Memory;
use crate::interval::Interval;
use crate::model::{Affine, Name, Row, Variable};

/// A row `expression <= limit`, whose limit depends on the memory of the first sample.
pub(crate) struct MemoryRow {
    /// The parts of its family's name; empty ones are none.
    name: Vec<String>,
    /// The sample, if there is one for several.
    pub(crate) sample: Option<usize>,
    pub(crate) expression: Affine,
    /// The range of the limit; at its upper end the row says nothing.
    pub(crate) range: Interval,
    subject: Subject,
}

/// The part of a memory that limits a row.
enum Subject {
    /// The choice, by its name in the memory, may be in a mode.
    Mode { choice: String, mode: String },
    /// It must be in the mode still at a sample.
    Least { choice: String, mode: String, least: usize, sample: usize },
    /// It may not be in the mode up to a sample.
    Most { choice: String, mode: String, most: usize, sample: usize },
    /// So many events are allowed in all.
    Events { most: usize },
}

impl MemoryRow {
    /// The name of the statement after a prefix.
    pub(crate) fn name(&self, prefix: &[&str], suffix: &str) -> Name {
        let own = self.name.iter().map(String::as_str);
        let parts = prefix.iter().copied().chain(own).chain([suffix]);
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        let family = parts.join("_").replace(char::is_whitespace, "_");
        match self.sample {
            Some(sample) => (family, sample).into(),
            None => family.into(),
        }
    }

    /// The limit for a memory.
    pub(crate) fn limit(&self, memory: &Memory) -> f64 {
        let upper = self.range.upper;
        match &self.subject {
            Subject::Mode { choice, mode } => match memory.mode(choice) {
                Some(own) if own != mode => 0.0,
                _ => upper,
            },
            Subject::Least { choice, mode, least, sample } => {
                let (still, _) = memory.left(choice, mode, *least, None);
                if *sample <= still { self.range.lower } else { upper }
            }
            Subject::Most { choice, mode, most, sample } => {
                let (_, more) = memory.left(choice, mode, 0, Some(*most));
                let ends = more.is_some_and(|more| *sample == more + 1);
                if ends { self.range.lower } else { upper }
            }
            Subject::Events { most } => most.saturating_sub(memory.events) as f64,
        }
    }
}

impl SystemVariables {
    /// The rows by which a memory limits a run.
    ///
    /// # Arguments
    ///
    /// * `name_of`: the name of a choice in the memory.
    pub(crate) fn memory_rows(&self, name_of: impl Fn(&str) -> String) -> Vec<MemoryRow> {
        let steps = self.horizon.steps();
        let mut rows = Vec::new();
        for (choice, program) in self.system.choices.iter().zip(&self.choices) {
            let names = choice.modes();
            let named = name_of(&choice.name);
            let name = |mode: &str, kind: String| vec![named.clone(), mode.to_owned(), kind];
            for (k, mode) in names.iter().enumerate() {
                let (choice_name, mode_name) = (named.clone(), (*mode).to_owned());
                rows.push(MemoryRow {
                    name: name(mode, String::new()),
                    sample: None,
                    expression: program.modes.value(k, 0),
                    range: Interval::new(0.0, 1.0),
                    subject: Subject::Mode { choice: choice_name, mode: mode_name },
                });
            }
            for (d, dwell) in choice.dwells.iter().enumerate() {
                let Some(k) = names.iter().position(|mode| *mode == dwell.mode) else { continue };
                let (choice, mode) = (|| named.clone(), || dwell.mode.clone());
                let number = if d == 0 { String::new() } else { format!("_{d}") };
                for sample in 1..dwell.least.min(steps + 1) {
                    let subject = Subject::Least {
                        choice: choice(),
                        mode: mode(),
                        least: dwell.least,
                        sample,
                    };
                    rows.push(MemoryRow {
                        name: name(&dwell.mode, format!("at_least{number}")),
                        sample: Some(sample),
                        expression: -1.0 * program.modes.value(k, sample),
                        range: Interval::new(-1.0, 0.0),
                        subject,
                    });
                }
                let Some(most) = dwell.most else { continue };
                for sample in 1..=most.min(steps) {
                    let subject = Subject::Most { choice: choice(), mode: mode(), most, sample };
                    let held = (0..=sample).map(|s| program.modes.value(k, s));
                    rows.push(MemoryRow {
                        name: name(&dwell.mode, format!("at_most{number}")),
                        sample: Some(sample),
                        expression: held.sum(),
                        range: Interval::new(sample as f64, sample as f64 + 1.0),
                        subject,
                    });
                }
            }
        }
        if let Some(most) = self.system.most_events {
            let events: Affine = (0..steps).map(|t| self.count_events(t)).sum();
            rows.push(MemoryRow {
                name: vec!["events".to_owned()],
                sample: None,
                expression: events,
                range: Interval::new(0.0, most as f64),
                subject: Subject::Events { most },
            });
        }
        // Whoever has only one mode is in it.
        rows.retain(|row| {
            !row.expression.terms().is_empty() || matches!(row.subject, Subject::Most { .. })
        });
        rows
    }

    /// The values with which a choice is in a mode at the first sample.
    pub(crate) fn first_mode(&self, choice: usize, mode: &str) -> Vec<(Variable, f64)> {
        let of = &self.choices[choice].modes;
        let number = self.system.choices[choice].modes().iter().position(|own| *own == mode);
        let value = |k: usize| if Some(k) == number { 1.0 } else { 0.0 };
        of.families().filter_map(|(k, family)| Some((family.get(0)?, value(k)))).collect()
    }

    /// A row that says the same, and has a variable.
    pub(crate) fn of_memory(&self, row: Row) -> Option<Row> {
        match constant(&row) {
            None => Some(row),
            Some(true) => None,
            Some(false) => Some(self.infeasible_row_at(0)),
        }
    }
}
