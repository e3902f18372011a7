//! The table with its proofs as a text, which `carom-proof table` checks.
//!
//! The text states the program in numbers, the plans at corners, the evidence for bounds, and the
//! cells as a tree. Its format is on the page `docs/explicit_control.md`.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::sync::Arc;

use carom_embedded::LookupNumber;

use crate::arrays::{CONDENSED_ROUNDING, LookupArrays, SINGLE_UNIT};
use crate::bounds::Evidence;
use crate::build::PartitionCell;
use crate::form::ParametricForm;
use crate::proof_of_cell::{CellProof, CellStep};
use crate::relaxed::{CornerRelaxation, PLAN_TOLERANCE};
use crate::table::ExplicitTable;

/// Numbers what is shared, by its address.
struct Shared<T> {
    numbers: HashMap<*const T, usize>,
    things: Vec<Arc<T>>,
}

impl<T> Shared<T> {
    fn new() -> Self {
        Shared { numbers: HashMap::new(), things: Vec::new() }
    }

    fn add(&mut self, thing: &Arc<T>) {
        let things = &mut self.things;
        self.numbers.entry(Arc::as_ptr(thing)).or_insert_with(|| {
            things.push(Arc::clone(thing));
            things.len() - 1
        });
    }

    fn number(&self, thing: &Arc<T>) -> usize {
        self.numbers.get(&Arc::as_ptr(thing)).copied().unwrap_or(usize::MAX)
    }
}

/// The entries that are not 0: their number, and position and value of each.
fn entries(values: impl IntoIterator<Item = f64>) -> String {
    let values = values.into_iter().enumerate().filter(|(_, value)| *value != 0.0);
    let words: Vec<String> = values.map(|(k, value)| format!(" {k} {value:?}")).collect();
    format!("{}{}", words.len(), words.concat())
}

fn numbers<T: std::fmt::Debug>(values: &[T]) -> String {
    values.iter().map(|value| format!(" {value:?}")).collect()
}

/// The numbers of a device as they are, not as the shortest digits that are rounded to them.
fn exact<T: Copy + Into<f64>>(values: &[T]) -> String {
    let values: Vec<f64> = values.iter().map(|&value| value.into()).collect();
    numbers(&values)
}

fn write_device<T: LookupNumber + Into<f64>>(
    out: &mut impl Write,
    bits: u32,
    arrays: &LookupArrays<T>,
) -> io::Result<()> {
    writeln!(out, "device {bits} {}", T::UNITS)?;
    writeln!(out, "lower{}", exact(&arrays.lower))?;
    writeln!(out, "upper{}", exact(&arrays.upper))?;
    writeln!(out, "scale{}", exact(&arrays.scale))?;
    let (state, input) = (numbers(&arrays.state_rounding), arrays.input_rounding);
    writeln!(out, "rounding{state} {input:?}")
}

/// The lines of a program, without what is asked of its table.
pub(crate) fn statement_text(form: &ParametricForm) -> String {
    let mut text = String::new();
    let out = &mut text;
    // Texts take everything.
    _ = writeln!(out, "carom-table 1");
    _ = writeln!(out, "sense {}", if form.sign < 0.0 { "max" } else { "min" });
    _ = writeln!(out, "columns {}", form.columns());
    for j in 0..form.columns() {
        let (lower, upper, whole) = (form.lower[j], form.upper[j], form.integral[j]);
        _ = writeln!(out, "c {lower:?} {upper:?} {} {}", u8::from(whole), form.names[j]);
    }
    _ = writeln!(out, "axes {}{}", form.axes.len(), numbers(&form.axes));
    _ = writeln!(out, "rows {}", form.rows.len());
    for row in &form.rows {
        _ = write!(out, "r {:?} {:?} {}", row.lower, row.upper, row.terms.len());
        row.terms.iter().for_each(|(j, a)| _ = write!(out, " {j} {a:?}"));
        _ = writeln!(out);
    }
    _ = writeln!(out, "cost {:?} {}", form.offset, entries(form.linear.iter().copied()));
    for (j, column) in form.quadratic.iter().enumerate() {
        for (i, p) in column.iter().filter(|(i, _)| *i <= j) {
            _ = writeln!(out, "p {i} {j} {p:?}");
        }
    }
    _ = writeln!(out, "lack {}", entries(form.lack.iter().copied()));
    text
}

