//! The programs of devices in the certificate of a table.

use std::io::{self, Write};

use crate::device_cells::DeviceCells;
use crate::followed_program::DeviceProgram;
use crate::table::ExplicitTable;

/// The part added to the most by which an input is off, relative and absolute, because the checker
/// does not round.
const INPUT_OFF_ROOM: f64 = 1e-9;

impl ExplicitTable {
    /// Writes the programs of a device with numbers of so many bits, those of each integers.
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
        writeln!(out, "programs {bits} {}", cells.solved.len())?;
        for group in &cells.solved {
            let DeviceProgram { rows, exchanges, negative, positive, numbers } =
                &cells.programs[group.program];
            let (missed, off) = (group.errors.missed, group.errors.input + INPUT_OFF_ROOM);
            writeln!(out, "q {rows} {exchanges} {negative:?} {positive:?} {missed:?} {off:?}")?;
            for (word, numbers) in [("m", numbers), ("v", &group.columns)] {
                write!(out, "{word}")?;
                numbers.iter().try_for_each(|value| write!(out, " {value:?}"))?;
                writeln!(out)?;
            }
            write!(out, "solves {}", group.cells.len())?;
            group.cells.iter().try_for_each(|(cell, excess)| write!(out, " {cell} {excess:?}"))?;
            writeln!(out)?;
        }
        Ok(())
    }
}
