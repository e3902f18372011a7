//! The program of a table, as it is stated.

use super::closed_loop::{Next, read_next};
use super::convexity::check_blocks;
use super::device::Device;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, Words, rejected, unreadable};
use std::io::BufRead;

/// A column of the program.
#[derive(Debug)]
pub(super) struct Column {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) whole: bool,
    /// Which axis it is.
    pub(super) axis: Option<usize>,
    /// Its rows and coefficients.
    pub(super) terms: Vec<(usize, f64)>,
    /// Its entries of the symmetric matrix of the cost.
    pub(super) squares: Vec<(usize, f64)>,
    pub(super) linear: f64,
}

/// A row: lower limit, upper limit, terms.
type TableRow = (f64, f64, Vec<(u32, f64)>);

/// `min 1/2 x'Px + q'x + offset` over rows and bounds.
#[derive(Debug)]
pub(super) struct Statement {
    pub(super) columns: Vec<Column>,
    /// The columns of the axes.
    pub(super) axes: Vec<usize>,
    pub(super) rows: Vec<TableRow>,
    pub(super) offset: f64,
    /// The loss that is asked for: absolute, and relative to the least cost.
    pub(super) loss: [f64; 2],
    /// By how much rows and bounds may be missed.
    pub(super) tolerance: f64,
    /// The inputs of a look-up: constants and terms of columns that are no axes.
    pub(super) inputs: Vec<(f64, Vec<(u32, f64)>)>,
    /// Where the axes are at the next sample; empty if nothing is said of it.
    pub(super) next: Vec<Next>,
    /// The longest edge of a piece of a cell in the loop, as a share of the side.
    pub(super) finest: f64,
    /// A range of each axis that the loop is to reach; empty if there is none.
    pub(super) goal: Vec<[f64; 2]>,
    /// Those with 64 bits and with 32.
    pub(super) devices: Vec<Device>,
    /// By how much the cost may miss being convex, over the bounds of the columns.
    pub(super) lack: Dyadic,
}

/// A number that is not negative.
fn size(words: &mut Words<'_>, meaning: &str) -> Result<f64, Refusal> {
    let value = words.number(meaning)?;
    if value >= 0.0 { Ok(value) } else { rejected(format!("{meaning} is negative")) }
}

impl Statement {
    pub(super) fn read<R: BufRead>(lines: &mut Lines<R>) -> Result<Self, Refusal> {
        let mut words = lines.expect("carom-table")?;
        if words.count("the version")? != 1 {
            return unreadable("this checker knows version 1 of the format only");
        }
        words.end()?;
        let mut words = lines.expect("sense")?;
        if !matches!(words.word("the sense")?, "min" | "max") {
            return unreadable("the sense is neither `min` nor `max`");
        }
        words.end()?;
        let columns = Self::read_columns(lines)?;
        let n = columns.len();
        let mut words = lines.expect("axes")?;
        let count = words.count("the number of axes")?;
        if count == 0 || count > 6 {
            return rejected("there are from 1 to 6 axes");
        }
        let mut statement = Statement {
            columns,
            axes: Vec::new(),
            rows: Vec::new(),
            offset: 0.0,
            loss: [0.0; 2],
            tolerance: 0.0,
            inputs: Vec::new(),
            next: Vec::new(),
            finest: 1.0,
            goal: Vec::new(),
            devices: Vec::new(),
            lack: Dyadic::zero(),
        };
        for axis in 0..count {
            let j = words.index("column", n)?;
            let column = &mut statement.columns[j];
            let is_range = column.lower < column.upper && column.upper - column.lower < f64::MAX;
            if column.axis.is_some() || column.whole || !is_range {
                return rejected(format!("column {j} is no axis, or is one twice"));
            }
            column.axis = Some(axis);
            statement.axes.push(j);
        }
        words.end()?;
        statement.read_rows(lines)?;
        statement.read_cost(lines)?;
        let mut words = lines.expect("tolerance")?;
        statement.tolerance = size(&mut words, "the tolerance")?;
        words.end()?;
        let mut words = lines.expect("inputs")?;
        let inputs = words.count("the number of inputs")?;
        words.end()?;
        for _ in 0..inputs {
            let mut words = lines.expect("i")?;
            let own = (words.number("the constant")?, words.entries(n)?);
            words.end()?;
            if own.1.iter().any(|entry| statement.columns[entry.0 as usize].axis.is_some()) {
                return rejected("an input has an axis in it");
            }
            statement.inputs.push(own);
        }
        read_next(lines, &mut statement)?;
        for bits in [53, 24] {
            let device = Device::read(lines, &statement)?;
            device.check(&statement, bits)?;
            statement.devices.push(device);
        }
        Ok(statement)
    }