impl ExplicitTable {
    /// Writes the table with its proofs as a text that the program `carom-proof` checks in exact
    /// arithmetic: `carom-proof table FILE`.
    ///
    /// # Errors
    ///
    /// Those of the writer.
    pub fn write_certificate(&self, mut out: impl Write) -> io::Result<()> {
        let out = &mut out;
        self.write_program(out)?;
        write_device(out, 53, self.double())?;
        write_device(out, 24, &self.single())?;
        let (mut plans, mut evidence) = (Shared::new(), Shared::new());
        for cell in &self.partition.cells {
            let proof = match cell {
                PartitionCell::Plan(law) => {
                    law.plans.iter().for_each(|plan| plans.add(plan));
                    &law.proof
                }
                PartitionCell::NoPlan(proof) => proof,
                PartitionCell::Cut { .. } | PartitionCell::Open => continue,
            };
            for step in &proof.steps {
                if let CellStep::Bound(all) | CellStep::Refuted(all) = step {
                    all.iter().for_each(|one| evidence.add(one));
                }
            }
        }
        writeln!(out, "plans {}", plans.things.len())?;
        for plan in &plans.things {
            if let CornerRelaxation::Solved { x, .. } = &**plan {
                let own = x.iter().zip(&self.form.is_axis);
                writeln!(
                    out,
                    "x {}",
                    entries(own.map(|(&x, is_axis)| if *is_axis { 0.0 } else { x }))
                )?;
            }
        }
        writeln!(out, "evidence {}", evidence.things.len())?;
        for one in &evidence.things {
            let y = entries(one.y.iter().copied());
            match one.is_ray {
                true => writeln!(out, "f {y}")?,
                false => writeln!(out, "b {} {y}", entries(one.z.iter().copied()))?,
            }
        }
        writeln!(out, "cells {}", self.partition.cells.len())?;
        for cell in &self.partition.cells {
            match cell {
                PartitionCell::Cut { edge: [i, j], next: [a, b] } => {
                    writeln!(out, "cut {i} {j} {a} {b}")?;
                }
                PartitionCell::Open => writeln!(out, "open")?,
                PartitionCell::NoPlan(proof) => {
                    writeln!(out, "none {}", proof.steps.len())?;
                    write_steps(out, proof, &evidence)?;
                }
                PartitionCell::Plan(law) => {
                    write!(out, "plan {:?}", law.loss)?;
                    for plan in &law.plans {
                        write!(out, " {}", plans.number(plan))?;
                    }
                    writeln!(out, " {}", law.proof.steps.len())?;
                    write_steps(out, &law.proof, &evidence)?;
                }
            }
        }
        self.write_programs(out, 53, (size_of::<f64>(), CONDENSED_ROUNDING))?;
        self.write_programs(out, 24, (size_of::<f32>(), SINGLE_UNIT))?;
        writeln!(out, "end")
    }

    fn write_program(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(statement_text(&self.form).as_bytes())?;
        writeln!(out, "loss {:?} {:?}", self.goal[0], self.goal[1])?;
        writeln!(out, "tolerance {PLAN_TOLERANCE:?}")?;
        writeln!(out, "inputs {}", self.outputs.len())?;
        for output in &self.outputs {
            write!(out, "i {:?} {}", output.offset, output.terms.len())?;
            output.terms.iter().try_for_each(|(j, a)| write!(out, " {j} {a:?}"))?;
            writeln!(out)?;
        }
        let Some(closed) = &self.closed else { return writeln!(out, "next 0") };
        writeln!(out, "next {} {:?}", closed.next.len(), closed.finest)?;
        for (disturbance, next) in &closed.next {
            write!(out, "n {disturbance:?} {:?} {}", next.offset, next.terms.len())?;
            next.terms.iter().try_for_each(|(j, a)| write!(out, " {j} {a:?}"))?;
            writeln!(out)?;
        }
        let goal = closed.goal.as_flattened();
        writeln!(out, "goal {}{}", closed.goal.len(), numbers(goal))
    }
}

fn write_steps(
    out: &mut impl Write,
    proof: &CellProof,
    evidence: &Shared<Evidence>,
) -> io::Result<()> {
    for step in &proof.steps {
        let (word, all) = match step {
            CellStep::Cut { column, value } => {
                writeln!(out, "s {column} {value:?}")?;
                continue;
            }
            CellStep::Bound(all) => ("b", all),
            CellStep::Refuted(all) => ("f", all),
        };
        let all: String = all.iter().map(|one| format!(" {}", evidence.number(one))).collect();
        writeln!(out, "{word}{all}")?;
    }
    Ok(())
}
