//! Checks tables of laws, in exact arithmetic and without a line of carom.
//!
//! A table states a program with parameters in a box, cuts the box into simplices, and says of each
//! simplex which plan holds there and what it loses, or that there is none. `statement` reads what
//! is said of the program and the device, `evidence` bounds costs over a simplex, `cells` walks the
//! tree, `leaves` checks plans and proofs, `closed_loop` says where the loop stays. `programs`
//! reads what a device solves, and `exchanges` follows it.

mod cells;
mod closed_loop;
mod convexity;
mod device;
mod evidence;
mod exchanges;
mod leaves;
mod programs;
mod statement;

pub use self::programs::ProvedPrograms;
use crate::exact::Plain;
use crate::text::{Failure, Lines, Refusal, unreadable};
use std::fmt;
use std::io::BufRead;

/// The proved parts of a table. Shares are parts of the box, from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProvedTable {
    /// The number of cells that are not cut.
    pub cells: u64,
    /// The share with a plan whose loss is at most what was asked for.
    pub within: f64,
    /// The share with a plan whose loss is proved and larger.
    pub larger: f64,
    /// The share with a plan that keeps its rows, and no proof of its loss.
    pub unproved: f64,
    /// The share without a plan.
    pub refuted: f64,
    /// The share without an answer.
    pub open: f64,
    /// The largest loss of those within.
    pub loss: f64,
    /// The share from which the loop stays in it: each state has a plan, and its next states are in
    /// this share again. `None` if the table does not say where the next states are.
    pub stays: Option<f64>,
    /// The share of those from which the loop is in the goal after some steps, and the most steps.
    /// `None` if the table has no goal.
    pub reaches: Option<(f64, u64)>,
    /// The most cuts on a way to a cell.
    pub depth: u64,
    /// The programs of the devices with 64 bits and with 32.
    pub programs: [ProvedPrograms; 2],
}

impl fmt::Display for ProvedTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| 100.0 * share;
        write!(
            f,
            "proved: {} cells cover the set; {:.3} % with a plan within the loss asked for (at \
             most {}), {:.3} % with a larger loss, {:.3} % with a plan alone, {:.3} % without a \
             plan, {:.3} % open; at most {} cuts",
            self.cells,
            percent(self.within),
            Plain(self.loss),
            percent(self.larger),
            percent(self.unproved),
            percent(self.refuted),
            percent(self.open),
            self.depth,
        )?;
        if let Some(share) = self.stays {
            write!(f, "; {:.3} % from which the loop stays there", percent(share))?;
        }
        if let Some((share, steps)) = self.reaches {
            let share = percent(share);
            write!(f, ", {share:.3} % from which it is in the goal after at most {steps} steps")?;
        }
        for (bits, programs) in [64, 32].into_iter().zip(&self.programs) {
            let ProvedPrograms { share, exchanges, missed, off, excess } = *programs;
            if share > 0.0 {
                write!(
                    f,
                    "; with {bits} bits, {:.3} % whose cells solve programs: at most {exchanges} \
                     exchanges, rows missed by at most {}, inputs off by at most {}, cost above that of \
                     the plan by at most {}",
                    percent(share),
                    Plain(missed),
                    Plain(off),
                    Plain(excess)
                )?;
            }
        }
        Ok(())
    }
}

/// Checks a table, line by line.
///
/// # Errors
///
/// A [`Failure`] names the first line that is not valid, and why.
pub fn check_table(table: impl BufRead) -> Result<ProvedTable, Failure> {
    let mut lines = Lines::new(table);
    check_lines(&mut lines).map_err(|refusal| lines.at_line(refusal))
}

fn check_lines<R: BufRead>(lines: &mut Lines<R>) -> Result<ProvedTable, Refusal> {
    let statement = statement::Statement::read(lines)?;
    let proved = cells::Checked::read(lines, &statement)?.walk(lines, &statement)?;
    lines.expect("end")?.end()?;
    match lines.next()? {
        None => Ok(proved),
        Some(_) => unreadable("the table goes on behind `end`"),
    }
}