    fn read_columns<R: BufRead>(lines: &mut Lines<R>) -> Result<Vec<Column>, Refusal> {
        let mut words = lines.expect("columns")?;
        let count = words.count("the number of columns")?;
        words.end()?;
        let mut columns = Vec::new();
        for j in 0..count {
            let mut words = lines.expect("c")?;
            let lower = words.number("the lower bound")?;
            let upper = words.number("the upper bound")?;
            let whole = words.index("kind", 2)? == 1;
            words.name();
            if lower > upper {
                return rejected(format!("the bounds of column {j} cross"));
            }
            columns.push(Column {
                lower,
                upper,
                whole,
                axis: None,
                terms: Vec::new(),
                squares: Vec::new(),
                linear: 0.0,
            });
        }
        Ok(columns)
    }

    fn read_rows<R: BufRead>(&mut self, lines: &mut Lines<R>) -> Result<(), Refusal> {
        let mut words = lines.expect("rows")?;
        let count = words.count("the number of rows")?;
        words.end()?;
        for i in 0..count {
            let mut words = lines.expect("r")?;
            let lower = words.limit("the lower limit")?;
            let upper = words.limit("the upper limit")?;
            let terms = words.entries(self.columns.len())?;
            words.end()?;
            for &(j, a) in &terms {
                self.columns[j as usize].terms.push((i, a));
            }
            self.rows.push((lower, upper, terms));
        }
        Ok(())
    }

    /// Reads the cost, what it lacks of being convex, and the loss.
    fn read_cost<R: BufRead>(&mut self, lines: &mut Lines<R>) -> Result<(), Refusal> {
        let n = self.columns.len();
        let mut words = lines.expect("cost")?;
        self.offset = words.number("the offset")?;
        for (j, q) in words.entries(n)? {
            self.columns[j as usize].linear = q;
        }
        words.end()?;
        loop {
            let (mut words, keyword) = lines.expect_any(&["p", "lack"])?;
            if keyword == "lack" {
                let lack = words.entries(n)?;
                words.end()?;
                self.check_convexity(&lack)?;
                break;
            }
            let (i, j) = (words.index("column", n)?, words.index("column", n)?);
            let p = words.number("an entry")?;
            words.end()?;
            if self.columns[i].squares.iter().any(|entry| entry.0 == j) {
                return unreadable("an entry of the cost is listed twice");
            }
            self.columns[i].squares.push((j, p));
            if i != j {
                self.columns[j].squares.push((i, p));
            }
        }
        let mut words = lines.expect("loss")?;
        self.loss =
            [size(&mut words, "the absolute loss")?, size(&mut words, "the relative loss")?];
        words.end()
    }

    /// Checks that the cost with squares `lack_j x_j^2 / 2` is convex in the columns that are no
    /// axes. Then the cost is above its tangents at points within the bounds, but for
    /// `lack_j (x_j - z_j)^2 / 2`, which is at most `lack_j (upper - lower)^2 / 2`.
    fn check_convexity(&mut self, lack: &[(u32, f64)]) -> Result<(), Refusal> {
        let mut entries = Vec::new();
        for (j, column) in self.columns.iter().enumerate().filter(|(_, c)| c.axis.is_none()) {
            let own = column.squares.iter().filter(|(k, _)| *k <= j);
            let own = own.filter(|(k, _)| self.columns[*k].axis.is_none());
            entries.extend(own.map(|&(k, p)| (k, j, p)));
        }
        let mut sum = Sum::default();
        let mut total = Sum::default();
        for &(j, lack) in lack {
            let (j, column) = (j as usize, &self.columns[j as usize]);
            if lack < 0.0 {
                return rejected(format!("what column {j} lacks is negative"));
            }
            entries.push((j, j, lack));
            sum.add(column.upper, 1.0);
            sum.subtract(column.lower, 1.0);
            let width = sum.take()?;
            sum.add(&width, &width);
            total.add(&sum.take()?, lack);
        }
        self.lack = total.take()?.half();
        check_blocks(self.columns.len(), &entries)
    }
}
