//! The programs of devices in the certificate of a table.

use std::io::{self, Write};

use carom_embedded::{LookupLeaf, LookupNumber, LookupProgram, LookupTable};

use crate::build::PartitionCell;
use crate::device_cells::{DeviceCells, corner_shares};
use crate::followed_program::{DeviceProgram, ShareCorners};
use crate::relaxed::CornerRelaxation;
use crate::simplex_cell::orders;
use crate::table::ExplicitTable;

/// What is added to the largest difference between inputs of programs and plans, because it is
/// computed in floats.
const APART_ROUNDING: f64 = 1e-6;

/// The inputs of a program at a state in shares of the sides, as a device finds them.
fn solve(program: &DeviceProgram, shares: &[f64], inputs: usize) -> Option<Vec<f64>> {
    let n = shares.len();
    let (lower, upper) = (vec![0.0; n], vec![1.0; n]);
    let (scale, roots) = (vec![f64::from(f64::UNITS); n], orders(n));
    let roots = vec![LookupTable::<f64>::LEAF; roots.len()];
    let table = LookupTable {
        lower: &lower,
        upper: &upper,
        scale: &scale,
        roots: &roots,
        nodes: &[],
        leaves: &[LookupLeaf::Solve { program: 0, loss: 0.0 }],
        laws: &[],
        values: &[],
        programs: &[LookupProgram {
            rows: program.rows as u32,
            first: 0,
            exchanges: program.exchanges as u32,
            negative: program.negative,
            positive: program.positive,
        }],
        numbers: &program.numbers,
        inputs,
        depth: 0,
    };
    let (mut found, mut work) = (vec![0.0; inputs], vec![0.0; table.work()]);
    table.solve(shares, &mut found, &mut work).has_inputs().then_some(found)
}

impl ExplicitTable {
    /// By how much the inputs of a program differ from those of plans at corners of its cells.
    fn apart(&self, program: &DeviceProgram, cells: &[usize], corners: &[ShareCorners]) -> f64 {
        let mut most = 0.0_f64;
        for &cell in cells {
            let PartitionCell::Plan(law) = &self.partition.cells[cell] else { continue };
            for (plan, shares) in law.plans.iter().zip(&corners[cell]) {
                let CornerRelaxation::Solved { x, .. } = &**plan else { continue };
                let own = solve(program, shares, self.outputs.len()).unwrap_or_default();
                for (output, own) in self.outputs.iter().zip(own) {
                    most = most.max((output.value(x) - own).abs());
                }
            }
        }
        most
    }

    /// Writes the programs of a device with numbers of so many bits.
    pub(crate) fn write_programs(
        &self,
        out: &mut impl Write,
        bits: u32,
        numbers: (usize, f64),
    ) -> io::Result<()> {
        let mut cells = DeviceCells::solving(&self.form, &self.partition, &self.outputs, numbers);
        if numbers.0 == size_of::<f32>() {
            let values = cells.programs.iter_mut().flat_map(|program| &mut program.numbers);
            values.for_each(|value| *value = f64::from(*value as f32));
        }
        let corners = corner_shares(&self.form, &self.partition);
        let programs = cells.programs.iter().zip(&cells.solved);
        let apart = programs.clone().map(|(program, own)| self.apart(program, own, &corners));
        let apart = apart.fold(0.0, f64::max) * (1.0 + APART_ROUNDING) + APART_ROUNDING;
        writeln!(out, "programs {bits} {} {apart:?}", cells.programs.len())?;
        for (program, own) in programs {
            let DeviceProgram { rows, exchanges, negative, positive, .. } = program;
            writeln!(out, "q {rows} {exchanges} {negative:?} {positive:?}")?;
            write!(out, "m")?;
            program.numbers.iter().try_for_each(|value| write!(out, " {value:?}"))?;
            write!(out, "\nsolves {}", own.len())?;
            own.iter().try_for_each(|cell| write!(out, " {cell}"))?;
            writeln!(out)?;
        }
        Ok(())
    }
}
